// SPDX-License-Identifier: Apache-2.0
// Estimation of the three-dimensional causal and simultaneous autoregressive models.
// Theory: docs/theory/car3d.md, docs/theory/sar3d.md. Partners: material/field_model.hpp,
// synthesis/joint_field.
#pragma once

#include <vector>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen {

/// The data matrices of [CAR2, eq. 2] for d planes and η offsets: X_r stacks Y_{r-s}.
///
///     V_xx = Σ X Xᵀ (ηd, ηd)    V_xy = Σ X Yᵀ (ηd, d)    V_yy = Σ Y Yᵀ (d, d)
struct JointEquations {
    std::size_t planes = 0;
    std::vector<Offset> neighbourhood;
    std::vector<double> V_xx;
    std::vector<double> V_xy;
    std::vector<double> V_yy;
    double sites = 0;
};

/// On a torus every entry is a covariance: V_xx((s,i),(t,j)) = n R_ij(t - s),
/// V_xy((s,i),j) = n R_ij(-s). Any neighbourhood.
/// \param planes  those that vary, ascending; the others are left out
[[nodiscard]] JointEquations toroidal_joint_equations(
    const CrossAutocovariance& R, const std::vector<std::size_t>& planes,
    std::vector<Offset> neighbourhood);

/// The normal-Wishart prior of `weight` imagined white samples of the planes' variances.
struct Car3dPrior {
    double weight = 1e-3;
    /// β(0), the same for all compared neighbourhoods; must exceed dη - 2.
    double beta = static_cast<double>(3 * kMaxNeighbours);
};

struct Car3dEstimate {
    Car3d model;
    double log_evidence = 0;  ///< ln p(Y | neighbourhood)
};

/// The Bayesian estimate of [CAR2, eq. 2] for d planes, V = V_data + V(0):
///
///     γ̂ᵀ = V_xx⁻¹ V_xy    λ = V_yy - V_xyᵀ V_xx⁻¹ V_xy    Σ̂ = λ / β,  β = β(0) + n
///
/// with full Σ, and the exact logarithm of the evidence.
/// \error singular  V_xx + V(0) or λ is not positive definite
[[nodiscard]] Result<Car3dEstimate> estimate_car3d(const JointEquations& equations,
                                                   const Car3dPrior& prior = {});

/// Least squares [SAR, eq. 9] with the full residual covariance Σ̂ = mean ê êᵀ. Consistent
/// on one-sided neighbourhoods, where it is a CAR on the torus; on symmetric ones it
/// estimates something else.
/// Deviation: [SAR, eq. 8] keeps the diagonal of Σ only, which loses the correlation of
/// the planes; see `diagonal`.
/// \param diagonal  as printed
[[nodiscard]] Result<Sar3d> estimate_sar3d(const JointEquations& equations,
                                           bool diagonal = false);

/// What a model implies: the covariance of Y_r, the mean of S(ω) over a (grid, grid)
/// torus, and the smallest singular value of Λ(ω), near 0 for an unstable one.
struct JointMoments {
    std::vector<double> covariance;  ///< (d, d)
    double smallest_singular_value = 0;
};
/// \param about_mean  leave out ω = 0, as samples do whose mean was taken away
[[nodiscard]] JointMoments moments(const Autoregression3d& model, int grid = 64,
                                   bool about_mean = false);

/// Scales the planes, A_ij f_i/f_j and Σ_ij f_i f_j, to the variances given.
void set_variances(Autoregression3d& model, const std::vector<double>& variances,
                   const JointMoments& present);

/// The model with the planes left out put back, as constants. \param d  of all
void restore_planes(Autoregression3d& model, const std::vector<std::size_t>& planes,
                    std::size_t d);

}  // namespace sateen
