// SPDX-License-Identifier: Apache-2.0
#include "analysis/quality_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analysis/quality_pyramid.hpp"
#include "reference/quality.hpp"
#include "support/degradations.hpp"
#include "support/textures.hpp"

namespace sateen::quality {
namespace {

using test::discs;

Features colour_of(const Image& planes) {
    Features features;
    add_colour(planes.view(), 0, 0, planes.rows(), planes.cols(), features);
    return features;
}

double weighted_square(const Features& a, const Features& b) {
    double sum = 0;
    for (const Group& group : a.groups()) {
        double square = 0;
        for (std::size_t i = group.first; i < group.first + group.count; ++i) {
            const double d =
                static_cast<double>(a.values()[i]) - static_cast<double>(b.values()[i]);
            square += d * d;
        }
        sum += group.weight * square / static_cast<double>(group.count);
    }
    return sum;
}

TEST(QualityParts, KlPlanesAreUncorrelatedAndKeepDeltaE) {
    const Image image = discs(128, 128, 1);
    const ColourBasis basis = estimate_basis(image);
    const Image planes = to_planes(image, basis);
    const auto n = static_cast<double>(planes.plane_size());
    for (std::size_t p = 0; p < kPlanes; ++p) {
        for (std::size_t q = p; q < kPlanes; ++q) {
            double product = 0;
            for (std::size_t i = 0; i < planes.plane_size(); ++i) {
                product += static_cast<double>(planes.plane(p).data[i]) *
                           static_cast<double>(planes.plane(q).data[i]);
            }
            const double expected = p == q ? basis.deviation[p] * basis.deviation[p] : 0;
            EXPECT_NEAR(product / n, expected, 1e-3);
        }
    }
    const Lab a = lab_from_linear_srgb(static_cast<double>(image(0, 3, 4)),
                                       static_cast<double>(image(1, 3, 4)),
                                       static_cast<double>(image(2, 3, 4)));
    const Lab b = lab_from_linear_srgb(static_cast<double>(image(0, 70, 9)),
                                       static_cast<double>(image(1, 70, 9)),
                                       static_cast<double>(image(2, 70, 9)));
    double square = 0;
    for (std::size_t p = 0; p < kPlanes; ++p) {
        square += std::pow(
            static_cast<double>(planes(p, 3, 4)) - static_cast<double>(planes(p, 70, 9)),
            2);
    }
    EXPECT_NEAR(std::sqrt(square), delta_e_76(a, b), 0.01);
}

// Against sorted samples, one plane at a time being varied: the mean of squared direction
// cosines with any axis is 1/3, up to the 16 directions' unevenness.
TEST(QualityParts, ColourIsTheSlicedWassersteinDistance) {
    Image a(3, 64, 64);
    Image b(3, 64, 64);
    const Image x = test::grey_noise(64, 64, 0, 1, 1);
    const Image y = test::grey_noise(64, 64, 0, 1, 2);
    std::vector<double> left;
    std::vector<double> right;
    for (std::size_t i = 0; i < a.plane_size(); ++i) {
        const auto normal = [i](const Image& image) {
            return 116 * std::cbrt(static_cast<double>(image.values()[i])) - 16;
        };
        left.push_back(12 * normal(x));
        right.push_back(5 * std::abs(normal(y)));
        a.values()[i] = static_cast<float>(left.back());
        b.values()[i] = static_cast<float>(right.back());
    }
    const double w2 = reference::wasserstein_2(left, right);
    double mean_a = 0;
    double mean_b = 0;
    for (double v : left) mean_a += v / static_cast<double>(left.size());
    for (double v : right) mean_b += v / static_cast<double>(right.size());
    const double shift_sq = (mean_a - mean_b) * (mean_a - mean_b);
    // The mean counts once for one of three planes, the shape for all directions.
    const double expected = 0.5 / 3 * shift_sq + 0.5 * (w2 * w2 - shift_sq);
    const double found = weighted_square(colour_of(a), colour_of(b));
    EXPECT_NEAR(std::sqrt(found), std::sqrt(expected), 0.03 * std::sqrt(expected));
}

TEST(QualityParts, PowerOfWhiteNoiseIsItsVarianceInEveryCell) {
    const std::size_t rows = 120;
    const std::size_t cols = 96;
    Image noise(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        draw_normals({7, 0}, static_cast<std::int32_t>(r), 0,
                     {noise.plane(0).row(r), cols});
    }
    auto fft = Fft2d::create(rows, cols);
    ASSERT_TRUE(fft.has_value());
    const SpectrumGrid grid(rows, cols);
    Features features;
    add_power(tapered_spectrum(noise.plane(0), grid, *fft), grid, 1, features);
    const double expected = 0.5 * std::log(1 + kInvisible * kInvisible);
    for (std::size_t i = 0; i < features.values().size(); ++i) {
        // Half the relative deviation of a mean of so many exponentials, correlated by
        // the taper over about two bins; 4.5 deviations, one test in 10^5.
        const double deviation = 0.5 * std::sqrt(2 / std::max(1.0, grid.bins[i]));
        if (grid.bins[i] >= 8) {
            EXPECT_NEAR(static_cast<double>(features.values()[i]), expected,
                        4.5 * deviation);
        }
    }
}

TEST(QualityParts, AutocovarianceIsTheCircularProductOfTheTaperedPlane) {
    const Image lightness = to_lightness(discs(64, 72, 1), 1);
    auto fft = Fft2d::create(64, 72);
    ASSERT_TRUE(fft.has_value());
    const SpectrumGrid grid(64, 72);
    SplitComplexPlane spectrum = tapered_spectrum(lightness.plane(0), grid, *fft);
    Features features;
    add_autocovariance(spectrum, grid, *fft, 1, features);

    Image tapered(1, 64, 72);
    SerialExecutor serial;
    fft->inverse(spectrum.view(), tapered.plane(0), serial);
    const double variance = reference::circular_product(tapered.plane(0), 0, 0) /
                                (grid.down.energy * grid.across.energy) +
                            kInvisible * kInvisible;
    // The first annulus holds the lags shorter than 2: (0, 1), (1, -1), (1, 0), (1, 1).
    ASSERT_EQ(features.groups().front().count, 4U);
    const std::vector<std::pair<std::size_t, std::size_t>> lags = {
        {0, 1}, {1, 71}, {1, 0}, {1, 1}};
    for (std::size_t i = 0; i < lags.size(); ++i) {
        const auto [dr, dc] = lags[i];
        const double expected =
            reference::circular_product(tapered.plane(0), dr, dc) /
            (grid.down.overlap(dr) * grid.across.overlap(dc) * variance);
        EXPECT_NEAR(static_cast<double>(features.values()[i]), expected, 1e-4);
    }
}

// Energy of the bands, each at the density of its own level, is the energy of the plane:
// the filters tile the frequencies, so nothing is lost or counted twice.
TEST(SteerablePyramid, KeepsTheEnergyOfThePlane) {
    for (std::size_t levels : {1U, 2U, 3U}) {
        const std::size_t rows = 96;
        const std::size_t cols = 144;
        Image noise(1, rows, cols);
        for (std::size_t r = 0; r < rows; ++r) {
            draw_normals({3, 0}, static_cast<std::int32_t>(r), 0,
                         {noise.plane(0).row(r), cols});
        }
        auto pyramid = SteerablePyramid::create(rows, cols, levels);
        ASSERT_TRUE(pyramid.has_value());
        SplitComplexPlane spectrum(rows, cols / 2 + 1);
        SerialExecutor serial;
        pyramid->fft().forward(noise.plane(0), spectrum.view(), serial);
        const SteerableBands bands = pyramid->decompose(spectrum);

        const auto energy = [](const Image& image) {
            double sum = 0;
            for (float v : image.values())
                sum += static_cast<double>(v) * static_cast<double>(v);
            return sum;
        };
        double sum = energy(bands.high);
        double odd = energy(bands.high);
        double density = 1;
        for (const PyramidLevel& level : bands.levels) {
            sum += density * energy(level.re);
            odd += density * energy(level.im);
            density *= 4;
        }
        sum += density * energy(bands.low);
        odd += density * energy(bands.low);
        EXPECT_NEAR(sum / energy(noise), 1, 1e-4);
        EXPECT_NEAR(odd / energy(noise), 1, 1e-4);
    }
}

// A grating's magnitude is the same everywhere, and largest where its direction is.
TEST(SteerablePyramid, TheMagnitudeOfAGratingIsFlat) {
    const std::size_t side = 128;
    Image grating(1, side, side);
    for (std::size_t r = 0; r < side; ++r) {
        for (std::size_t c = 0; c < side; ++c) {
            grating(0, r, c) = static_cast<float>(
                std::cos(2 * std::numbers::pi * 40 * static_cast<double>(c) /
                         static_cast<double>(side)));
        }
    }
    auto pyramid = SteerablePyramid::create(side, side, 2);
    ASSERT_TRUE(pyramid.has_value());
    SplitComplexPlane spectrum(side, side / 2 + 1);
    SerialExecutor serial;
    pyramid->fft().forward(grating.plane(0), spectrum.view(), serial);
    const Image magnitude = pyramid->decompose(spectrum).levels.front().magnitude;
    const float first = magnitude(0, 0, 0);
    for (std::size_t i = 0; i < magnitude.plane_size(); ++i) {
        EXPECT_NEAR(magnitude.plane(0).data[i], first, 1e-4F * first);
        EXPECT_LT(magnitude.plane(2).data[i], 1e-3F * first);
    }
}

}  // namespace
}  // namespace sateen::quality
