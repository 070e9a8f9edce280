// SPDX-License-Identifier: Apache-2.0
// Appearances of pairs that were not measured. See reflectance.hpp.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "sateen/analysis/reflectance.hpp"

namespace sateen {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vec = std::array<double, 3>;

std::vector<Vec> unit_vectors(std::span<const Direction> directions) {
    std::vector<Vec> out;
    for (const Direction d : directions) {
        const auto v = to_vector(d);
        out.push_back({static_cast<double>(v[0]), static_cast<double>(v[1]),
                       static_cast<double>(v[2])});
    }
    return out;
}

double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Smooth functions of a pair, the first a Lambertian surface: the cube root of cos θ_l
// where values contain it. The others bend it with the elevations, with the angle between
// light and view, towards highlights (powers of the half vector's elevation) and at
// grazing angles.
constexpr Index kFunctions = 9;
using Functions = Eigen::Matrix<double, kFunctions, 1>;

Functions smooth_functions(const Vec& light, const Vec& view, bool cosine_included) {
    const double l = std::max(0.0, light[2]);
    const double v = std::max(0.0, view[2]);
    const double cosine = dot(light, view);
    const double h = (l + v) / std::sqrt(std::max(1e-12, 2 + 2 * cosine));
    const double h8 = std::pow(h, 8);
    Functions f;
    f << 1, l, v, cosine, h8, std::pow(h8, 4), l * v, std::pow(1 - v, 3),
        std::pow(1 - l, 3);
    return cosine_included ? f * std::cbrt(l) : f;
}

// k of every two directions of a set.
MatrixXd covariance(const std::vector<Vec>& vectors, double reach) {
    const auto n = static_cast<Index>(vectors.size());
    MatrixXd K(n, n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j)
            K(i, j) = std::exp((dot(vectors[static_cast<std::size_t>(i)],
                                    vectors[static_cast<std::size_t>(j)]) -
                                1) /
                               (reach * reach));
    return K;
}

// Solves (mask ∘ (K_L A K_V) + noise A) = R for A on the mask by conjugate gradients.
MatrixXd solve_on_mask(const MatrixXd& K_L, const MatrixXd& K_V, const MatrixXd& mask,
                       const MatrixXd& R) {
    constexpr double kNoise = 0.01;
    constexpr int kSteps = 200;
    constexpr double kEnough = 1e-6;  // of the square of the residual
    MatrixXd A = MatrixXd::Zero(R.rows(), R.cols());
    MatrixXd residual = R;
    MatrixXd way = R;
    double square = R.squaredNorm();
    const double end = kEnough * square;
    for (int step = 0; step < kSteps && square > end; ++step) {
        MatrixXd image = K_L * way * K_V;
        image = image.cwiseProduct(mask) + kNoise * way;
        const double length = square / way.cwiseProduct(image).sum();
        A += length * way;
        residual -= length * image;
        const double next = residual.squaredNorm();
        way = residual + next / square * way;
        square = next;
    }
    return A;
}

// The regression on the smooth functions: the first costs nothing, the others little.
VectorXd regress(const Eigen::Matrix<double, Eigen::Dynamic, kFunctions>& F,
                 const VectorXd& e) {
    const double n = static_cast<double>(F.rows());
    Functions penalty = Functions::Constant(0.02 + 1e-4 * n);
    penalty[0] = 1e-9;
    Eigen::Matrix<double, kFunctions, kFunctions> normal = F.transpose() * F;
    normal.diagonal() += penalty;
    return normal.ldlt().solve(F.transpose() * e);
}

}  // namespace

Result<std::vector<float>> complete_appearance(
    const AppearanceGrid& grid, std::span<const MeasuredAppearance> known) {
    const std::size_t L = grid.lights.size();
    const std::size_t V = grid.views.size();
    if (known.empty() || L * V > kMaxAppearancePairs)
        return Error{Errc::invalid_argument,
                     std::to_string(known.size()) + " of " + std::to_string(L * V) +
                         " pairs of directions, expected at least 1 of at most " +
                         std::to_string(kMaxAppearancePairs)};
    const std::size_t channels = grid.channels;
    std::vector<float> table(L * V * channels);
    MatrixXd mask = MatrixXd::Zero(static_cast<Index>(L), static_cast<Index>(V));
    for (const MeasuredAppearance& m : known) {
        mask(static_cast<Index>(m.light), static_cast<Index>(m.view)) = 1;
        for (std::size_t c = 0; c < channels; ++c)
            table[(m.light * V + m.view) * channels + c] = m.encoded[c];
    }
    if (mask.sum() == static_cast<double>(L * V)) return table;

    const std::vector<Vec> lights = unit_vectors(grid.lights);
    const std::vector<Vec> views = unit_vectors(grid.views);
    const auto count = static_cast<Index>(known.size());
    const double reach =
        std::clamp(1.9 * std::pow(static_cast<double>(count), -0.25), 0.2, 0.5);
    const MatrixXd K_L = covariance(lights, reach);
    const MatrixXd K_V = covariance(views, reach);
    for (std::size_t c = 0; c < channels; ++c) {
        const bool is_contrast = c + 1 == channels;
        const auto functions = [&](std::size_t light, std::size_t view) {
            return smooth_functions(lights[light], views[view],
                                    grid.cosine_included && !is_contrast);
        };
        VectorXd e(count);
        Eigen::Matrix<double, Eigen::Dynamic, kFunctions> F(count, kFunctions);
        for (Index i = 0; i < count; ++i) {
            const MeasuredAppearance& m = known[static_cast<std::size_t>(i)];
            e[i] = static_cast<double>(m.encoded[c]);
            F.row(i) = functions(m.light, m.view).transpose();
        }
        const VectorXd weights = regress(F, e);
        const VectorXd unexplained = e - F * weights;
        MatrixXd R = MatrixXd::Zero(mask.rows(), mask.cols());
        for (Index i = 0; i < count; ++i) {
            const MeasuredAppearance& m = known[static_cast<std::size_t>(i)];
            R(static_cast<Index>(m.light), static_cast<Index>(m.view)) = unexplained[i];
        }
        const MatrixXd smooth = K_L * solve_on_mask(K_L, K_V, mask, R) * K_V;
        for (std::size_t l = 0; l < L; ++l)
            for (std::size_t v = 0; v < V; ++v) {
                const auto row = static_cast<Index>(l);
                const auto col = static_cast<Index>(v);
                if (mask(row, col) != 0) continue;
                const double predicted = functions(l, v).dot(weights) + smooth(row, col);
                table[(l * V + v) * channels + c] =
                    static_cast<float>(std::max(0.0, predicted));
            }
    }
    return table;
}

}  // namespace sateen
