// SPDX-License-Identifier: Apache-2.0
// Estimating smooth fields. Theory: docs/theory/periodic_layer.md. Partner:
// synthesis/smooth_field.
#pragma once

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/structure.hpp"

namespace sateen {

/// The smooth field whose covariances are nearest to those of a sample, in least squares
/// over lags up to 40 sites or half the sample, each with the weight of its reciprocal
/// distance: weights that are not negative, by coordinate descent.
/// \param sample  about 0
[[nodiscard]] SmoothField fit_smooth_field(PlaneView<const float> sample,
                                           Executor& executor);

}  // namespace sateen
