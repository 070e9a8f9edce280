// SPDX-License-Identifier: Apache-2.0
// Estimation of the two-dimensional Gaussian Markov random field.
// Theory: docs/theory/gmrf2d.md. Partners: material/field_model.hpp,
// synthesis/spectral_density.
#pragma once

#include <vector>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/analysis/options.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen {

/// A Gaussian Markov random field in natural parameters, 1/S(ω) = θ_0 - 2 Σ θ_s cos ω·s:
/// σ² = 1/θ_0, a_s = θ_s/θ_0. The valid ones are a convex set.
struct NaturalGmrf2d {
    std::vector<Offset> neighbourhood;
    double theta_0 = 0;
    std::vector<double> theta;
};

struct Gmrf2dOptions {
    /// The frequency grid is doubled from `first_grid` until that changes nothing, at most
    /// to `last_grid`. Equal ones: the likelihood of exactly that torus.
    int first_grid = 64;
    int last_grid = 256;
};

/// The maximum of the exact likelihood of a torus,
///
///     ℓ/MN = ½ mean_t ln(θ_0 - 2 Σ θ_s cos ω·s) - ½ (θ_0 R(0) - 2 Σ θ_s R(s)),
///
/// strictly concave; the logarithm keeps the spectrum positive. At the maximum the field
/// has exactly the covariances R(0) and R(s): of all fields with these it is the one of
/// largest entropy.
/// \param start  a valid field to start from, whose neighbourhood is the beginning of this
///               one; or null
/// \error singular  the variance is not positive
/// \cost  5 to 20 Newton steps of O(grid² reach + η³)
[[nodiscard]] Result<NaturalGmrf2d> maximise_likelihood(
    const Autocovariance& R, const std::vector<Offset>& neighbourhood,
    const Gmrf2dOptions& options = {}, const NaturalGmrf2d* start = nullptr);

/// 1 - 2 Σ a_s cos ω·s at its minimum over all frequencies, not only those of a grid.
[[nodiscard]] double smallest_denominator(const Gmrf2d& field);

/// b(s) with 1/S(ω) = Σ_s b(s) cos ω·s, in double precision: near a unit root the a_s as
/// floats have another spectrum.
[[nodiscard]] Autocovariance inverse_covariance(const NaturalGmrf2d& field);

/// The field as the material keeps it: coefficients on the grid of the file, shrunk where
/// the spectrum would not stay positive at every frequency, σ² such that the field has
/// exactly the variance given.
[[nodiscard]] Gmrf2d to_material(const NaturalGmrf2d& field, double variance);

/// [GMRF, eq. 12-13]: q_r = [Y_{r-s} + Y_{r+s}], â = (Σ q qᵀ)⁻¹ Σ q Y,
/// σ̂² = mean (Y - âᵀq)², by covariances. Often no valid field: look at the denominator.
/// \error singular
[[nodiscard]] Result<Gmrf2d> maximise_pseudo_likelihood(
    const Autocovariance& R, const std::vector<Offset>& neighbourhood);

/// a ← g a with the largest g that leaves a denominator of at least `smallest`, σ² such
/// that the field has the variance given.
[[nodiscard]] Gmrf2d shrunk(const Gmrf2d& field, double smallest, double variance);

/// The hierarchical order 1 … max_order with the best Bayesian information, and its field.
[[nodiscard]] Result<NaturalGmrf2d> select_gmrf2d(const Autocovariance& R, int max_order);

}  // namespace sateen
