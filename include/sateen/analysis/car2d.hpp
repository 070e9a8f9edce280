// SPDX-License-Identifier: Apache-2.0
// Estimation of the two-dimensional causal autoregressive model.
// Theory: docs/theory/car2d.md. Partners: material/field_model.hpp, synthesis/car2d.
#pragma once

#include <span>
#include <vector>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/analysis/options.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen {

/// The data matrices of [CAR2, eq. 2] without the prior, for a neighbourhood of η
/// offsets:
///
///     V_xx = Σ X_r X_rᵀ (η, η)   V_xy = Σ X_r Y_r (η)   V_yy = Σ Y_r²
struct NormalEquations {
    std::vector<Offset> neighbourhood;
    std::vector<double> V_xx;
    std::vector<double> V_xy;
    double V_yy = 0;
    double sites = 0;  ///< how many r were summed
};

/// On a torus every entry is an autocovariance: V_xx(s, t) = n R(s - t), V_xy(s) = n
/// R(s).
[[nodiscard]] NormalEquations toroidal_normal_equations(
    const Autocovariance& R, std::vector<Offset> neighbourhood);
/// Sums over the sites whose whole neighbourhood lies in the plane, as [CAR2] does.
[[nodiscard]] NormalEquations interior_normal_equations(
    PlaneView<const float> plane, std::vector<Offset> neighbourhood);

/// The normal-gamma prior. Its matrices are those of `weight` imagined white samples of
/// the data's variance: V_xx(0) = weight σ_Y² I, V_yy(0) = weight σ_Y².
struct Car2dPrior {
    double weight = 1e-3;
    /// β(0), the same for all compared neighbourhoods; must exceed η - 2.
    double beta = static_cast<double>(kMaxNeighbours);
};

struct Car2dEstimate {
    Car2d model;
    double lambda = 0;  ///< λ of the posterior
    double log_evidence =
        0;  ///< ln p(Y | neighbourhood), comparable between neighbourhoods
};

/// The Bayesian estimate [CAR2, eq. 2], V = V_data + V(0):
///
///     γ̂ᵀ = V_xx⁻¹ V_xy    λ = V_yy - V_xyᵀ V_xx⁻¹ V_xy    σ̂² = λ / β,  β = β(0) + n
///
/// and the exact logarithm of the evidence of its neighbourhood.
/// \error singular  V_xx + V(0) is not positive definite (a constant plane)
/// \cost  O(η³)
[[nodiscard]] Result<Car2dEstimate> estimate_car2d(const NormalEquations& equations,
                                                   const Car2dPrior& prior = {});

/// The same estimate, site by site (Sherman-Morrison), as a tracker that could follow a
/// slowly changing texture; equals estimate_car2d() after the last site.
class RecursiveCar2d {
  public:
    RecursiveCar2d(std::vector<Offset> neighbourhood, double variance,
                   const Car2dPrior& prior);
    /// Predicts Y_r from X_r (η values in neighbourhood order), then learns from it.
    /// \returns the logarithm of the predictive density of Y_r, a Student t
    double update(std::span<const double> X_r, double Y_r);
    [[nodiscard]] Car2d model() const;

  private:
    std::vector<Offset> neighbourhood_;
    std::vector<double> inverse_;  ///< V_xx⁻¹
    std::vector<double> gamma_;
    double lambda_;
    double beta_;
};

/// The spectral radius of the recursion: below 1 it is stable and transients die out as
/// ρ^rows. Tested within rows by the companion matrix of the same-row polynomial, between
/// rows by the block companion matrix at `frequencies` column frequencies (algorithm of
/// the DeCarlo-Strintzis type).
[[nodiscard]] double spectral_radius(const Car2d& model, std::size_t frequencies = 256);

/// Bandwidth expansion a_s ← g^(|s1|+|s2|) a_s with the largest g that brings the
/// spectral radius below `radius`, σ² rescaled so that the model keeps the variance
/// given.
[[nodiscard]] Car2d stabilised(const Car2d& model, double variance, double radius = 0.98);

/// The variance that the model implies, the mean of its spectral density on a grid.
[[nodiscard]] double model_variance(const Car2d& model, std::size_t grid = 128);

}  // namespace sateen
