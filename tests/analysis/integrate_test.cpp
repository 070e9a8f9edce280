// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/integrate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/relief.hpp"

namespace sateen {
namespace {

using test::cosine_relief;
using test::Relief;

double largest_difference(const BasicImage<double>& a, const BasicImage<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.plane_size(); ++i)
        largest = std::max(largest, std::abs(a.values()[i] - b.values()[i]));
    return largest;
}

// Frequencies up to 0.6 of the Nyquist frequency, sizes with large prime factors.
TEST(Integrate, AnalyticSlopesOfCosinesGiveTheirHeight) {
    for (const auto& [rows, cols] : {std::pair{64U, 64U}, std::pair{53U, 62U}}) {
        const Relief relief = cosine_relief(rows, cols, 15, 1.5, 3);
        const auto z =
            integrate(relief.slopes, Difference::band_limited, Periodicity::torus);
        EXPECT_LT(largest_difference(z, relief.height), 1e-12);
    }
}

TEST(Integrate, PurelyHorizontalAndVerticalWavesAreNotLost) {
    for (const bool along_columns : {true, false}) {
        BasicImage<double> height(1, 20, 24);
        for (std::size_t r = 0; r < 20; ++r)
            for (std::size_t c = 0; c < 24; ++c)
                height(0, r, c) = std::sin(2 * std::numbers::pi *
                                           (along_columns ? static_cast<double>(c) / 24
                                                          : static_cast<double>(r) / 20));
        for (const Difference d :
             {Difference::band_limited, Difference::central, Difference::forward})
            EXPECT_LT(largest_difference(
                          integrate(slopes_of(height, d), d, Periodicity::torus), height),
                      1e-12);
    }
}

TEST(Integrate, EveryDifferenceIsInvertedByItsOwnSymbol) {
    const Relief relief = cosine_relief(48, 60, 12, 2, 4);
    for (const Difference d :
         {Difference::band_limited, Difference::central, Difference::forward}) {
        const SlopeField slopes = slopes_of(relief.height, d);
        EXPECT_LT(
            largest_difference(integrate(slopes, d, Periodicity::torus), relief.height),
            1e-12);
    }
}

// Random heights of a sheared torus from differences taken by hand.
TEST(Integrate, AShearedTorusIsInvertedToo) {
    constexpr std::size_t kRows = 15;
    constexpr std::size_t kCols = 21;
    constexpr std::size_t kShear = 8;
    BasicImage<double> height(1, kRows, kCols);
    std::mt19937 engine(8);
    double mean = 0;
    for (double& z : height.values())
        mean += z = static_cast<double>(engine()) / 4294967296.0;
    for (double& z : height.values()) z -= mean / (kRows * kCols);
    SlopeField slopes(2, kRows, kCols);
    for (std::size_t r = 0; r < kRows; ++r)
        for (std::size_t c = 0; c < kCols; ++c) {
            const double above =
                r > 0 ? height(0, r - 1, c) : height(0, kRows - 1, (c + kShear) % kCols);
            slopes(0, r, c) = height(0, r, (c + 1) % kCols) - height(0, r, c);
            slopes(1, r, c) = above - height(0, r, c);
        }
    const auto z = integrate(slopes, Difference::forward, Periodicity::torus, kShear);
    EXPECT_LT(largest_difference(z, height), 1e-12);
}

// Naively, from the heights themselves.
TEST(SlopesOf, AreTheDifferencesThatTheyAreCalled) {
    const Relief relief = cosine_relief(17, 22, 7, 2, 5);
    const auto z = [&](std::size_t r, std::size_t c) {
        return relief.height(0, r % 17, c % 22);
    };
    const SlopeField central = slopes_of(relief.height, Difference::central);
    const SlopeField forward = slopes_of(relief.height, Difference::forward);
    const SlopeField derivative = slopes_of(relief.height, Difference::band_limited);
    for (std::size_t r = 0; r < 17; ++r)
        for (std::size_t c = 0; c < 22; ++c) {
            EXPECT_NEAR(central(0, r, c), (z(r, c + 1) - z(r, c + 21)) / 2, 1e-12);
            EXPECT_NEAR(central(1, r, c), (z(r + 16, c) - z(r + 1, c)) / 2, 1e-12);
            EXPECT_NEAR(forward(0, r, c), z(r, c + 1) - z(r, c), 1e-12);
            EXPECT_NEAR(forward(1, r, c), z(r + 16, c) - z(r, c), 1e-12);
            EXPECT_NEAR(derivative(0, r, c), relief.slopes(0, r, c), 1e-12);
            EXPECT_NEAR(derivative(1, r, c), relief.slopes(1, r, c), 1e-12);
        }
}

// A dome is no torus: its mirror is continuous.
TEST(Integrate, ADomeComesBackFromItsNormals) {
    constexpr std::size_t kSize = 96;
    constexpr double kRadius = 90;
    Relief dome{BasicImage<double>(1, kSize, kSize), SlopeField(2, kSize, kSize), {}};
    for (std::size_t r = 0; r < kSize; ++r)
        for (std::size_t c = 0; c < kSize; ++c) {
            const double x = static_cast<double>(c) - 47.5 + 6;
            const double y = 47.5 - static_cast<double>(r);
            dome.height(0, r, c) = std::sqrt(kRadius * kRadius - x * x - y * y);
            dome.slopes(0, r, c) = -x / dome.height(0, r, c);
            dome.slopes(1, r, c) = -y / dome.height(0, r, c);
        }
    dome.normals = test::normals_of_slopes(dome.slopes);
    const SlopeField slopes = slopes_of_normals(dome.normals);
    for (const Difference d : {Difference::band_limited, Difference::central}) {
        const auto z = integrate(slopes, d, Periodicity::mirror);
        EXPECT_GT(test::correlation(z, dome.height), 0.9995);
    }
}

TEST(Integrate, NoiseNearTheNyquistFrequencyIsNotBlownUp) {
    SlopeField slopes(2, 64, 64);
    std::mt19937 engine(6);
    for (double& v : slopes.values())
        v = static_cast<double>(engine()) / 4294967296.0 - 0.5;
    const auto sharp = integrate(slopes, Difference::central, Periodicity::torus);
    const auto smooth = integrate(slopes, Difference::band_limited, Periodicity::torus);
    const auto power = [](const BasicImage<double>& z) {
        double sum = 0;
        for (const double v : z.values()) sum += v * v;
        return sum;
    };
    EXPECT_LT(power(sharp), 2 * power(smooth));
}

TEST(SlopesOfNormals, AreBounded) {
    Image normals(3, 1, 2);
    normals(0, 0, 0) = 1;
    normals(2, 0, 1) = 1;
    const SlopeField slopes = slopes_of_normals(normals);
    EXPECT_NEAR(slopes(0, 0, 0), -1 / 0.15, 1e-6);
    EXPECT_EQ(slopes(0, 0, 1), 0);
}

TEST(RemoveTilt, LeavesWhatIsNoPlane) {
    Relief relief = cosine_relief(40, 30, 3, 1, 7);
    remove_tilt(relief.height);
    BasicImage<double> tilted = relief.height;
    for (std::size_t r = 0; r < 40; ++r)
        for (std::size_t c = 0; c < 30; ++c)
            tilted(0, r, c) +=
                3 + 0.2 * static_cast<double>(r) - 0.7 * static_cast<double>(c);
    remove_tilt(tilted);
    EXPECT_LT(largest_difference(tilted, relief.height), 1e-10);
}

}  // namespace
}  // namespace sateen
