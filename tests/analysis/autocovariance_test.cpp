// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/autocovariance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "reference/stationary_field.hpp"
#include "sateen/core/periodic_part.hpp"
#include "support/fields.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using reference::DoublePlane;

/// A draw with all frequencies, no multiple of anything, of mean 5.
Image sample(std::size_t rows, std::size_t cols) {
    DoublePlane plane =
        reference::toroidal_field(test::quarter_plane_field(), rows, cols, 3);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < cols; ++c)
            plane(r, c) += 5 + 0.01 * static_cast<double>(r + 2 * c);
    }
    return reference::to_image(plane);
}

/// The periodogram of the periodic part that the pyramid must hold, without the mean.
DoublePlane periodogram_to_hold(const Image& image) {
    SerialExecutor executor;
    Image periodic(1, image.rows(), image.cols());
    EXPECT_TRUE(periodic_part(image.plane(0), periodic.plane(0), executor, 0.125));
    DoublePlane S = reference::periodogram(reference::to_double(periodic.plane(0)));
    S(0, 0) = 0;
    return S;
}

/// W²S summed over the frequencies that decimation folds together with (m, n).
double folded(const DoublePlane& S, std::size_t m, std::size_t n) {
    double sum = 0;
    for (const std::size_t row : {m, (m + S.rows / 2) % S.rows}) {
        for (const std::size_t col : {n, (n + S.cols / 2) % S.cols}) {
            const double W = reference::kernel_transfer(
                reference::frequency(row, S.rows), reference::frequency(col, S.cols));
            sum += W * W * S(row, col);
        }
    }
    return sum;
}

/// The level spectra by their definition, every frequency of the torus.
std::vector<DoublePlane> level_spectra(DoublePlane S, std::size_t levels) {
    std::vector<DoublePlane> result;
    for (std::size_t k = 0; k + 1 < levels; ++k) {
        DoublePlane band(S.rows, S.cols);
        for (std::size_t m = 0; m < S.rows; ++m) {
            for (std::size_t n = 0; n < S.cols; ++n) {
                const double W = reference::kernel_transfer(
                    reference::frequency(m, S.rows), reference::frequency(n, S.cols));
                band(m, n) = std::max(0.0, S(m, n) - W * W * folded(S, m, n));
            }
        }
        DoublePlane coarse(S.rows / 2, S.cols / 2);
        for (std::size_t m = 0; m < coarse.rows; ++m) {
            for (std::size_t n = 0; n < coarse.cols; ++n)
                coarse(m, n) = folded(S, m, n) / 4;
        }
        result.push_back(band);
        S = coarse;
    }
    result.push_back(S);
    return result;
}

struct Shape {
    std::size_t rows, cols, levels;
};
constexpr Shape kShapes[] = {Shape{24, 32, 3}, {20, 36, 2}, {16, 16, 5}, {15, 9, 1},
                             {6, 10, 2},       {1, 12, 1},  {2, 4, 2}};

TEST(PowerPreservingPyramid, EqualsTheNaiveReference) {
    SerialExecutor executor;
    constexpr int kReach = 5;
    for (const Shape& s : kShapes) {
        const Image image = sample(s.rows, s.cols);
        const auto levels =
            power_preserving_pyramid(image.plane(0), s.levels, kReach, executor);
        ASSERT_TRUE(levels);
        const auto spectra = level_spectra(periodogram_to_hold(image), s.levels);
        ASSERT_EQ(levels->size(), s.levels);
        for (std::size_t k = 0; k < s.levels; ++k) {
            const DoublePlane R = reference::autocovariance_of_density(spectra[k]);
            const auto rows = static_cast<int>(R.rows);
            const auto cols = static_cast<int>(R.cols);
            EXPECT_EQ((*levels)[k].sites(), static_cast<double>(R.values.size()));
            for (int row = -kReach; row <= kReach; ++row) {
                for (int col = -kReach; col <= kReach; ++col) {
                    const double expected =
                        R(static_cast<std::size_t>((row % rows + rows) % rows),
                          static_cast<std::size_t>((col % cols + cols) % cols));
                    ASSERT_NEAR((*levels)[k](row, col), expected, 2e-6)
                        << s.rows << 'x' << s.cols << " level " << k << ' ' << row << ','
                        << col;
                }
            }
        }
    }
}

TEST(PowerPreservingPyramid, ExpandedLevelsAddUpToThePeriodogram) {
    SerialExecutor executor;
    const Image image = sample(32, 24);
    const auto levels = power_preserving_pyramid(image.plane(0), 3, 16, executor);
    ASSERT_TRUE(levels);
    // Back from autocovariances to spectra, then expanded on the naive pyramid: a plane
    // whose periodogram is the spectrum of a level, expanded, has the periodogram that
    // the level adds.
    const DoublePlane whole = periodogram_to_hold(image);
    DoublePlane sum(whole.rows, whole.cols);
    for (std::size_t k = 0; k < 3; ++k) {
        const Autocovariance& R = (*levels)[k];
        DoublePlane autocovariance(whole.rows >> k, whole.cols >> k);
        for (std::size_t r = 0; r < autocovariance.rows; ++r) {
            for (std::size_t c = 0; c < autocovariance.cols; ++c) {
                const bool far = 2 * r > autocovariance.rows;
                autocovariance(r, c) =
                    R(static_cast<int>(r) -
                          (far ? static_cast<int>(autocovariance.rows) : 0),
                      2 * c > autocovariance.cols
                          ? static_cast<int>(c) - static_cast<int>(autocovariance.cols)
                          : static_cast<int>(c));
            }
        }
        // The DFT of an even sequence is real: Σ R e^{+jω·s} is the spectrum over MN.
        DoublePlane spectrum = reference::autocovariance_of_density(autocovariance);
        const double sites = static_cast<double>(spectrum.values.size());
        for (double& value : spectrum.values)
            value = std::sqrt(std::max(0.0, value * sites) * sites);
        DoublePlane plane = reference::autocovariance_of_density(spectrum);
        for (std::size_t level = 0; level < k; ++level) plane = reference::expand(plane);
        const DoublePlane added = reference::periodogram(plane);
        for (std::size_t i = 0; i < sum.values.size(); ++i)
            sum.values[i] += added.values[i];
    }
    const double peak = *std::max_element(whole.values.begin(), whole.values.end());
    for (std::size_t i = 0; i < sum.values.size(); ++i)
        ASSERT_NEAR(sum.values[i], whole.values[i], 1e-5 * peak) << i;
}

TEST(PowerPreservingPyramid, OneLevelIsTheToroidalAutocovarianceOfThePeriodicPart) {
    SerialExecutor executor;
    const Image image = sample(18, 20);
    Image periodic(1, 18, 20);
    ASSERT_TRUE(periodic_part(image.plane(0), periodic.plane(0), executor, 0.125));
    DoublePlane centred = reference::to_double(periodic.plane(0));
    double mean = 0;
    for (const double value : centred.values) mean += value / 360;
    for (double& value : centred.values) value -= mean;
    const auto levels = power_preserving_pyramid(image.plane(0), 1, 4, executor);
    ASSERT_TRUE(levels);
    for (int row = -4; row <= 4; ++row) {
        for (int col = -4; col <= 4; ++col)
            EXPECT_NEAR((*levels)[0](row, col),
                        reference::autocovariance(centred, row, col), 2e-6);
    }
}

TEST(PowerPreservingPyramid, DoesNotDependOnTheExecutor) {
    SerialExecutor serial;
    test::ThreadedExecutor threads(3);
    const Image image = sample(48, 60);
    const auto expected = power_preserving_pyramid(image.plane(0), 3, 6, serial);
    const auto got = power_preserving_pyramid(image.plane(0), 3, 6, threads);
    ASSERT_TRUE(expected && got);
    for (std::size_t k = 0; k < 3; ++k) {
        for (int row = 0; row <= 6; ++row) {
            for (int col = -6; col <= 6; ++col)
                ASSERT_EQ((*got)[k](row, col), (*expected)[k](row, col));
        }
    }
}

TEST(PowerPreservingPyramid, RefusesSizesThatCannotBeHalved) {
    SerialExecutor executor;
    const auto odd = power_preserving_pyramid(sample(30, 32).plane(0), 3, 2, executor);
    ASSERT_FALSE(odd);
    EXPECT_EQ(odd.error().code, Errc::invalid_argument);
    EXPECT_EQ(odd.error().message, "a sample of 30 x 32 pixels cannot be halved 2 times");
    const auto prime = power_preserving_pyramid(sample(14, 16).plane(0), 1, 2, executor);
    ASSERT_FALSE(prime);
    EXPECT_EQ(prime.error().code, Errc::invalid_argument);
}

TEST(Autocovariance, IsEven) {
    Autocovariance R(2, 10);
    R.at(1, -2) = 3;
    EXPECT_EQ(R(1, -2), 3);
    EXPECT_EQ(R(-1, 2), 3);
    EXPECT_EQ(R(1, 2), 0);
}

TEST(Autocovariance, PoolsByTheNumberOfSites) {
    Autocovariance few(1, 100);
    few.at(0, 0) = 4;
    Autocovariance many(1, 300);
    many.at(0, 0) = 8;
    Autocovariance pooled;
    pooled.pool(few);
    EXPECT_EQ(pooled.variance(), 4);
    pooled.pool(many);
    EXPECT_EQ(pooled.variance(), 7);
    EXPECT_EQ(pooled.sites(), 400);
    EXPECT_EQ(pooled.reach(), 1);
}

}  // namespace
}  // namespace sateen
