// SPDX-License-Identifier: Apache-2.0
// Stability of the causal recursion, and its repair. See car2d.hpp.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sateen/analysis/car2d.hpp"
#include "sateen/analysis/whittle.hpp"

namespace sateen {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// The spectral radius of the companion matrix of z^p - b_1 z^{p-1} - … - b_p.
double companion_radius(const std::vector<Complex>& b) {
    const Index p = static_cast<Index>(b.size());
    if (p == 0) return 0;
    Eigen::MatrixXcd companion = Eigen::MatrixXcd::Zero(p, p);
    for (Index k = 0; k < p; ++k) companion(0, k) = b[static_cast<std::size_t>(k)];
    for (Index k = 1; k < p; ++k) companion(k, k - 1) = 1;
    return companion.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

// (i)  Within a row: the roots of 1 - Σ_{s1=0} a_s z^{-s2}.
// (ii) Between rows: at a column frequency ω the rows obey C_0 y_r = Σ_k C_k y_{r-k} + e
// with
//      C_0 = 1 - Σ_{s1=0} a_s e^{-jω s2},  C_k = Σ_{s1=k} a_s e^{-jω s2};
//      the companion matrix of C_k / C_0 for every ω on a grid.
double spectral_radius(const Car2d& model, std::size_t frequencies) {
    std::size_t reach_rows = 0;
    std::size_t reach_cols = 0;
    for (const Offset s : model.neighbourhood) {
        reach_rows = std::max(reach_rows, static_cast<std::size_t>(s.row));
        if (s.row == 0)
            reach_cols = std::max(reach_cols, static_cast<std::size_t>(s.col));
    }
    std::vector<Complex> within(reach_cols, 0.0);
    for (std::size_t i = 0; i < model.a.size(); ++i) {
        const Offset s = model.neighbourhood[i];
        if (s.row == 0)
            within[static_cast<std::size_t>(s.col - 1)] +=
                static_cast<double>(model.a[i]);
    }
    double radius = companion_radius(within);

    // C(-ω) is the conjugate of C(ω), so half of the circle is enough.
    for (std::size_t k = 0; k <= frequencies / 2; ++k) {
        const double omega = 2 * std::numbers::pi * static_cast<double>(k) /
                             static_cast<double>(frequencies);
        std::vector<Complex> C(reach_rows + 1, 0.0);
        C[0] = 1;
        for (std::size_t i = 0; i < model.a.size(); ++i) {
            const Offset s = model.neighbourhood[i];
            const Complex term =
                static_cast<double>(model.a[i]) * std::polar(1.0, -omega * s.col);
            C[static_cast<std::size_t>(s.row)] += s.row == 0 ? -term : term;
        }
        std::vector<Complex> between;
        for (std::size_t row = 1; row <= reach_rows; ++row)
            between.push_back(C[row] / C[0]);
        radius = std::max(radius, companion_radius(between));
    }
    return radius;
}

double model_variance(const Car2d& model, std::size_t grid) {
    Car2d unit = model;
    unit.variance = 1;
    return static_cast<double>(model.variance) *
           field_variance(inverse_covariance(unit), static_cast<int>(grid));
}

Car2d stabilised(const Car2d& model, double variance, double radius) {
    const auto expanded = [&](double g) {
        Car2d result = model;
        for (std::size_t i = 0; i < result.a.size(); ++i) {
            const Offset s = result.neighbourhood[i];
            const int distance = std::abs(s.row) + std::abs(s.col);
            result.a[i] = static_cast<float>(static_cast<double>(result.a[i]) *
                                             std::pow(g, distance));
        }
        return result;
    };
    double stable = 0;
    double unstable = 1;
    for (int step = 0; step < 30; ++step) {
        const double g = (stable + unstable) / 2;
        (spectral_radius(expanded(g)) < radius ? stable : unstable) = g;
    }
    Car2d result = expanded(stable);
    result.variance = static_cast<float>(static_cast<double>(result.variance) * variance /
                                         model_variance(result));
    return result;
}

}  // namespace sateen
