// SPDX-License-Identifier: Apache-2.0
// Slow and plain: what the features of the texture similarity stand for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sateen/core/image.hpp"

namespace sateen::reference {

/// 2-Wasserstein distance of two samples of equal size: sort, and pair them off.
inline double wasserstein_2(std::vector<double> a, std::vector<double> b) {
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    double square = 0;
    for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(square / static_cast<double>(a.size()));
}

/// Σ x(r, c) x(r + dr, c + dc) on the torus.
inline double circular_product(PlaneView<const float> x, std::size_t dr, std::size_t dc) {
    double sum = 0;
    for (std::size_t r = 0; r < x.rows; ++r) {
        for (std::size_t c = 0; c < x.cols; ++c) {
            sum += static_cast<double>(x(r, c)) *
                   static_cast<double>(x((r + dr) % x.rows, (c + dc) % x.cols));
        }
    }
    return sum;
}

}  // namespace sateen::reference
