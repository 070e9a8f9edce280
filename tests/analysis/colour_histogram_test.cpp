// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/colour_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "sateen/core/colour.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

using Feature = std::array<double, kColourFeatures>;

Image noise_image(std::size_t rows, std::size_t cols, std::uint64_t seed) {
    Image image(3, rows, cols);
    constexpr std::array<float, 3> kMean = {0.4F, 0.3F, 0.2F};
    for (std::size_t b = 0; b < 3; ++b) {
        for (std::size_t r = 0; r < rows; ++r) {
            float* row = image.plane(b).row(r);
            draw_normals({seed, static_cast<std::uint32_t>(b)},
                         static_cast<std::int32_t>(r), 0, {row, cols});
            for (std::size_t c = 0; c < cols; ++c) row[c] = kMean[b] + 0.05F * row[c];
        }
    }
    return image;
}

Image constant_image(std::size_t bands, float value) {
    Image image(bands, 9, 7);
    std::ranges::fill(image.values(), value);
    return image;
}

Feature feature_of(const ColourHistogram& histogram, const FeatureGrid& grid) {
    Feature feature;
    cumulative_feature(histogram, grid, feature);
    return feature;
}

double distance2(const Feature& f, const Feature& g) {
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) sum += (f[i] - g[i]) * (f[i] - g[i]);
    return sum;
}

// The sorted values of one channel, in double.
std::vector<double> channel(const Image& image, std::size_t c) {
    std::vector<double> values;
    for (std::size_t i = 0; i < image.plane_size(); ++i) {
        const auto at = [&](std::size_t b) {
            return static_cast<double>(image.values()[b * image.plane_size() + i]);
        };
        const Lab lab = lab_from_linear_srgb(at(0), at(1), at(2));
        values.push_back(c == 0 ? lab.L : c == 1 ? lab.a : lab.b);
    }
    std::ranges::sort(values);
    return values;
}

TEST(ColourHistogram, FeatureIsTheDistributionFunctionByDefinition) {
    const std::array<Image, 2> images = {noise_image(37, 41, 0), noise_image(50, 20, 1)};
    const std::array<ColourHistogram, 2> histograms = {
        colour_histogram(images[0].view()), colour_histogram(images[1].view())};
    const FeatureGrid grid = common_grid(histograms);
    for (std::size_t n = 0; n < 2; ++n) {
        const Feature feature = feature_of(histograms[n], grid);
        for (std::size_t c = 0; c < 3; ++c) {
            const std::vector<double> values = channel(images[n], c);
            for (std::size_t b = 0; b < kFeatureBins; ++b) {
                const double edge =
                    kLabBins[c].origin +
                    static_cast<double>(grid.first[c] + (b + 1) * grid.merge[c]) *
                        kLabBins[c].width;
                const auto below = std::ranges::lower_bound(values, edge);
                const double share = static_cast<double>(below - values.begin()) /
                                     static_cast<double>(values.size());
                // A pixel so close to an edge that float puts it on the other side.
                const double one = 1.01 / static_cast<double>(values.size());
                EXPECT_NEAR(feature[c * kFeatureBins + b] / std::sqrt(grid.width(c)),
                            share, one);
            }
        }
    }
}

TEST(ColourHistogram, GridCoversTheOccupiedRangeWithTheFinestBins) {
    const std::array<ColourHistogram, 1> histograms = {
        colour_histogram(noise_image(64, 64, 2).view())};
    const FeatureGrid grid = common_grid(histograms);
    const Feature feature = feature_of(histograms[0], grid);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t occupied = histograms[0].channels[c].counts.size();
        EXPECT_NEAR(feature[c * kFeatureBins + kFeatureBins - 1],
                    std::sqrt(grid.width(c)), 1e-12);
        if (c == 0) continue;
        EXPECT_GE(grid.merge[c] * kFeatureBins, occupied);
        EXPECT_LT((grid.merge[c] - 1) * kFeatureBins, occupied);
    }
}

// The Cramér distance of two point masses is the distance between them.
TEST(ColourHistogram, SquaredDistanceOfUniformImagesIsTheDifferenceOfLightness) {
    const float dark = 0.05F;
    for (const float light : {0.05F, 0.06F, 0.2F, 0.9F}) {
        const std::array<ColourHistogram, 2> histograms = {
            colour_histogram(constant_image(3, dark).view()),
            colour_histogram(constant_image(3, light).view())};
        const FeatureGrid grid = common_grid(histograms);
        const double d2 =
            distance2(feature_of(histograms[0], grid), feature_of(histograms[1], grid));
        const auto L = [](float v) {
            const auto value = static_cast<double>(v);
            return lab_from_linear_srgb(value, value, value).L;
        };
        EXPECT_NEAR(d2, L(light) - L(dark), kLabBins[0].width);
        EXPECT_NEAR(mean_lightness(histograms[1]), L(light), kLabBins[0].width / 2);
    }
}

TEST(ColourHistogram, SquaredDistanceIsTheCramerIntegralOfTheSamples) {
    // ∫ (F - G)² dx of two samples = E|X - Y| - E|X - X'| / 2 - E|Y - Y'| / 2.
    const std::array<Image, 2> images = {noise_image(30, 30, 3), noise_image(25, 31, 4)};
    const std::array<ColourHistogram, 2> histograms = {
        colour_histogram(images[0].view()), colour_histogram(images[1].view())};
    // Shift one so that the distance is far above that of two samples of one law.
    Image brighter = images[1];
    for (float& v : brighter.values()) v *= 1.5F;
    const std::array<ColourHistogram, 2> shifted = {histograms[0],
                                                    colour_histogram(brighter.view())};
    const FeatureGrid grid = common_grid(shifted);
    const auto mean_gap = [](const std::vector<double>& x, const std::vector<double>& y) {
        double sum = 0;
        for (const double u : x)
            for (const double v : y) sum += std::abs(u - v);
        return sum / static_cast<double>(x.size() * y.size());
    };
    double expected = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<double> x = channel(images[0], c);
        const std::vector<double> y = channel(brighter, c);
        expected += mean_gap(x, y) - mean_gap(x, x) / 2 - mean_gap(y, y) / 2;
    }
    const double d2 =
        distance2(feature_of(shifted[0], grid), feature_of(shifted[1], grid));
    EXPECT_NEAR(d2 / expected, 1.0, 0.01);
}

TEST(ColourHistogram, OfAGreyImageIsThatOfTheSameColourImage) {
    const Image colour = noise_image(20, 30, 5);
    Image grey(1, 20, 30);
    Image equal(3, 20, 30);
    for (std::size_t i = 0; i < grey.plane_size(); ++i) {
        grey.values()[i] = colour.values()[i];
        for (std::size_t b = 0; b < 3; ++b)
            equal.values()[b * grey.plane_size() + i] = colour.values()[i];
    }
    const std::array<ColourHistogram, 2> histograms = {colour_histogram(grey.view()),
                                                       colour_histogram(equal.view())};
    EXPECT_EQ(histograms[1].channels[1].counts.size(), 1U);
    EXPECT_EQ(histograms[1].channels[2].counts.size(), 1U);
    const FeatureGrid grid = common_grid(histograms);
    EXPECT_LT(distance2(feature_of(histograms[0], grid), feature_of(histograms[1], grid)),
              1e-4);
}

TEST(ColourHistogram, CountsEveryPixelWhateverItsValue) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float value :
         {-5.0F, 1e30F, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
        for (const std::size_t bands : {1U, 3U}) {
            Image image = constant_image(bands, 0.5F);
            image(0, 4, 4) = value;
            const ColourHistogram histogram = colour_histogram(image.view());
            EXPECT_EQ(histogram.pixels, image.plane_size());
            for (const ChannelHistogram& c : histogram.channels) {
                std::uint64_t sum = 0;
                for (const std::uint32_t n : c.counts) sum += n;
                EXPECT_EQ(sum, image.plane_size());
            }
        }
    }
}

TEST(ColourHistogram, HandsOutLightness) {
    const Image image = noise_image(33, 47, 6);
    Image lightness(1, 33, 47);
    (void)colour_histogram(image.view(), lightness.plane(0));
    std::vector<double> expected = channel(image, 0);
    std::vector<float> found(lightness.values().begin(), lightness.values().end());
    std::ranges::sort(found);
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_NEAR(found[i], expected[i], 1e-3);
}

}  // namespace
}  // namespace sateen
