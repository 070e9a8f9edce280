// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/analyse.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <span>
#include <variant>
#include <vector>

#include "analysis/fit_subspace.hpp"
#include "sateen/analysis/car2d.hpp"
#include "sateen/core/band_split.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "support/fields.hpp"
#include "support/progress.hpp"
#include "support/synthetic_measurement.hpp"
#include "support/textures.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using test::SyntheticMeasurement;

Analysis analysed(const Measurement& measurement, const AnalysisOptions& options = {}) {
    SerialExecutor executor;
    Progress progress;
    auto analysis = analyse(measurement, options, executor, progress);
    EXPECT_TRUE(analysis) << (analysis ? "" : analysis.error().message);
    if (!analysis) return {};
    const auto valid = validate(analysis->material);
    EXPECT_TRUE(valid) << (valid ? "" : valid.error().message);
    return std::move(*analysis);
}

Image textured(const Material& material, std::size_t side, bool tileable,
               std::size_t subspace = 0) {
    SerialExecutor executor;
    Progress progress;
    const SynthesisOptions options{.rows = side, .cols = side, .tileable = tileable};
    auto image = synthesise(material, subspace, options, executor, progress);
    EXPECT_TRUE(image);
    return image ? std::move(*image) : Image();
}

Lab mean_colour(const Image& image) {
    std::array<double, 3> mean{};
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t i = 0; i < image.plane_size(); ++i)
            mean[band] +=
                static_cast<double>(image.plane(image.bands() == 1 ? 0 : band).data[i]) /
                static_cast<double>(image.plane_size());
    return lab_from_linear_srgb(mean[0], mean[1], mean[2]);
}

Image constant(std::size_t rows, std::size_t cols, std::array<float, 3> colour) {
    Image image(3, rows, cols);
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t i = 0; i < rows * cols; ++i)
            image.plane(band).data[i] = colour[band];
    return image;
}

const Car2d& car2d(const Subspace& subspace, std::size_t level, std::size_t plane) {
    return std::get<Car2d>(subspace.levels[level].fields[plane]);
}

TEST(AnalysisOptions, AreCheckedBeforeAnyWork) {
    const auto message = [](const AnalysisOptions& options) {
        const auto checked = check(options);
        return checked ? std::string() : checked.error().message;
    };
    EXPECT_EQ(message({}), "");
    EXPECT_NE(message({.subspaces = 21}).find("subspaces: found 21"), std::string::npos);
    EXPECT_NE(message({.levels = 9}).find("levels: found 9"), std::string::npos);
    EXPECT_NE(
        message({.neighbourhood = NeighbourhoodOptions{NeighbourhoodRule::order, 14}})
            .find("order:14"),
        std::string::npos);
}

TEST(AnalysisOptions, OfPaperModeGiveWayToTheUsers) {
    EXPECT_EQ(neighbourhood_of({.paper = true}),
              (NeighbourhoodOptions{NeighbourhoodRule::nearest, 3}));
    EXPECT_EQ(neighbourhood_of({.field = FieldKind::gmrf2d, .paper = true}),
              (NeighbourhoodOptions{NeighbourhoodRule::order, 4}));
    const NeighbourhoodOptions asked{NeighbourhoodRule::evidence, 6};
    EXPECT_EQ(neighbourhood_of({.paper = true, .neighbourhood = asked}), asked);
}

TEST(Analyse, MeanColourOfTheTextureIsThatOfTheSample) {
    for (const Image& sample : {test::discs(128, 150, 1), test::weave(160, 128, 9, 2),
                                test::grey_noise(96, 96, 50, 8, 3)}) {
        const auto analysis = analysed(SyntheticMeasurement({sample}));
        const Lab expected = mean_colour(sample);
        // Tileable textures have their means pinned; the infinite plane's is that of 400²
        // sites. The photographs' values are encoded, clipped and averaged linearly.
        EXPECT_LT(
            delta_e_76(mean_colour(textured(analysis.material, 128, true)), expected), 1);
        EXPECT_LT(
            delta_e_76(mean_colour(textured(analysis.material, 400, false)), expected),
            1.5);
    }
}

TEST(Analyse, DescribesAPhotograph) {
    const auto analysis = analysed(SyntheticMeasurement({test::discs(80, 100, 1)}));
    const Material& material = analysis.material;
    EXPECT_EQ(material.provenance.name, "synthetic");
    EXPECT_EQ(material.provenance.source, "photograph");
    EXPECT_EQ(material.provenance.source_checksum, 42U);
    EXPECT_EQ(material.sample_rows, 80U);
    EXPECT_EQ(material.sample_cols, 100U);
    EXPECT_EQ(material.bands, 3U);
    EXPECT_EQ(material.drawing, Drawing::spectral);
    EXPECT_TRUE(material.index.empty());
    ASSERT_EQ(material.subspaces.size(), 1U);
    EXPECT_EQ(material.subspaces[0].members, 1U);
    EXPECT_EQ(analysis.representatives, std::vector<std::size_t>{0});
    EXPECT_TRUE(analysis.notes.empty());
    for (const Marginal& marginal : material.subspaces[0].marginals)
        EXPECT_EQ(marginal.knots.size(), Marginal::kKnots);
}

/// Three channels of noise; the second repeats so much of the first, two pixels away.
Image noise_that_follows(float share) {
    Image image(3, 128, 128);
    for (std::uint32_t band = 0; band < 3; ++band)
        for (std::size_t r = 0; r < image.rows(); ++r)
            draw_normals({7, band}, static_cast<std::int32_t>(r), 0,
                         std::span(image.plane(band).row(r), image.cols()));
    for (std::size_t r = 0; r < image.rows(); ++r)
        for (std::size_t c = 0; c < image.cols(); ++c)
            image(1, r, c) = share * image(0, r, (c + 2) % image.cols()) +
                             std::sqrt(1 - share * share) * image(1, r, c);
    for (float& value : image.values()) value = 0.4F + 0.05F * value;
    return image;
}

TEST(Analyse, DrawsPlanesTogetherOnlyWhereOneFollowsAnother) {
    const auto apart = analysed(SyntheticMeasurement({noise_that_follows(0)}));
    EXPECT_EQ(apart.choice.car3d, 0U);
    EXPECT_LT(apart.choice.information_apart, apart.choice.information_car3d);
    const auto together = analysed(SyntheticMeasurement({noise_that_follows(0.8F)}));
    EXPECT_EQ(together.choice.car3d, together.material.subspaces[0].levels.size());
    // What the second channel's noise of variance 1 - 0.8² is worth: n ln 1/0.36, at
    // least most of it.
    EXPECT_GT(together.choice.information_apart - together.choice.information_car3d,
              0.8 * 128 * 128 * std::log(1 / 0.36));
    AnalysisOptions options;
    options.joint = false;
    EXPECT_EQ(
        analysed(SyntheticMeasurement({noise_that_follows(0.8F)}), options).choice.car3d,
        0U);
}

TEST(Analyse, PoolsPhotographsOfDifferentSize) {
    // Of one field, so that the pooled estimate is close to each.
    std::vector<Image> photographs;
    for (const auto& [rows, cols, seed] :
         {std::array{96, 100, 1}, {128, 90, 2}, {101, 67, 3}}) {
        Image image = reference::to_image(reference::toroidal_field(
            test::quarter_plane_field(), static_cast<std::size_t>(rows),
            static_cast<std::size_t>(cols), static_cast<std::uint64_t>(seed)));
        for (float& value : image.values()) value = 0.5F + 0.02F * value;
        photographs.push_back(std::move(image));
    }
    const auto analysis =
        analysed(SyntheticMeasurement(photographs),
                 {.field = FieldKind::car2d,
                  .levels = 1,
                  .neighbourhood = NeighbourhoodOptions{NeighbourhoodRule::nearest, 3},
                  .tone = Tone::linear});
    const Subspace& subspace = analysis.material.subspaces.at(0);
    EXPECT_EQ(subspace.members, 3U);
    const Car2d& field = car2d(subspace, 0, 0);
    // 24000 sites: standard errors of about 0.006; the curve is close to a straight line.
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(static_cast<double>(field.a[i]),
                    static_cast<double>(test::quarter_plane_field().a[i]), 0.025);
    EXPECT_NEAR(static_cast<double>(subspace.marginals[0].scale),
                0.02 * std::sqrt(model_variance(test::quarter_plane_field())), 0.002);
}

TEST(Analyse, FindsThePatternThatPhotographsShare) {
    // Two windows of one weave, and discs, which have no pattern.
    const Image whole = test::weave(300, 300, 14.3, 5);
    std::vector<Image> photographs;
    for (const std::size_t first : {std::size_t{0}, std::size_t{101}}) {
        Image& part = photographs.emplace_back(3, 180, 180);
        for (std::size_t band = 0; band < 3; ++band)
            for (std::size_t r = 0; r < 180; ++r)
                for (std::size_t c = 0; c < 180; ++c)
                    part(band, r, c) = whole(band, first + r, first + c);
    }
    photographs.push_back(test::discs(180, 180, 1));
    const Analysis analysis = analysed(SyntheticMeasurement(photographs));
    ASSERT_TRUE(analysis.material.structure.has_value());
    EXPECT_THAT(analysis.notes,
                testing::Contains(testing::HasSubstr("in 2 of 3 photographs")));
    // The weave repeats after 14.3 columns, hence after 43 nearly: so does what is drawn.
    const Image drawn = textured(analysis.material, 143, true);
    double power = 0;
    double moved = 0;
    double mean = 0;
    for (std::size_t i = 0; i < drawn.plane_size(); ++i)
        mean += static_cast<double>(drawn.plane(1).data[i]) /
                static_cast<double>(drawn.plane_size());
    for (std::size_t r = 0; r < 143; ++r)
        for (std::size_t c = 0; c < 143; ++c) {
            const double here = static_cast<double>(drawn(1, r, c)) - mean;
            power += here * here;
            moved += here * (static_cast<double>(drawn(1, r, (c + 43) % 143)) - mean);
        }
    EXPECT_GT(moved / power, 0.3);
    const Analysis plain =
        analysed(SyntheticMeasurement(photographs), {.structure = false});
    EXPECT_FALSE(plain.material.structure.has_value());
}

TEST(Analyse, LevelsHaveThePowerOfTheGaussianisedPlane) {
    const auto analysis =
        analysed(SyntheticMeasurement({test::grey_noise(128, 128, 50, 8, 4)}),
                 {.field = FieldKind::car2d});
    const Subspace& subspace = analysis.material.subspaces.at(0);
    // White noise, S = 1: the finest level misses W² Σ_alias W², whose mean is the square
    // of that on one axis, of cos¹⁶(ω/2) + cos⁸(ω/2) sin⁸(ω/2).
    const double one_axis = 12870.0 / 65536 + 35.0 / 32768;
    EXPECT_NEAR(model_variance(car2d(subspace, 0, 0)), 1 - one_axis * one_axis, 0.02);
}

TEST(Analyse, TakesDegeneratePhotographs) {
    Image pixel = constant(1, 1, {0.2F, 0.4F, 0.6F});
    Image grey(1, 64, 64);
    for (float& value : grey.values()) value = 0.18F;
    Image two_colours = constant(64, 64, {0.1F, 0.2F, 0.3F});
    for (std::size_t r = 0; r < 64; ++r)
        for (std::size_t c = 0; c < 64; ++c)
            if ((r / 8 + c / 8) % 2 == 0)
                for (std::size_t band = 0; band < 3; ++band)
                    two_colours(band, r, c) = 0.8F - 0.2F * static_cast<float>(band);
    Image line(3, 1, 200);
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t c = 0; c < 200; ++c)
            line(band, 0, c) = 0.5F + 0.3F * std::sin(static_cast<float>(c * (band + 1)));
    Image black(3, 40, 30);
    for (const bool paper : {false, true}) {
        for (const Image* image : {&pixel, &grey, &two_colours, &line, &black}) {
            const auto analysis =
                analysed(SyntheticMeasurement({*image}), {.paper = paper});
            ASSERT_EQ(analysis.material.subspaces.size(), 1U);
            for (const bool tileable : {false, true}) {
                const Image texture = textured(analysis.material, 40, tileable);
                for (const float value : texture.values()) {
                    ASSERT_TRUE(std::isfinite(value));
                    ASSERT_GE(value, 0);
                }
                if (image == &pixel || image == &grey || image == &black) {
                    EXPECT_LT(delta_e_76(mean_colour(texture), mean_colour(*image)),
                              0.01);
                }
            }
        }
    }
}

TEST(Analyse, FactorsOfGreyImagesAreConstant) {
    const Image grey = test::grey_noise(64, 64, 50, 10, 5);
    Image colour(3, 64, 64);
    for (std::size_t band = 0; band < 3; ++band)
        std::copy_n(grey.values().data(), 4096, colour.plane(band).data);
    const auto analysis = analysed(SyntheticMeasurement({colour}));
    const Subspace& subspace = analysis.material.subspaces.at(0);
    EXPECT_GT(subspace.marginals[0].scale, 0);
    for (const std::size_t plane : {1U, 2U}) {
        EXPECT_EQ(subspace.marginals[plane].scale, 0);
        EXPECT_EQ(car2d(subspace, 0, plane), Car2d{});
    }
    const Image texture = textured(analysis.material, 32, true);
    for (std::size_t i = 0; i < 1024; ++i)
        EXPECT_NEAR(static_cast<double>(texture.plane(0).data[i]),
                    static_cast<double>(texture.plane(2).data[i]), 1e-5);
}

/// 4 views x 3 lights of 48 x 48, in three clusters by brightness and grain.
SyntheticMeasurement planted_btf() {
    std::vector<Direction> views;
    std::vector<Direction> lights;
    for (int i = 0; i < 4; ++i)
        views.push_back(direction_from_degrees(static_cast<float>(15 * i), 30));
    for (int i = 0; i < 3; ++i)
        lights.push_back(direction_from_degrees(static_cast<float>(20 * i), 200));
    std::vector<Image> images;
    for (std::size_t light = 0; light < 3; ++light)
        for (std::size_t view = 0; view < 4; ++view) {
            Image image = test::weave(48, 48, 8, 10 * light + view);
            const float scale = std::array{0.1F, 0.4F, 1.0F}[(light + view) % 3];
            for (float& value : image.values()) value *= scale;
            images.push_back(std::move(image));
        }
    return SyntheticMeasurement(std::move(views), std::move(lights), std::move(images));
}

TEST(Analyse, FindsThePlantedSubspacesOfABtf) {
    const auto measurement = planted_btf();
    const auto analysis = analysed(measurement, {.subspaces = 3});
    const Material& material = analysis.material;
    ASSERT_EQ(material.subspaces.size(), 3U);
    ASSERT_EQ(material.index.size(), 12U);
    EXPECT_EQ(material.views, measurement.info().views);
    for (const IndexEntry& a : material.index) {
        for (const IndexEntry& b : material.index)
            EXPECT_EQ((a.light + a.view) % 3 == (b.light + b.view) % 3,
                      a.subspace == b.subspace);
        EXPECT_EQ(
            nearest_subspace(material, material.views[a.view], material.lights[a.light]),
            a.subspace);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Subspace& subspace = material.subspaces[k];
        EXPECT_EQ(subspace.members, 4U);
        const Observation& observation =
            measurement.info().observations[analysis.representatives[k]];
        EXPECT_EQ(subspace.view, observation.view);
        EXPECT_EQ(subspace.light, observation.light);
        EXPECT_LT(delta_e_76(mean_colour(textured(material, 64, true, k)),
                             mean_colour(*measurement.read(analysis.representatives[k]))),
                  1);
        // All are driven by the same noise, so their factors must point the same way.
        for (std::size_t row = 0; row < 3; ++row) {
            double product = 0;
            for (std::size_t i = 0; i < 3; ++i)
                product +=
                    static_cast<double>(subspace.spectral.T[3 * row + i]) *
                    static_cast<double>(material.subspaces[0].spectral.T[3 * row + i]);
            EXPECT_GT(product, 0);
        }
    }
}

double correlation(PlaneView<const float> a, PlaneView<const float> b) {
    double aa = 0;
    double bb = 0;
    double ab = 0;
    double mean_a = 0;
    double mean_b = 0;
    const auto n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        mean_a += static_cast<double>(a.data[i]) / n;
        mean_b += static_cast<double>(b.data[i]) / n;
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double x = static_cast<double>(a.data[i]) - mean_a;
        const double y = static_cast<double>(b.data[i]) - mean_b;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    return ab / std::sqrt(aa * bb);
}

/// The bands of a plane: fine detail, and what is coarser than it by an octave or more.
Image fine_and_coarse(PlaneView<const float> plane) {
    SerialExecutor executor;
    Image parts(3, plane.rows, plane.cols);
    split_band(plane, 1, Border::wrap, parts.plane(0), parts.plane(1), executor);
    const Image low = parts;
    split_band(low.plane(1), 2, Border::wrap, parts.plane(2), parts.plane(1), executor);
    return parts;
}

/// How the amplitude of fine detail goes with what is coarser.
double coupling(PlaneView<const float> plane) {
    Image parts = fine_and_coarse(plane);
    for (std::size_t i = 0; i < plane.size(); ++i)
        parts.plane(0).data[i] = std::abs(parts.plane(0).data[i]);
    return correlation(parts.plane(0), parts.plane(1));
}

/// Pictures by two views and three lights of one surface that is rough where it is high; under
/// the last light high is dark.
SyntheticMeasurement btf_of_varying_roughness(std::size_t side) {
    Image noise(1, side, side);
    for (std::size_t r = 0; r < side; ++r)
        draw_normals({5, 0}, static_cast<std::int32_t>(r), 0,
                     {noise.plane(0).row(r), side});
    const Image parts = fine_and_coarse(noise.plane(0));
    std::vector<Image> images;
    for (const float contrast : {0.25F, 0.12F, -0.2F})
        for (const float tint : {1.0F, 0.8F}) {
            Image& image = images.emplace_back(3, side, side);
            for (std::size_t i = 0; i < image.plane_size(); ++i) {
                const float coarse = 10 * parts.plane(1).data[i];
                const float height =
                    0.7F * coarse + parts.plane(0).data[i] * std::exp2(0.8F * coarse);
                for (std::size_t b = 0; b < 3; ++b)
                    image.plane(b).data[i] =
                        0.3F * std::exp(contrast * height) * (b == 2 ? tint : 1.0F);
            }
        }
    return SyntheticMeasurement({{0, 0}, {0.6F, 0}}, {{0, 0}, {0.5F, 0}, {1.0F, 2}},
                                std::move(images));
}

TEST(Analyse, ModulatesEverySubspaceOfABtfAsItsPicturesAre) {
    constexpr std::size_t kSide = 256;
    const auto measurement = btf_of_varying_roughness(kSide);
    const auto analysis = analysed(measurement, {.subspaces = 3});
    const Material& material = analysis.material;
    ASSERT_TRUE(material.modulation);
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        ASSERT_TRUE(material.subspaces[k].modulation) << k;
        const Image seen = *measurement.read(analysis.representatives[k]);
        const double wanted = coupling(seen.plane(0));
        const double drawn = coupling(textured(material, kSide, true, k).plane(0));
        // Under the last light it has the other sign.
        EXPECT_GT(std::abs(wanted), 0.2) << k;
        // Without modulation 0.35, 0.41 and 0.02 of 0.57, 0.49 and -0.27.
        EXPECT_NEAR(drawn, wanted, 0.16) << k;
    }
}

TEST(Analyse, GivesTheSameMaterialForAnyNumberOfThreads) {
    const auto measurement = planted_btf();
    const auto expected = analysed(measurement, {.subspaces = 3});
    for (const std::size_t count : {2U, 3U}) {
        test::ThreadedExecutor threads(count);
        Progress progress;
        const auto got = analyse(measurement, {.subspaces = 3}, threads, progress);
        ASSERT_TRUE(got);
        EXPECT_TRUE(got->material == expected.material);
    }
}

TEST(Analyse, StopsAtOrSkipsUnreadableImages) {
    SerialExecutor executor;
    Progress progress;
    auto btf = planted_btf();
    btf.damage(5);
    const auto failed = analyse(btf, {.subspaces = 3}, executor, progress);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().message, "image 5: damaged");
    const auto skipped = analysed(btf, {.subspaces = 3, .skip_bad = true});
    EXPECT_EQ(skipped.material.index.size(), 11U);
    EXPECT_THAT(skipped.notes, testing::ElementsAre("skipped image 5: damaged"));

    SyntheticMeasurement photographs({test::discs(32, 32, 1), test::discs(32, 32, 2)});
    photographs.damage(0);
    ASSERT_FALSE(analyse(photographs, {}, executor, progress));
    const auto rest = analysed(photographs, {.skip_bad = true});
    EXPECT_THAT(rest.notes, testing::ElementsAre("subspace 0: skipped image 0: damaged"));
    photographs.damage(1);
    const auto none = analyse(photographs, {.skip_bad = true}, executor, progress);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().message, "no readable image in synthetic");
}

TEST(Analyse, StopsWhenCancelled) {
    SerialExecutor executor;
    test::CancelAfter at_once(0);
    const auto result = analyse(planted_btf(), {.subspaces = 3}, executor, at_once);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::cancelled);
}

TEST(Analyse, PaperModeIsThePrintedModel) {
    const Image sample = test::discs(128, 128, 6);
    const auto analysis = analysed(SyntheticMeasurement({sample}), {.paper = true});
    const Material& material = analysis.material;
    EXPECT_EQ(material.drawing, Drawing::recursive);
    const Subspace& subspace = material.subspaces.at(0);
    ASSERT_EQ(subspace.levels.size(), 3U);
    for (const Marginal& marginal : subspace.marginals)
        EXPECT_TRUE(marginal.knots.empty());
    const std::vector<Offset> printed = {{0, 1}, {1, 0}, {1, 1}};
    for (std::size_t level = 0; level < 3; ++level) {
        for (std::size_t plane = 0; plane < 3; ++plane) {
            EXPECT_EQ(car2d(subspace, level, plane).neighbourhood, printed);
            EXPECT_LT(spectral_radius(car2d(subspace, level, plane)), 1);
        }
    }
    // No power compensation: the fields are those of the ordinary Laplacian bands.
    std::vector<reference::DoublePlane> planes;
    reference::DoublePlane plane(128, 128);
    for (std::size_t i = 0; i < plane.values.size(); ++i) {
        double value = 0;
        for (std::size_t band = 0; band < 3; ++band)
            value += static_cast<double>(subspace.spectral.T[band]) *
                     (srgb_encode(static_cast<double>(sample.plane(band).data[i])) -
                      static_cast<double>(subspace.spectral.mean[band]));
        plane.values[i] = value / static_cast<double>(subspace.marginals[0].scale);
    }
    const auto bands = reference::decompose(plane, 3);
    for (std::size_t level = 0; level < 3; ++level) {
        const Image band = reference::to_image(bands[level]);
        const auto expected =
            estimate_car2d(interior_normal_equations(band.plane(0), printed));
        ASSERT_TRUE(expected);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(static_cast<double>(car2d(subspace, level, 0).a[i]),
                        static_cast<double>(expected->model.a[i]), 1e-4);
        EXPECT_NEAR(static_cast<double>(car2d(subspace, level, 0).variance /
                                        expected->model.variance),
                    1, 1e-3);
    }
}

TEST(ChooseLevels, LeavesTheCoarsestLevelSixteenPixels) {
    const std::array<std::pair<std::size_t, std::size_t>, 8> expected = {
        {{1, 1}, {31, 1}, {32, 2}, {64, 3}, {128, 4}, {255, 4}, {256, 5}, {4000, 5}}};
    for (const auto& [side, levels] : expected)
        EXPECT_EQ(choose_levels(side, {}), levels) << side;
    EXPECT_EQ(choose_levels(4000, {.paper = true}), 3U);
    EXPECT_EQ(choose_levels(32, {.paper = true}), 2U);
    EXPECT_EQ(choose_levels(4000, {.levels = 8}), 8U);
    EXPECT_EQ(choose_levels(32, {.levels = 8}), 5U);
    EXPECT_EQ(choose_levels(1, {.levels = 8}), 1U);
}

}  // namespace
}  // namespace sateen
