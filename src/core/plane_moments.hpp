// SPDX-License-Identifier: Apache-2.0
// Mean and variance of a plane.
#pragma once

#include <algorithm>
#include <cstddef>

#include "sateen/core/image.hpp"

namespace sateen {

struct PlaneMoments {
    double mean = 0;
    double variance = 0;  ///< never negative
};

[[nodiscard]] inline PlaneMoments moments_of(PlaneView<const float> plane) {
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const auto value = static_cast<double>(plane.data[i]);
        sum += value;
        squares += value * value;
    }
    const auto n = static_cast<double>(plane.size());
    const double mean = sum / n;
    return {mean, std::max(0.0, squares / n - mean * mean)};
}

}  // namespace sateen
