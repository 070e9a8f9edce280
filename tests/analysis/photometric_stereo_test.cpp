// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/photometric_stereo.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/relief.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using test::cosine_relief;
using test::Gloss;
using test::mean_angle;
using test::measurement_of;
using test::mottled_albedo;
using test::Relief;
using test::ring_lights;
using testing::HasSubstr;

StereoEstimate estimate(const Measurement& measurement,
                        const StereoOptions& options = {}) {
    SerialExecutor executor;
    Progress progress;
    auto result = photometric_stereo(measurement, options, executor, progress);
    EXPECT_TRUE(result) << result.error().message;
    return *std::move(result);
}

constexpr std::array kModes = {false, true};

TEST(PhotometricStereo, AFlatPlateIsFoundExactly) {
    Relief plate{BasicImage<double>(1, 5, 7), SlopeField(2, 5, 7), {}};
    plate.normals = test::normals_of_slopes(plate.slopes);
    const Image albedo = mottled_albedo(3, 5, 7, 1);
    for (const bool robust : kModes) {
        const auto found =
            estimate(measurement_of(plate, albedo, ring_lights()), {.robust = robust});
        EXPECT_LT(mean_angle(found.normals, plate.normals), 0.03) << "rounding of acos";
        for (std::size_t i = 0; i < albedo.values().size(); ++i)
            EXPECT_NEAR(found.albedo.values()[i], albedo.values()[i], 1e-5);
    }
}

// Slopes up to 0.25: no light of at most 75 degrees leaves a pixel in its own shadow.
TEST(PhotometricStereo, ALambertFieldWithoutShadowIsFoundExactly) {
    const Relief relief = cosine_relief(32, 40, 4, 0.25, 2);
    const Image albedo = mottled_albedo(3, 32, 40, 3);
    for (const bool robust : kModes) {
        const auto found =
            estimate(measurement_of(relief, albedo, ring_lights()), {.robust = robust});
        EXPECT_LT(mean_angle(found.normals, relief.normals), 0.05);
        EXPECT_EQ(found.lights, 40U);
    }
}

TEST(PhotometricStereo, ReflectanceWithoutTheCosineIsMultipliedByIt) {
    const Relief relief = cosine_relief(16, 16, 3, 0.25, 4);
    const Image albedo = mottled_albedo(1, 16, 16, 5);
    std::vector<Image> images;
    for (const Direction light : ring_lights()) {
        images.push_back(test::picture(relief.normals, albedo, light));
        for (float& v : images.back().values()) v /= std::cos(light.theta);
    }
    class Reflectance final : public Measurement {
      public:
        explicit Reflectance(std::vector<Image> pictures)
            : inner_({Direction{}}, ring_lights(), std::move(pictures)),
              info_(inner_.info()) {
            info_.radiometry.cosine_included = false;
        }
        [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
        [[nodiscard]] Result<Image> read(std::size_t i) const override {
            return inner_.read(i);
        }

      private:
        test::SyntheticMeasurement inner_;
        MeasurementInfo info_;
    };
    const auto found = estimate(Reflectance(std::move(images)), {});
    EXPECT_LT(mean_angle(found.normals, relief.normals), 0.05);
}

// Slopes to 2 and lights to 75 degrees: a quarter of the values lie in shadow.
TEST(PhotometricStereo, RobustFitsWithstandShadowAndGloss) {
    const Relief relief = cosine_relief(32, 32, 4, 2, 6);
    const Image albedo = mottled_albedo(3, 32, 32, 7);
    for (const double gloss : {0.0, 0.3, 1.0}) {
        const auto measurement =
            measurement_of(relief, albedo, ring_lights(5, 16), {.strength = gloss});
        const auto plain = estimate(measurement, {.robust = false, .upright = false});
        const auto robust = estimate(measurement, {.upright = false});
        const double plain_error = mean_angle(plain.normals, relief.normals);
        const double robust_error = mean_angle(robust.normals, relief.normals);
        EXPECT_LT(robust_error, gloss > 0 ? 1.5 : 0.05) << gloss;
        EXPECT_LT(robust_error, 0.5 * plain_error) << gloss;
        EXPECT_GT(plain_error, 1) << "or the test shows nothing";
    }
}

// Fresnel's factors for light in and out, after Schlick.
TEST(PhotometricStereo, ABodyUnderALayerIsFoundExactly) {
    const Relief relief = cosine_relief(24, 24, 3, 0.5, 16);
    const Image albedo = mottled_albedo(3, 24, 24, 17);
    std::vector<Image> images;
    const auto passes = [](float cosine) {
        return 1 - (0.04F + 0.96F * std::pow(1 - std::max(0.0F, cosine), 5.0F));
    };
    for (const Direction light : ring_lights()) {
        const auto l = to_vector(light);
        images.push_back(test::picture(relief.normals, albedo, light));
        for (std::size_t i = 0; i < relief.normals.plane_size(); ++i) {
            const float nz = relief.normals.plane(2).data[i];
            const float nl = relief.normals.plane(0).data[i] * l[0] +
                             relief.normals.plane(1).data[i] * l[1] + nz * l[2];
            for (std::size_t band = 0; band < 3; ++band)
                images.back().plane(band).data[i] *= passes(nl) * passes(nz);
        }
    }
    const test::SyntheticMeasurement measurement({{Direction{}}, ring_lights(), images});
    const auto robust = estimate(measurement, {.upright = false});
    const auto plain = estimate(measurement, {.robust = false, .upright = false});
    EXPECT_LT(mean_angle(robust.normals, relief.normals), 0.05);
    EXPECT_GT(mean_angle(plain.normals, relief.normals), 0.5) << "or it shows nothing";
}

// A lobe so wide that nearly every light sees some of it.
TEST(PhotometricStereo, GreyGlossOverAColourHardlyCounts) {
    const Relief relief = cosine_relief(24, 24, 3, 0.5, 18);
    Image brown = mottled_albedo(3, 24, 24, 19);
    for (std::size_t i = 0; i < brown.plane_size(); ++i) {
        brown.plane(1).data[i] = 0.4F * brown.plane(0).data[i];
        brown.plane(2).data[i] = 0.2F * brown.plane(0).data[i];
    }
    const Image grey = mottled_albedo(1, 24, 24, 19);
    const auto error = [&](const Image& albedo) {
        const auto measurement = measurement_of(relief, albedo, ring_lights(),
                                                {.strength = 0.15, .exponent = 12});
        return mean_angle(estimate(measurement, {.upright = false}).normals,
                          relief.normals);
    };
    const double grey_error = error(grey);
    EXPECT_LT(error(brown), 0.65 * grey_error);
    EXPECT_GT(grey_error, 1) << "or the test shows nothing";
}

TEST(PhotometricStereo, TheMeanNormalIsMadeUpright) {
    Relief tilted = cosine_relief(24, 24, 3, 0.1, 8);
    for (std::size_t i = 0; i < tilted.slopes.plane_size(); ++i)
        tilted.slopes.plane(0).data[i] += 0.1;
    tilted.normals = test::normals_of_slopes(tilted.slopes);
    const auto measurement =
        measurement_of(tilted, mottled_albedo(1, 24, 24, 9), ring_lights());
    const auto found = estimate(measurement);
    double mean[3] = {};
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t i = 0; i < found.normals.plane_size(); ++i)
            mean[band] += static_cast<double>(found.normals.plane(band).data[i]);
    EXPECT_NEAR(mean[0] / mean[2], 0, 1e-5);
    EXPECT_NEAR(mean[1] / mean[2], 0, 1e-5);
    EXPECT_NEAR(found.up[0] / found.up[2], -0.1, 0.01);
    EXPECT_LT(
        mean_angle(estimate(measurement, {.upright = false}).normals, tilted.normals),
        0.05);
}

TEST(PhotometricStereo, StripsAndThreadsChangeNothing) {
    const Relief relief = cosine_relief(21, 16, 3, 0.8, 10);
    const auto measurement =
        measurement_of(relief, mottled_albedo(3, 21, 16, 11), ring_lights());
    const auto whole = estimate(measurement);
    Progress progress;
    test::ThreadedExecutor threads(4);
    const auto strips =
        photometric_stereo(measurement, {.memory_bytes = 40000}, threads, progress);
    ASSERT_TRUE(strips);
    for (std::size_t i = 0; i < whole.normals.values().size(); ++i)
        ASSERT_EQ(strips->normals.values()[i], whole.normals.values()[i]);
    EXPECT_EQ(strips->mean_used, whole.mean_used);
}

TEST(PhotometricStereo, UnreadableImagesAreErrorsOrLeftOut) {
    const Relief relief = cosine_relief(16, 16, 3, 0.25, 12);
    auto measurement =
        measurement_of(relief, mottled_albedo(1, 16, 16, 13), ring_lights());
    measurement.damage(7);
    SerialExecutor executor;
    Progress progress;
    const auto refused = photometric_stereo(measurement, {}, executor, progress);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("image 7: damaged"));
    const auto found = estimate(measurement, {.skip_bad = true});
    EXPECT_EQ(found.lights, 39U);
    EXPECT_THAT(found.notes, testing::ElementsAre(HasSubstr("image 7: damaged")));
    EXPECT_LT(mean_angle(found.normals, relief.normals), 0.05);
}

TEST(PhotometricStereo, RefusesTooFewLights) {
    const Relief relief = cosine_relief(8, 8, 2, 0.2, 14);
    const Image albedo = mottled_albedo(1, 8, 8, 15);
    SerialExecutor executor;
    Progress progress;
    const std::vector<Direction> in_a_plane = {
        direction_from_degrees(10, 0), direction_from_degrees(40, 0),
        direction_from_degrees(50, 180), direction_from_degrees(0, 0)};
    for (const auto& lights :
         {std::vector<Direction>(in_a_plane.begin(), in_a_plane.begin() + 2),
          in_a_plane}) {
        const auto result = photometric_stereo(measurement_of(relief, albedo, lights), {},
                                               executor, progress);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, Errc::singular);
    }
    const auto photographs =
        photometric_stereo(test::SyntheticMeasurement({albedo}), {}, executor, progress);
    ASSERT_FALSE(photographs);
    EXPECT_EQ(photographs.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace sateen
