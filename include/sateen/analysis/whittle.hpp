// SPDX-License-Identifier: Apache-2.0
// How well a field of one plane explains the covariances of a sample: the same measure for
// every model. Theory: docs/theory/field_choice.md.
#pragma once

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen {

/// b(s), |s1|, |s2| <= twice the reach of the field, with 1 / S(ω) = Σ_s b(s) cos ω·s.
[[nodiscard]] Autocovariance inverse_covariance(const Car2d& field);
[[nodiscard]] Autocovariance inverse_covariance(const Gmrf2d& field);

/// The variance of the field: the mean of S over a (grid, grid) torus.
[[nodiscard]] double field_variance(const Autocovariance& inverse, int grid = 128);

/// Whittle's deviance for one site, -2 ln p / n without constants,
///
///     D = mean_t (ln S_t + P_t / S_t) = -mean_t ln Σ_s b(s) cos ω·s + Σ_s b(s) R(s),
///
/// of a sample with periodogram P, of which only R(s) at the lags of b is needed. NaN where
/// Σ_s b(s) cos ω·s is not positive.
[[nodiscard]] double whittle_deviance(const Autocovariance& inverse,
                                      const Autocovariance& R, int grid = 128);

/// Schwarz's criterion for a field of `coefficients`: n D + (coefficients + 1) ln n.
[[nodiscard]] double bayesian_information(double deviance, double sites,
                                          std::size_t coefficients);

}  // namespace sateen
