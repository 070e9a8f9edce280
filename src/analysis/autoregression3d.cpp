// SPDX-License-Identifier: Apache-2.0
// Estimation of autoregressive models of several planes. See autoregression3d.hpp.
#include "sateen/analysis/autoregression3d.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "analysis/lag_transform.hpp"

namespace sateen {
namespace {

using Eigen::Index;
using Complex = std::complex<double>;
/// At most 3 planes, never on the heap.
using SmallComplex = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;

Index index(std::size_t i) {
    return static_cast<Index>(i);
}

Eigen::Map<const RowMatrix> map(const std::vector<double>& values, Index rows,
                                Index cols) {
    return {values.data(), rows, cols};
}

double log_determinant(const Eigen::LLT<RowMatrix>& cholesky) {
    return 2 * cholesky.matrixLLT().diagonal().array().log().sum();
}

struct Regression {
    RowMatrix gamma_transposed;  ///< (ηd, d)
    RowMatrix lambda;            ///< (d, d)
    double log_det_V_xx = 0;
    double log_det_lambda = 0;
};

Result<Regression> regress(const RowMatrix& V_xx, const RowMatrix& V_xy,
                           const RowMatrix& V_yy) {
    const Eigen::LLT<RowMatrix> cholesky(V_xx);
    if (cholesky.info() != Eigen::Success)
        return Error{Errc::singular, "V_xx of " + std::to_string(V_xx.rows()) +
                                         " unknowns is not positive definite"};
    Regression result;
    result.gamma_transposed = cholesky.solve(V_xy);
    const RowMatrix lambda = V_yy - V_xy.transpose() * result.gamma_transposed;
    result.lambda = (lambda + lambda.transpose()) / 2;
    const Eigen::LLT<RowMatrix> residual(result.lambda);
    if (residual.info() != Eigen::Success)
        return Error{Errc::singular, "the residual λ of " + std::to_string(V_yy.rows()) +
                                         " planes is not positive definite"};
    result.log_det_V_xx = log_determinant(cholesky);
    result.log_det_lambda = log_determinant(residual);
    return result;
}

/// A_s(j, i) is the weight of plane i at s for plane j: γ̂ᵀ((s, i), j).
Autoregression3d model_of(const JointEquations& equations, const Regression& regression,
                          double divisor) {
    const std::size_t d = equations.planes;
    Autoregression3d model{d, equations.neighbourhood, {}, {}};
    for (std::size_t s = 0; s < equations.neighbourhood.size(); ++s)
        for (std::size_t j = 0; j < d; ++j)
            for (std::size_t i = 0; i < d; ++i)
                model.A.push_back(static_cast<float>(
                    regression.gamma_transposed(index(s * d + i), index(j))));
    for (Index i = 0; i < index(d); ++i)
        for (Index j = 0; j < index(d); ++j)
            model.Sigma.push_back(static_cast<float>(regression.lambda(i, j) / divisor));
    return model;
}

Result<void> check_variances(const JointEquations& equations) {
    const std::size_t d = equations.planes;
    for (std::size_t i = 0; i < d; ++i)
        if (!(equations.V_yy[i * d + i] > 0))
            return Error{Errc::singular,
                         "plane " + std::to_string(i) + " is constant: it has no field"};
    return {};
}

}  // namespace

JointEquations toroidal_joint_equations(const CrossAutocovariance& R,
                                        const std::vector<std::size_t>& planes,
                                        std::vector<Offset> neighbourhood) {
    const double n = R.sites();
    JointEquations equations{planes.size(), {}, {}, {}, {}, n};
    for (const Offset s : neighbourhood)
        for (const std::size_t i : planes) {
            for (const Offset t : neighbourhood)
                for (const std::size_t j : planes)
                    equations.V_xx.push_back(n * R(i, j, t.row - s.row, t.col - s.col));
            for (const std::size_t j : planes)
                equations.V_xy.push_back(n * R(i, j, -s.row, -s.col));
        }
    for (const std::size_t i : planes)
        for (const std::size_t j : planes) equations.V_yy.push_back(n * R(i, j, 0, 0));
    equations.neighbourhood = std::move(neighbourhood);
    return equations;
}

//     ln p = -(d/2) ln|V_xx| - ((β-dη+d+1)/2) ln|λ| + Σ_{i=1}^d lnΓ((β-dη+d+2-i)/2)
//            + the same of the prior with the opposite sign - (nd/2) ln π
Result<Car3dEstimate> estimate_car3d(const JointEquations& equations,
                                     const Car3dPrior& prior) {
    SATEEN_CHECK(check_variances(equations));
    const Index d = index(equations.planes);
    const Index unknowns = d * index(equations.neighbourhood.size());
    const RowMatrix V_yy = map(equations.V_yy, d, d);
    const Eigen::VectorXd variance = V_yy.diagonal() / equations.sites;

    RowMatrix V_xx = map(equations.V_xx, unknowns, unknowns);
    for (Index k = 0; k < unknowns; ++k) V_xx(k, k) += prior.weight * variance(k % d);
    RowMatrix V_yy_posterior = V_yy;
    V_yy_posterior.diagonal() += prior.weight * variance;
    SATEEN_TRY(const Regression regression,
               regress(V_xx, map(equations.V_xy, unknowns, d), V_yy_posterior));

    const double planes = static_cast<double>(d);
    const double beta = prior.beta + equations.sites;
    const auto log_normaliser = [&](double degrees, double log_det_V_xx,
                                    double log_det_lambda) {
        const double shape = degrees - static_cast<double>(unknowns) + planes + 1;
        double value = -planes / 2 * log_det_V_xx - shape / 2 * log_det_lambda;
        for (Index i = 0; i < d; ++i)
            value += std::lgamma((shape - static_cast<double>(i)) / 2);
        return value;
    };
    const double log_det_0 = (prior.weight * variance).array().log().sum();
    Car3dEstimate estimate;
    static_cast<Autoregression3d&>(estimate.model) =
        model_of(equations, regression, beta);
    estimate.log_evidence =
        log_normaliser(beta, regression.log_det_V_xx, regression.log_det_lambda) -
        log_normaliser(prior.beta, log_det_0 * static_cast<double>(unknowns) / planes,
                       log_det_0) -
        equations.sites * planes / 2 * std::log(std::numbers::pi);
    return estimate;
}

Result<Sar3d> estimate_sar3d(const JointEquations& equations, bool diagonal) {
    SATEEN_CHECK(check_variances(equations));
    // Enough to solve collinear planes, and no more than rounding.
    constexpr double kRidge = 1e-9;
    const Index d = index(equations.planes);
    const Index unknowns = d * index(equations.neighbourhood.size());
    RowMatrix V_yy = map(equations.V_yy, d, d);
    RowMatrix V_xx = map(equations.V_xx, unknowns, unknowns);
    for (Index k = 0; k < unknowns; ++k) V_xx(k, k) += kRidge * V_yy(k % d, k % d);
    V_yy.diagonal() *= 1 + kRidge;
    SATEEN_TRY(const Regression regression,
               regress(V_xx, map(equations.V_xy, unknowns, d), V_yy));
    Sar3d model;
    static_cast<Autoregression3d&>(model) =
        model_of(equations, regression, equations.sites);
    for (std::size_t k = 0; diagonal && k < model.Sigma.size(); ++k)
        if (k % (model.planes + 1) != 0) model.Sigma[k] = 0;
    return model;
}

JointMoments moments(const Autoregression3d& model, int grid, bool about_mean) {
    const Index d = index(model.planes);
    SmallComplex Sigma(d, d);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j)
            Sigma(i, j) =
                static_cast<double>(model.Sigma[static_cast<std::size_t>(i * d + j)]);
    std::vector<SmallComplex> A;
    for (std::size_t s = 0; s < model.neighbourhood.size(); ++s) {
        SmallComplex A_s(d, d);
        for (Index i = 0; i < d; ++i)
            for (Index j = 0; j < d; ++j)
                A_s(i, j) =
                    static_cast<double>(model.A[s * model.planes * model.planes +
                                                static_cast<std::size_t>(i * d + j)]);
        A.push_back(A_s);
    }
    std::vector<Complex> phases;
    for (int k = 0; k < grid; ++k)
        phases.push_back(std::polar(1.0, -2 * std::numbers::pi * k / grid));

    RowMatrix covariance = RowMatrix::Zero(d, d);
    double smallest = std::numeric_limits<double>::infinity();
    // S(-ω) is the conjugate of S(ω): half of the columns stand for all.
    for (int m = 0; m < grid; ++m)
        for (int n = 0; 2 * n <= grid; ++n) {
            SmallComplex Lambda = SmallComplex::Identity(d, d);
            for (std::size_t s = 0; s < A.size(); ++s) {
                const int turn =
                    m * model.neighbourhood[s].row + n * model.neighbourhood[s].col;
                Lambda -=
                    phases[static_cast<std::size_t>((turn % grid + grid) % grid)] * A[s];
            }
            const SmallComplex square = Lambda.adjoint() * Lambda;
            const Eigen::SelfAdjointEigenSolver<SmallComplex> eigen(
                square, Eigen::EigenvaluesOnly);
            smallest = std::min(smallest, eigen.eigenvalues()(0));
            if (about_mean && m == 0 && n == 0) continue;
            const SmallComplex inverse = Lambda.inverse();
            const SmallComplex S = inverse * Sigma * inverse.adjoint();
            covariance += (n == 0 || 2 * n == grid ? 1.0 : 2.0) * S.real();
        }
    covariance /= static_cast<double>(grid) * grid;
    return {{covariance.data(), covariance.data() + covariance.size()},
            std::sqrt(std::max(0.0, smallest))};
}

void set_variances(Autoregression3d& model, const std::vector<double>& variances,
                   const JointMoments& present) {
    const std::size_t d = model.planes;
    std::vector<double> factor;
    for (std::size_t i = 0; i < d; ++i)
        factor.push_back(std::sqrt(variances[i] / present.covariance[i * d + i]));
    const auto scale = [](float& value, double by) {
        value = static_cast<float>(static_cast<double>(value) * by);
    };
    for (std::size_t k = 0; k < model.A.size(); ++k)
        scale(model.A[k], factor[k / d % d] / factor[k % d]);
    for (std::size_t k = 0; k < model.Sigma.size(); ++k)
        scale(model.Sigma[k], factor[k / d] * factor[k % d]);
}

void restore_planes(Autoregression3d& model, const std::vector<std::size_t>& planes,
                    std::size_t d) {
    Autoregression3d whole{d, model.neighbourhood, {}, std::vector<float>(d * d)};
    whole.A.resize(model.neighbourhood.size() * d * d);
    const std::size_t few = planes.size();
    for (std::size_t i = 0; i < few; ++i)
        for (std::size_t j = 0; j < few; ++j) {
            const std::size_t to = planes[i] * d + planes[j];
            const std::size_t from = i * few + j;
            whole.Sigma[to] = model.Sigma[from];
            for (std::size_t s = 0; s < model.neighbourhood.size(); ++s)
                whole.A[s * d * d + to] = model.A[s * few * few + from];
        }
    model = std::move(whole);
}

}  // namespace sateen
