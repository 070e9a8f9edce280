// SPDX-License-Identifier: Apache-2.0
// The periodic layer as it is drawn: closed on tori, the same in all windows.
#include "synthesis/periodic_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sateen/material/cell_table.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "sateen/synthesis/torus_size.hpp"
#include "support/random_material.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

Material structured(std::size_t subspaces = 1) {
    Material m = test::random_material(
        {.seed = 12, .subspaces = subspaces, .levels = 3, .structure = true});
    m.drawing = Drawing::spectral;
    return m;
}

TEST(PeriodicLayer, OfFieldsOnlyIsInUnitsOfItsDeviation) {
    Material m = structured();
    for (auto& cell : m.subspaces[0].structure->cells) cell.curve = {};
    m.subspaces[0].marginals.assign(3, {0.1F, {}});
    SerialExecutor executor;
    Progress progress;
    SynthesisOptions options;
    options.rows = options.cols = 256;
    options.tileable = true;
    options.fields_only = true;
    const auto fields = synthesise(m, 0, options, executor, progress);
    ASSERT_TRUE(fields);
    for (std::size_t plane = 0; plane < 3; ++plane) {
        double sum = 0;
        double squares = 0;
        const PlaneView<const float> view = fields->plane(plane);
        for (std::size_t i = 0; i < view.size(); ++i) {
            sum += static_cast<double>(view.data[i]) / static_cast<double>(view.size());
            squares += static_cast<double>(view.data[i]) *
                       static_cast<double>(view.data[i]) /
                       static_cast<double>(view.size());
        }
        EXPECT_NEAR(squares - sum * sum, 1, 0.1) << plane;
    }
}

/// One harmonic of each kind, by the formula of docs/format.md.
TEST(CellTable, IsTheFourierSeriesOfTheFormat) {
    PeriodicLayer layer;
    layer.rows = 8;
    layer.cols = 6;
    PeriodicCell cell;
    cell.step = 0.25F;
    cell.coefficients = {3, 1, -2, 0, 5, 7, 0};
    const CellTable table(layer, {&cell, 1});
    const auto order = half_plane_order(8, 6);
    for (std::size_t r = 0; r < table.rows(); ++r)
        for (std::size_t c = 0; c < table.cols(); ++c) {
            const double u = static_cast<double>(r) / static_cast<double>(table.rows());
            const double v = static_cast<double>(c) / static_cast<double>(table.cols());
            double expected = cell.coefficients[0];
            for (std::size_t h = 1; h < 4; ++h) {
                const double phase =
                    2 * std::numbers::pi * (order[h].m * u + order[h].n * v);
                expected += 2 * (cell.coefficients[2 * h - 1] * std::cos(phase) -
                                 cell.coefficients[2 * h] * std::sin(phase));
            }
            EXPECT_NEAR(table.site(r, c)[0], 0.25 * expected, 1e-5);
            EXPECT_EQ(table.site(r, c)[CellTable::kPlanes], 1.0F) << "no deviations";
        }
}

/// X_1 = s_1 R_1 + l_10 R_0 of the format, at a site of the mixing cell.
TEST(CellTable, HoldsTheMixingOfThePlanes) {
    PeriodicLayer layer;
    layer.rows = layer.cols = 8;
    std::vector<PeriodicCell> cells(3);
    cells[1].mixing_step = 0.5F;
    cells[1].mixing = {1, -2, 3, 127};
    cells[2].mixing_step = 0.25F;
    cells[2].mixing = {0, 0, 0, 0, 4, 4, 4, 4};
    const CellTable table(layer, cells);
    // Sites of the 2 x 2 grid are a quarter of the cell from the border.
    EXPECT_EQ(table.site(8, 8)[CellTable::mixing(1, 0)], 0.5F * (1 - 2 + 3 + 127) / 4);
    const auto at = table.at(0.25, 0.25);
    EXPECT_NEAR(at[CellTable::mixing(1, 0)], 0.5, 1e-6);
    EXPECT_NEAR(table.at(0.75, 0.75)[CellTable::mixing(1, 0)], 63.5, 1e-5);
    EXPECT_NEAR(at[CellTable::mixing(2, 0)], 0, 1e-6);
    EXPECT_NEAR(at[CellTable::mixing(2, 1)], 1, 1e-6);
}

TEST(PeriodicLayer, MixesTheFieldsOfThePlanes) {
    Material m = structured();
    Structure& structure = *m.structure;
    for (PeriodicCell& cell : m.subspaces[0].structure->cells) cell = {};
    PeriodicCell& mixed = m.subspaces[0].structure->cells[2];
    mixed.mixing_step = 0.01F;
    const std::size_t sites =
        mixing_side(structure.periodic.rows) * mixing_side(structure.periodic.cols);
    mixed.mixing.assign(2 * sites, 50);
    m.subspaces[0].marginals.assign(3, {1, {}});
    SerialExecutor executor;
    const auto phase = PeriodicPhase::create(structure.periodic, 1, {}, executor);
    ASSERT_TRUE(phase);
    Image planes(3, 4, 4);
    for (std::size_t plane = 0; plane < 3; ++plane)
        for (std::size_t i = 0; i < 16; ++i)
            planes.plane(plane).data[i] = static_cast<float>(plane + 1 + i);
    apply_periodic_layer(structure, m.subspaces[0], *phase, 0, 0, planes.view(),
                         executor);
    for (std::size_t i = 0; i < 16; ++i) {
        const auto g = static_cast<float>(i);
        EXPECT_NEAR(planes.plane(0).data[i], g + 1, 1e-5);
        EXPECT_NEAR(planes.plane(1).data[i], g + 2, 1e-5);
        EXPECT_NEAR(planes.plane(2).data[i], g + 3 + 0.5F * (2 * g + 3), 1e-4);
    }
}

TEST(PeriodicPhase, OfATorusReturnsToItselfInWholeCells) {
    SerialExecutor executor;
    const Material m = structured();
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{96, 128}, {101, 77}}) {
        const Period period{static_cast<std::int32_t>(rows),
                            static_cast<std::int32_t>(cols)};
        const auto phase =
            PeriodicPhase::create(m.structure->periodic, 3, period, executor);
        ASSERT_TRUE(phase);
        const PeriodicPhase::Window window(*phase, 0, 0, rows + 1, cols + 1, executor);
        std::vector<double> u(cols + 1);
        std::vector<double> v(cols + 1);
        std::vector<double> last_u(cols + 1);
        std::vector<double> last_v(cols + 1);
        window.phases(0, u, v);
        window.phases(rows, last_u, last_v);
        const auto whole = [](double difference) {
            return std::abs(difference - std::round(difference)) < 1e-6;
        };
        EXPECT_TRUE(whole(u[cols] - u[0]) && whole(v[cols] - v[0]));
        for (std::size_t c = 0; c <= cols; ++c)
            EXPECT_TRUE(whole(last_u[c] - u[c]) && whole(last_v[c] - v[c]));
    }
}

TEST(PeriodicLayer, IsTheSameInAllWindowsBitForBit) {
    const Material m = structured();
    SerialExecutor executor;
    Progress progress;
    const auto window = [&](std::int32_t row, std::int32_t col, std::size_t rows,
                            std::size_t cols) {
        SynthesisOptions options;
        options.rows = rows;
        options.cols = cols;
        options.offset_row = row;
        options.offset_col = col;
        options.seed = 5;
        return *synthesise(m, 0, options, executor, progress);
    };
    const Image large = window(-50, 1000, 400, 300);
    const Image small = window(130, 1111, 77, 93);
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t r = 0; r < 77; ++r)
            for (std::size_t c = 0; c < 93; ++c)
                ASSERT_EQ(small(band, r, c), large(band, r + 180, c + 111));
}

TEST(PeriodicLayer, IsTheSameForAnyNumberOfThreads) {
    const Material m = structured();
    SerialExecutor serial;
    test::ThreadedExecutor threaded(3);
    Progress progress;
    for (const bool tileable : {false, true}) {
        SynthesisOptions options;
        options.rows = 120;
        options.cols = 90;
        options.tileable = tileable;
        const auto one = synthesise(m, 0, options, serial, progress);
        const auto three = synthesise(m, 0, options, threaded, progress);
        ASSERT_TRUE(one && three);
        EXPECT_TRUE(std::ranges::equal(one->values(), three->values()));
    }
}

TEST(PeriodicLayer, MovesAllSubspacesAlike) {
    Material m = structured(2);
    m.subspaces[1] = m.subspaces[0];
    SerialExecutor executor;
    Progress progress;
    SynthesisOptions options;
    options.rows = options.cols = 64;
    std::vector<Image> textures;
    const std::array<std::size_t, 2> both = {0, 1};
    ASSERT_TRUE(synthesise_tiles(
        m, both, options,
        [&](std::size_t, Image texture) -> Result<void> {
            textures.push_back(std::move(texture));
            return {};
        },
        executor, progress));
    EXPECT_TRUE(std::ranges::equal(textures[0].values(), textures[1].values()));
}

// R(0) of 64 sites' mean over 40 seeds; the standard error is below 5 %.
TEST(SmoothLattice, HasTheCovariancesOfItsField) {
    SerialExecutor executor;
    SmoothField field;
    field.deviation = 2;
    field.weights[0 * SmoothField::kScales + 1] = 100;
    field.weights[2 * SmoothField::kScales + 0] = 50;
    const auto expected = [&](double r, double c) {
        const auto bell = [](double x, double s) {
            return std::exp(-x * x / (4 * s * s));
        };
        return 4 * (100 * bell(r, 1) * bell(c, 2) + 50 * bell(r, 4) * bell(c, 1)) / 150;
    };
    for (const Period period : {Period{64, 60}, Period{}}) {
        double R[3] = {};
        constexpr int kSeeds = 40;
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            const auto lattice =
                SmoothLattice::create(field, {seed, 64}, period, 1, 1, executor);
            ASSERT_TRUE(lattice);
            Image image(1, 60, 60);
            lattice->draw(0, 0, image.plane(0), executor);
            for (std::size_t r = 0; r < 56; ++r)
                for (std::size_t c = 0; c < 56; ++c) {
                    const auto at = [&](std::size_t i, std::size_t j) {
                        return static_cast<double>(image(0, r + i, c + j));
                    };
                    R[0] += at(0, 0) * at(0, 0) / (56 * 56 * kSeeds);
                    R[1] += at(0, 0) * at(3, 0) / (56 * 56 * kSeeds);
                    R[2] += at(0, 0) * at(0, 2) / (56 * 56 * kSeeds);
                }
        }
        EXPECT_NEAR(R[0], expected(0, 0), 0.15 * expected(0, 0)) << period.rows;
        EXPECT_NEAR(R[1], expected(3, 0), 0.15 * expected(0, 0)) << period.rows;
        EXPECT_NEAR(R[2], expected(0, 2), 0.15 * expected(0, 0)) << period.rows;
    }
}

TEST(TorusSize, IsUnstrainedWhereTheLatticeCloses) {
    Material m = structured();
    m.structure->periodic.a = {0, 16};
    m.structure->periodic.b = {24, 8};
    EXPECT_NEAR(torus_of(m, 96, 160).strain, 0, 1e-12);
    // 100 columns hold 6.25 columns of cells: 6 of them are stretched by 100/96.
    EXPECT_NEAR(torus_of(m, 96, 100).strain, 100.0 / 96 - 1, 1e-3);
    const TorusSize best = best_torus(m, 100, 100);
    EXPECT_LT(best.strain, 1e-6);
    EXPECT_EQ(best.rows, 96U);
    EXPECT_EQ(best.cols, 96U);
    EXPECT_EQ(best_torus(test::random_material({}), 100, 90).cols, 90U);
}

TEST(TorusSize, SmallerThanACellHasOneCell) {
    const Material m = structured();
    const LatticeMap map = closed_lattice(m.structure->periodic, 4, 3);
    EXPECT_EQ(map.a()[0], 4);
    EXPECT_EQ(map.b()[1], 3);
}

}  // namespace
}  // namespace sateen
