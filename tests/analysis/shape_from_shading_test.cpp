// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/shape_from_shading.hpp"

#include <gtest/gtest.h>

#include "support/relief.hpp"

namespace sateen {
namespace {

using test::cosine_relief;

ShadingEstimate estimate(const Image& image, const ShadingOptions& options) {
    SerialExecutor executor;
    Progress progress;
    auto result = shape_from_shading(image, options, executor, progress);
    EXPECT_TRUE(result) << result.error().message;
    return *std::move(result);
}

Image plain(std::size_t bands, std::size_t rows, std::size_t cols) {
    Image out(bands, rows, cols);
    for (float& v : out.values()) v = 0.6F;
    return out;
}

TEST(ShapeFromShading, AGentleReliefIsFoundFromElevationsOf30To60Degrees) {
    for (const float theta : {30.0F, 45.0F, 60.0F})
        for (const unsigned seed : {1U, 2U}) {
            const auto relief = cosine_relief(96, 120, 8, 3, seed, 300);
            const Direction light = direction_from_degrees(theta, 40);
            const Image image = test::picture(relief.normals, plain(3, 96, 120), light);
            const ShadingEstimate found = estimate(image, {.light = light});
            EXPECT_GT(test::correlation(found.height_px, relief.height), 0.9)
                << theta << " " << seed;
            EXPECT_LT(found.residual, 0.15) << theta << " " << seed;
            EXPECT_NEAR(found.albedo, 0.6, 0.03);
            EXPECT_FALSE(found.light_estimated);
        }
}

TEST(ShapeFromShading, TheAzimuthOfTheLightIsEstimatedAndReported) {
    const auto relief = cosine_relief(128, 128, 12, 2, 3, 500);
    for (const float phi : {30.0F, 90.0F, 130.0F}) {
        const Direction light = direction_from_degrees(45, phi);
        const Image image = test::picture(relief.normals, plain(1, 128, 128), light);
        const ShadingEstimate found = estimate(image, {.iterations = 5});
        EXPECT_TRUE(found.light_estimated);
        EXPECT_NEAR(found.light.phi / kRadiansPerDegree, phi, 15);
        EXPECT_NEAR(found.light.theta / kRadiansPerDegree, 45, 1e-3);
    }
}

TEST(ShapeFromShading, APlateIsFlat) {
    const ShadingEstimate found =
        estimate(plain(1, 32, 32), {.light = direction_from_degrees(45, 10)});
    for (const double z : found.height_px.values()) EXPECT_NEAR(z, 0, 1e-4);
    EXPECT_NEAR(found.albedo, 0.6 / std::sqrt(0.5), 1e-5);
}

TEST(ShapeFromShading, RefusesWhatShowsNoShape) {
    SerialExecutor executor;
    Progress progress;
    const auto refused = [&](const Image& image, const ShadingOptions& options) {
        const auto result = shape_from_shading(image, options, executor, progress);
        return !result && result.error().code == Errc::invalid_argument;
    };
    EXPECT_TRUE(refused(plain(1, 15, 40), {}));
    EXPECT_TRUE(refused(plain(1, 40, 40), {.light = direction_from_degrees(0, 0)}));
    EXPECT_TRUE(refused(plain(1, 40, 40), {.light = direction_from_degrees(89, 0)}));
    EXPECT_TRUE(refused(Image(3, 40, 40), {}));
}

}  // namespace
}  // namespace sateen
