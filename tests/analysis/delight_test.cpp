// SPDX-License-Identifier: Apache-2.0
// Shading is divided out of images, and nothing else is.
#include "sateen/analysis/delight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "sateen/analysis/analyse.hpp"
#include "support/relief.hpp"
#include "support/synthetic_measurement.hpp"

namespace sateen {
namespace {

RangeMap range_of(const test::Relief& relief) {
    RangeMap range;
    range.height_px = Image(1, relief.height.rows(), relief.height.cols());
    std::copy(relief.height.values().begin(), relief.height.values().end(),
              range.height_px.values().begin());
    range.normals = relief.normals;
    return range;
}

double mean_of(const Image& image, std::size_t band = 0) {
    double sum = 0;
    for (std::size_t i = 0; i < image.plane_size(); ++i)
        sum += static_cast<double>(image.plane(band).data[i]);
    return sum / static_cast<double>(image.plane_size());
}

/// What a ray of slope (dx, dy), y up, meets of a height given as a function: small steps.
template <class F>
std::array<double, 2> met(const F& height, double x, double y, double dx, double dy,
                          double highest) {
    double z = highest;
    while (height(x + z * dx, y + z * dy) < z && z > -highest) z -= 1e-3;
    return {x + z * dx, y + z * dy};
}

TEST(Delight, LeavesTheAlbedo) {
    const test::Relief relief = test::cosine_relief(64, 64, 6, 1.0, 3);
    const Image albedo = test::mottled_albedo(3, 64, 64, 5);
    const RangeMap range = range_of(relief);
    for (const auto& [theta, phi] : {std::pair{30.0F, 0.0F}, {60.0F, 130.0F}}) {
        const Direction light = direction_from_degrees(theta, phi);
        const Image lit = test::picture(relief.normals, albedo, light);
        const Image shading = shading_seen(range, {}, light);
        EXPECT_NEAR(mean_of(shading), 1, 1e-5);
        const Image left = divide_by_shading(lit, shading);
        EXPECT_GT(test::correlation(left, albedo), 0.985) << theta;
        EXPECT_GT(test::correlation(left, albedo), test::correlation(lit, albedo));
        for (std::size_t band = 0; band < 3; ++band)
            EXPECT_NEAR(mean_of(left, band), mean_of(lit, band), 1e-4);
    }
}

TEST(Delight, ShadowsDoNotExplode) {
    // Half of the image is black, and shows a tenth of noise all the same.
    Image image(1, 8, 8);
    Image shading(1, 8, 8);
    for (std::size_t i = 0; i < 64; ++i) {
        shading.values()[i] = i < 32 ? 0.0F : 2.0F;
        image.values()[i] = i < 32 ? (i % 2 == 0 ? 0.1F : 0.0F) : 1.0F;
    }
    const double mean = mean_of(image);
    const Image left = divide_by_shading(image, shading);
    // Nothing is known of the black half but the mean: it is flat.
    for (std::size_t i = 1; i < 32; ++i)
        EXPECT_FLOAT_EQ(left.values()[i], left.values()[0]);
    EXPECT_NEAR(mean_of(left), mean, 1e-6);
    EXPECT_LT(*std::max_element(left.values().begin(), left.values().end()), 2 * mean);
    // Where nothing is lit at all, the image is left as it is.
    const Image dark = shading_seen(range_of(test::cosine_relief(16, 16, 2, 0.1, 1)), {},
                                    direction_from_degrees(180, 0));
    for (const float s : dark.values()) EXPECT_EQ(s, 1);
}

TEST(Delight, FollowsTheRaysOfSight) {
    // Ribs of 3 pixels height along y; the ray of every pixel is followed in small steps.
    constexpr std::size_t kSide = 60;
    const double omega = 2 * 3.14159265358979 / 20;
    test::Relief relief{
        BasicImage<double>(1, kSide, kSide), SlopeField(2, kSide, kSide), {}};
    const auto height = [&](double x, double) { return 1.5 * std::cos(omega * x); };
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c) {
            relief.height(0, r, c) = height(static_cast<double>(c), 0);
            relief.slopes(0, r, c) =
                -1.5 * omega * std::sin(omega * static_cast<double>(c));
        }
    relief.normals = test::normals_of_slopes(relief.slopes);
    const RangeMap range = range_of(relief);
    const Direction view = direction_from_degrees(60, 180);
    const Direction light = direction_from_degrees(45, 0);
    const Image shading = shading_seen(range, view, light);
    const auto v = to_vector(view);
    const auto l = to_vector(light);
    const double slope = static_cast<double>(v[0] / v[2]);
    Image expected(1, kSide, kSide);
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c) {
            const double x = met(height, static_cast<double>(c), 0, slope, 0, 1.5)[0];
            const double p = -1.5 * omega * std::sin(omega * x);
            expected(0, r, c) = static_cast<float>(std::max(
                0.0, (-p * static_cast<double>(l[0]) + static_cast<double>(l[2])) /
                         std::sqrt(1 + p * p)));
        }
    // The outermost pixels see past the border.
    double worst = 0;
    const double scale = 1 / mean_of(expected);
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 8; c + 8 < kSide; ++c)
            worst =
                std::max(worst, std::abs(static_cast<double>(shading(0, r, c)) -
                                         scale * static_cast<double>(expected(0, r, c))));
    EXPECT_LT(worst, 0.12);
    EXPECT_GT(test::correlation(shading, expected), 0.98);
    EXPECT_LT(test::correlation(shading_seen(range, {}, light), expected), 0.94);
}

TEST(Delight, LightFromElsewhereIsSeenWhereTheLampIsNot) {
    const test::Relief relief = test::cosine_relief(64, 64, 6, 1.2, 3);
    const Direction light = direction_from_degrees(65, 40);
    const Image shading = shading_seen(range_of(relief), {}, light);
    const Image albedo = test::mottled_albedo(3, 64, 64, 5);
    const auto found = [&](float ambient) {
        Image lit = albedo;
        const Image all = with_ambient(shading, ambient);
        for (std::size_t band = 0; band < 3; ++band)
            for (std::size_t i = 0; i < lit.plane_size(); ++i)
                lit.plane(band).data[i] *= all.values()[i];
        ExplainedContrast contrast;
        contrast.add(lit, shading, 2);
        EXPECT_GT(contrast.dark, 0.1);
        return contrast.ambient();
    };
    // Mottles of the albedo, over a few hundred dark pixels.
    for (const float ambient : {0.0F, 0.1F, 0.4F, 1.0F})
        EXPECT_NEAR(found(ambient), ambient, 0.02F + 0.1F * ambient);
    EXPECT_EQ(ExplainedContrast().ambient(), 0);
    // Mean 1 stays mean 1.
    EXPECT_NEAR(mean_of(with_ambient(shading, 3)), 1, 1e-5);
}

TEST(Delight, TellsShadingFromPrint) {
    const test::Relief relief = test::cosine_relief(64, 64, 6, 0.5, 3);
    const Direction light = direction_from_degrees(45, 70);
    const Image shading = shading_seen(range_of(relief), {}, light);
    Image white(1, 64, 64);
    std::fill(white.values().begin(), white.values().end(), 0.5F);
    ExplainedContrast shape;
    shape.add(test::picture(relief.normals, white, light), shading, 3);
    EXPECT_GT(shape.share(), 0.999);
    ExplainedContrast print;
    print.add(test::mottled_albedo(1, 64, 64, 9), shading, 1);
    EXPECT_LT(print.share(), 0.02);
    EXPECT_EQ(ExplainedContrast().share(), 0);
}

class LitMaterial : public ::testing::Test {
  protected:
    Analysis analysis_of(const test::SyntheticMeasurement& measurement,
                         AnalysisOptions options = {}) {
        SerialExecutor executor;
        Progress progress;
        auto range = estimate_range_map(measurement, {}, executor, progress);
        EXPECT_TRUE(range) << range.error().message;
        auto analysis = analyse(measurement, options, executor, progress, &**range);
        EXPECT_TRUE(analysis) << analysis.error().message;
        return std::move(*analysis);
    }
    const std::vector<Direction> lights_ = test::ring_lights();
};

TEST_F(LitMaterial, IsModelledWithoutItsShading) {
    const test::Relief relief = test::cosine_relief(64, 64, 5, 0.8, 2);
    const Image albedo = test::mottled_albedo(3, 64, 64, 5);
    AnalysisOptions options;
    options.subspaces = 2;
    options.structure = false;
    const auto measurement = test::measurement_of(relief, albedo, lights_);
    const Analysis analysis = analysis_of(measurement, options);
    ASSERT_TRUE(analysis.material.surface);
    EXPECT_TRUE(analysis.material.surface->delit);
    EXPECT_GT(analysis.shading_share, 0.3);
    // [CAR2] multiplies by the relit range map without dividing by it.
    options.paper = true;
    const Analysis paper = analysis_of(measurement, options);
    EXPECT_TRUE(paper.material.surface->delit);
    EXPECT_NE(paper.material.subspaces[0].spectral.mean,
              analysis.material.subspaces[0].spectral.mean);
}

TEST_F(LitMaterial, OfPrintIsModelledAsItLooks) {
    const test::Relief flat = test::cosine_relief(64, 64, 5, 0.02, 2);
    AnalysisOptions options;
    options.subspaces = 2;
    options.structure = false;
    const Analysis analysis = analysis_of(
        test::measurement_of(flat, test::mottled_albedo(3, 64, 64, 5), lights_), options);
    ASSERT_TRUE(analysis.material.surface);
    EXPECT_FALSE(analysis.material.surface->delit);
    EXPECT_LT(analysis.shading_share, 0.05);
}

}  // namespace
}  // namespace sateen
