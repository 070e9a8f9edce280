// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/roller.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "analysis/roller_cut.hpp"
#include "sateen/analysis/integrate.hpp"
#include "support/relief.hpp"

namespace sateen {
namespace {

using test::cosine_relief;
using Plane = BasicImage<double>;

RolledSurface rolled(const Plane& height, const RollerOptions& options = {}) {
    auto result = roll(height, options);
    EXPECT_TRUE(result) << result.error().message;
    return *std::move(result);
}

Plane window(const Plane& from, std::size_t rows, std::size_t cols) {
    Plane out(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) out(0, r, c) = from(0, r, c);
    return out;
}

// All paths, by recursion.
double naive_best(const Plane& error, std::size_t step, std::size_t site, std::size_t end,
                  bool closed) {
    if (step + 1 == error.rows()) {
        const bool ends = !closed || (site + 1 >= end && site <= end + 1);
        return ends ? error(0, step, site) : 1e30;
    }
    double best = 1e30;
    for (std::size_t next = site > 0 ? site - 1 : 0;
         next <= std::min(site + 1, error.cols() - 1); ++next)
        best = std::min(best, naive_best(error, step + 1, next, end, closed));
    return error(0, step, site) + best;
}

TEST(MinimumErrorPath, IsTheBestOfAllPaths) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        Plane error(1, 8, 5);
        std::mt19937 engine(seed);
        for (double& v : error.values()) v = static_cast<double>(engine() % 1000);
        for (const bool closed : {false, true}) {
            const auto path = minimum_error_path(error, closed);
            double found = 0;
            for (std::size_t i = 0; i < 8; ++i) {
                found += error(0, i, path[i]);
                const auto next = static_cast<int>(path[i + 1 < 8 ? i + 1 : 0]);
                if (closed || i + 1 < 8) {
                    EXPECT_LE(std::abs(next - static_cast<int>(path[i])), 1);
                }
            }
            double best = 1e30;
            for (std::size_t start = 0; start < 5; ++start)
                best = std::min(best, naive_best(error, 0, start, start, closed));
            EXPECT_EQ(found, best);
        }
    }
}

TEST(MinimumErrorInside, FollowsAFreeRingAndFillsIt) {
    Plane error(1, 20, 24);
    for (std::size_t r = 0; r < 20; ++r)
        for (std::size_t c = 0; c < 24; ++c)
            error(0, r, c) = std::min({r, c, 19 - r, 23 - c}) == 3 ? 0 : 1;
    const auto inside = minimum_error_inside(error, 5);
    for (std::size_t r = 0; r < 20; ++r)
        for (std::size_t c = 0; c < 24; ++c)
            EXPECT_EQ(inside[r * 24 + c], std::min({r, c, 19 - r, 23 - c}) > 3 ? 1 : 0)
                << r << " " << c;
}

TEST(Roll, ATorusIsLeftAlone) {
    const auto relief = cosine_relief(40, 48, 6, 1, 1);
    const RolledSurface out = rolled(relief.height, {.tiles = 1});
    EXPECT_TRUE(out.was_toroidal);
    ASSERT_EQ(out.tiles.size(), 1U);
    for (std::size_t i = 0; i < relief.height.plane_size(); ++i)
        EXPECT_EQ(out.tiles[0].values()[i],
                  static_cast<float>(relief.height.values()[i]));
}

// Whatever is cut out of a larger torus has no period of its own.
TEST(Roll, SeamsOfRandomReliefAreNoLargerThanItsOwnSteps) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        const auto relief = cosine_relief(400, 360, 40, 4, seed, 60);
        const RolledSurface out = rolled(window(relief.height, 96, 110));
        EXPECT_FALSE(out.was_toroidal);
        ASSERT_EQ(out.tiles.size(), 4U);
        EXPECT_LE(out.seam_ratio, 1.05);
        EXPECT_LE(out.normal_seam_ratio, 1.05);
    }
}

TEST(Roll, TilesAreInterchangeable) {
    const auto relief = cosine_relief(400, 360, 40, 4, 9, 60);
    const RolledSurface out = rolled(window(relief.height, 96, 96));
    const std::size_t rows = out.tiles[0].rows();
    const std::size_t cols = out.tiles[0].cols();
    for (std::size_t t = 1; t < out.tiles.size(); ++t) {
        std::size_t changed = 0;
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c) {
                const bool border = r <= 1 || c <= 1 || r + 2 >= rows || c + 2 >= cols;
                const bool equal = out.tiles[t](0, r, c) == out.tiles[0](0, r, c);
                if (border) {
                    ASSERT_TRUE(equal) << r << " " << c;
                }
                changed += static_cast<std::size_t>(!equal);
            }
        EXPECT_GT(changed, rows * cols / 2);
    }
}

// A weave with periods (12, 5) and (0, 14): the tile is a whole number of them.
TEST(Roll, TheLatticeOfARegularMaterialIsKept) {
    Plane weave(1, 100, 120);
    for (std::size_t r = 0; r < 100; ++r)
        for (std::size_t c = 0; c < 120; ++c) {
            const double v = static_cast<double>(r) / 12;
            const double u = (static_cast<double>(c) - 5 * v) / 14;
            weave(0, r, c) = std::cos(2 * std::numbers::pi * u) +
                             0.7 * std::cos(2 * std::numbers::pi * (u + v)) +
                             0.4 * std::sin(2 * std::numbers::pi * (2 * u - v));
        }
    const RolledSurface out = rolled(weave);
    const auto rows = static_cast<double>(out.tiles[0].rows());
    const auto cols = static_cast<double>(out.tiles[0].cols());
    EXPECT_EQ(std::fmod(rows, 12), 0);
    EXPECT_EQ(std::fmod(cols, 14), 0);
    EXPECT_NEAR(std::remainder(out.shear_px - 5 * rows / 12, 14), 0, 1e-9);
    EXPECT_LE(out.seam_ratio, 1.05);
    // The weave itself, but for a constant.
    Plane exact(1, out.tiles[0].rows(), out.tiles[0].cols());
    for (std::size_t r = 0; r < exact.rows(); ++r)
        for (std::size_t c = 0; c < exact.cols(); ++c)
            exact(0, r, c) = weave(0, r + 1, c);
    EXPECT_GT(test::correlation(out.tiles[0], exact), 0.9999);
}

/// A weave of threads with any two periods, (row, column) each.
Plane weave_of(std::size_t rows, std::size_t cols, std::array<double, 2> a,
               std::array<double, 2> b) {
    Plane out(1, rows, cols);
    const double area = a[0] * b[1] - a[1] * b[0];
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            const auto y = static_cast<double>(r);
            const auto x = static_cast<double>(c);
            const double v = 2 * std::numbers::pi * (y * b[1] - x * b[0]) / area;
            const double u = 2 * std::numbers::pi * (x * a[0] - y * a[1]) / area;
            out(0, r, c) = std::cos(u) + 0.7 * std::cos(u + v) + 0.4 * std::sin(v);
        }
    return out;
}

// Turned by 3 degrees, and no period is whole.
TEST(Roll, PeriodsNeedNeitherBeWholeNorAlongTheRows) {
    const Plane weave = weave_of(120, 130, {12.3, -0.65}, {0.65, 12.3});
    const RolledSurface out = rolled(weave);
    EXPECT_FALSE(out.was_toroidal);
    // Both sides of a cut agree everywhere, so it may run where the weave itself is steep.
    EXPECT_LE(out.seam_ratio, 1.1);
    EXPECT_LE(out.normal_seam_ratio, 1.05);
    // As much of every height as in the weave: nothing was blended or bent.
    double square = 0;
    for (const float z : out.tiles[0].values())
        square += static_cast<double>(z) * static_cast<double>(z);
    EXPECT_NEAR(square / static_cast<double>(out.tiles[0].plane_size()),
                (1 + 0.49 + 0.16) / 2, 0.03);
}

bool continues(const Plane& height) {
    return is_toroidal(slopes_of(height, Difference::central));
}

TEST(IsToroidal, TellsAWholeNumberOfThreadsFromABrokenOne) {
    EXPECT_TRUE(continues(weave_of(96, 96, {12, 0}, {0, 16})));
    EXPECT_TRUE(continues(weave_of(96, 96, {12, 4}, {0, 16})));
    EXPECT_FALSE(continues(weave_of(96, 90, {12, 0}, {0, 16})));
    EXPECT_FALSE(continues(weave_of(91, 96, {12, 0}, {0, 16})));
    // Waves of 3 pixels hide a border: not every piece of a random relief is told.
    int told = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const Plane torus = cosine_relief(90, 96, 30, 4, seed, 60).height;
        EXPECT_TRUE(continues(torus)) << seed;
        told += continues(window(torus, 80, 96)) ? 0 : 1;
        told += continues(window(torus, 90, 84)) ? 0 : 1;
    }
    EXPECT_GE(told, 10);
}

TEST(Roll, ATiltIsNotRolledUp) {
    auto relief = cosine_relief(300, 300, 30, 4, 3, 60);
    Plane tilted = window(relief.height, 80, 80);
    for (std::size_t r = 0; r < 80; ++r)
        for (std::size_t c = 0; c < 80; ++c)
            tilted(0, r, c) += 0.5 * static_cast<double>(c);
    EXPECT_LE(rolled(tilted).seam_ratio, 1.05);
}

TEST(Roll, RefusesSmallSamplesAndTooManyTiles) {
    EXPECT_FALSE(roll(Plane(1, 15, 100), {}));
    EXPECT_FALSE(roll(Plane(1, 20, 20), {.tiles = 9}));
    EXPECT_FALSE(roll(Plane(1, 20, 20), {.tiles = 0}));
    EXPECT_TRUE(roll(Plane(1, 20, 20), {})) << "flat";
}

}  // namespace
}  // namespace sateen
