// SPDX-License-Identifier: Apache-2.0
#include "sateen/goniometer/goniometer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "goniometer/surfaces.hpp"
#include "sateen/goniometer/directions.hpp"
#include "sateen/goniometer/preset.hpp"
#include "sateen/io/executor.hpp"

namespace sateen {
namespace {

using test::grey_surface;
using test::image_of;
using test::lambertian;

Direction degrees(float theta, float phi) {
    return direction_from_degrees(theta, phi);
}

TEST(Goniometer, AFlatLambertianPlateIsAlbedoTimesCosineForAllViewsAndLights) {
    const SurfaceMaps plate = grey_surface(8, 4, 0.6F, [](float, float) { return 3.0F; });
    GoniometerOptions options = lambertian(4);
    options.gather_rays = 16;
    SerialExecutor executor;
    const std::vector<Direction> directions = ubo2003_directions();
    auto goniometer = Goniometer::create(plate, directions, options, executor);
    ASSERT_TRUE(goniometer);
    std::vector<std::size_t> all(directions.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    for (const Direction& view : directions) {
        const auto check = [&](std::size_t light, const Image& image) -> Result<void> {
            const float expected = 0.6F * std::cos(directions[light].theta);
            for (const float v : image.values()) EXPECT_NEAR(v, expected, 1e-6F);
            return {};
        };
        ASSERT_TRUE(goniometer->measure(view, all, check, executor, Progress()));
    }
}

// A sinusoid along x too gentle for shadows: n·l at the point that a view sees.
TEST(Goniometer, ASinusoidWithoutShadowHasTheValuesOfItsClosedForm) {
    constexpr std::size_t kSide = 64;
    constexpr float kWave = 2 * std::numbers::pi_v<float> / 32;
    constexpr float kAmplitude = 1.5F;
    const SurfaceMaps surface = grey_surface(8 * kSide, kSide, 0.8F, [](float x, float) {
        return kAmplitude * std::sin(kWave * x);
    });
    GoniometerOptions options = lambertian(kSide);
    options.samples = 1;
    for (const Direction view : {degrees(0, 0), degrees(45, 0), degrees(60, 200)})
        for (const Direction light : {degrees(0, 0), degrees(30, 90), degrees(60, 30)}) {
            const Image image = image_of(surface, options, view, light);
            const auto l = to_vector(light);
            const float shear = std::tan(view.theta) * std::cos(view.phi);
            for (std::size_t c = 0; c < kSide; ++c) {
                // The ray through (x0, 0) meets the surface where x = x0 + z shear.
                const float x0 = static_cast<float>(c) + 0.5F;
                float x = x0;
                for (int i = 0; i < 100; ++i)
                    x = x0 + shear * kAmplitude * std::sin(kWave * x);
                const float slope = kAmplitude * kWave * std::cos(kWave * x);
                const float expected =
                    0.8F * (l[2] - slope * l[0]) / std::sqrt(1 + slope * slope);
                EXPECT_NEAR(image(0, 5, c), expected, 2e-3F) << c;
            }
        }
}

TEST(Goniometer, AStepAtGrazingLightShadesTheRightPixels) {
    constexpr std::size_t kSide = 64;
    constexpr float kHeight = 4;
    // A wall at x from 6 to 10; the light stands beyond it, so its shadow falls to the
    // left and comes in again on the right, for the surface is a torus.
    const SurfaceMaps surface = grey_surface(8 * kSide, kSide, 1, [](float x, float) {
        return x > 6 && x < 10 ? kHeight : 0;
    });
    const float theta = 75;
    const float length = kHeight * std::tan(theta * kRadiansPerDegree);
    const Image image =
        image_of(surface, lambertian(kSide), degrees(0, 0), degrees(theta, 0));
    const float lit = std::cos(theta * kRadiansPerDegree);
    for (std::size_t c = 0; c < kSide; ++c) {
        // Distance to the left of the wall, modulo the torus.
        const float left = std::fmod(6 - (static_cast<float>(c) + 0.5F) + 64.0F, 64.0F);
        if (left > 1 && left < length - 1) {
            EXPECT_EQ(image(0, 9, c), 0) << c;
        }
        if (left > length + 1 && left < kSide - 6) {
            EXPECT_NEAR(image(0, 9, c), lit, 1e-5F) << c;
        }
    }
    GoniometerOptions unshaded = lambertian(kSide);
    unshaded.shadows = false;
    const Image without = image_of(surface, unshaded, degrees(0, 0), degrees(theta, 0));
    EXPECT_NEAR(without(0, 9, 1), lit, 1e-5F);
}

TEST(Goniometer, RowZeroIsOnTopAndPhiTurnsFromXToY) {
    // A ramp that rises towards the top faces downwards (minus y): lit from phi 270.
    const SurfaceMaps ridge = grey_surface(64, 64, 1, [](float, float y) {
        return 4 * std::sin(2 * std::numbers::pi_v<float> * y / 64);
    });
    const Image from_below =
        image_of(ridge, lambertian(64), degrees(0, 0), degrees(40, 270));
    // y = -2 lies on the rising slope, row 32 (y = -32) on the falling one.
    EXPECT_GT(from_below(0, 2, 10), from_below(0, 32, 10) + 0.2F);
}

TEST(Goniometer, ImagesAreTheSameForAnyNumberOfThreads) {
    const auto surface = make_preset("leather", 48, 3);
    ASSERT_TRUE(surface);
    SurfaceMaps scaled = *surface;
    for (float& z : scaled.height.values()) z *= 24;
    GoniometerOptions options;
    options.rows = options.cols = 24;
    const std::vector<Direction> lights = {degrees(0, 0), degrees(60, 45),
                                           degrees(75, 180)};
    const std::vector<std::size_t> all = {0, 1, 2};
    std::map<std::size_t, std::vector<float>> first;
    for (const std::size_t threads : {1U, 2U, 5U}) {
        const auto executor = make_executor(threads);
        auto goniometer = Goniometer::create(scaled, lights, options, *executor);
        ASSERT_TRUE(goniometer);
        std::vector<Image> images(3);
        ASSERT_TRUE(goniometer->measure(
            degrees(45, 100), all,
            [&](std::size_t light, const Image& image) -> Result<void> {
                images[light] = image;
                return {};
            },
            *executor, Progress()));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::vector<float> values(images[k].values().begin(),
                                            images[k].values().end());
            if (threads == 1) first[k] = values;
            EXPECT_EQ(values, first[k]);
        }
    }
}

TEST(Goniometer, TheTruthHasMeanHeightZeroAndUnitNormals) {
    const SurfaceMaps surface = grey_surface(64, 32, 0.3F, [](float x, float) {
        return 7 + std::sin(2 * std::numbers::pi_v<float> * x / 16);
    });
    SerialExecutor executor;
    auto goniometer = Goniometer::create(surface, {{}}, lambertian(32), executor);
    ASSERT_TRUE(goniometer);
    const SurfaceMaps truth = goniometer->truth(executor);
    double sum = 0;
    for (const float z : truth.height.values()) sum += static_cast<double>(z);
    EXPECT_NEAR(sum / 1024, 0, 1e-4);
    for (std::size_t p = 0; p < 1024; ++p) {
        const auto n = truth.normal.values();
        EXPECT_NEAR(n[p] * n[p] + n[1024 + p] * n[1024 + p] + n[2048 + p] * n[2048 + p],
                    1, 1e-5F);
        EXPECT_NEAR(truth.colour.values()[p], 0.3F, 1e-6F);
        EXPECT_NEAR(truth.roughness.values()[p], 0.5F, 1e-6F);
    }
    EXPECT_NEAR(truth.height(0, 3, 4), 0.97F, 0.02F);
}

TEST(Goniometer, WhatCannotBeMeasuredIsNamed) {
    const SurfaceMaps plate = grey_surface(8, 8, 0.6F, [](float, float) { return 0.0F; });
    SerialExecutor executor;
    const auto message = [&](const SurfaceMaps& surface, Direction light,
                             const GoniometerOptions& options) {
        const auto made = Goniometer::create(surface, {light}, options, executor);
        return made ? std::string() : made.error().message;
    };
    EXPECT_THAT(message(plate, degrees(89.5F, 0), lambertian(8)),
                testing::HasSubstr("expected 0 to 89"));
    GoniometerOptions none = lambertian(8);
    none.samples = 0;
    EXPECT_THAT(message(plate, {}, none), testing::HasSubstr("samples: found 0"));
    SurfaceMaps wrong = plate;
    wrong.colour = Image(3, 4, 8);
    EXPECT_THAT(message(wrong, {}, lambertian(8)),
                testing::HasSubstr("colour: found 3 bands of 8 x 4"));
    wrong = plate;
    wrong.height(0, 1, 1) = NAN;
    EXPECT_THAT(message(wrong, {}, lambertian(8)), testing::HasSubstr("not finite"));
    auto made = Goniometer::create(plate, {{}}, lambertian(8), executor);
    ASSERT_TRUE(made);
    const std::size_t first = 0;
    const auto ignore = [](std::size_t, const Image&) -> Result<void> { return {}; };
    EXPECT_FALSE(
        made->measure(degrees(80, 0), {&first, 1}, ignore, executor, Progress()));
}

TEST(VirtualMeasurement, HasTheImagesOfTheGoniometer) {
    const SurfaceMaps plate = grey_surface(8, 8, 0.5F, [](float, float) { return 0.0F; });
    SerialExecutor executor;
    auto made = virtual_measurement(plate, {degrees(30, 0), {}}, coarse_directions(),
                                    lambertian(8), executor);
    ASSERT_TRUE(made);
    const MeasurementInfo& info = (*made)->info();
    EXPECT_EQ(info.observations.size(), 50U);
    EXPECT_EQ(info.views[0], Direction{});
    for (std::size_t k = 0; k < info.observations.size(); k += 7) {
        auto image = (*made)->read(k);
        ASSERT_TRUE(image);
        EXPECT_NEAR((*image)(1, 4, 4),
                    0.5F * std::cos(info.lights[info.observations[k].light].theta),
                    1e-6F);
    }
}

}  // namespace
}  // namespace sateen
