// SPDX-License-Identifier: Apache-2.0
// K-means by definition: the inertia of a partition, and the least of all partitions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "sateen/core/image.hpp"

namespace sateen::reference {

/// Σ_i ‖x_i - mean of its cluster‖² for labels below `clusters`.
inline double inertia(PlaneView<const double> points,
                      const std::vector<std::uint32_t>& labels, std::size_t clusters) {
    double total = 0;
    for (std::size_t k = 0; k < clusters; ++k) {
        for (std::size_t f = 0; f < points.cols; ++f) {
            double sum = 0;
            double count = 0;
            for (std::size_t i = 0; i < points.rows; ++i) {
                if (labels[i] != k) continue;
                sum += points(i, f);
                ++count;
            }
            for (std::size_t i = 0; i < points.rows; ++i) {
                const double d = points(i, f) - sum / count;
                if (labels[i] == k) total += d * d;
            }
        }
    }
    return total;
}

/// The least inertia of all partitions into at most `clusters` sets: every labelling in
/// which a new label is one more than the largest before it. For about 10 points.
inline double least_inertia(PlaneView<const double> points, std::size_t clusters) {
    std::vector<std::uint32_t> labels(points.rows);
    double least = std::numeric_limits<double>::infinity();
    const auto label_from = [&](const auto& self, std::size_t at,
                                std::uint32_t used) -> void {
        if (at == points.rows) {
            least = std::min(least, inertia(points, labels, used));
            return;
        }
        for (std::uint32_t k = 0; k <= used && k < clusters; ++k) {
            labels[at] = k;
            self(self, at + 1, std::max(used, k + 1));
        }
    };
    label_from(label_from, 0, 0);
    return least;
}

}  // namespace sateen::reference
