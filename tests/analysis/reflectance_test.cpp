// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/reflectance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sateen/analysis/analyse.hpp"
#include "sateen/material/file.hpp"
#include "support/directions.hpp"
#include "support/synthetic_measurement.hpp"

namespace sateen {
namespace {

using test::ubo2003_directions;

double uniform(std::mt19937_64& engine) {
    return static_cast<double>(engine() >> 11U) * 0x1p-53;
}

TEST(ImageMoments, AreThoseOfTheDefinition) {
    std::mt19937_64 engine(1);
    for (const std::size_t bands : {1U, 3U}) {
        Image image(bands, 37, 53);
        for (float& v : image.values())
            v = static_cast<float>(uniform(engine) * uniform(engine));
        const ImageMoments m = image_moments(image.view());
        const std::array<double, 3> weight = {0.21263900587151036, 0.71516867876775593,
                                              0.072192315360733715};
        std::array<double, 3> mean{};
        double Y = 0;
        double YY = 0;
        for (std::size_t i = 0; i < image.plane_size(); ++i) {
            double luminance = 0;
            for (std::size_t b = 0; b < bands; ++b) {
                const double v =
                    static_cast<double>(image.values()[b * image.plane_size() + i]);
                mean[b] += v;
                luminance += bands == 1 ? v : weight[b] * v;
            }
            Y += luminance;
            YY += luminance * luminance;
        }
        const auto n = static_cast<double>(image.plane_size());
        for (std::size_t b = 0; b < bands; ++b) EXPECT_NEAR(m.mean[b], mean[b] / n, 1e-6);
        EXPECT_NEAR(m.luminance, Y / n, 1e-6);
        EXPECT_NEAR(m.deviation, std::sqrt(YY / n - Y * Y / n / n), 1e-5);
    }
}

// A glossy, slightly anisotropic material of known mean colour and contrast.
EncodedAppearance truth(Direction view, Direction light) {
    const auto v = to_vector(view);
    const auto l = to_vector(light);
    const float cosine = v[0] * l[0] + v[1] * l[1] + v[2] * l[2];
    const float h = (l[2] + v[2]) / std::sqrt(2 + 2 * cosine);
    const float gloss = 0.15F * std::pow(h, 20.0F);
    const float sheen = 1 + 0.1F * l[0] * l[0] - 0.1F * v[1];
    EncodedAppearance e{};
    const std::array<float, 3> albedo = {0.5F, 0.3F, 0.1F};
    for (std::size_t c = 0; c < 3; ++c)
        e[c] = std::cbrt(l[2] * (albedo[c] * sheen + gloss));
    e[3] = 0.2F + 0.3F * (1 - l[2]);
    return e;
}

struct Scene {
    std::vector<Direction> directions = ubo2003_directions();
    AppearanceGrid grid{directions, directions, 4, true};

    std::vector<MeasuredAppearance> known(double share, std::uint64_t seed) const {
        std::mt19937_64 engine(seed);
        std::vector<MeasuredAppearance> out;
        for (std::size_t l = 0; l < 81; ++l)
            for (std::size_t v = 0; v < 81; ++v)
                if (uniform(engine) < share)
                    out.push_back({v, l, truth(directions[v], directions[l])});
        return out;
    }
};

// Root mean square over all pairs of the three colours, and of the contrast.
std::array<double, 2> errors(const Scene& scene, const std::vector<float>& table) {
    std::array<double, 2> sum{};
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v) {
            const auto e = truth(scene.directions[v], scene.directions[l]);
            for (std::size_t c = 0; c < 4; ++c) {
                const double d = static_cast<double>(table[(l * 81 + v) * 4 + c] - e[c]);
                sum[c / 3] += d * d;
            }
        }
    return {std::sqrt(sum[0] / (3 * 6561)), std::sqrt(sum[1] / 6561)};
}

TEST(CompleteAppearance, KeepsACompleteTable) {
    const Scene scene;
    const auto table = complete_appearance(scene.grid, scene.known(2, 0));
    ASSERT_TRUE(table);
    EXPECT_EQ(errors(scene, *table)[0], 0);
}

TEST(CompleteAppearance, PredictsWhatWasLeftOut) {
    const Scene scene;
    double before = 1;
    for (const double share : {0.01, 0.1, 0.5}) {
        const auto table = complete_appearance(scene.grid, scene.known(share, 3));
        ASSERT_TRUE(table);
        const auto [colour, contrast] = errors(scene, *table);
        EXPECT_LT(colour, share < 0.05 ? 0.03 : 0.006) << share;
        EXPECT_LT(contrast, 0.03) << share;
        EXPECT_LT(colour, before);
        before = colour;
    }
}

TEST(CompleteAppearance, OnePairIsALambertianMaterial) {
    const Scene scene;
    const std::vector<MeasuredAppearance> one = {{20, 30, {0.5F, 0.4F, 0.3F, 0.2F}}};
    const auto table = complete_appearance(scene.grid, one);
    ASSERT_TRUE(table);
    const float at = std::cos(scene.directions[30].theta);
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v) {
            const float* e = table->data() + (l * 81 + v) * 4;
            const float expected = 0.125F * std::cos(scene.directions[l].theta) / at;
            EXPECT_NEAR(e[0] * e[0] * e[0], expected, 2e-4);
            EXPECT_NEAR(e[3], 0.2F, 1e-4);
        }
}

TEST(CompleteAppearance, RefusesNothingAndTooMuch) {
    const Scene scene;
    EXPECT_FALSE(complete_appearance(scene.grid, {}));
    const std::vector<Direction> many(600);
    const AppearanceGrid grid{many, many, 4, true};
    EXPECT_FALSE(complete_appearance(grid, scene.known(0.01, 1)));
}

TEST(FactoriseAppearance, RecoversATableOfItsRank) {
    const Scene scene;
    std::mt19937_64 engine(5);
    const std::size_t columns = 81 * 4;
    std::vector<double> a(81 * 3);
    std::vector<double> b(columns * 3);
    for (double& x : a) x = uniform(engine) - 0.5;
    for (double& x : b) x = uniform(engine) - 0.5;
    std::vector<float> table(81 * columns);
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t c = 0; c < columns; ++c)
            for (std::size_t k = 0; k < 3; ++k)
                table[l * columns + c] += static_cast<float>(a[l * 3 + k] * b[c * 3 + k]);
    const Reflectance r =
        factorise_appearance(scene.grid, table, {.rank = 16, .tolerance = 1e-5});
    // Rounding the light factors costs components that correct it.
    EXPECT_GE(r.rank, 3U);
    EXPECT_LE(r.rank, 4U);
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v)
            for (std::size_t c = 0; c < 4; ++c)
                EXPECT_NEAR(encoded_appearance(r, v, l)[c], table[(l * 81 + v) * 4 + c],
                            0.01);
}

TEST(FactoriseAppearance, AGlossyMaterialTakesFewComponents) {
    const Scene scene;
    const auto table = complete_appearance(scene.grid, scene.known(2, 0));
    ASSERT_TRUE(table);
    const Reflectance r = factorise_appearance(scene.grid, *table);
    EXPECT_LE(r.rank, 16U);
    std::vector<float> again;
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v)
            for (const float e : encoded_appearance(r, v, l)) again.push_back(e);
    EXPECT_LT(errors(scene, again)[0], 0.004);
}

// Uniform images, half of them unreadable: the material knows the colour of each.
TEST(Analyse, KeepsTheColourOfEveryPairOfDirections) {
    std::vector<Direction> views;
    for (const int phi : {0, 90, 180, 270})
        views.push_back(direction_from_degrees(40, static_cast<float>(phi)));
    views.push_back({});
    const auto lights = views;
    std::vector<Image> images;
    std::mt19937_64 engine(9);
    for (const Direction light : lights)
        for (const Direction view : views) {
            const auto e = truth(view, light);
            Image image(3, 32, 32);
            for (std::size_t i = 0; i < image.plane_size(); ++i) {
                const auto texture = static_cast<float>(0.5 + uniform(engine));
                for (std::size_t b = 0; b < 3; ++b)
                    image.values()[b * image.plane_size() + i] =
                        texture * e[b] * e[b] * e[b];
            }
            images.push_back(std::move(image));
        }
    const test::SyntheticMeasurement measurement(views, lights, std::move(images));
    AnalysisOptions options;
    options.subspaces = 2;
    SerialExecutor executor;
    Progress progress;
    const auto analysis = analyse(measurement, options, executor, progress);
    ASSERT_TRUE(analysis) << analysis.error().message;
    const auto payload = write_material(analysis->material);
    ASSERT_TRUE(payload) << payload.error().message;
    const auto material = read_material(*payload);
    ASSERT_TRUE(material && material->reflectance);
    for (std::size_t l = 0; l < 5; ++l)
        for (std::size_t v = 0; v < 5; ++v) {
            const auto found = encoded_appearance(*material->reflectance, v, l);
            const auto e = truth(views[v], lights[l]);
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], e[c], 0.01);
            EXPECT_NEAR(found[3], 1 / std::sqrt(12.0), 0.03);
        }
    options.paper = true;
    const auto paper = analyse(measurement, options, executor, progress);
    ASSERT_TRUE(paper);
    EXPECT_FALSE(paper->material.reflectance);
}

}  // namespace
}  // namespace sateen
