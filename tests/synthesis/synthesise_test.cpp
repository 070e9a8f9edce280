// SPDX-License-Identifier: Apache-2.0
#include "sateen/synthesis/synthesise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "sateen/core/colour.hpp"
#include "support/materials.hpp"
#include "support/progress.hpp"
#include "support/random_material.hpp"
#include "support/threaded_executor.hpp"
#include "synthesis/appearance.hpp"

namespace sateen {
namespace {

Image draw(const Material& material, const SynthesisOptions& options,
           std::size_t subspace = 0) {
    SerialExecutor executor;
    Progress progress;
    auto image = synthesise(material, subspace, options, executor, progress);
    EXPECT_TRUE(image) << (image ? "" : image.error().message);
    return image ? std::move(*image) : Image();
}

void expect_equal(const Image& a, const Image& b) {
    ASSERT_EQ(a.bands(), b.bands());
    ASSERT_EQ(a.rows(), b.rows());
    ASSERT_EQ(a.cols(), b.cols());
    for (std::size_t i = 0; i < a.values().size(); ++i)
        ASSERT_EQ(a.values()[i], b.values()[i]) << i;
}

double mean_of(const Image& image) {
    double sum = 0;
    for (const float value : image.values()) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.values().size());
}

double variance_of(const Image& image) {
    const double mean = mean_of(image);
    double sum = 0;
    for (const float value : image.values())
        sum += (static_cast<double>(value) - mean) * (static_cast<double>(value) - mean);
    return sum / static_cast<double>(image.values().size());
}

Material plain(std::size_t levels = 3) {
    return test::plain_material(test::pyramid_of(test::half_plane_field(), levels));
}

/// Three bands, curves, several subspaces, drawn spectrally.
Material colourful(std::size_t subspaces = 2, bool recursive = false) {
    Material material = test::random_material({.seed = 5,
                                               .subspaces = subspaces,
                                               .levels = 3,
                                               .order = 3,
                                               .views = 3,
                                               .lights = 2});
    material.drawing = recursive ? Drawing::recursive : Drawing::spectral;
    return material;
}

const std::array<SynthesisOptions, 5> kWays = {
    SynthesisOptions{.rows = 48, .cols = 60, .tileable = true},  // one transform
    SynthesisOptions{.rows = 47, .cols = 61, .tileable = true},  // periodic noise
    SynthesisOptions{.rows = 44, .cols = 28, .tileable = true},  // the same, two lattices
    SynthesisOptions{.rows = 30, .cols = 41, .offset_row = -7, .offset_col = 9},
    SynthesisOptions{.rows = 30, .cols = 41, .offset_col = -20, .recursive = true}};

TEST(Synthesise, DrawsTheFieldsThatBecomeTheTexture) {
    const Material material = colourful();
    for (SynthesisOptions options : kWays) {
        const Image texture = draw(material, options);
        options.fields_only = true;
        Image fields = draw(material, options);
        SerialExecutor executor;
        invert_spectral(material.subspaces[0], fields.view(), executor);
        expect_equal(fields, texture);
    }
}

TEST(Synthesise, GivesTheSameBytesForAnyNumberOfThreads) {
    const Material material = colourful();
    Progress progress;
    for (const SynthesisOptions& options : kWays) {
        const Image expected = draw(material, options, 1);
        for (const std::size_t count : {2U, 3U}) {
            if (count == 2 && !options.tileable) continue;
            test::ThreadedExecutor threads(count);
            const auto got = synthesise(material, 1, options, threads, progress);
            ASSERT_TRUE(got);
            expect_equal(*got, expected);
        }
    }
}

TEST(Synthesise, GivesTheSizeAskedForDownToOnePixel) {
    const Material material = colourful();
    for (const SynthesisOptions& way : kWays) {
        for (const auto& [rows, cols] : {std::pair{1U, 1U}, {1U, 37U}}) {
            SynthesisOptions options = way;
            options.rows = rows;
            options.cols = cols;
            const Image image = draw(material, options);
            EXPECT_EQ(image.bands(), 3U);
            EXPECT_EQ(image.rows(), rows);
            EXPECT_EQ(image.cols(), cols);
            for (const float value : image.values()) {
                EXPECT_TRUE(std::isfinite(value));
                EXPECT_GE(value, 0);
            }
        }
    }
}

TEST(Synthesise, DrawsVeryWideTextures) {
    const Image wide = draw(plain(), {.rows = 2, .cols = 20000, .offset_row = 3});
    const Image part =
        draw(plain(), {.rows = 1, .cols = 10, .offset_row = 4, .offset_col = 19000});
    for (std::size_t c = 0; c < 10; ++c) EXPECT_EQ(part(0, 0, c), wide(0, 1, 19000 + c));
}

TEST(Synthesise, WindowsAgreeToTheBitInColourAndByRecursion) {
    for (const bool recursive : {false, true}) {
        const Material material = colourful(2, recursive);
        const Image large = draw(
            material, {.rows = 60, .cols = 70, .offset_row = -30, .offset_col = 480});
        const Image small =
            draw(material, {.rows = 20, .cols = 30, .offset_row = -5, .offset_col = 500});
        for (std::size_t band = 0; band < 3; ++band)
            for (std::size_t r = 0; r < 20; ++r)
                for (std::size_t c = 0; c < 30; ++c)
                    ASSERT_EQ(small(band, r, c), large(band, r + 25, c + 20));
    }
}

TEST(Synthesise, SeedsMakeDifferentTextures) {
    for (SynthesisOptions options : kWays) {
        const Image a = draw(plain(), options);
        options.seed = 1;
        EXPECT_NE(a.values()[3], draw(plain(), options).values()[3]);
    }
}

TEST(Synthesise, PinsMeanAndVarianceOfTileableTextures) {
    for (const auto& [rows, cols] : {std::pair{64U, 60U}, {61U, 67U}, {44U, 28U}}) {
        for (const std::uint64_t seed : {0U, 1U}) {
            const Image image = draw(
                plain(), {.rows = rows, .cols = cols, .tileable = true, .seed = seed});
            EXPECT_NEAR(mean_of(image), 100, 1e-4);
            EXPECT_NEAR(variance_of(image), 1, 1e-4);
        }
    }
}

/// Mean absolute difference across the wrap over that between neighbours inside.
double seam_ratio(const Image& image, bool rows) {
    const std::size_t lines = rows ? image.rows() : image.cols();
    const std::size_t length = rows ? image.cols() : image.rows();
    std::vector<double> steps(lines);
    for (std::size_t line = 0; line < lines; ++line) {
        for (std::size_t i = 0; i < length; ++i) {
            const std::size_t next = (line + 1) % lines;
            steps[line] += rows ? std::abs(static_cast<double>(image(0, line, i)) -
                                           static_cast<double>(image(0, next, i)))
                                : std::abs(static_cast<double>(image(0, i, line)) -
                                           static_cast<double>(image(0, i, next)));
        }
    }
    const double inside = std::accumulate(steps.begin(), steps.end() - 1, 0.0) /
                          static_cast<double>(lines - 1);
    return steps.back() / inside;
}

TEST(Synthesise, TileableTexturesHaveNoSeam) {
    // A line of 500 differences has a standard error of about 4 %.
    for (const auto& [rows, cols] :
         {std::pair{512U, 480U}, {509U, 511U}, {508U, 508U}, {1021U, 509U}}) {
        const Image image =
            draw(plain(4), {.rows = rows, .cols = cols, .tileable = true, .seed = 2});
        EXPECT_LT(seam_ratio(image, true), 1.1) << rows << 'x' << cols;
        EXPECT_LT(seam_ratio(image, false), 1.1) << rows << 'x' << cols;
    }
}

TEST(Synthesise, BlendsOfSubspacesKeepTheirContrast) {
    Material material = plain();
    material.subspaces.push_back(
        test::plain_subspace(test::pyramid_of(test::separable_field(0.7F, 0.5F), 3)));
    for (SynthesisOptions options : kWays) {
        if (options.recursive) continue;
        options.rows *= 3;
        options.cols *= 3;
        const Image first = draw(material, options, 0);
        const auto contrast_with = [&](const Image& other) {
            Image blend = first;
            for (std::size_t i = 0; i < blend.values().size(); ++i)
                blend.values()[i] = (first.values()[i] + other.values()[i]) / 2;
            return variance_of(blend) / ((variance_of(first) + variance_of(other)) / 2);
        };
        EXPECT_GT(contrast_with(draw(material, options, 1)), 0.9);
        options.seed = 1;
        EXPECT_LT(contrast_with(draw(material, options, 1)), 0.7);
    }
}

TEST(Synthesise, PlanesAreIndependent) {
    Material material = plain(1);
    material.bands = 3;
    Subspace& subspace = material.subspaces[0];
    subspace.spectral = {Tone::linear, {100, 100, 100}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    subspace.marginals.assign(3, {1, {}});
    subspace.levels[0].fields.assign(3, test::half_plane_field());
    for (const SynthesisOptions& way : kWays) {
        SynthesisOptions options = way;
        options.rows *= 4;
        options.cols *= 4;
        const Image image = draw(material, options);
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t b = 0; b < a; ++b) {
                double sum = 0;
                for (std::size_t i = 0; i < image.plane_size(); ++i)
                    sum += static_cast<double>(image.plane(a).data[i] - 100) *
                           static_cast<double>(image.plane(b).data[i] - 100);
                // n / Σρ² ≥ 4000 independent sites: 1.6 %, four times that.
                EXPECT_NEAR(sum / static_cast<double>(image.plane_size()), 0, 0.07);
            }
        }
    }
}

TEST(Synthesise, ConstantPlanesGiveTheMeanColour) {
    Material material = colourful(1);
    Subspace& subspace = material.subspaces[0];
    for (Marginal& marginal : subspace.marginals) marginal = {0, {}};
    for (Level& level : subspace.levels) level.fields.assign(3, Car2d{});
    subspace.spectral.tone = Tone::srgb;
    subspace.spectral.mean = {0.2F, 0.5F, 0.8F};
    for (const SynthesisOptions& options : kWays) {
        const Image image = draw(material, options);
        for (std::size_t band = 0; band < 3; ++band)
            for (std::size_t i = 0; i < image.plane_size(); ++i)
                ASSERT_NEAR(
                    static_cast<double>(image.plane(band).data[i]),
                    static_cast<double>(srgb_decode(subspace.spectral.mean[band])), 1e-6);
    }
}

TEST(Synthesise, UnstableFieldsStillDrawSpectrally) {
    const Material material =
        test::plain_material({{{{0, 1}, {1, 0}}, {0.51F, 0.51F}, 1}});
    for (const SynthesisOptions& options : kWays) {
        if (options.recursive) continue;
        const Image image = draw(material, options);
        for (const float value : image.values()) EXPECT_TRUE(std::isfinite(value));
        if (options.tileable) {
            EXPECT_NEAR(variance_of(image), 1, 1e-3);
        }
    }
}

TEST(Synthesise, UnstableFieldsAreDrawnByTheirDensityInstead) {
    SerialExecutor executor;
    Progress progress;
    const auto result =
        synthesise(test::plain_material({{{{0, 1}, {1, 0}}, {0.51F, 0.51F}, 1}}), 0,
                   {.rows = 8, .cols = 8, .recursive = true}, executor, progress);
    ASSERT_TRUE(result) << result.error().message;
    for (const float value : result->values()) EXPECT_TRUE(std::isfinite(value));
}

TEST(Synthesise, StripsAreInOrderAndCoverTheTexture) {
    SerialExecutor executor;
    Progress progress;
    for (const bool tileable : {false, true}) {
        const SynthesisOptions options{
            .rows = 700, .cols = 6, .offset_row = -333, .tileable = tileable};
        const Image whole = draw(plain(), options);
        std::size_t expected_row = 0;
        const StripSink sink = [&](std::size_t first_row,
                                   ImageView<const float> strip) -> Result<void> {
            EXPECT_EQ(first_row, expected_row);
            EXPECT_EQ(strip.cols, 6U);
            for (std::size_t r = 0; r < strip.rows; ++r)
                for (std::size_t c = 0; c < 6; ++c)
                    EXPECT_EQ(strip.plane(0)(r, c), whole(0, first_row + r, c));
            expected_row += strip.rows;
            return {};
        };
        ASSERT_TRUE(synthesise(plain(), 0, options, sink, executor, progress));
        EXPECT_EQ(expected_row, 700U);
    }
}

TEST(Synthesise, PassesOnTheErrorOfTheSink) {
    SerialExecutor executor;
    Progress progress;
    for (const SynthesisOptions& options : kWays) {
        int calls = 0;
        const auto result = synthesise(
            plain(), 0, options,
            [&](std::size_t, ImageView<const float>) -> Result<void> {
                ++calls;
                return Error{Errc::io, "disk full"};
            },
            executor, progress);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().message, "disk full");
        EXPECT_EQ(calls, 1);
    }
}

TEST(Synthesise, RefusesSizesSubspacesAndOffsetsThatCannotBe) {
    SerialExecutor executor;
    Progress progress;
    const auto error_of = [&](const SynthesisOptions& options, std::size_t subspace = 0) {
        const auto result = synthesise(plain(), subspace, options, executor, progress);
        EXPECT_FALSE(result);
        return result ? std::string() : result.error().message;
    };
    EXPECT_EQ(error_of({.rows = 0, .cols = 5}),
              "a texture of 5x0 pixels: each side must be 1 to 1048576");
    EXPECT_EQ(error_of({.rows = 1, .cols = kMaxTextureSide + 1}),
              "a texture of 1048577x1 pixels: each side must be 1 to 1048576");
    EXPECT_EQ(error_of({.rows = 4, .cols = 4}, 1),
              "subspace 1: the material has 1, numbered from 0");
    EXPECT_EQ(error_of({.rows = 4, .cols = 4, .offset_row = 2000000000}),
              "an offset of 0,2000000000: each must be within 2^30 of 0");
}

TEST(Synthesise, StopsWhenCancelled) {
    SerialExecutor executor;
    for (SynthesisOptions options : kWays) {
        test::CancelAfter at_once(0);
        const auto result = synthesise(plain(), 0, options, executor, at_once);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, Errc::cancelled);
    }
    test::CancelAfter first_strip(1);
    const auto result =
        synthesise(plain(), 0, {.rows = 2000, .cols = 4}, executor, first_strip);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::cancelled);
}

TEST(SynthesiseTiles, GivesEachSubspaceItsOwnTexture) {
    SerialExecutor executor;
    Progress progress;
    const Material material = colourful(3);
    const std::array<std::size_t, 3> wanted = {2, 0, 2};
    for (const auto& [rows, cols] : {std::pair{30U, 32U}, {28U, 44U}}) {
        std::vector<std::size_t> got;
        const SynthesisOptions options{.rows = rows, .cols = cols, .seed = 4};
        ASSERT_TRUE(synthesise_tiles(
            material, wanted, options,
            [&](std::size_t k, Image texture) -> Result<void> {
                got.push_back(k);
                SynthesisOptions one = options;
                one.tileable = true;
                expect_equal(texture, draw(material, one, k));
                return {};
            },
            executor, progress));
        EXPECT_THAT(got, testing::ElementsAreArray(wanted));
    }
}

TEST(SynthesiseTiles, StopsAtErrorsAndWhenCancelled) {
    SerialExecutor executor;
    Progress progress;
    const Material material = colourful(2);
    const std::array<std::size_t, 2> both = {0, 1};
    const SynthesisOptions options{.rows = 8, .cols = 8};
    int calls = 0;
    const auto fail = [&](std::size_t, Image) -> Result<void> {
        ++calls;
        return Error{Errc::io, "disk full"};
    };
    EXPECT_EQ(synthesise_tiles(material, both, options, fail, executor, progress)
                  .error()
                  .message,
              "disk full");
    EXPECT_EQ(calls, 1);
    const auto count = [&](std::size_t, Image) -> Result<void> {
        ++calls;
        return {};
    };
    test::CancelAfter first(1);
    EXPECT_EQ(
        synthesise_tiles(material, both, options, count, executor, first).error().code,
        Errc::cancelled);
    EXPECT_EQ(calls, 2);
    const std::array<std::size_t, 1> unknown = {7};
    EXPECT_EQ(synthesise_tiles(material, unknown, options, count, executor, progress)
                  .error()
                  .code,
              Errc::invalid_argument);
}

TEST(NearestSubspace, FollowsTheIndexOfTheNearestPair) {
    Material material = plain();
    material.subspaces.resize(4, material.subspaces[0]);
    material.views = {direction_from_degrees(0, 0), direction_from_degrees(60, 0),
                      direction_from_degrees(60, 180)};
    material.lights = {direction_from_degrees(0, 0), direction_from_degrees(45, 90)};
    material.index = {{0, 0, 0}, {0, 1, 1}, {0, 2, 2}, {1, 0, 3}, {1, 1, 2}, {1, 2, 1}};
    const auto nearest = [&](Direction view, Direction light) {
        return nearest_subspace(material, view, light);
    };
    for (const IndexEntry& entry : material.index)
        EXPECT_EQ(nearest(material.views[entry.view], material.lights[entry.light]),
                  entry.subspace);
    const Direction light = direction_from_degrees(5, 0);
    EXPECT_EQ(nearest(direction_from_degrees(20, 90), light), 0U);
    EXPECT_EQ(nearest(direction_from_degrees(75, -20), light), 1U);
    EXPECT_EQ(nearest(direction_from_degrees(75, 190), light), 2U);
    EXPECT_EQ(nearest(direction_from_degrees(75, 550), light), 2U);
    EXPECT_EQ(nearest(direction_from_degrees(0, 0), direction_from_degrees(60, 80)), 3U);
}

TEST(NearestSubspace, OfPhotographsIsTheOnlyOne) {
    EXPECT_EQ(nearest_subspace(plain(), {1, 2}, {0.5F, 3}), 0U);
}

}  // namespace
}  // namespace sateen
