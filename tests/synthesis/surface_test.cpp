// SPDX-License-Identifier: Apache-2.0
#include "sateen/synthesis/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/surfaces.hpp"

namespace sateen {
namespace {

using test::random_surface;

Image range(const Surface& surface, const PlaneWindow& window, std::uint64_t seed = 0) {
    auto image = draw_range(surface, window, seed);
    EXPECT_TRUE(image) << image.error().message;
    return *std::move(image);
}

ToroidalRange torus(const Surface& surface, std::size_t rows, std::size_t cols,
                    std::uint64_t seed = 0) {
    auto result = draw_toroidal_range(surface, rows, cols, seed);
    EXPECT_TRUE(result) << result.error().message;
    return *std::move(result);
}

TEST(DrawRange, OneTileRepeatsAlongTheLattice) {
    const Surface surface = random_surface({.shear_px = 4, .tiles = 1});
    const Image plane = range(surface, {-30, -40, 60, 80});
    for (std::size_t r = 0; r < 60 - surface.rows; ++r)
        for (std::size_t c = 0; c < 80 - surface.cols; ++c) {
            ASSERT_EQ(plane(0, r, c), plane(0, r, c + surface.cols));
            ASSERT_EQ(plane(0, r, c), plane(0, r + surface.rows, c + surface.shear_px));
        }
}

TEST(DrawRange, EveryTileIsTheOneThatItsHashNames) {
    const Surface surface = random_surface({.shear_px = 5, .tiles = 4});
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j) {
            const int row = i * 11;
            const int col = j * 13 + i * 5;
            const Image tile = range(surface, {row, col, 11, 13}, 9);
            const auto& codes = surface.tiles[tile_at(i, j, 9, 4)];
            for (std::size_t k = 0; k < codes.size(); ++k)
                ASSERT_EQ(tile.values()[k], surface.height_px(codes[k]));
        }
}

TEST(DrawRange, WindowsAgreeWhereTheyOverlap) {
    const Surface surface = random_surface({.shear_px = 3, .tiles = 3});
    const Image large = range(surface, {-50, -50, 100, 100}, 4);
    const Image small = range(surface, {-17, 8, 20, 30}, 4);
    for (std::size_t r = 0; r < 20; ++r)
        for (std::size_t c = 0; c < 30; ++c)
            ASSERT_EQ(small(0, r, c), large(0, r + 33, c + 58));
}

TEST(DrawRange, RefusesEmptyAndFarWindows) {
    const Surface surface = random_surface();
    EXPECT_FALSE(draw_range(surface, {0, 0, 0, 4}, 0));
    EXPECT_FALSE(draw_range(surface, {1 << 30, 0, 4, 4}, 0));
    EXPECT_FALSE(draw_toroidal_range(surface, 0, 4, 0));
    EXPECT_FALSE(draw_toroidal_range(surface, 4, std::size_t{1} << 21U, 0));
}

TEST(DrawToroidalRange, AMultipleOfTheTileIsNotStrained) {
    const Surface surface = random_surface({.tiles = 3});
    const ToroidalRange drawn = torus(surface, 33, 26, 5);
    EXPECT_EQ(drawn.tile_rows, 3U);
    EXPECT_EQ(drawn.tile_cols, 2U);
    EXPECT_EQ(drawn.strain_rows, 0);
    EXPECT_EQ(drawn.strain_cols, 0);
    EXPECT_EQ(drawn.strain_shear, 0);
    const Image plane = range(surface, {0, 0, 33, 26}, 5);
    for (std::size_t k = 0; k < plane.plane_size(); ++k)
        EXPECT_EQ(drawn.height_px.values()[k], plane.values()[k]);
}

// Two tile rows of shear 6 in 13 columns drift by 12: one column is sheared away.
TEST(DrawToroidalRange, AShearedLatticeClosesAndTellsItsStrain) {
    const Surface surface = random_surface({.shear_px = 6, .tiles = 1});
    const ToroidalRange drawn = torus(surface, 22, 39);
    EXPECT_EQ(drawn.strain_rows, 0);
    EXPECT_EQ(drawn.strain_cols, 0);
    EXPECT_NEAR(drawn.strain_shear, 1.0 / 22, 1e-12);
    const Image unstrained = range(surface, {0, 0, 22, 39});
    for (std::size_t c = 0; c < 39; ++c)
        EXPECT_EQ(drawn.height_px(0, 0, c), unstrained(0, 0, c));
}

// A smooth tile: where it is closed, no step is larger than inside.
Surface wave(std::uint32_t rows, std::uint32_t cols, std::uint32_t shear) {
    Image tile(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            const double v = static_cast<double>(r) / rows;
            const double u = static_cast<double>(c) / cols - v * shear / cols;
            tile(0, r, c) =
                static_cast<float>(3 * std::sin(2 * std::numbers::pi * (u + v)) +
                                   2 * std::cos(2 * std::numbers::pi * (2 * u - v)));
        }
    return *quantise_surface({&tile, 1}, 0, shear);
}

TEST(DrawToroidalRange, AnySizeContinuesAcrossItsBorders) {
    for (const auto& [rows, cols, shear] :
         {std::tuple{32U, 40U, 0U}, std::tuple{32U, 40U, 11U},
          std::tuple{17U, 29U, 23U}}) {
        const Surface surface = wave(rows, cols, shear);
        for (const auto& [m, n] : {std::pair{75U, 64U}, std::pair{100U, 130U}}) {
            const Image z = torus(surface, m, n).height_px;
            double inside = 0;
            double across = 0;
            for (std::size_t r = 0; r < m; ++r)
                for (std::size_t c = 0; c < n; ++c) {
                    const auto right =
                        static_cast<double>(std::abs(z(0, r, (c + 1) % n) - z(0, r, c)));
                    const auto down =
                        static_cast<double>(std::abs(z(0, (r + 1) % m, c) - z(0, r, c)));
                    (c + 1 < n ? inside : across) =
                        std::max(c + 1 < n ? inside : across, right);
                    (r + 1 < m ? inside : across) =
                        std::max(r + 1 < m ? inside : across, down);
                }
            EXPECT_LE(across, 1.05 * inside) << rows << " " << cols << " " << shear;
        }
    }
}

TEST(NormalsOf, APlateFacesUp) {
    const Image flat(1, 5, 7);
    const Image n = normals_of(flat.plane(0), Border::wraps);
    for (std::size_t k = 0; k < n.plane_size(); ++k) {
        EXPECT_EQ(n.plane(0).data[k], 0.0F);
        EXPECT_EQ(n.plane(1).data[k], 0.0F);
        EXPECT_EQ(n.plane(2).data[k], 1.0F);
    }
}

TEST(NormalsOf, ASlopeLeansAwayFromWhereItRises) {
    Image z(1, 8, 8);
    for (std::size_t r = 0; r < 8; ++r)
        for (std::size_t c = 0; c < 8; ++c)
            z(0, r, c) = 0.5F * static_cast<float>(c) - 0.25F * static_cast<float>(r);
    const Image n = normals_of(z.plane(0), Border::repeats_last, 2);
    // p = 1 along x; rows go down, so that z rises by 0.5 along y.
    const float length = std::sqrt(1 + 0.25F + 1);
    EXPECT_FLOAT_EQ(n(0, 4, 4), -1 / length);
    EXPECT_FLOAT_EQ(n(1, 4, 4), -0.5F / length);
    EXPECT_FLOAT_EQ(n(2, 4, 4), 1 / length);
}

}  // namespace
}  // namespace sateen
