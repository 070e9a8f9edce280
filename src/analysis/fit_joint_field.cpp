// SPDX-License-Identifier: Apache-2.0
// The field of all planes of one level. See fit_field.hpp.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/fit_field.hpp"
#include "sateen/analysis/autoregression3d.hpp"
#include "sateen/analysis/neighbourhood.hpp"

namespace sateen {
namespace {

/// Λ is called nearly singular where a singular value is smaller. A peak of the spectrum
/// makes it small as well, so by itself that is no fault.
constexpr double kNearlySingular = 0.02;
constexpr double kWrongVariance = 2;
constexpr double kLargestGrid = 128;

std::vector<std::size_t> varying_planes(const CrossAutocovariance& R) {
    std::vector<std::size_t> planes;
    for (std::size_t i = 0; i < R.planes(); ++i)
        if (R.plane(i).variance() >= kNegligibleVariance) planes.push_back(i);
    return planes;
}

/// Σ_i R_ii, for rules that look at one plane; a coefficient costs d unknowns a plane.
Autocovariance summed(const CrossAutocovariance& R,
                      const std::vector<std::size_t>& planes) {
    const double d = static_cast<double>(planes.size());
    const int reach = R.plane(0).reach();
    Autocovariance sum(reach, R.sites() / d);
    for (const std::size_t i : planes)
        for (int row = 0; row <= reach; ++row)
            for (int col = -reach; col <= reach; ++col)
                sum.at(row, col) += R.plane(i)(row, col);
    return sum;
}

/// The hierarchical half plane of largest evidence, or what another rule gives.
Result<std::vector<Offset>> select_joint(const CrossAutocovariance& R,
                                         const std::vector<std::size_t>& planes,
                                         const NeighbourhoodOptions& options) {
    const Autocovariance sum = summed(R, planes);
    if (options.rule != NeighbourhoodRule::evidence)
        return select_neighbourhood(sum, options);
    std::vector<Offset> best;
    double best_evidence = 0;
    const int last = affordable_order(sum.sites(), options.value);
    for (int order = 1; order <= last; ++order) {
        const auto offsets = hierarchical_half_plane(order);
        SATEEN_TRY(const Car3dEstimate estimate,
                   estimate_car3d(toroidal_joint_equations(R, planes, offsets)));
        if (best.empty() || estimate.log_evidence > best_evidence) {
            best = offsets;
            best_evidence = estimate.log_evidence;
        }
    }
    return best;
}

std::vector<Offset> with_mirrored(std::vector<Offset> offsets) {
    const std::size_t half = offsets.size();
    for (std::size_t i = 0; i < half; ++i)
        offsets.push_back({static_cast<std::int8_t>(-offsets[i].row),
                           static_cast<std::int8_t>(-offsets[i].col)});
    return offsets;
}

/// Exactly the variances of the sample where the model is sound; a note where it is not.
void finish(Autoregression3d& model, const CrossAutocovariance& R,
            const std::vector<std::size_t>& planes, const AnalysisOptions& options,
            const std::string& place, std::vector<std::string>& notes) {
    // A peak at the origin, of clouds as large as the sample, counts as the sample shows it:
    // on the sample's own frequencies, without the mean.
    const int grid = static_cast<int>(std::min(std::sqrt(R.sites()), kLargestGrid));
    const JointMoments implied = moments(model, grid, true);
    std::vector<double> variances;
    double ratio = 0;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        variances.push_back(R.plane(planes[i]).variance());
        ratio =
            std::max(ratio, implied.covariance[i * planes.size() + i] / variances.back());
    }
    const bool wrong = ratio > kWrongVariance || ratio * kWrongVariance < 1;
    if (implied.smallest_singular_value < kNearlySingular && (options.paper || wrong))
        notes.push_back(place + ": Λ is nearly singular, smallest singular value " +
                        std::to_string(implied.smallest_singular_value) +
                        ", variance of the model / of the sample up to " +
                        std::to_string(ratio));
    if (!options.paper) set_variances(model, variances, implied);
    restore_planes(model, planes, R.planes());
}

// Schwarz's criterion with Whittle's deviance of d planes, mean_t (ln |S_t| + tr S_t⁻¹ P_t),
// for least squares on a torus: a causal Λ has ln |Λ| of mean 0, and the trace has mean d.
//
//     n (ln |Σ| + d) + (d² η + d (d + 1)/2) ln n,    Σ = λ/n
//
// while the Bayesian estimate is λ/(β(0) + n).
double information_of(const Car3d& model, double sites) {
    const auto d = static_cast<Eigen::Index>(model.planes);
    const Eigen::MatrixXd Sigma =
        Eigen::Map<const Eigen::MatrixXf>(model.Sigma.data(), d, d).cast<double>();
    const double log_determinant =
        2 * Sigma.llt().matrixLLT().diagonal().array().log().sum();
    const auto planes = static_cast<double>(d);
    const double numbers =
        static_cast<double>(model.A.size()) + planes * (planes + 1) / 2;
    const double shrinkage = planes * std::log1p(Car3dPrior().beta / sites);
    return sites * (log_determinant + shrinkage + planes) + numbers * std::log(sites);
}

}  // namespace

Result<FieldModel> fit_joint_field(const CrossAutocovariance& toroidal,
                                   const AnalysisOptions& options,
                                   const std::string& place, FieldChoice& choice,
                                   std::vector<std::string>& notes) {
    const CrossAutocovariance R = options.paper ? toroidal : toroidal.resolved();
    const std::size_t d = R.planes();
    const bool simultaneous = options.field == FieldKind::sar3d;
    const std::vector<std::size_t> planes = varying_planes(R);
    if (planes.empty()) {
        const Autoregression3d constant{d, {}, {}, std::vector<float>(d * d)};
        return simultaneous ? FieldModel(Sar3d{constant}) : FieldModel(Car3d{constant});
    }
    SATEEN_TRY(auto offsets, select_joint(R, planes, neighbourhood_of(options)));
    // [SAR] symmetric hierarchical neighbourhoods; "the symmetric half" is `nearest`.
    if (simultaneous && options.paper &&
        neighbourhood_of(options).rule != NeighbourhoodRule::nearest &&
        offsets.size() <= kMaxNeighbours / 2)
        offsets = with_mirrored(std::move(offsets));
    const JointEquations equations =
        toroidal_joint_equations(R, planes, std::move(offsets));
    if (simultaneous) {
        SATEEN_TRY(Sar3d model, estimate_sar3d(equations, options.paper));
        finish(model, R, planes, options, place, notes);
        return FieldModel(std::move(model));
    }
    SATEEN_TRY(Car3dEstimate estimate, estimate_car3d(equations));
    choice.add(
        {.car3d = 1, .information_car3d = information_of(estimate.model, R.sites())});
    finish(estimate.model, R, planes, options, place, notes);
    return FieldModel(std::move(estimate.model));
}

}  // namespace sateen
