// SPDX-License-Identifier: Apache-2.0
// Arithmetic of three numbers.
#pragma once

#include <cmath>

#include "sateen/render/mesh.hpp"

namespace sateen::vector3 {

inline float dot(const Vector3& a, const Vector3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]};
}
inline Vector3 sum(const Vector3& a, const Vector3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector3 times(const Vector3& a, float factor) {
    return {a[0] * factor, a[1] * factor, a[2] * factor};
}
inline Vector3 difference(const Vector3& a, const Vector3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// Zero stays zero.
inline Vector3 unit(const Vector3& a) {
    const float length = std::sqrt(dot(a, a));
    return length > 0 ? times(a, 1 / length) : a;
}

}  // namespace sateen::vector3
