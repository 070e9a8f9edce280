// SPDX-License-Identifier: Apache-2.0
#include "synthesis/recursive_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "sateen/core/normal.hpp"
#include "support/threaded_executor.hpp"
#include "synthesis/noise_bands.hpp"

namespace sateen {
namespace {

// Correlation a along columns and b along rows, innovations of deviation σ:
//     E Y_r Y_{r+d} = σ² a^|d_2| b^|d_1| / ((1 - a²)(1 - b²))
Car2d separable(float a, float b, float sigma) {
    return {{{0, 1}, {1, 0}, {1, 1}}, {a, b, -a * b}, sigma * sigma};
}

std::vector<Level> levels_of(const std::vector<Car2d>& fields) {
    std::vector<Level> levels;
    for (const Car2d& field : fields) levels.push_back({{field}});
    return levels;
}

// Three levels of different neighbourhoods, one with columns to the right.
std::vector<Level> pyramid() {
    return levels_of(
        {separable(0.5F, 0.6F, 1),
         {{{0, 1}, {1, -1}, {1, 0}, {2, 1}}, {0.4F, 0.3F, 0.2F, -0.1F}, 0.5F},
         separable(0.7F, 0.3F, 0.8F)});
}

Image draw(const std::vector<Level>& levels, std::uint64_t seed, LatticePoint at,
           std::size_t rows, std::size_t cols, Executor& executor) {
    Image out(1, rows, cols);
    const auto field = RecursiveField::create({levels, 0, 0, 0});
    EXPECT_TRUE(field);
    if (field) {
        EXPECT_TRUE(field->draw(seed, 0, at.row, at.col, out.plane(0), executor));
    }
    return out;
}

Image draw(const std::vector<Level>& levels, std::uint64_t seed, LatticePoint at,
           std::size_t rows, std::size_t cols) {
    SerialExecutor serial;
    return draw(levels, seed, at, rows, cols, serial);
}

TEST(RecursiveField, WindowsAgreeWhereTheyOverlap) {
    const auto levels = pyramid();
    constexpr LatticePoint kWhole{-530, -40};
    const Image whole = draw(levels, 3, kWhole, 600, 620);
    struct Window {
        LatticePoint at;
        std::size_t rows, cols;
    };
    for (const Window& w : {Window{{-530, -40}, 1, 1}, Window{{-513, -1}, 3, 2},
                            Window{{-100, 17}, 150, 63}, Window{{0, 0}, 70, 512},
                            Window{{5, 500}, 60, 80}, Window{{-400, 511}, 33, 2}}) {
        const Image window = draw(levels, 3, w.at, w.rows, w.cols);
        const auto expected = std::as_const(whole).plane(0).window(
            static_cast<std::size_t>(w.at.row - kWhole.row),
            static_cast<std::size_t>(w.at.col - kWhole.col), w.rows, w.cols);
        for (std::size_t r = 0; r < w.rows; ++r)
            ASSERT_TRUE(std::equal(expected.row(r), expected.row(r) + w.cols,
                                   window.plane(0).row(r)))
                << "window at (" << w.at.row << ", " << w.at.col << "), row " << r;
    }
}

TEST(RecursiveField, IsTheSameForAnyNumberOfThreads) {
    const auto levels = pyramid();
    const Image serial = draw(levels, 5, {-20, 400}, 600, 700);
    test::ThreadedExecutor threads(3);
    const Image threaded = draw(levels, 5, {-20, 400}, 600, 700, threads);
    EXPECT_TRUE(std::equal(serial.values().begin(), serial.values().end(),
                           threaded.values().begin()));
}

TEST(RecursiveField, PlanesAndSeedsDiffer) {
    const auto levels = pyramid();
    const auto field = RecursiveField::create({levels, 0, 0, 0});
    ASSERT_TRUE(field);
    SerialExecutor serial;
    Image planes(2, 16, 16);
    for (std::uint32_t plane = 0; plane < 2; ++plane)
        ASSERT_TRUE(field->draw(1, plane, 0, 0, planes.plane(plane), serial));
    const Image seed = draw(levels, 2, {0, 0}, 16, 16);
    for (std::size_t i = 0; i < 256; ++i) {
        ASSERT_NE(planes.values()[i], planes.values()[256 + i]);
        ASSERT_NE(planes.values()[i], seed.values()[i]);
    }
}

// The mean of Y_r Y_{r+d} over a plane.
double sample_autocovariance(PlaneView<const float> y, std::size_t down,
                             std::size_t right) {
    double sum = 0;
    for (std::size_t r = 0; r + down < y.rows; ++r)
        for (std::size_t c = 0; c + right < y.cols; ++c)
            sum += static_cast<double>(y(r, c)) *
                   static_cast<double>(y(r + down, c + right));
    return sum / static_cast<double>((y.rows - down) * (y.cols - right));
}

// Compares with the mean over independent fields, and takes the standard error from
// their scatter: 5 of it have probability 4e-5 under Student's t of 23 degrees.
template <class Expected>
void expect_autocovariance(const std::vector<Level>& levels, Expected&& expected) {
    constexpr std::size_t kFields = 24;
    constexpr double kStandardErrors = 5;
    constexpr std::pair<std::size_t, std::size_t> kLags[] = {
        {0, 0}, {0, 1}, {1, 0}, {1, 1}, {0, 3}, {3, 0}, {5, 2}, {0, 9}};
    std::vector<Image> fields;
    for (std::uint64_t seed = 0; seed < kFields; ++seed)
        fields.push_back(draw(levels, seed, {0, 0}, 256, 512));
    for (const auto& [down, right] : kLags) {
        double sum = 0;
        double squares = 0;
        for (const Image& field : fields) {
            const double sample = sample_autocovariance(field.plane(0), down, right);
            sum += sample;
            squares += sample * sample;
        }
        const double mean = sum / kFields;
        const double scatter = (squares / kFields - mean * mean) / (kFields - 1);
        EXPECT_NEAR(mean, expected(down, right), kStandardErrors * std::sqrt(scatter))
            << "lag (" << down << ", " << right << ")";
    }
}

TEST(RecursiveField, OneLevelHasTheAutocovarianceOfItsModel) {
    expect_autocovariance(levels_of({separable(0.8F, 0.6F, 1.5F)}),
                          [](std::size_t down, std::size_t right) {
                              return 2.25 / ((1 - 0.64) * (1 - 0.36)) *
                                     std::pow(0.8, right) * std::pow(0.6, down);
                          });
}

TEST(RecursiveField, LevelsAddUpToTheAutocovarianceOfTheirDensity) {
    // A sum over the density, which is 0 at no frequency and smooth: 64 x 64 are exact.
    constexpr std::size_t kSize = 64;
    const auto levels = pyramid();
    SerialExecutor serial;
    const Image density = spectral_density({levels, 0, 0, 0}, kSize, kSize, serial);
    expect_autocovariance(levels, [&](std::size_t down, std::size_t right) {
        double sum = 0;
        for (std::size_t m = 0; m < kSize; ++m) {
            for (std::size_t n = 0; n <= kSize / 2; ++n) {
                const double phase = 2 * std::numbers::pi *
                                     static_cast<double>(m * down + n * right) / kSize;
                const double twice = n == 0 || n == kSize / 2 ? 1 : 2;
                sum += twice * static_cast<double>(density(0, m, n)) * std::cos(phase);
            }
        }
        return sum / (kSize * kSize);
    });
}

TEST(RecursiveField, AConstantPlaneIsZero) {
    Car2d constant = separable(0.5F, 0.5F, 0);
    const Image drawn = draw(levels_of({constant, {{}, {}, 0}}), 1, {500, 500}, 30, 30);
    EXPECT_THAT(drawn.values(), testing::Each(0.0F));
}

TEST(RecursiveField, RefusesAModelThatDoesNotForgetItsStart) {
    for (const Car2d& model :
         {Car2d{{{0, 1}}, {1.01F}, 1}, Car2d{{{1, 0}}, {1}, 1}, separable(0.99F, 0.5F, 1),
          Car2d{{{0, 1}, {1, 0}}, {0.6F, 0.6F}, 1}, Car2d{{{1, -1}}, {100}, 1},
          Car2d{{{0, 1}, {1, 0}}, {1e30F, 1e30F}, 1}}) {
        const auto levels = levels_of({separable(0.5F, 0.5F, 1), model});
        const auto field = RecursiveField::create({levels, 0, 0, 0});
        ASSERT_FALSE(field);
        EXPECT_EQ(field.error().code, Errc::not_stationary);
        EXPECT_THAT(field.error().message, testing::HasSubstr("level 1"));
    }
}

TEST(RecursiveField, RefusesAFieldThatIsNotCausal) {
    const std::vector<Level> levels = {{{Gmrf2d{}}}};
    const auto field = RecursiveField::create({levels, 0, 0, 0});
    ASSERT_FALSE(field);
    EXPECT_EQ(field.error().code, Errc::unsupported);
}

TEST(RecursiveField, BlocksContinueEachOther) {
    // At sites beside another block, from 512 on, the recursion holds but for what the
    // two have forgotten: 1e-3 of the deviation in the root mean square.
    //     Y_r - Σ a_s Y_{r-s} = σ e_r
    constexpr float kA = 0.8F;
    constexpr float kB = 0.7F;
    constexpr std::size_t kSites = 400;
    const double deviation = 1 / std::sqrt((1 - 0.64) * (1 - 0.49));
    const auto levels = levels_of({separable(kA, kB, 1)});
    for (const bool below : {true, false}) {
        const LatticePoint at = below ? LatticePoint{511, 39} : LatticePoint{39, 511};
        const std::size_t rows = below ? 2 : kSites + 1;
        const std::size_t cols = below ? kSites + 1 : 2;
        const Image y = draw(levels, 9, at, rows, cols);
        std::vector<float> e(cols);
        double squares = 0;
        for (std::size_t r = 1; r < rows; ++r) {
            draw_normals({9, recursion_noise_band(0, 0)},
                         at.row + static_cast<std::int32_t>(r), at.col, e);
            for (std::size_t c = 1; c < cols; ++c) {
                const float predicted = kA * y(0, r, c - 1) + kB * y(0, r - 1, c) -
                                        kA * kB * y(0, r - 1, c - 1);
                const auto missing = static_cast<double>(y(0, r, c) - predicted - e[c]);
                squares += missing * missing;
            }
        }
        const double rms = std::sqrt(squares / kSites);
        EXPECT_LT(rms, 1e-3 * deviation) << (below ? "below" : "beside");
        EXPECT_GT(rms, 1e-5) << "no border was crossed";
    }
}

}  // namespace
}  // namespace sateen
