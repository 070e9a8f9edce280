// SPDX-License-Identifier: Apache-2.0
// The limits of structure.hpp, checked.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "material/message.hpp"
#include "material/numbers.hpp"
#include "material/structure_file.hpp"

namespace sateen {
namespace {

Result<void> check_smooth_field(const SmoothField& field) {
    SATEEN_CHECK(check_range("deviation", field.deviation, 0, kMaxMagnitude));
    const int sum = std::accumulate(field.weights.begin(), field.weights.end(), 0);
    if (field.deviation > 0 && sum == 0)
        return bad_format("weights: all 0, expected one that is not");
    return {};
}

Result<void> check_lattice(const PeriodicLayer& layer) {
    constexpr float kMax = PeriodicLayer::kMaxPeriod;
    for (const auto& vector : {layer.a, layer.b}) {
        SATEEN_CHECK(check_range("lattice vector", vector[0], -kMax, kMax));
        SATEEN_CHECK(check_range("lattice vector", vector[1], -kMax, kMax));
    }
    const float area = std::abs(layer.a[0] * layer.b[1] - layer.a[1] * layer.b[0]);
    return check_range("area of the lattice cell", area, PeriodicLayer::kMinArea,
                       kMax * kMax);
}

Result<void> check_count(std::string_view what, std::size_t value, std::size_t low,
                         std::size_t high) {
    if (value >= low && value <= high) return {};
    return bad_format(what, ": ", text(value), ", expected ", text(low), " to ",
                      text(high));
}

Result<void> check_layer(const PeriodicLayer& layer) {
    SATEEN_CHECK(check_lattice(layer));
    SATEEN_CHECK(check_count("cell rows", layer.rows, 2, PeriodicLayer::kMaxCellSide));
    SATEEN_CHECK(check_count("cell cols", layer.cols, 2, PeriodicLayer::kMaxCellSide));
    SATEEN_CHECK(check_count("spacing", layer.spacing, 1, PeriodicLayer::kMaxSpacing));
    for (std::size_t i = 0; i < layer.displacement.size(); ++i)
        SATEEN_CHECK(
            in_element("displacement", i, check_smooth_field(layer.displacement[i])));
    return {};
}

Result<void> check_curve(const ToneCurve& curve) {
    if (curve.values.empty()) {
        if (curve == ToneCurve{}) return {};
        return bad_format("curve: a range without values");
    }
    SATEEN_CHECK(expect_count("curve", curve.values.size(), ToneCurve::kKnots));
    SATEEN_CHECK(check_range("curve, low", curve.low, -kMaxMagnitude, kMaxMagnitude));
    SATEEN_CHECK(check_range("curve, high", curve.high, -kMaxMagnitude, kMaxMagnitude));
    if (!(curve.high > curve.low))
        return bad_format("curve: from ", text(curve.low), " to ", text(curve.high),
                          ", expected it to rise");
    SATEEN_CHECK(check_numbers("curve", curve.values));
    const auto fall = std::is_sorted_until(curve.values.begin(), curve.values.end());
    if (fall != curve.values.end())
        return bad_format("curve: ", text(*fall), " after ", text(*std::prev(fall)),
                          ", expected no descent");
    return {};
}

/// \param plane  of the cell: it has a grid for each before it
Result<void> check_grids(const PeriodicCell& cell, const PeriodicLayer& layer,
                         std::size_t plane) {
    const std::size_t sites = deviation_side(layer.rows) * deviation_side(layer.cols);
    SATEEN_CHECK(check_range("deviation step", cell.deviation_step, 0, kMaxMagnitude));
    SATEEN_CHECK(expect_count("deviation cell", cell.deviations.size(),
                              cell.deviation_step > 0 ? sites : 0));
    const std::size_t mixing_sites = mixing_side(layer.rows) * mixing_side(layer.cols);
    SATEEN_CHECK(check_range("mixing step", cell.mixing_step, 0, kMaxMagnitude));
    return expect_count("mixing cell", cell.mixing.size(),
                        cell.mixing_step > 0 ? plane * mixing_sites : 0);
}

Result<void> check_cell(const PeriodicCell& cell, const PeriodicLayer& layer,
                        std::size_t plane) {
    SATEEN_CHECK(check_range("cell step", cell.step, 0, kMaxMagnitude));
    // The constant, then pairs; none at all for a plane without a pattern.
    const std::size_t most = 2 * half_plane_order(layer.rows, layer.cols).size() - 1;
    const std::size_t count = cell.coefficients.size();
    if (count > most || (count > 0 && count % 2 == 0))
        return bad_format("cell: ", text(count),
                          " coefficients, expected 0 or an odd number up to ",
                          text(most));
    SATEEN_CHECK(check_grids(cell, layer, plane));
    return check_curve(cell.curve);
}

Result<void> check_subspace(const Subspace& subspace, const Structure& structure) {
    if (!subspace.structure)
        return bad_format("no structure, expected one as the material has");
    const auto& cells = subspace.structure->cells;
    SATEEN_CHECK(expect_count("cells", cells.size(), subspace.marginals.size()));
    for (std::size_t plane = 0; plane < cells.size(); ++plane)
        SATEEN_CHECK(in_element("plane", plane,
                                check_cell(cells[plane], structure.periodic, plane)));
    return {};
}

}  // namespace

Result<void> validate_structure(const Material& material) {
    if (material.structure) {
        SATEEN_CHECK(check_layer(material.structure->periodic));
    }
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        const Subspace& subspace = material.subspaces[k];
        if (material.structure) {
            SATEEN_CHECK(
                in_element("subspace", k, check_subspace(subspace, *material.structure)));
        } else if (subspace.structure) {
            return bad_format("subspace ", text(k),
                              ": a structure, expected none as the material has");
        }
    }
    return {};
}

}  // namespace sateen
