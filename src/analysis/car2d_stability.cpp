// SPDX-License-Identifier: Apache-2.0
// Stability of the causal recursion, and its repair. See car2d.hpp.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sateen/analysis/car2d.hpp"

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

//     R(0) = (1/MN) Σ_t σ² / |Λ_t|²,   Λ_t = Σ_q c_q(ω1) e^{-jω2 q}
//
// with the offsets of one column gathered in c_q first. Λ(-ω) is the conjugate of Λ(ω),
// so that the rows 0 … M/2 stand for all.
double model_variance(const Car2d& model, std::size_t grid) {
    constexpr int kTerms = 2 * kMaxReach + 1;
    int reach = 0;
    for (const Offset s : model.neighbourhood) reach = std::max(reach, std::abs(s.col));
    const auto step = 2 * std::numbers::pi / static_cast<double>(grid);
    std::vector<double> cosines(grid);
    std::vector<double> sines(grid);
    for (std::size_t k = 0; k < grid; ++k) {
        cosines[k] = std::cos(step * static_cast<double>(k));
        sines[k] = std::sin(step * static_cast<double>(k));
    }
    double sum = 0;
    for (std::size_t m = 0; 2 * m <= grid; ++m) {
        std::array<Complex, kTerms> c{};
        c[kMaxReach] = 1;
        for (std::size_t i = 0; i < model.a.size(); ++i) {
            const Offset s = model.neighbourhood[i];
            c[static_cast<std::size_t>(kMaxReach + s.col)] -=
                static_cast<double>(model.a[i]) *
                std::polar(1.0, -step * static_cast<double>(m) * s.row);
        }
        double row = 0;
        for (std::size_t n = 0; n < grid; ++n) {
            double re = 0;
            double im = 0;
            for (int q = -reach; q <= reach; ++q) {
                const Complex& c_q = c[static_cast<std::size_t>(kMaxReach + q)];
                const std::size_t turn = n * static_cast<std::size_t>(std::abs(q)) % grid;
                const double sine = q < 0 ? -sines[turn] : sines[turn];
                re += c_q.real() * cosines[turn] + c_q.imag() * sine;
                im += c_q.imag() * cosines[turn] - c_q.real() * sine;
            }
            row += 1 / (re * re + im * im);
        }
        sum += m == 0 || 2 * m == grid ? row : 2 * row;
    }
    return static_cast<double>(model.variance) * sum / static_cast<double>(grid * grid);
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
