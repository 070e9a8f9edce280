// SPDX-License-Identifier: Apache-2.0
// Densities of smooth fields. See smooth_density.hpp.
#include "sateen/material/smooth_density.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace sateen {
namespace {

/// 2√π s exp(-s²ω²) at every frequency of an axis, a row for every scale.
std::vector<std::vector<double>> bells(std::size_t count, std::size_t n, double scale) {
    std::vector<std::vector<double>> result(SmoothField::kScales);
    for (std::size_t k = 0; k < result.size(); ++k) {
        const double s = scale * std::ldexp(1.0, static_cast<int>(k));
        for (std::size_t m = 0; m < count; ++m) {
            const double turn =
                static_cast<double>(std::min(m, n - m)) / static_cast<double>(n);
            const double omega = 2 * std::numbers::pi * turn;
            result[k].push_back(2 * std::sqrt(std::numbers::pi) * s *
                                std::exp(-s * s * omega * omega));
        }
    }
    return result;
}

}  // namespace

Image smooth_density(const SmoothField& field, std::size_t rows, std::size_t cols,
                     double scale_rows, double scale_cols) {
    constexpr std::size_t kScales = SmoothField::kScales;
    Image density(1, rows, cols / 2 + 1);
    double total = 0;
    for (const std::uint8_t weight : field.weights) total += weight;
    if (!(total > 0)) return density;
    const double unit = static_cast<double>(field.deviation) *
                        static_cast<double>(field.deviation) / total;
    const auto down = bells(rows, rows, scale_rows);
    const auto across = bells(density.cols(), cols, scale_cols);
    for (std::size_t m = 0; m < rows; ++m) {
        double of_row[kScales] = {};
        for (std::size_t j = 0; j < kScales; ++j)
            for (std::size_t k = 0; k < kScales; ++k)
                of_row[k] += unit * field.weights[j * kScales + k] * down[j][m];
        for (std::size_t n = 0; n < density.cols(); ++n) {
            double sum = 0;
            for (std::size_t k = 0; k < kScales; ++k) sum += of_row[k] * across[k][n];
            density(0, m, n) = static_cast<float>(sum);
        }
    }
    return density;
}

}  // namespace sateen
