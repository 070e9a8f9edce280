// SPDX-License-Identifier: Apache-2.0
// The curves that give a plane with a pattern its distribution. See periodic_layer.hpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/periodic_layer.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {
namespace {

/// Points (g_0, g_1, …) for each site of the cell.
constexpr std::size_t kQuantiles = 24;
/// Between these quantiles a tone curve has its knots.
constexpr double kOutermost = 0.002;

/// q(g)
double value_of(const Marginal& marginal, double g) {
    const auto scale = static_cast<double>(marginal.scale);
    if (marginal.knots.empty()) return scale * g;
    constexpr auto kRange = static_cast<double>(Marginal::kRange);
    const double t = (std::clamp(g, -kRange, kRange) + kRange) *
                     (static_cast<double>(Marginal::kKnots - 1) / (2 * kRange));
    const auto j = std::min(static_cast<std::size_t>(t), Marginal::kKnots - 2);
    const auto low = static_cast<double>(marginal.knots[j]);
    return scale * (low + (t - static_cast<double>(j)) *
                              (static_cast<double>(marginal.knots[j + 1]) - low));
}

double quantile(const std::vector<float>& sorted, double p) {
    const double x = p * static_cast<double>(sorted.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(x), sorted.size() - 2);
    const auto low = static_cast<double>(sorted[i]);
    return low +
           (x - static_cast<double>(i)) * (static_cast<double>(sorted[i + 1]) - low);
}

/// F(x) of a sorted sample.
double rank(const std::vector<float>& sorted, double x) {
    const auto at = std::ranges::lower_bound(sorted, static_cast<float>(x));
    return static_cast<double>(at - sorted.begin()) / static_cast<double>(sorted.size());
}

/// q_j(g_j) of a set of equally likely points (g_0, g_1, …): all planes take the same quantiles,
/// in orders that leave their correlations below 0.05.
std::vector<std::array<float, CellTable::kPlanes>> residual_points(
    const std::vector<Marginal>& marginals) {
    constexpr std::array<std::size_t, CellTable::kPlanes> kStride = {1, 11, 13};
    constexpr std::array<std::size_t, CellTable::kPlanes> kFirst = {0, 13, 5};
    std::vector<std::array<float, CellTable::kPlanes>> points(kQuantiles);
    for (std::size_t k = 0; k < kQuantiles; ++k)
        for (std::size_t j = 0; j < marginals.size(); ++j) {
            const std::size_t place = (kStride[j] * k + kFirst[j]) % kQuantiles;
            points[k][j] = static_cast<float>(value_of(
                marginals[j],
                normal_quantile((static_cast<double>(place) + 0.5) / kQuantiles)));
        }
    return points;
}

std::vector<float> drawn_values(const CellTable& table, std::size_t plane,
                                const std::vector<Marginal>& marginals) {
    const auto points = residual_points(marginals);
    std::vector<float> values;
    for (std::size_t r = 0; r < table.rows(); ++r)
        for (std::size_t c = 0; c < table.cols(); ++c) {
            const float* site = table.site(r, c);
            for (const auto& R : points) {
                float x = site[plane] + site[CellTable::kPlanes + plane] * R[plane];
                for (std::size_t j = 0; j < plane; ++j)
                    x += site[CellTable::mixing(plane, j)] * R[j];
                values.push_back(x);
            }
        }
    std::ranges::sort(values);
    return values;
}

ToneCurve curve_between(const std::vector<float>& drawn,
                        const std::vector<float>& wanted) {
    ToneCurve curve;
    const double low = quantile(drawn, kOutermost);
    const double high = quantile(drawn, 1 - kOutermost);
    if (!(high - low > 1e-6)) return curve;
    curve.low = static_cast<float>(low);
    curve.high = static_cast<float>(high);
    for (std::size_t j = 0; j < ToneCurve::kKnots; ++j) {
        const double x = low + (high - low) * static_cast<double>(j) /
                                   static_cast<double>(ToneCurve::kKnots - 1);
        const double p = std::clamp(rank(drawn, x), kOutermost, 1 - kOutermost);
        curve.values.push_back(static_cast<float>(quantile(wanted, p)));
    }
    return curve;
}

}  // namespace

void fit_tone_curves(std::span<const Image> planes, const PeriodicLayer& layer,
                     const std::vector<Marginal>& marginals,
                     std::vector<PeriodicCell>& cells) {
    const CellTable table(layer, cells);
    for (std::size_t plane = 0; plane < cells.size(); ++plane) {
        std::vector<float> wanted;
        for (const Image& image : planes) {
            const PlaneView<const float> view = image.plane(plane);
            wanted.insert(wanted.end(), view.data, view.data + view.size());
        }
        std::ranges::sort(wanted);
        cells[plane].curve = curve_between(drawn_values(table, plane, marginals), wanted);
    }
}

}  // namespace sateen
