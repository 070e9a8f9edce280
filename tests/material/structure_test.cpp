// SPDX-License-Identifier: Apache-2.0
// The structure of a material: order of frequencies, limits, hostile files.
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "material/schema.hpp"
#include "support/faults.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

using test::random_material;

Material structured() {
    return random_material({.seed = 9,
                            .subspaces = 2,
                            .levels = 1,
                            .order = 1,
                            .knots = false,
                            .structure = true});
}

TEST(HalfPlaneOrder, HoldsOneOfEveryPairOnceNearestFirst) {
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{5, 7}, {6, 8}, {2, 2}, {13, 4}}) {
        const auto order = half_plane_order(rows, cols);
        const std::size_t odd_rows = (rows - 1) / 2 * 2 + 1;
        const std::size_t odd_cols = (cols - 1) / 2 * 2 + 1;
        ASSERT_EQ(order.size(), (odd_rows * odd_cols + 1) / 2);
        EXPECT_EQ(order[0], Harmonic{});
        std::set<std::pair<int, int>> seen;
        double before = 0;
        for (const Harmonic& h : order) {
            EXPECT_TRUE(seen.insert({h.m, h.n}).second);
            EXPECT_TRUE(h == Harmonic{} || seen.count({-h.m, -h.n}) == 0);
            const double m = h.m / static_cast<double>(rows);
            const double n = h.n / static_cast<double>(cols);
            EXPECT_GE(m * m + n * n, before - 1e-12);
            before = m * m + n * n;
        }
    }
}

TEST(HalfPlaneOrder, IsThatOfTheFormat) {
    const std::vector<Harmonic> expected = {{0, 0}, {1, 0}, {0, 1}, {-1, 1}, {1, 1}};
    EXPECT_EQ(half_plane_order(4, 3), expected);
}

TEST(ValidateStructure, NamesEachFault) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const auto layer = [](Material& m) -> PeriodicLayer& {
        return m.structure->periodic;
    };
    const auto cell = [](Material& m) -> PeriodicCell& {
        return m.subspaces[1].structure->cells[2];
    };
    test::expect_each_fault_is_named(
        structured(),
        {
            {"lattice vector: nan", [&](Material& m) { layer(m).a[0] = kNan; }},
            {"lattice vector: 5000", [&](Material& m) { layer(m).b[1] = 5000; }},
            {"area of the lattice cell: 0",
             [&](Material& m) { layer(m).b = layer(m).a; }},
            {"cell rows: 1, expected 2 to 96", [&](Material& m) { layer(m).rows = 1; }},
            {"cell cols: 97", [&](Material& m) { layer(m).cols = 97; }},
            {"spacing: 0", [&](Material& m) { layer(m).spacing = 0; }},
            {"displacement 1, deviation: -1",
             [&](Material& m) { layer(m).displacement[1].deviation = -1; }},
            {"displacement 0, weights: all 0",
             [&](Material& m) { layer(m).displacement[0].weights = {}; }},
            {"subspace 1, plane 2, cell step", [&](Material& m) { cell(m).step = kNan; }},
            {"cell: 40 coefficients",
             [&](Material& m) { cell(m).coefficients.pop_back(); }},
            {"cell: 2001 coefficients",
             [&](Material& m) { cell(m).coefficients.resize(2001); }},
            {"deviation cell: 41 entries, expected 40",
             [&](Material& m) { cell(m).deviations.push_back(0); }},
            {"mixing step: nan", [&](Material& m) { cell(m).mixing_step = kNan; }},
            {"mixing cell: 49 entries, expected 48",
             [&](Material& m) { cell(m).mixing.push_back(0); }},
            {"mixing cell: 48 entries, expected 0",
             [&](Material& m) { cell(m).mixing_step = 0; }},
            {"curve: 15 entries", [&](Material& m) { cell(m).curve.values.pop_back(); }},
            {"expected it to rise", [&](Material& m) { cell(m).curve.high = -7; }},
            {"expected no descent", [&](Material& m) { cell(m).curve.values[3] = 9; }},
            {"curve: a range without values",
             [&](Material& m) { cell(m).curve.values.clear(); }},
            {"subspace 1, cells: 2",
             [](Material& m) { m.subspaces[1].structure->cells.pop_back(); }},
            {"subspace 0, no structure",
             [](Material& m) { m.subspaces[0].structure.reset(); }},
            {"expected none", [](Material& m) { m.structure.reset(); }},
        });
}

TEST(StructureFile, APlaneWithoutAPatternTakesAFewBytes) {
    Material m = structured();
    m.subspaces[0].structure->cells[1] = PeriodicCell{};
    const auto payload = write_material(m);
    ASSERT_TRUE(payload);
    const auto again = read_material(*payload);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->subspaces[0].structure->cells[1], PeriodicCell{});
}

TEST(StructureFile, NothingMixedTakesNoBytes) {
    Material m = structured();
    for (Subspace& subspace : m.subspaces)
        for (PeriodicCell& cell : subspace.structure->cells) {
            cell.mixing_step = 0;
            cell.mixing.clear();
        }
    const auto payload = write_material(m);
    ASSERT_TRUE(payload);
    EXPECT_TRUE(schema::UnPackSizePrefixedMaterial(payload->data())
                    ->structure->mixing_steps.empty());
    const auto again = read_material(*payload);
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->subspaces[1].structure->cells[2].mixing.empty());
}

TEST(StructureFile, LargeCoefficientsOfEitherSignAreKept) {
    Material m = structured();
    m.subspaces[0].structure->cells[0].coefficients = {32767, -32768, -1};
    const auto again = read_material(*write_material(m));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->subspaces[0].structure->cells[0].coefficients,
              m.subspaces[0].structure->cells[0].coefficients);
}

TEST(HostileStructure, CountsThatDoNotFitTogetherAreRejected) {
    test::expect_each_is_rejected<schema::StructureT>(
        structured(), &schema::MaterialT::structure,
        {
            {"structure.lattice: 3", [](auto& t) { t.lattice.pop_back(); }},
            {"structure.cell_rows and cell_cols: 60000",
             [](auto& t) { t.cell_rows = 60000; }},
            {"structure.field_deviations: 3",
             [](auto& t) { t.field_deviations.push_back(1); }},
            {"structure.field_weights: 49", [](auto& t) { t.field_weights.pop_back(); }},
            {"structure.steps: 5", [](auto& t) { t.steps.pop_back(); }},
            {"structure.counts: 7", [](auto& t) { t.counts.push_back(0); }},
            {"structure.low_bytes: 246 entries, expected at least",
             [](auto& t) { t.counts[5] = 65535; }},
            {"structure.high_bytes: 245", [](auto& t) { t.high_bytes.pop_back(); }},
            {"structure.low_bytes: 247",
             [](auto& t) { t.high_bytes.push_back(0), t.low_bytes.push_back(0); }},
            {"structure.deviation_steps: 5",
             [](auto& t) { t.deviation_steps.pop_back(); }},
            {"structure.deviations: 239 entries, expected at least 240",
             [](auto& t) { t.deviations.pop_back(); }},
            {"structure.deviations: 240 entries, expected 200",
             [](auto& t) { t.deviation_steps[0] = 0; }},
            {"structure.mixing_steps: 5", [](auto& t) { t.mixing_steps.pop_back(); }},
            {"structure.mixing: 143 entries, expected at least 144",
             [](auto& t) { t.mixing.pop_back(); }},
            {"structure.mixing: 144 entries, expected 120",
             [](auto& t) { t.mixing_steps[1] = 0; }},
            {"structure.mixing: 144 entries, expected 0",
             [](auto& t) { t.mixing_steps.clear(); }},
            {"structure.curve_ranges: 11", [](auto& t) { t.curve_ranges.pop_back(); }},
            {"structure.curve_exponents: 5",
             [](auto& t) { t.curve_exponents.pop_back(); }},
            {"structure.curve_values: 95", [](auto& t) { t.curve_values.pop_back(); }},
            {"structure.curve_values: 97", [](auto& t) { t.curve_values.push_back(0); }},
            {"curve", [](auto& t) { t.curve_exponents[0] = 127; }},
        });
}

}  // namespace
}  // namespace sateen
