// SPDX-License-Identifier: Apache-2.0
// Estimating smooth fields. Theory: docs/theory/periodic_layer.md. Partner:
// synthesis/smooth_field.
#pragma once

#include <cstddef>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/structure.hpp"

namespace sateen {

/// Covariances of a sample over lags from 0 to `down` and `across` sites, even in both.
struct CovarianceTable {
    std::size_t down;
    std::size_t across;
    std::vector<double> values;

    /// Lags up to 40 sites or half a sample of this size.
    CovarianceTable(std::size_t rows, std::size_t cols);
    [[nodiscard]] double& operator()(std::size_t row, std::size_t col) {
        return values[row * (across + 1) + col];
    }
    [[nodiscard]] double operator()(std::size_t row, std::size_t col) const {
        return values[row * (across + 1) + col];
    }
};

/// The mean of y(x) y(x + (r, ±c)): a mixture of bells is even in both.
/// \param sample  y, about 0
[[nodiscard]] Result<CovarianceTable> covariances_of(PlaneView<const float> sample,
                                                     Executor& executor);

/// The smooth field whose covariances are nearest to those given, in least squares, each
/// with the weight of its reciprocal distance: weights that are not negative, by coordinate
/// descent.
[[nodiscard]] SmoothField fit_smooth_field(const CovarianceTable& R);

}  // namespace sateen
