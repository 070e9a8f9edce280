// SPDX-License-Identifier: Apache-2.0
// Fields of known parameters, and the statistics that the estimators take.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "reference/stationary_field.hpp"
#include "sateen/analysis/autocovariance.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen::test {

/// Stable although Σ|a| = 1.15.
inline Car2d quarter_plane_field() {
    return {{{0, 1}, {1, 0}, {1, 1}}, {0.5F, 0.45F, -0.2F}, 1};
}

/// A half plane that looks to the right as well.
inline Car2d half_plane_field() {
    return {{{0, 1}, {1, 0}, {1, -1}, {1, 1}}, {0.45F, 0.3F, 0.2F, -0.15F}, 0.5F};
}

/// Variance 1 / ((1 - a²)(1 - b²)), correlation a^|s2| b^|s1|.
inline Car2d separable_field(float a, float b) {
    return {{{0, 1}, {1, 0}, {1, 1}}, {a, b, -a * b}, 1};
}

/// The autocovariances of a plane by direct sums.
inline Autocovariance direct_autocovariance(const reference::DoublePlane& plane,
                                            int reach) {
    Autocovariance R(reach, static_cast<double>(plane.values.size()));
    for (int row = 0; row <= reach; ++row) {
        for (int col = -reach; col <= reach; ++col)
            R.at(row, col) = reference::autocovariance(plane, row, col);
    }
    return R;
}

}  // namespace sateen::test
