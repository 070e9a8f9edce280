// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/quality.hpp"

#include "sateen/analysis/texture_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "baselines/random_phase.hpp"
#include "support/degradations.hpp"
#include "support/textures.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using test::crop;
using test::discs;
using test::grey_noise;
using test::weave;

TextureScore score(const Image& reference, const Image& candidate) {
    SerialExecutor serial;
    auto prepared = TextureReference::create(reference, {}, serial);
    EXPECT_TRUE(prepared.has_value());
    auto result = prepared->compare(candidate, serial);
    EXPECT_TRUE(result.has_value());
    return *result;
}

std::vector<double> scores_of(const TextureScore& s) {
    return {s.colour.score,   s.power.score, s.autocovariance.score,
            s.subbands.score, s.joint.score, s.total};
}

Image random_phase_of(const Image& linear, std::uint64_t seed) {
    auto noise = baselines::random_phase(test::encoded(linear), linear.rows(),
                                         linear.cols(), seed);
    EXPECT_TRUE(noise.has_value());
    return test::through_eight_bits(*noise);
}

Image constant(std::size_t bands, std::size_t side, float value) {
    return test::mapped(Image(bands, side, side), [value](float) { return value; });
}

TEST(Quality, AnImageIsAtDistanceOneFromItself) {
    for (const Image& image : {discs(200, 173, 1), discs(64, 64, 2), discs(32, 90, 3),
                               weave(128, 128, 9.3, 4), grey_noise(99, 131, 50, 8, 5)}) {
        for (double s : scores_of(score(image, image))) EXPECT_EQ(s, 1);
    }
}

// 10 pairs; the bound is far above what the seeds give, and far below random phase.
TEST(Quality, AnotherPieceOfAStationaryTextureIsAtDistanceOne) {
    double sum = 0;
    for (std::uint32_t seed = 0; seed < 10; ++seed) {
        sum += score(discs(192, 192, 2 * seed), discs(192, 192, 2 * seed + 1)).total;
    }
    EXPECT_LT(sum / 10, 1.06);
}

TEST(Quality, RanksPiecesThenRandomPhaseThenWhatIsPlainlyWrong) {
    const std::vector<std::pair<Image, Image>> pairs = {
        {discs(240, 240, 1), discs(240, 240, 2)},
        {weave(240, 240, 11.7, 1), weave(240, 240, 11.7, 2)}};
    for (const auto& [reference, other] : pairs) {
        const double piece = score(reference, other).total;
        const double phase = score(reference, random_phase_of(reference, 3)).total;
        EXPECT_LT(piece, 1.15);
        EXPECT_LT(piece, phase);
        for (const Image& wrong :
             {test::wrong_colours(reference), test::negative(reference),
              test::shuffled(reference, 4), test::blurred(reference, 1.5),
              test::white_noise_like(reference, 5)}) {
            EXPECT_LT(phase, score(reference, wrong).total);
        }
    }
}

TEST(Quality, GrowsWithTheDegradation) {
    const Image reference = discs(192, 192, 1);
    double last = 1;
    for (double sigma : {0.5, 1.0, 2.0, 4.0}) {
        const double total = score(reference, test::blurred(reference, sigma)).total;
        EXPECT_GT(total, last);
        last = total;
    }
}

// A shift of lightness by v moves the mean of the first plane by v, and nothing else.
TEST(Quality, AShiftOfLightnessIsMeasuredInDeltaE) {
    const Image reference = grey_noise(256, 256, 50, 6, 1);
    const Image brighter = grey_noise(256, 256, 55, 6, 1);
    const TextureScore s = score(reference, brighter);
    EXPECT_NEAR(s.colour.distance, 5 / std::sqrt(6.0), 0.05);
    EXPECT_NEAR(s.power.score, 1, 0.01);
    EXPECT_NEAR(s.joint.score, 1, 0.01);
}

TEST(Quality, ComparesImagesOfAnySizes) {
    const Image large = discs(300, 411, 1);
    for (const Image& other : {discs(64, 64, 2), discs(127, 301, 3), discs(600, 65, 4)}) {
        for (const auto& s : {score(large, other), score(other, large)}) {
            EXPECT_TRUE(std::isfinite(s.total));
            EXPECT_LT(s.total, 1.5);
        }
    }
}

TEST(Quality, PreparationForACandidateSizeChangesNoScore) {
    SerialExecutor serial;
    const Image reference = discs(300, 300, 1);
    const Image candidate = discs(160, 128, 2);
    auto prepared = TextureReference::create(reference, {160, 128}, serial);
    ASSERT_TRUE(prepared.has_value());
    auto result = prepared->compare(candidate, serial);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(scores_of(*result), scores_of(score(reference, candidate)));
}

TEST(Quality, ConstantImagesHaveFiniteScores) {
    const Image texture = discs(96, 96, 1);
    for (double s : scores_of(score(constant(3, 96, 0.4F), constant(3, 96, 0.4F))))
        EXPECT_EQ(s, 1);
    for (const Image& flat :
         {constant(3, 96, 0), constant(3, 96, 0.4F), constant(1, 96, 1)}) {
        for (const auto& s : {score(flat, texture), score(texture, flat)}) {
            for (double value : scores_of(s)) EXPECT_TRUE(std::isfinite(value));
            EXPECT_GT(s.total, 2);
        }
    }
}

TEST(Quality, AGreyImageOfThreeBandsScoresAsOneOfOneBand) {
    const Image grey = grey_noise(128, 128, 50, 8, 1);
    Image three(3, 128, 128);
    for (std::size_t b = 0; b < 3; ++b) {
        std::copy(
            grey.values().begin(), grey.values().end(),
            three.values().begin() + static_cast<std::ptrdiff_t>(b * grey.plane_size()));
    }
    const Image other = test::blurred(grey, 0.7);
    const auto one_band = scores_of(score(grey, other));
    const auto three_bands = scores_of(score(three, other));
    for (std::size_t i = 0; i < one_band.size(); ++i) {
        EXPECT_NEAR(one_band[i], three_bands[i], 0.01 * one_band[i]);
    }
}

TEST(Quality, TheUnitOfVeryBrightAndVeryDarkImagesDoesNotMatter) {
    const auto scaled = [](const Image& image, float gain) {
        return test::mapped(image, [gain](float v) { return gain * v; });
    };
    const Image reference = discs(128, 128, 1);
    const Image candidate = test::blurred(reference, 1);
    const auto expected =
        scores_of(score(scaled(reference, 1e3F), scaled(candidate, 1e3F)));
    for (float gain : {1e-6F, 1e-3F, 1e5F}) {
        const auto found =
            scores_of(score(scaled(reference, gain), scaled(candidate, gain)));
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_NEAR(found[i], expected[i], 0.01 * expected[i]);
        }
    }
}

TEST(Quality, GivesTheSameBytesForAnyNumberOfThreads) {
    const Image reference = discs(160, 160, 1);
    const Image candidate = discs(160, 160, 2);
    const auto expected = scores_of(score(reference, candidate));
    test::ThreadedExecutor threads(3);
    auto prepared = TextureReference::create(reference, {}, threads);
    ASSERT_TRUE(prepared.has_value());
    auto result = prepared->compare(candidate, threads);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(scores_of(*result), expected);
}

TEST(Quality, RefusesWhatItCannotRead) {
    SerialExecutor serial;
    const auto message = [&serial](const Image& image) {
        auto result = TextureReference::create(image, {}, serial);
        EXPECT_FALSE(result.has_value());
        return result ? std::string() : result.error().message;
    };
    EXPECT_EQ(message(Image(2, 64, 64)), "reference: 2 bands, expected 1 or 3");
    EXPECT_EQ(message(Image(3, 31, 64)),
              "reference: 64x31 pixels, expected at least 32x32");
    Image broken = discs(64, 64, 1);
    broken(1, 5, 6) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(message(broken), "reference: holds a value that is not finite");

    auto reference = TextureReference::create(discs(64, 64, 1), {}, serial);
    ASSERT_TRUE(reference.has_value());
    auto result = reference->compare(broken, serial);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().message, "candidate: holds a value that is not finite");
}

// Twice the same product of exponentials has excess kurtosis 3, a difference of two such
// half of it, and averaging 4 pixels divides it by 4: log ratios 0.405, 0.118, 0.031.
TEST(CrossCheck, GradientKurtosisOfLaplaceNoiseIsKnown) {
    const Image gaussian = grey_noise(512, 512, 50, 5, 1);
    const std::vector<Image> n = {
        grey_noise(512, 512, 0, 1, 2), grey_noise(512, 512, 0, 1, 3),
        grey_noise(512, 512, 0, 1, 4), grey_noise(512, 512, 0, 1, 5)};
    Image laplace(1, 512, 512);
    for (std::size_t i = 0; i < laplace.plane_size(); ++i) {
        const auto normal = [&](std::size_t k) {
            return 116 * std::cbrt(static_cast<double>(n[k].values()[i])) - 16;
        };
        // The determinant of a 2 x 2 matrix of normals is Laplace distributed,
        // variance 2.
        const double l = normal(0) * normal(1) - normal(2) * normal(3);
        const double f = (50 + 5 / std::sqrt(2.0) * l + 16) / 116;
        laplace.values()[i] = static_cast<float>(f * f * f);
    }
    auto check = cross_check(gaussian, laplace);
    ASSERT_TRUE(check.has_value());
    EXPECT_NEAR(check->gradient_kurtosis, (0.405 + 0.118 + 0.031) / 3, 0.02);
}

// Dark squares of 16 and of 64 pixels, a quarter of the area: two octaves apart. What is
// bright hangs together in both.
TEST(CrossCheck, BlobDistanceIsInOctavesOfArea) {
    const auto squares = [](std::size_t side) {
        Image image(1, 128, 128);
        for (std::size_t r = 0; r < 128; ++r) {
            for (std::size_t c = 0; c < 128; ++c) {
                image(0, r, c) = (r / side) % 2 == 1 && (c / side) % 2 == 1 ? 0.1F : 0.6F;
            }
        }
        return image;
    };
    auto check = cross_check(squares(4), squares(8));
    ASSERT_TRUE(check.has_value());
    EXPECT_NEAR(check->blob, (2 + 0) / 2.0, 1e-9);
}

// Responses of unit filters to white noise have its deviation; 2 x 2 means halve it. Half
// the contrast is then 1/2, 1/4, 1/8 of the deviation away.
TEST(CrossCheck, PatchDistanceIsInDeviationsOfTheReference) {
    auto check =
        cross_check(grey_noise(512, 512, 50, 8, 1), grey_noise(512, 512, 50, 4, 2));
    ASSERT_TRUE(check.has_value());
    EXPECT_NEAR(check->patches, (0.5 + 0.25 + 0.125) / 3, 0.01);
}

TEST(CrossCheck, AnImageEqualsItself) {
    const Image image = discs(90, 77, 1);
    auto check = cross_check(image, image);
    ASSERT_TRUE(check.has_value());
    EXPECT_EQ(check->gradient_kurtosis, 0);
    EXPECT_EQ(check->blob, 0);
    EXPECT_EQ(check->patches, 0);
}

TEST(SeamRatio, OfARampIsItsLengthAndOfATorusOne) {
    Image ramp(1, 40, 50);
    Image torus(1, 40, 50);
    for (std::size_t r = 0; r < 40; ++r) {
        for (std::size_t c = 0; c < 50; ++c) {
            ramp(0, r, c) = static_cast<float>(r);
            torus(0, r, c) = static_cast<float>((r + c) % 2);
        }
    }
    EXPECT_DOUBLE_EQ(seam_ratio(ramp.view()).rows, 39);
    EXPECT_DOUBLE_EQ(seam_ratio(ramp.view()).cols, 1);
    EXPECT_DOUBLE_EQ(seam_ratio(torus.view()).rows, 1);
    EXPECT_DOUBLE_EQ(seam_ratio(torus.view()).cols, 1);
}

// White noise: flat power at its variance, no autocovariance, a Gaussian histogram.
TEST(TextureProfile, OfWhiteNoiseIsFlat) {
    auto profile = texture_profile(grey_noise(400, 301, 50, 4, 1));
    ASSERT_TRUE(profile.has_value());
    double mean = 0;
    for (double p : profile->power)
        mean += p / static_cast<double>(profile->power.size());
    EXPECT_NEAR(profile->power.back(), 16, 0.5);
    EXPECT_NEAR(mean, 16, 2);
    EXPECT_EQ(profile->along_cols.front(), 1);
    for (std::size_t lag = 1; lag < profile->along_cols.size(); ++lag) {
        EXPECT_NEAR(profile->along_cols[lag], 0, 0.03);
    }
    double lightness = 0;
    for (std::size_t k = 0; k < TextureProfile::kBins; ++k) {
        lightness += profile->histogram[0][k] * (static_cast<double>(k) + 0.5) * 100 /
                     static_cast<double>(TextureProfile::kBins);
    }
    EXPECT_NEAR(lightness, 50, 0.1);
    EXPECT_EQ(profile->spectrum.rows(), 256U);
}

TEST(TextureProfile, FindsThePeriodOfAWeave) {
    auto profile = texture_profile(weave(256, 256, 16, 1));
    ASSERT_TRUE(profile.has_value());
    EXPECT_GT(profile->along_cols[16], 0.8 * profile->along_cols[0]);
    EXPECT_LT(profile->along_cols[8], 0.2);
    const auto peak = std::max_element(profile->power.begin(), profile->power.end());
    EXPECT_NEAR(
        profile->frequency[static_cast<std::size_t>(peak - profile->power.begin())],
        1.0 / 16, 0.005);
}

}  // namespace
}  // namespace sateen
