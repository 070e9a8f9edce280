// SPDX-License-Identifier: Apache-2.0
// Decoding cells. See cell_table.hpp.
#include "sateen/material/cell_table.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace sateen {
namespace {

/// e^{2πi k/n}, k = 0 … n - 1.
std::vector<std::complex<float>> roots_of_unity(std::size_t n) {
    std::vector<std::complex<float>> roots;
    for (std::size_t k = 0; k < n; ++k) {
        const double angle =
            2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
        roots.emplace_back(static_cast<float>(std::cos(angle)),
                           static_cast<float>(std::sin(angle)));
    }
    return roots;
}

std::size_t modulo(int k, std::size_t n) {
    const int period = static_cast<int>(n);
    return static_cast<std::size_t>((k % period + period) % period);
}

/// Where a sample of the table lies between the samples of a coarser cell, whose first is
/// half a step from the border.
struct Between {
    std::size_t low;
    std::size_t high;
    float share;
};
Between between(std::size_t k, std::size_t fine, std::size_t coarse) {
    const double x =
        static_cast<double>(k) * static_cast<double>(coarse) / static_cast<double>(fine) -
        0.5 + static_cast<double>(coarse);
    const auto low = static_cast<std::size_t>(x);
    return {low % coarse, (low + 1) % coarse,
            static_cast<float>(x - static_cast<double>(low))};
}

}  // namespace

CellTable::CellTable(const PeriodicLayer& layer, std::span<const PeriodicCell> cells)
    : rows_(kOversampling * layer.rows),
      cols_(kOversampling * layer.cols),
      values_(rows_ * cols_ * kValues) {
    for (std::size_t plane = 0; plane < std::min(kPlanes, cells.size()); ++plane) {
        fill_means(plane, layer, cells[plane]);
        fill_deviations(plane, layer, cells[plane]);
        fill_mixing(plane, layer, cells[plane]);
    }
}

// First along the columns of the table, for every m, then along its rows.
void CellTable::fill_means(std::size_t plane, const PeriodicLayer& layer,
                           const PeriodicCell& cell) {
    if (cell.coefficients.empty()) return;
    const auto harmonics = half_plane_order(layer.rows, layer.cols);
    const auto row_roots = roots_of_unity(rows_);
    const auto col_roots = roots_of_unity(cols_);
    const std::size_t count =
        std::min(harmonics.size(), (cell.coefficients.size() + 1) / 2);
    const std::size_t m_count = 2 * ((layer.rows - 1U) / 2) + 1;
    std::vector<std::complex<float>> along(m_count * cols_);
    for (std::size_t h = 0; h < count; ++h) {
        const auto q = [&](std::size_t i) {
            return cell.step * static_cast<float>(cell.coefficients[i]);
        };
        const std::complex<float> c =
            h == 0 ? std::complex<float>(q(0), 0)
                   : std::complex<float>(2 * q(2 * h - 1), 2 * q(2 * h));
        std::complex<float>* row = along.data() + modulo(harmonics[h].m, m_count) * cols_;
        std::size_t k = 0;
        const auto n = static_cast<std::size_t>(harmonics[h].n);
        for (std::size_t x = 0; x < cols_; ++x, k = (k + n) % cols_) {
            const std::complex<float> w = col_roots[k];
            row[x] += std::complex<float>(c.real() * w.real() - c.imag() * w.imag(),
                                          c.real() * w.imag() + c.imag() * w.real());
        }
    }
    const int furthest = static_cast<int>((layer.rows - 1U) / 2);
    for (std::size_t y = 0; y < rows_; ++y)
        for (int m = -furthest; m <= furthest; ++m) {
            const std::complex<float> w = row_roots[(modulo(m, rows_) * y) % rows_];
            const std::complex<float>* row = along.data() + modulo(m, m_count) * cols_;
            float* out = values_.data() + y * cols_ * kValues + plane;
            for (std::size_t x = 0; x < cols_; ++x)
                out[x * kValues] += row[x].real() * w.real() - row[x].imag() * w.imag();
        }
}

template <class Grid>
void CellTable::fill_from(std::size_t P, std::size_t Q, std::size_t value,
                          const Grid& grid) {
    for (std::size_t y = 0; y < rows_; ++y)
        for (std::size_t x = 0; x < cols_; ++x) {
            const Between row = between(y, rows_, P);
            const Between col = between(x, cols_, Q);
            values_[(y * cols_ + x) * kValues + value] =
                (1 - row.share) * ((1 - col.share) * grid(row.low * Q + col.low) +
                                   col.share * grid(row.low * Q + col.high)) +
                row.share * ((1 - col.share) * grid(row.high * Q + col.low) +
                             col.share * grid(row.high * Q + col.high));
        }
}

void CellTable::fill_deviations(std::size_t plane, const PeriodicLayer& layer,
                                const PeriodicCell& cell) {
    const std::size_t P = deviation_side(layer.rows);
    const std::size_t Q = deviation_side(layer.cols);
    fill_from(P, Q, kPlanes + plane, [&](std::size_t i) {
        return cell.deviation_step > 0
                   ? cell.deviation_step * static_cast<float>(cell.deviations[i])
                   : 1.0F;
    });
}

void CellTable::fill_mixing(std::size_t plane, const PeriodicLayer& layer,
                            const PeriodicCell& cell) {
    if (!(cell.mixing_step > 0)) return;
    const std::size_t P = mixing_side(layer.rows);
    const std::size_t Q = mixing_side(layer.cols);
    for (std::size_t j = 0; j < plane; ++j)
        fill_from(P, Q, mixing(plane, j), [&](std::size_t i) {
            return cell.mixing_step * static_cast<float>(cell.mixing[j * P * Q + i]);
        });
}

std::vector<float> plane_deviations(const Structure& structure,
                                    const Subspace& subspace) {
    const CellTable table(structure.periodic, subspace.structure->cells);
    const auto sites = static_cast<double>(table.rows() * table.cols());
    std::vector<float> deviations;
    const auto square = [](float value) {
        return static_cast<double>(value) * static_cast<double>(value);
    };
    for (std::size_t plane = 0; plane < subspace.marginals.size(); ++plane) {
        double mean = 0;
        double squares = 0;
        double noise = 0;
        for (std::size_t r = 0; r < table.rows(); ++r)
            for (std::size_t c = 0; c < table.cols(); ++c) {
                const float* site = table.site(r, c);
                mean += static_cast<double>(site[plane]) / sites;
                squares += square(site[plane]) / sites;
                noise += square(site[CellTable::kPlanes + plane] *
                                subspace.marginals[plane].scale) /
                         sites;
                for (std::size_t j = 0; j < plane; ++j)
                    noise += square(site[CellTable::mixing(plane, j)] *
                                    subspace.marginals[j].scale) /
                             sites;
            }
        const double variance = squares - mean * mean + noise;
        deviations.push_back(static_cast<float>(std::sqrt(std::max(0.0, variance))));
    }
    return deviations;
}

float apply(const ToneCurve& curve, float x) {
    if (curve.values.empty()) return x;
    if (x <= curve.low) return curve.values.front() + (x - curve.low);
    if (x >= curve.high) return curve.values.back() + (x - curve.high);
    constexpr auto kSteps = static_cast<float>(ToneCurve::kKnots - 1);
    const float t = (x - curve.low) / (curve.high - curve.low) * kSteps;
    const auto j = std::min(static_cast<std::size_t>(t), ToneCurve::kKnots - 2);
    const float share = t - static_cast<float>(j);
    return curve.values[j] + share * (curve.values[j + 1] - curve.values[j]);
}

}  // namespace sateen
