// SPDX-License-Identifier: Apache-2.0
// Estimation of the two-dimensional causal autoregressive model. See car2d.hpp.
#include "sateen/analysis/car2d.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace sateen {
namespace {

using Eigen::Index;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Matrix prior_V_xx(Index eta, double weight, double variance) {
    return Matrix::Identity(eta, eta) * (weight * variance);
}

std::vector<float> to_floats(const Eigen::VectorXd& values) {
    std::vector<float> result(static_cast<std::size_t>(values.size()));
    for (Index i = 0; i < values.size(); ++i)
        result[static_cast<std::size_t>(i)] = static_cast<float>(values(i));
    return result;
}

}  // namespace

NormalEquations toroidal_normal_equations(const Autocovariance& R,
                                          std::vector<Offset> neighbourhood) {
    NormalEquations equations;
    const double n = R.sites();
    for (const Offset s : neighbourhood) {
        for (const Offset t : neighbourhood)
            equations.V_xx.push_back(n * R(s.row - t.row, s.col - t.col));
        equations.V_xy.push_back(n * R(s));
    }
    equations.V_yy = n * R.variance();
    equations.sites = n;
    equations.neighbourhood = std::move(neighbourhood);
    return equations;
}

NormalEquations interior_normal_equations(PlaneView<const float> plane,
                                          std::vector<Offset> neighbourhood) {
    int top = 0;
    int left = 0;
    int right = 0;
    for (const Offset s : neighbourhood) {
        top = std::max<int>(top, s.row);
        left = std::max<int>(left, s.col);
        right = std::max<int>(right, -s.col);
    }
    const Index eta = static_cast<Index>(neighbourhood.size());
    const int rows = static_cast<int>(plane.rows);
    const int width = static_cast<int>(plane.cols) - left - right;
    Matrix V_xx = Matrix::Zero(eta, eta);
    Eigen::VectorXd V_xy = Eigen::VectorXd::Zero(eta);
    NormalEquations equations;
    if (width > 0 && rows > top) {
        // One row of sites at a time: X has a column a site.
        Matrix X(eta, width);
        Eigen::VectorXd Y(width);
        for (int r = top; r < rows; ++r) {
            for (int c = 0; c < width; ++c)
                Y(c) = static_cast<double>(plane(static_cast<std::size_t>(r),
                                                 static_cast<std::size_t>(c + left)));
            for (Index i = 0; i < eta; ++i) {
                const Offset s = neighbourhood[static_cast<std::size_t>(i)];
                const float* source =
                    plane.row(static_cast<std::size_t>(r - s.row)) + (left - s.col);
                for (int c = 0; c < width; ++c) X(i, c) = static_cast<double>(source[c]);
            }
            V_xx.noalias() += X * X.transpose();
            V_xy.noalias() += X * Y;
            equations.V_yy += Y.squaredNorm();
        }
        equations.sites = static_cast<double>(width) * static_cast<double>(rows - top);
    }
    equations.V_xx.assign(V_xx.data(), V_xx.data() + V_xx.size());
    equations.V_xy.assign(V_xy.data(), V_xy.data() + V_xy.size());
    equations.neighbourhood = std::move(neighbourhood);
    return equations;
}

//     ln p = -½ ln|V_xx| - ((β-η+2)/2) ln λ + lnΓ((β-η+2)/2)
//            + ½ ln|V_xx(0)| + ((β(0)-η+2)/2) ln λ(0) - lnΓ((β(0)-η+2)/2) - (n/2) ln π
//
// with λ(0) = V_yy(0), since V_xy(0) = 0. It is the normaliser of the posterior over that
// of the prior, hence comparable between neighbourhoods of different size.
Result<Car2dEstimate> estimate_car2d(const NormalEquations& equations,
                                     const Car2dPrior& prior) {
    const Index eta = static_cast<Index>(equations.neighbourhood.size());
    const double n = equations.sites;
    const double variance = n > 0 ? equations.V_yy / n : 0;
    if (!(variance > 0))
        return Error{Errc::singular,
                     "a constant plane has no autoregressive model: variance " +
                         std::to_string(variance) + " over " +
                         std::to_string(static_cast<std::size_t>(n)) + " sites"};

    const Matrix V_xx_0 = prior_V_xx(eta, prior.weight, variance);
    const Matrix V_xx =
        Eigen::Map<const Matrix>(equations.V_xx.data(), eta, eta) + V_xx_0;
    const Eigen::VectorXd V_xy =
        Eigen::Map<const Eigen::VectorXd>(equations.V_xy.data(), eta);
    const double V_yy_0 = prior.weight * variance;

    const Eigen::LLT<Matrix> cholesky(V_xx);
    if (cholesky.info() != Eigen::Success)
        return Error{Errc::singular, "V_xx of " + std::to_string(eta) +
                                         " neighbours is not positive definite"};
    const Eigen::VectorXd gamma = cholesky.solve(V_xy);
    const double lambda = equations.V_yy + V_yy_0 - V_xy.dot(gamma);
    if (!(lambda > 0))
        return Error{Errc::singular, "the residual λ of " + std::to_string(eta) +
                                         " neighbours is " + std::to_string(lambda) +
                                         ", expected a positive number"};

    const double beta = prior.beta + n;
    const double eta_d = static_cast<double>(eta);
    const double posterior_shape = (beta - eta_d + 2) / 2;
    const double prior_shape = (prior.beta - eta_d + 2) / 2;
    const double log_det = 2 * cholesky.matrixLLT().diagonal().array().log().sum();
    const double log_det_0 = eta_d * std::log(prior.weight * variance);

    Car2dEstimate estimate;
    estimate.model = {equations.neighbourhood, to_floats(gamma),
                      static_cast<float>(lambda / beta)};
    estimate.lambda = lambda;
    estimate.log_evidence = -log_det / 2 - posterior_shape * std::log(lambda) +
                            std::lgamma(posterior_shape) + log_det_0 / 2 +
                            prior_shape * std::log(V_yy_0) - std::lgamma(prior_shape) -
                            n / 2 * std::log(std::numbers::pi);
    return estimate;
}

RecursiveCar2d::RecursiveCar2d(std::vector<Offset> neighbourhood, double variance,
                               const Car2dPrior& prior)
    : neighbourhood_(std::move(neighbourhood)),
      inverse_(neighbourhood_.size() * neighbourhood_.size(), 0.0),
      gamma_(neighbourhood_.size(), 0.0),
      lambda_(prior.weight * variance),
      beta_(prior.beta) {
    for (std::size_t i = 0; i < gamma_.size(); ++i)
        inverse_[i * gamma_.size() + i] = 1 / (prior.weight * variance);
}

//     ζ = X_rᵀ V_xx⁻¹ X_r     ê = Y_r - γ̂ X_r
//     γ̂ᵀ += V_xx⁻¹ X_r ê / (1+ζ)     λ += ê² / (1+ζ)     V_xx⁻¹ -= (V_xx⁻¹X)(V_xx⁻¹X)ᵀ /
//     (1+ζ)
//
//     p(Y_r | past) = Γ((β-η+3)/2) / (Γ((β-η+2)/2) √(π(1+ζ)λ)) · (1 +
//     ê²/(λ(1+ζ)))^{-(β-η+3)/2}
double RecursiveCar2d::update(std::span<const double> X_r, double Y_r) {
    const Index eta = static_cast<Index>(gamma_.size());
    const Eigen::Map<const Eigen::VectorXd> X(X_r.data(), eta);
    Eigen::Map<Matrix> inverse(inverse_.data(), eta, eta);
    Eigen::Map<Eigen::VectorXd> gamma(gamma_.data(), eta);

    const Eigen::VectorXd gain = inverse * X;
    const double spread = 1 + X.dot(gain);
    const double innovation = Y_r - gamma.dot(X);
    const double shape = (beta_ - static_cast<double>(eta) + 2) / 2;
    const double scaled = innovation * innovation / (lambda_ * spread);
    const double log_density = std::lgamma(shape + 0.5) - std::lgamma(shape) -
                               std::log(std::numbers::pi * spread * lambda_) / 2 -
                               (shape + 0.5) * std::log1p(scaled);

    gamma += gain * (innovation / spread);
    lambda_ += innovation * innovation / spread;
    inverse -= gain * gain.transpose() / spread;
    beta_ += 1;
    return log_density;
}

Car2d RecursiveCar2d::model() const {
    Car2d result{neighbourhood_, {}, static_cast<float>(lambda_ / beta_)};
    for (const double a : gamma_) result.a.push_back(static_cast<float>(a));
    return result;
}

}  // namespace sateen
