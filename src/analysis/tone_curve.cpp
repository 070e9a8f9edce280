// SPDX-License-Identifier: Apache-2.0
// The curves that give a plane with a pattern its distribution. See periodic_layer.hpp.
#include <algorithm>
#include <array>
#include <utility>

#include "analysis/periodic_layer.hpp"
#include "analysis/sorted_sample.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {
namespace {

/// Points (g_0, g_1, …) for each site of the cell.
constexpr std::size_t kQuantiles = 24;
/// Between these quantiles a tone curve has its knots.
constexpr double kOutermost = 0.002;

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
            points[k][j] = static_cast<float>(value_at(
                marginals[j],
                normal_quantile((static_cast<double>(place) + 0.5) / kQuantiles)));
        }
    return points;
}

SortedSample drawn_values(const CellTable& table, std::size_t plane,
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
    return SortedSample(std::move(values));
}

ToneCurve curve_between(const SortedSample& drawn, const SortedSample& wanted) {
    ToneCurve curve;
    const double low = drawn.quantile(kOutermost);
    const double high = drawn.quantile(1 - kOutermost);
    if (!(high - low > 1e-6)) return curve;
    curve.low = static_cast<float>(low);
    curve.high = static_cast<float>(high);
    for (std::size_t j = 0; j < ToneCurve::kKnots; ++j) {
        const double x = low + (high - low) * static_cast<double>(j) /
                                   static_cast<double>(ToneCurve::kKnots - 1);
        const double p = std::clamp(drawn.rank(x), kOutermost, 1 - kOutermost);
        curve.values.push_back(static_cast<float>(wanted.quantile(p)));
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
        cells[plane].curve = curve_between(drawn_values(table, plane, marginals),
                                           SortedSample(std::move(wanted)));
    }
}

}  // namespace sateen
