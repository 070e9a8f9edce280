// SPDX-License-Identifier: Apache-2.0
// The variance of a plane.
#pragma once

#include <algorithm>
#include <cstddef>

#include "sateen/core/image.hpp"

namespace sateen {

[[nodiscard]] inline double variance_of(PlaneView<const float> plane) {
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const auto value = static_cast<double>(plane.data[i]);
        sum += value;
        squares += value * value;
    }
    const double n = static_cast<double>(plane.size());
    return std::max(0.0, squares / n - sum * sum / (n * n));
}

}  // namespace sateen
