// SPDX-License-Identifier: Apache-2.0
// The normal of one pixel. See pixel_normal.hpp.
#include "analysis/pixel_normal.hpp"

#include <algorithm>
#include <cmath>

namespace sateen {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Of what all but the brightest tenth of the values stay below: attached or cast shadow. Not of
// the median, which lies in shadow itself deep between yarns.
constexpr double kShadow = 0.1;
constexpr double kBright = 0.9;
constexpr double kHighlights = 0.15;  // of the values, left out of the first estimate
constexpr int kIterations = 8;
constexpr double kConverged = 1e-3;         // change of g over |g|
constexpr double kCauchy = 2.385 * 1.4826;  // tuning constant x median to deviation
constexpr double kLeastScale = 1e-3;        // of |g|: rounding of 8-bit values
constexpr double kLargestCondition = 20;
constexpr std::size_t kFewestValues = 5;
// T falls to 0 at grazing angles, where other light than the lamp's is seen.
constexpr double kLeastTransmitted = 0.2;
// Of the body colour: rounding and compression, where nothing else is left.
constexpr double kNoise = 0.01;
constexpr double kBlack = 1e-4;

/// (1 - F(c)) / (1 - F(1)) = 1 - (1 - c)⁵ for any F(1).
double passed(double cosine) {
    const double x = 1 - std::clamp(cosine, 0.0, 1.0);
    const double squared = x * x;
    return 1 - squared * squared * x;
}

double quantile(std::vector<double>& values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                         share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

std::optional<Vector3d> solved(const Matrix3d& A, const Vector3d& b) {
    Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
    eigen.computeDirect(A);
    const Vector3d lambda = eigen.eigenvalues();
    if (!(lambda[0] * kLargestCondition * kLargestCondition > lambda[2]))
        return std::nullopt;
    return eigen.eigenvectors() *
           (eigen.eigenvectors().transpose() * b).cwiseQuotient(lambda);
}

}  // namespace

PixelFitter::PixelFitter(std::span<const std::array<double, 3>> lights, Body body)
    : lights_(lights),
      body_(body),
      lit_(lights.size(), 1),
      transmitted_(lights.size(), 1),
      cosines_(lights.size(), 0),
      weights_(lights.size(), 1),
      residuals_(lights.size(), 0) {}

std::optional<PixelNormal> PixelFitter::plain(std::span<const double> values) {
    std::fill(weights_.begin(), weights_.end(), 1.0);
    std::fill(transmitted_.begin(), transmitted_.end(), 1.0);
    const std::optional<Vector3d> g = solve(values);
    if (!g) return std::nullopt;
    return PixelNormal{*g, 0, values.size()};
}

std::optional<PixelNormal> PixelFitter::robust(std::span<const double> values,
                                               std::span<const std::uint8_t> usable) {
    choose(values, usable);
    leave_out_highlights(values);
    std::fill(transmitted_.begin(), transmitted_.end(), 1.0);
    std::optional<Vector3d> g = solve(values);
    double scale = 0;
    for (int i = 0; g && i < kIterations; ++i) {
        const Vector3d before = *g;
        transmit(before);
        const std::optional<double> found = reweight(values, before);
        if (!found) return std::nullopt;
        scale = *found;
        g = solve(values);
        if (g && (*g - before).norm() <= kConverged * before.norm()) break;
    }
    if (!g || !(g->norm() > 0)) return std::nullopt;
    const auto used = static_cast<std::size_t>(std::count_if(
        weights_.begin(), weights_.end(), [](double w) { return w >= 0.1; }));
    return PixelNormal{*g, scale / g->norm(), used};
}

std::span<const double> PixelFitter::shading(const Vector3d& normal) {
    transmit(normal);
    for (std::size_t k = 0; k < lights_.size(); ++k)
        cosines_[k] = transmitted_[k] * std::max(0.0, cosines_[k]);
    return cosines_;
}

void PixelFitter::choose(std::span<const double> values,
                         std::span<const std::uint8_t> usable) {
    sorted_.assign(values.begin(), values.end());
    const double shadow = kShadow * std::max(0.0, quantile(sorted_, kBright));
    for (std::size_t k = 0; k < values.size(); ++k)
        lit_[k] = static_cast<std::uint8_t>(usable[k] != 0 && values[k] > shadow &&
                                            lights_[k][2] > 0);
}

// The first weights: without the brightest of the values that are left.
void PixelFitter::leave_out_highlights(std::span<const double> values) {
    sorted_.clear();
    for (std::size_t k = 0; k < values.size(); ++k) {
        weights_[k] = lit_[k];
        if (lit_[k] != 0) sorted_.push_back(values[k]);
    }
    if (sorted_.size() < 2 * kFewestValues) return;
    const double brightest = quantile(sorted_, 1 - kHighlights);
    for (std::size_t k = 0; k < values.size(); ++k)
        if (values[k] > brightest) weights_[k] = 0;
}

/// T and n · l.
void PixelFitter::transmit(const Vector3d& g) {
    const Vector3d n = g.normalized();
    for (std::size_t k = 0; k < lights_.size(); ++k)
        cosines_[k] = n[0] * lights_[k][0] + n[1] * lights_[k][1] + n[2] * lights_[k][2];
    if (body_ == Body::lambert) return;
    const double seen = passed(n[2]);
    for (std::size_t k = 0; k < lights_.size(); ++k)
        transmitted_[k] = std::max(kLeastTransmitted, seen * passed(cosines_[k]));
}

/// Cauchy weights; the median residual. Nothing where too few values are left.
std::optional<double> PixelFitter::reweight(std::span<const double> values,
                                            const Vector3d& g) {
    const double length = g.norm();
    sorted_.clear();
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double shading = transmitted_[k] * std::max(0.0, cosines_[k]);
        residuals_[k] = std::abs(values[k] - length * shading);
        if (lit_[k] != 0) sorted_.push_back(residuals_[k]);
    }
    if (sorted_.size() < kFewestValues || !(length > 0)) return std::nullopt;
    const double median = quantile(sorted_, 0.5);
    const double c = kCauchy * std::max(median, kLeastScale * length);
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double e = residuals_[k] / c;
        weights_[k] = lit_[k] / (1 + e * e);
    }
    return median;
}

std::optional<Vector3d> PixelFitter::solve(std::span<const double> values) {
    std::array<double, 6> a = {};
    Vector3d b = Vector3d::Zero();
    for (std::size_t k = 0; k < values.size(); ++k) {
        const auto& [x, y, z] = lights_[k];
        const double w = weights_[k] * transmitted_[k];
        const double ww = w * transmitted_[k];
        a[0] += ww * x * x;
        a[1] += ww * x * y;
        a[2] += ww * x * z;
        a[3] += ww * y * y;
        a[4] += ww * y * z;
        a[5] += ww * z * z;
        b += w * values[k] * Vector3d(x, y, z);
    }
    Matrix3d A;
    A << a[0], a[1], a[2], a[1], a[3], a[4], a[2], a[4], a[5];
    return solved(A, b);
}

bool span_space(std::span<const std::array<double, 3>> lights) {
    if (lights.size() < 3) return false;
    const std::vector<double> ones(lights.size(), 1.0);
    return PixelFitter(lights, Body::lambert).plain(ones).has_value();
}

std::array<double, 3> body_colour(std::span<const std::array<double, 3>> colours,
                                  std::span<const double> shading,
                                  std::span<const double> weights) {
    std::array<double, 3> sum = {};
    double square = 0;
    for (std::size_t k = 0; k < colours.size(); ++k) {
        const double ws = weights[k] * shading[k];
        for (std::size_t i = 0; i < 3; ++i) sum[i] += ws * colours[k][i];
        square += ws * shading[k];
    }
    for (double& v : sum) v = square > 0 ? std::max(0.0, v / square) : 0.0;
    return sum;
}

std::optional<std::array<double, 3>> quiet_mixture(
    std::span<const std::array<double, 3>> colours, std::span<const double> shading,
    std::span<const double> weights, const std::array<double, 3>& body) {
    const Vector3d b(body[0], body[1], body[2]);
    Matrix3d C = Matrix3d::Zero();
    double sum = 0;
    for (std::size_t k = 0; k < colours.size(); ++k) {
        const Vector3d e =
            Vector3d(colours[k][0], colours[k][1], colours[k][2]) - shading[k] * b;
        C.noalias() += weights[k] * e * e.transpose();
        sum += weights[k];
    }
    if (!(sum > 0)) return std::nullopt;
    const double noise = kNoise * b.norm() + kBlack;
    C = C / sum + noise * noise * Matrix3d::Identity();
    const Vector3d w = C.ldlt().solve(b);
    const double scale = luminance(body, 3) / w.dot(b);
    if (!(scale > 0) || !std::isfinite(scale)) return std::nullopt;
    return std::array<double, 3>{scale * w[0], scale * w[1], scale * w[2]};
}

}  // namespace sateen
