// SPDX-License-Identifier: Apache-2.0
// The structure of a material to its table and back; docs/format.md is normative.
#include "material/structure_file.hpp"

#include <algorithm>

#include "material/message.hpp"
#include "material/quantise.hpp"
#include "material/vectors.hpp"

namespace sateen {
namespace {

constexpr std::size_t kWeights = SmoothField::kScales * SmoothField::kScales;

/// Small numbers of either sign have small codes.
std::uint16_t zigzag(std::int16_t q) {
    return static_cast<std::uint16_t>(q < 0 ? -2 * q - 1 : 2 * q);
}
std::int16_t from_zigzag(unsigned code) {
    const int half = static_cast<int>(code >> 1U);
    return static_cast<std::int16_t>((code & 1U) != 0 ? -half - 1 : half);
}

void append_field(const SmoothField& field, schema::StructureT& out) {
    out.field_deviations.push_back(canonical(field.deviation));
    out.field_weights.insert(out.field_weights.end(), field.weights.begin(),
                             field.weights.end());
}

void append_cell(const PeriodicCell& cell, schema::StructureT& out) {
    out.steps.push_back(canonical(cell.step));
    out.counts.push_back(static_cast<std::uint16_t>(cell.coefficients.size()));
    for (const std::int16_t q : cell.coefficients) {
        out.low_bytes.push_back(static_cast<std::uint8_t>(zigzag(q) & 0xFFU));
        out.high_bytes.push_back(static_cast<std::uint8_t>(zigzag(q) >> 8U));
    }
    out.deviation_steps.push_back(canonical(cell.deviation_step));
    out.deviations.insert(out.deviations.end(), cell.deviations.begin(),
                          cell.deviations.end());
    out.mixing_steps.push_back(canonical(cell.mixing_step));
    out.mixing.insert(out.mixing.end(), cell.mixing.begin(), cell.mixing.end());
    out.curve_ranges.push_back(canonical(cell.curve.low));
    out.curve_ranges.push_back(canonical(cell.curve.high));
    append_block(cell.curve.values, out.curve_values, out.curve_exponents);
}

/// Takes what it reads from the front of the vectors over all subspaces.
class StructureReader {
  public:
    explicit StructureReader(const schema::Structure& in) : in_(in) {}

    Result<Structure> read_layer() {
        SATEEN_CHECK(expect_count("structure.lattice", count(in_.lattice()), 4));
        Structure out;
        PeriodicLayer& layer = out.periodic;
        layer.a = {at(in_.lattice(), 0), at(in_.lattice(), 1)};
        layer.b = {at(in_.lattice(), 2), at(in_.lattice(), 3)};
        layer.rows = in_.cell_rows();
        layer.cols = in_.cell_cols();
        layer.spacing = in_.spacing();
        // What the lengths below depend on.
        if (std::max(layer.rows, layer.cols) > PeriodicLayer::kMaxCellSide)
            return bad_format(
                "structure.cell_rows and cell_cols: ", text(std::size_t{layer.rows}),
                " and ", text(std::size_t{layer.cols}), ", expected at most ",
                text(PeriodicLayer::kMaxCellSide));
        const std::size_t fields = layer.displacement.size();
        SATEEN_CHECK(expect_count("structure.field_deviations",
                                  count(in_.field_deviations()), fields));
        SATEEN_CHECK(expect_count("structure.field_weights", count(in_.field_weights()),
                                  fields * kWeights));
        for (std::size_t i = 0; i < fields; ++i) {
            layer.displacement[i].deviation = at(in_.field_deviations(), i);
            for (std::size_t k = 0; k < kWeights; ++k)
                layer.displacement[i].weights[k] =
                    at(in_.field_weights(), i * kWeights + k);
        }
        deviation_sites_ = deviation_side(layer.rows) * deviation_side(layer.cols);
        mixing_sites_ = mixing_side(layer.rows) * mixing_side(layer.cols);
        return out;
    }

    Result<void> check_counts(std::size_t planes) const {
        SATEEN_CHECK(expect_count("structure.steps", count(in_.steps()), planes));
        SATEEN_CHECK(expect_count("structure.counts", count(in_.counts()), planes));
        SATEEN_CHECK(expect_count("structure.deviation_steps",
                                  count(in_.deviation_steps()), planes));
        SATEEN_CHECK(expect_count("structure.curve_ranges", count(in_.curve_ranges()),
                                  2 * planes));
        SATEEN_CHECK(expect_count("structure.curve_exponents",
                                  count(in_.curve_exponents()), planes));
        if (in_.mixing_steps() != nullptr)
            SATEEN_CHECK(expect_count("structure.mixing_steps", count(in_.mixing_steps()),
                                      planes));
        return expect_count("structure.high_bytes", count(in_.high_bytes()),
                            count(in_.low_bytes()));
    }

    /// \param number  of the plane in its subspace
    Result<void> read(std::size_t plane, std::size_t number, PeriodicCell& out) {
        out.step = at(in_.steps(), plane);
        const std::size_t n = at(in_.counts(), plane);
        SATEEN_CHECK(expect_left("structure.low_bytes", count(in_.low_bytes()),
                                 coefficients_read_, n));
        for (const std::size_t end = coefficients_read_ + n; coefficients_read_ < end;
             ++coefficients_read_)
            out.coefficients.push_back(
                from_zigzag(at(in_.low_bytes(), coefficients_read_) +
                            256U * at(in_.high_bytes(), coefficients_read_)));
        out.deviation_step = at(in_.deviation_steps(), plane);
        if (out.deviation_step != 0) {
            SATEEN_CHECK(expect_left("structure.deviations", count(in_.deviations()),
                                     deviations_read_, deviation_sites_));
            for (std::size_t i = 0; i < deviation_sites_; ++i)
                out.deviations.push_back(at(in_.deviations(), deviations_read_++));
        }
        if (in_.mixing_steps() != nullptr)
            out.mixing_step = at(in_.mixing_steps(), plane);
        if (out.mixing_step != 0) {
            const std::size_t sites = number * mixing_sites_;
            SATEEN_CHECK(expect_left("structure.mixing", count(in_.mixing()),
                                     mixing_read_, sites));
            for (std::size_t i = 0; i < sites; ++i)
                out.mixing.push_back(at(in_.mixing(), mixing_read_++));
        }
        out.curve.low = at(in_.curve_ranges(), 2 * plane);
        out.curve.high = at(in_.curve_ranges(), 2 * plane + 1);
        if (out.curve.low == out.curve.high) return {};
        SATEEN_CHECK(expect_left("structure.curve_values", count(in_.curve_values()),
                                 values_read_, ToneCurve::kKnots));
        out.curve.values = block(in_.curve_values(), values_read_, ToneCurve::kKnots,
                                 at(in_.curve_exponents(), plane));
        values_read_ += ToneCurve::kKnots;
        return {};
    }

    Result<void> check_all_read() const {
        SATEEN_CHECK(expect_count("structure.low_bytes", count(in_.low_bytes()),
                                  coefficients_read_));
        SATEEN_CHECK(expect_count("structure.deviations", count(in_.deviations()),
                                  deviations_read_));
        SATEEN_CHECK(expect_count("structure.mixing", count(in_.mixing()), mixing_read_));
        return expect_count("structure.curve_values", count(in_.curve_values()),
                            values_read_);
    }

  private:
    static Result<void> expect_left(std::string_view what, std::size_t found,
                                    std::size_t used, std::size_t wanted) {
        if (wanted <= found - used) return {};
        return bad_format(what, ": ", text(found), " entries, expected at least ",
                          text(used + wanted));
    }

    const schema::Structure& in_;
    std::size_t deviation_sites_ = 0;
    std::size_t mixing_sites_ = 0;
    std::size_t coefficients_read_ = 0;
    std::size_t deviations_read_ = 0;
    std::size_t mixing_read_ = 0;
    std::size_t values_read_ = 0;
};

}  // namespace

std::unique_ptr<schema::StructureT> pack_structure(const Material& material) {
    auto out = std::make_unique<schema::StructureT>();
    const PeriodicLayer& layer = material.structure->periodic;
    for (const float value : {layer.a[0], layer.a[1], layer.b[0], layer.b[1]})
        out->lattice.push_back(canonical(value));
    out->cell_rows = layer.rows;
    out->cell_cols = layer.cols;
    out->spacing = layer.spacing;
    for (const SmoothField& field : layer.displacement) append_field(field, *out);
    for (const Subspace& subspace : material.subspaces)
        for (const PeriodicCell& cell : subspace.structure->cells)
            append_cell(cell, *out);
    if (std::all_of(out->mixing_steps.begin(), out->mixing_steps.end(),
                    [](float step) { return step == 0; }))
        out->mixing_steps.clear();
    return out;
}

Result<void> unpack_structure(const schema::Structure& in, Material& out) {
    StructureReader reader(in);
    SATEEN_TRY(out.structure, reader.read_layer());
    SATEEN_CHECK(reader.check_counts(out.subspaces.size() * out.bands));
    for (std::size_t k = 0; k < out.subspaces.size(); ++k) {
        auto& cells = out.subspaces[k].structure.emplace().cells;
        cells.resize(out.bands);
        for (std::size_t plane = 0; plane < out.bands; ++plane)
            SATEEN_CHECK(in_element(
                "subspace", k,
                in_element("plane", plane,
                           reader.read(k * out.bands + plane, plane, cells[plane]))));
    }
    return reader.check_all_read();
}

}  // namespace sateen
