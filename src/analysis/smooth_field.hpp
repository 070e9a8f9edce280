// SPDX-License-Identifier: Apache-2.0
// Estimating smooth fields. Theory: docs/theory/periodic_layer.md. Partner:
// synthesis/smooth_field.
#pragma once

#include <cstddef>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
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

/// The smooth field whose covariances are nearest to those given.
[[nodiscard]] SmoothField fit_smooth_field(const CovarianceTable& R);

/// The smooth field whose covariances are nearest to those of a sample, in least squares
/// over lags up to 40 sites or half the sample, each with the weight of its reciprocal
/// distance: weights that are not negative, by coordinate descent.
/// \param sample  about 0
[[nodiscard]] SmoothField fit_smooth_field(PlaneView<const float> sample,
                                           Executor& executor);

}  // namespace sateen
