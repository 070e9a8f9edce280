// SPDX-License-Identifier: Apache-2.0
// Directions on the hemisphere above a surface.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace sateen {

/// A direction away from the surface: theta from the normal (+z), phi from +x (columns)
/// counter-clockwise towards +y (up, so minus rows). Radians.
struct Direction {
    float theta = 0;
    float phi = 0;
    friend bool operator==(const Direction&, const Direction&) = default;
};

/// The unit vector (sin θ cos φ, sin θ sin φ, cos θ).
inline std::array<float, 3> to_vector(Direction d) {
    return {std::sin(d.theta) * std::cos(d.phi), std::sin(d.theta) * std::sin(d.phi),
            std::cos(d.theta)};
}

inline constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180.0F;

inline Direction direction_from_degrees(float theta_deg, float phi_deg) {
    return {theta_deg * kRadiansPerDegree, phi_deg * kRadiansPerDegree};
}

}  // namespace sateen
