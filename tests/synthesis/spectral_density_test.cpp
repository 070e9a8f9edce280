// SPDX-License-Identifier: Apache-2.0
#include "synthesis/spectral_density.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "reference/stationary_field.hpp"
#include "support/materials.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using reference::DoublePlane;

struct Size {
    std::size_t rows, cols;
};
constexpr Size kSizes[] = {Size{32, 48}, Size{15, 27}, Size{24, 21},
                           Size{7, 64},  Size{1, 1},   Size{1, 17},
                           Size{36, 1},  Size{2, 2},   Size{50, 99}};

std::vector<Car2d> fields() {
    return {test::half_plane_field(),
            test::quarter_plane_field(),
            {{{2, -3}, {1, 4}, {0, 8}, {8, -8}}, {0.3F, -0.2F, 0.1F, 0.15F}, 0.7F},
            {{}, {}, 2}};
}

PlaneField plane_field(const std::vector<Level>& levels, double sample = 64) {
    return {levels, 0, sample, sample};
}

TEST(SpectralDensity, OfOneLevelEqualsItsDefinition) {
    SerialExecutor executor;
    for (const Car2d& field : fields()) {
        const auto levels = test::levels_of({field});
        for (const Size& size : kSizes) {
            const Image S =
                spectral_density(plane_field(levels), size.rows, size.cols, executor);
            ASSERT_EQ(S.rows(), size.rows);
            ASSERT_EQ(S.cols(), size.cols / 2 + 1);
            for (std::size_t m = 0; m < S.rows(); ++m) {
                for (std::size_t n = 0; n < S.cols(); ++n) {
                    const double expected =
                        reference::density(field, reference::frequency(m, size.rows),
                                           reference::frequency(n, size.cols));
                    ASSERT_NEAR(static_cast<double>(S(0, m, n)), expected,
                                2e-5 * expected)
                        << size.rows << 'x' << size.cols << " at " << m << ',' << n;
                }
            }
        }
    }
}

TEST(SpectralDensity, OfAPyramidEqualsTheRecursionAtAnySize) {
    SerialExecutor executor;
    const std::vector<Car2d> levels = fields();
    const auto stored = test::levels_of(levels);
    for (const Size& size : kSizes) {
        const Image E =
            spectral_density(plane_field(stored), size.rows, size.cols, executor);
        for (std::size_t m = 0; m < E.rows(); ++m) {
            for (std::size_t n = 0; n < E.cols(); ++n) {
                const double expected = reference::density(
                    std::span<const Car2d>(levels), reference::frequency(m, size.rows),
                    reference::frequency(n, size.cols));
                ASSERT_NEAR(static_cast<double>(E(0, m, n)), expected, 5e-5 * expected)
                    << size.rows << 'x' << size.cols << " at " << m << ',' << n;
            }
        }
    }
}

// A plane whose periodogram is the density of a level, expanded by the pyramid itself, has
// the periodogram that the level adds when levels are independent.
TEST(SpectralDensity, OfAPyramidIsThatOfItsExpandedLevels) {
    SerialExecutor executor;
    const std::vector<Car2d> levels = {fields()[0], fields()[1], fields()[2]};
    const auto stored = test::levels_of(levels);
    const std::size_t rows = 24;
    const std::size_t cols = 32;
    DoublePlane sum(rows, cols);
    for (std::size_t k = 0; k < levels.size(); ++k) {
        DoublePlane root = reference::density_on_torus(levels[k], rows >> k, cols >> k);
        const auto sites = static_cast<double>(root.values.size());
        for (double& value : root.values) value = std::sqrt(value * sites);
        DoublePlane plane = reference::autocovariance_of_density(root);
        for (std::size_t level = 0; level < k; ++level) plane = reference::expand(plane);
        const DoublePlane added = reference::periodogram(plane);
        for (std::size_t i = 0; i < sum.values.size(); ++i)
            sum.values[i] += added.values[i];
    }
    const Image E = spectral_density(plane_field(stored), rows, cols, executor);
    for (std::size_t m = 0; m < rows; ++m) {
        for (std::size_t n = 0; n <= cols / 2; ++n)
            ASSERT_NEAR(static_cast<double>(E(0, m, n)), sum(m, n), 5e-5 * sum(m, n));
    }
}

TEST(SpectralDensity, StaysFiniteOnAPole) {
    SerialExecutor executor;
    const auto levels = test::levels_of({{{{0, 1}}, {1}, 1}});
    const Image S = spectral_density(plane_field(levels), 8, 8, executor);
    for (const float value : S.values()) EXPECT_TRUE(std::isfinite(value));
    EXPECT_GT(S(0, 0, 0), 1e6F);
}

TEST(SpectralDensity, OfAConstantPlaneIsZero) {
    SerialExecutor executor;
    const auto levels = test::levels_of({Car2d{}, Car2d{}});
    const Image S = spectral_density(plane_field(levels), 6, 10, executor);
    for (const float value : S.values()) EXPECT_EQ(value, 0);
}

TEST(SpectralDensity, DoesNotDependOnTheExecutor) {
    SerialExecutor serial;
    test::ThreadedExecutor threads(3);
    const auto levels = test::levels_of(fields());
    const Image a = spectral_density(plane_field(levels), 60, 45, serial);
    const Image b = spectral_density(plane_field(levels), 60, 45, threads);
    for (std::size_t i = 0; i < a.values().size(); ++i)
        ASSERT_EQ(a.values()[i], b.values()[i]);
}

TEST(MeanDensity, IsTheMeanOverTheWholeTorus) {
    SerialExecutor executor;
    const std::vector<Car2d> pyramid = fields();
    const auto levels = test::levels_of(pyramid);
    for (const Size& size : kSizes) {
        const Image E =
            spectral_density(plane_field(levels), size.rows, size.cols, executor);
        const DoublePlane whole = reference::density_on_torus(
            std::span<const Car2d>(pyramid), size.rows, size.cols);
        double mean = 0;
        for (const double value : whole.values)
            mean += value / static_cast<double>(whole.values.size());
        EXPECT_NEAR(mean_density(E.plane(0), size.cols), mean, 5e-5 * mean);
    }
}

TEST(SuppressUnmeasured, LeavesTheFrequenciesOfTheSampleAlone) {
    for (const Size& size : {Size{64, 64}, Size{40, 50}}) {
        Image E(1, size.rows, size.cols / 2 + 1);
        for (float& value : E.values()) value = 1;
        const std::vector<Level> none;
        suppress_unmeasured(plane_field(none, 64), E.plane(0), size.cols);
        EXPECT_EQ(E(0, 0, 0), 0);
        for (std::size_t i = 1; i < E.values().size(); ++i)
            ASSERT_EQ(E.values()[i], 1) << i;
    }
}

TEST(SuppressUnmeasured, TakesWavesLongerThanTheSample) {
    // 4 samples long each way: frequency k is k / 4 waves a sample.
    const std::vector<Level> none;
    Image E(1, 256, 129);
    for (float& value : E.values()) value = 1;
    suppress_unmeasured(plane_field(none, 64), E.plane(0), 256);
    for (std::size_t m = 0; m < 256; ++m) {
        for (std::size_t n = 0; n < 129; ++n) {
            const double row =
                std::max(0.0, 1 - static_cast<double>(std::min(m, 256 - m)) / 4);
            const double col = std::max(0.0, 1 - static_cast<double>(n) / 4);
            ASSERT_NEAR(static_cast<double>(E(0, m, n)), 1 - row * col, 1e-6);
        }
    }
}

}  // namespace
}  // namespace sateen
