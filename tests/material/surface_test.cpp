// SPDX-License-Identifier: Apache-2.0
#include "sateen/material/surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "material/surface_codec.hpp"
#include "support/surfaces.hpp"

namespace sateen {
namespace {

using test::random_surface;
using testing::HasSubstr;

std::vector<std::uint16_t> round_trip(const std::vector<std::uint16_t>& codes,
                                      std::size_t cols) {
    std::vector<std::uint8_t> low;
    std::vector<std::uint8_t> high;
    append_residuals(codes, cols, low, high);
    return restore_codes([&](std::size_t i) { return low[i]; },
                         [&](std::size_t i) { return high[i]; }, 0, codes.size() / cols,
                         cols);
}

TEST(SurfaceCodec, EveryCodeComesBack) {
    std::mt19937 engine(1);
    for (const std::size_t cols : {1U, 2U, 7U, 64U}) {
        std::vector<std::uint16_t> codes(cols * 9);
        for (auto& code : codes) code = static_cast<std::uint16_t>(engine());
        EXPECT_EQ(round_trip(codes, cols), codes);
        for (auto& code : codes) code = engine() % 2 == 0 ? 0xFFFF : 0;
        EXPECT_EQ(round_trip(codes, cols), codes);
    }
}

TEST(SurfaceCodec, APlaneIsPredictedBehindItsFirstRowAndColumn) {
    constexpr std::size_t kCols = 10;
    std::vector<std::uint16_t> codes;
    for (std::size_t r = 0; r < 8; ++r)
        for (std::size_t c = 0; c < kCols; ++c)
            codes.push_back(static_cast<std::uint16_t>(100 + 5 * r));
    std::vector<std::uint8_t> low;
    std::vector<std::uint8_t> high;
    append_residuals(codes, kCols, low, high);
    for (std::size_t i = 0; i < low.size(); ++i)
        EXPECT_EQ(low[i] != 0, i % kCols == 0) << i;
}

TEST(QuantiseSurface, ErrsByHalfAStepAtMost) {
    std::mt19937 engine(2);
    std::uniform_real_distribution<float> height(-7, 19);
    std::vector<Image> tiles(3, Image(1, 12, 9));
    for (Image& tile : tiles)
        for (float& z : tile.values()) z = height(engine);
    for (const float step : {0.5F, 0.05F, 0.0F}) {
        const auto surface = quantise_surface(tiles, step, 4);
        ASSERT_TRUE(surface) << surface.error().message;
        EXPECT_EQ(surface->shear_px, 4U);
        const float limit = 0.501F * std::max(step, 26.0F / 65535);
        for (std::size_t t = 0; t < tiles.size(); ++t)
            for (std::size_t i = 0; i < tiles[t].plane_size(); ++i)
                EXPECT_NEAR(surface->height_px(surface->tiles[t][i]),
                            tiles[t].values()[i], limit);
    }
}

TEST(QuantiseSurface, AFlatSurfaceIsExact) {
    Image flat(1, 4, 4);
    for (float& z : flat.values()) z = -2.5F;
    const auto surface = quantise_surface({&flat, 1}, 0);
    ASSERT_TRUE(surface) << surface.error().message;
    for (const std::uint16_t code : surface->tiles[0])
        EXPECT_EQ(surface->height_px(code), -2.5F);
}

TEST(QuantiseSurface, RefusesWhatNoSurfaceHolds) {
    EXPECT_FALSE(quantise_surface({}, 1));
    const std::vector<Image> nine(9, Image(1, 2, 2));
    EXPECT_FALSE(quantise_surface(nine, 1));
    const std::vector<Image> sizes = {Image(1, 2, 2), Image(1, 2, 3)};
    EXPECT_FALSE(quantise_surface(sizes, 1));
    std::vector<Image> nan(1, Image(1, 2, 2));
    nan[0](0, 1, 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(quantise_surface(nan, 1));
    EXPECT_FALSE(quantise_surface({&sizes[0], 1}, 1, 2)) << "sheared by a whole tile";
}

TEST(ValidateSurface, AmbientIsBounded) {
    Surface surface = test::random_surface();
    EXPECT_TRUE(validate(surface));
    for (const float wrong : {-0.1F, 16.5F, std::numeric_limits<float>::quiet_NaN()}) {
        surface.ambient = wrong;
        const auto checked = validate(surface);
        ASSERT_FALSE(checked);
        EXPECT_NE(checked.error().message.find("surface.ambient"), std::string::npos);
    }
}

TEST(TileAt, IsTheSameInEveryRunAndOnEveryPlatform) {
    const std::array<std::size_t, 8> expected = {
        tile_at(0, 0, 0, 4),
        tile_at(0, 1, 0, 4),
        tile_at(1, 0, 0, 4),
        tile_at(-1, -7, 0, 4),
        tile_at(0, 0, 1, 4),
        tile_at(5, 9, 1, 7),
        tile_at(5, 9, std::uint64_t{1} << 40U, 7),
        tile_at(1 << 29, -(1 << 29), 3, 8)};
    EXPECT_THAT(expected, testing::ElementsAre(0, 1, 1, 1, 3, 4, 0, 7));
}

// Significance 1e-6 each: 16384 draws of a fair die deviate by less than 5 standard errors.
TEST(TileAt, ChoosesEveryTileEquallyOftenAndNeighboursIndependently) {
    constexpr int kSide = 128;
    constexpr std::size_t kTiles = 4;
    std::array<int, kTiles> counts = {};
    std::array<int, 3> equal = {};
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const std::size_t tile = tile_at(i, j, 7, kTiles);
            ++counts[tile];
            equal[0] += static_cast<int>(tile == tile_at(i, j + 1, 7, kTiles));
            equal[1] += static_cast<int>(tile == tile_at(i + 1, j, 7, kTiles));
            equal[2] += static_cast<int>(tile == tile_at(i, j, 8, kTiles));
        }
    constexpr double kMean = kSide * kSide / 4.0;
    const double limit = 5 * std::sqrt(kMean * 0.75);
    for (const int count : counts) EXPECT_NEAR(count, kMean, limit);
    for (const int count : equal) EXPECT_NEAR(count, kMean, limit);
}

TEST(ValidateSurface, NamesWhatIsWrong) {
    struct Fault {
        const char* message;
        std::function<void(Surface&)> make;
    };
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Fault> faults = {
        {"surface.rows: 0", [](Surface& s) { s.rows = 0; }},
        {"surface.cols: 2049", [](Surface& s) { s.cols = 2049; }},
        {"surface.shear_px", [](Surface& s) { s.shear_px = s.cols; }},
        {"surface.offset_px: nan", [](Surface& s) { s.offset_px = kNan; }},
        {"surface.scale_px: -1", [](Surface& s) { s.scale_px = -1; }},
        {"surface.scale_px", [](Surface& s) { s.scale_px = 2e6F; }},
        {"surface.tiles: 0", [](Surface& s) { s.tiles.clear(); }},
        {"surface.tiles: 9", [](Surface& s) { s.tiles.resize(9); }},
        {"surface.tiles: ", [](Surface& s) { s.tiles[0].pop_back(); }},
        {"values, expected at most", [](Surface& s) { s.rows = s.cols = 2048; }},
    };
    for (const Fault& fault : faults) {
        Surface surface = random_surface({.rows = 6, .cols = 5});
        ASSERT_TRUE(validate(surface));
        fault.make(surface);
        const auto result = validate(surface);
        ASSERT_FALSE(result) << fault.message;
        EXPECT_THAT(result.error().message, HasSubstr(fault.message));
    }
}

}  // namespace
}  // namespace sateen
