// SPDX-License-Identifier: Apache-2.0
#include "synthesis/infinite_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "reference/stationary_field.hpp"
#include "support/materials.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using reference::DoublePlane;

class InfinitePlane {
  public:
    explicit InfinitePlane(std::vector<Level> levels, Period period = {},
                           double sample = 256)
        : levels_(std::move(levels)),
          field_(InfiniteField::create({levels_, 0, sample, sample}, period, executor_)) {
        EXPECT_TRUE(field_);
    }
    Image window(std::int32_t row, std::int32_t col, std::size_t rows, std::size_t cols,
                 std::uint64_t seed = 1) {
        Image out(1, rows, cols);
        EXPECT_TRUE(field_->draw(seed, 0, row, col, out.plane(0), executor_));
        return out;
    }
    const InfiniteField& field() { return *field_; }

  private:
    SerialExecutor executor_;
    std::vector<Level> levels_;
    Result<InfiniteField> field_;
};

std::vector<Level> shallow() {
    return test::levels_of(test::pyramid_of(test::half_plane_field(), 2));
}
std::vector<Level> deep() {
    return test::levels_of(test::pyramid_of(test::half_plane_field(), 4));
}

TEST(InfiniteField, WindowsAgreeToTheBitWhereTheyOverlap) {
    for (const auto& levels : {shallow(), deep()}) {
        InfinitePlane plane(levels);
        const auto side = static_cast<std::int32_t>(plane.field().strip_rows());
        // Around the origin and around a border of blocks.
        for (const std::int32_t centre : {0, side, -2 * side}) {
            const Image large = plane.window(centre - 40, centre - 50, 90, 100);
            for (const auto& [row, col, rows, cols] : {std::array{-40, -50, 1, 1},
                                                       {-1, -1, 3, 3},
                                                       {0, 0, 50, 50},
                                                       {-17, 13, 31, 22},
                                                       {-39, -50, 1, 100}}) {
                const Image small = plane.window(centre + row, centre + col,
                                                 static_cast<std::size_t>(rows),
                                                 static_cast<std::size_t>(cols));
                for (std::size_t r = 0; r < small.rows(); ++r) {
                    for (std::size_t c = 0; c < small.cols(); ++c)
                        ASSERT_EQ(small(0, r, c),
                                  large(0, r + static_cast<std::size_t>(row + 40),
                                        c + static_cast<std::size_t>(col + 50)));
                }
            }
        }
    }
}

TEST(InfiniteField, DoesNotDependOnTheExecutor) {
    const auto levels = deep();
    SerialExecutor serial;
    const auto field = InfiniteField::create({levels, 0, 256, 256}, {}, serial);
    ASSERT_TRUE(field);
    Image expected(1, 30, 900);
    ASSERT_TRUE(field->draw(3, 0, -10, -450, expected.plane(0), serial));
    for (const std::size_t count : {2U, 3U}) {
        test::ThreadedExecutor threads(count);
        Image got(1, 30, 900);
        ASSERT_TRUE(field->draw(3, 0, -10, -450, got.plane(0), threads));
        for (std::size_t i = 0; i < got.values().size(); ++i)
            ASSERT_EQ(got.values()[i], expected.values()[i]);
    }
}

TEST(InfiniteField, OfAConstantPlaneIsZero) {
    for (const std::size_t levels : {1U, 3U}) {
        InfinitePlane plane(test::levels_of(std::vector<Car2d>(levels)));
        const Image window = plane.window(5, 5, 9, 9);
        for (const float value : window.values()) EXPECT_EQ(value, 0);
    }
}

// 900 x 900 sites with a correlation length of a few: the standard error of an
// autocorrelation is below 1 %; the kernel is cut at 0.05 % of its energy, hence the field
// changes by up to 2 % of its deviation.
TEST(InfiniteField, HasTheAutocovarianceOfTheDensityAndVarianceOne) {
    for (const std::size_t depth : {1U, 2U, 4U}) {
        const auto pyramid = test::pyramid_of(test::half_plane_field(), depth);
        InfinitePlane plane(test::levels_of(pyramid));
        const Image window = plane.window(-100, 200, 900, 900);
        double mean = 0;
        for (const float value : window.values())
            mean += static_cast<double>(value) / 810000;
        EXPECT_NEAR(mean, 0, 0.01);
        const auto correlation = [&](int row, int col) {
            double sum = 0;
            for (std::size_t r = 8; r < 892; ++r) {
                for (std::size_t c = 8; c < 892; ++c)
                    sum += static_cast<double>(window(0, r, c)) *
                           static_cast<double>(window(
                               0, static_cast<std::size_t>(static_cast<int>(r) - row),
                               static_cast<std::size_t>(static_cast<int>(c) - col)));
            }
            return sum / (884 * 884);
        };
        const DoublePlane R = reference::autocovariance_of_density(
            reference::density_on_torus(std::span<const Car2d>(pyramid), 128, 128));
        EXPECT_NEAR(correlation(0, 0), 1, 0.03) << depth;
        for (const auto& [row, col] : {std::array{0, 1},
                                       {1, 0},
                                       {1, 1},
                                       {1, -1},
                                       {0, 3},
                                       {4, 0},
                                       {3, -4},
                                       {8, 8}}) {
            const double expected = R(static_cast<std::size_t>(row),
                                      static_cast<std::size_t>((col + 128) % 128)) /
                                    R(0, 0);
            EXPECT_NEAR(correlation(row, col), expected, 0.02)
                << depth << " levels, lag " << row << ',' << col;
        }
    }
}

TEST(InfiniteField, ExpandedCoarseLevelsDoNotShowTheirLattice) {
    // An expanded field is cyclostationary: its variance differs between the 16 positions of
    // the 4 x 4 cell, by 3 % for this one; 90 000 sites a position make it 1 %.
    std::vector<Car2d> pyramid = test::pyramid_of(test::half_plane_field(), 4);
    pyramid[0].variance = 0;
    pyramid[1].variance = 0;
    InfinitePlane plane(test::levels_of(pyramid));
    const Image window = plane.window(0, 0, 1200, 1200);
    std::array<double, 16> variances{};
    for (std::size_t r = 0; r < 1200; ++r) {
        for (std::size_t c = 0; c < 1200; ++c) {
            const auto value = static_cast<double>(window(0, r, c));
            variances[r % 4 * 4 + c % 4] += value * value / (300 * 300);
        }
    }
    const auto [least, most] = std::minmax_element(variances.begin(), variances.end());
    EXPECT_LT(*most / *least, 1.05);
}

TEST(InfiniteField, PeriodicNoiseMakesATorus) {
    // Split (a multiple of 4) and not.
    for (const Period period : {Period{44, 52}, Period{37, 51}}) {
        InfinitePlane plane(deep(), period);
        const auto rows = static_cast<std::size_t>(period.rows);
        const auto cols = static_cast<std::size_t>(period.cols);
        const Image once = plane.window(0, 0, rows, cols);
        const Image again = plane.window(period.rows, -period.cols, rows, cols);
        for (std::size_t i = 0; i < once.values().size(); ++i)
            ASSERT_NEAR(static_cast<double>(once.values()[i]),
                        static_cast<double>(again.values()[i]), 1e-4);
    }
}

}  // namespace
}  // namespace sateen
