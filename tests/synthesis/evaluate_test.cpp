// SPDX-License-Identifier: Apache-2.0
// Interpolation over directions and the value of a material at a point.
#include "sateen/synthesis/evaluate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "sateen/synthesis/synthesise.hpp"
#include "sateen/synthesis/synthesise_direction.hpp"
#include "support/directions.hpp"
#include "support/materials.hpp"

namespace sateen {
namespace {

using Vec = std::array<float, 3>;
using test::ubo2003_directions;

Vec at(float theta, float phi) {
    return to_vector(direction_from_degrees(theta, phi));
}

// A texture of mean `mean` and deviation `scale`, smooth enough to have its own look.
Subspace subspace(float mean, float scale) {
    Subspace s;
    s.spectral = {Tone::linear, {mean}, {1}};
    s.marginals = {{scale, {}}};
    s.levels = test::levels_of({Car2d{{{0, 1}, {1, 0}}, {0.6F, 0.3F}, 1}});
    return s;
}

// A grey material on the UBO2003 grid: subspace 0 for lights up to 30°, 1 for the others.
Material two_subspaces(float scale) {
    Material m = test::plain_material({Car2d{}});
    m.views = ubo2003_directions();
    m.lights = ubo2003_directions();
    m.subspaces = {subspace(0.5F, scale), subspace(0.25F, scale)};
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v)
            m.index.push_back({static_cast<std::uint16_t>(l),
                               static_cast<std::uint16_t>(v),
                               static_cast<std::uint8_t>(l < 19 ? 0 : 1)});
    return m;
}

// Mean colour cos θ_l · albedo, contrast as given: rank 1 in cube roots.
Reflectance lambertian(const Material& m, float albedo, float contrast) {
    Reflectance r;
    r.channels = 2;
    r.rank = 1;
    for (std::size_t v = 0; v < m.views.size(); ++v) {
        r.base.insert(r.base.end(), {0, contrast});
        r.views.insert(r.views.end(), {std::cbrt(albedo), 0});
    }
    for (const Direction l : m.lights) r.lights.push_back(std::cbrt(std::cos(l.theta)));
    return r;
}

Evaluator evaluator_of(const Material& m, EvaluatorOptions options = {.side = 64}) {
    SerialExecutor executor;
    Progress progress;
    auto evaluator = Evaluator::create(m, options, executor, progress);
    EXPECT_TRUE(evaluator) << evaluator.error().message;
    return *std::move(evaluator);
}

struct Moments {
    double mean = 0;
    double deviation = 0;
};

Moments moments_over_texture(const Evaluator& e, const Vec& view, const Vec& light) {
    const auto directional = e.prepare(view, light);
    const auto n = static_cast<double>(e.side() * e.side());
    double sum = 0;
    double squares = 0;
    for (std::size_t r = 0; r < e.side(); ++r)
        for (std::size_t c = 0; c < e.side(); ++c) {
            const auto side = static_cast<float>(e.side());
            const auto value = static_cast<double>(
                e.sample(directional, (static_cast<float>(c) + 0.5F) / side,
                         -(static_cast<float>(r) + 0.5F) / side)[0]);
            sum += value;
            squares += value * value;
        }
    return {sum / n, std::sqrt(squares / n - sum * sum / n / n)};
}

TEST(Interpolation, MergesEqualSubspacesAndItsWeightsAddUp) {
    const Evaluator e = evaluator_of(two_subspaces(0.05F));
    std::mt19937_64 engine(1);
    for (int i = 0; i < 20000; ++i) {
        const auto angle = [&](double top) {
            return static_cast<float>(top * static_cast<double>(engine() >> 11U) *
                                      0x1p-53);
        };
        const Vec view = at(angle(90), angle(360));
        const Vec light = at(angle(90), angle(360));
        const Blend blend = e.prepare(view, light).blend;
        ASSERT_GE(blend.count, 1U);
        ASSERT_LE(blend.count, 2U);
        float sum = 0;
        for (std::size_t k = 0; k < blend.count; ++k) {
            ASSERT_GT(blend.weight[k], 0);
            sum += blend.weight[k];
        }
        ASSERT_NEAR(sum, 1, 1e-4);
    }
    EXPECT_EQ(e.prepare(at(0, 0), at(10, 20)).blend.count, 1U);
    EXPECT_EQ(e.prepare(at(0, 0), at(37, 20)).blend.count, 2U);
}

// algorithms h3: with noise of their own the textures' blend would lose half its contrast.
TEST(Interpolation, ABlendOfSubspacesKeepsTheirContrast) {
    const Evaluator e = evaluator_of(two_subspaces(0.05F));
    const double first = moments_over_texture(e, at(0, 0), at(0, 0)).deviation;
    const double second = moments_over_texture(e, at(0, 0), at(60, 0)).deviation;
    const double between = moments_over_texture(e, at(0, 0), at(37, 7)).deviation;
    EXPECT_GE(between * between, 0.9 * 0.5 * (first * first + second * second));
}

TEST(Interpolation, UnmeasuredPairsHaveTheSubspaceOfTheNearestMeasuredOne) {
    Material m = two_subspaces(0.05F);
    std::mt19937_64 engine(2);
    std::erase_if(m.index, [&](const IndexEntry&) { return engine() % 10 != 0; });
    const Evaluator e = evaluator_of(m);
    for (std::size_t l = 0; l < 81; ++l)
        for (std::size_t v = 0; v < 81; ++v) {
            const std::size_t expected = nearest_subspace(m, m.views[v], m.lights[l]);
            const std::size_t found = e.interpolation().index()[l * 81 + v];
            if (found == expected) continue;
            // Two pairs at equal distance.
            const auto closeness = [&](std::size_t k) {
                float best = -3;
                for (const IndexEntry& entry : m.index) {
                    if (entry.subspace != k) continue;
                    const Vec a = to_vector(m.views[v]);
                    const Vec b = to_vector(m.views[entry.view]);
                    const Vec c = to_vector(m.lights[l]);
                    const Vec d = to_vector(m.lights[entry.light]);
                    best = std::max(best, a[0] * b[0] + a[1] * b[1] + a[2] * b[2] +
                                              c[0] * d[0] + c[1] * d[1] + c[2] * d[2]);
                }
                return best;
            };
            EXPECT_NEAR(closeness(found), closeness(expected), 1e-5);
        }
}

TEST(Evaluate, HasTheMeanColourAndContrastOfTheReflectance) {
    Material m = two_subspaces(0.05F);
    m.reflectance = lambertian(m, 0.4F, 0.15F);
    const Evaluator e = evaluator_of(m);
    for (const float theta : {0.0F, 22.0F, 37.0F, 60.0F, 75.0F}) {
        const Moments found = moments_over_texture(e, at(20, 10), at(theta, 33));
        const double expected =
            0.4 * std::cos(static_cast<double>(theta) * std::numbers::pi / 180);
        EXPECT_NEAR(found.mean, expected, 0.001) << theta;
        EXPECT_NEAR(found.deviation / found.mean, 0.15, 0.003) << theta;
    }
}

// Uniform over the part of the hemisphere above `lowest`.
Vec random_direction(std::mt19937_64& engine, float lowest) {
    const auto uniform = [&] {
        return static_cast<float>(static_cast<double>(engine() >> 11U) * 0x1p-53);
    };
    const float z = lowest + (1 - lowest) * uniform();
    const float phi = 2 * std::numbers::pi_v<float> * uniform();
    const float r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<Vec> values_of(const Evaluator& e, const std::vector<ShadingPoint>& points) {
    std::vector<Vec> values(points.size());
    e.evaluate(points, values);
    return values;
}

// A third of the texture is black, as where cast shadows fall.
TEST(Evaluate, LowersContrastByAPowerThatKeepsMeanAndBlack) {
    Material m = two_subspaces(0.5F);
    for (Subspace& s : m.subspaces) s.spectral.mean = {0.2F};
    const auto black_and_mean = [&](float wanted) {
        m.reflectance = lambertian(m, 0.4F, wanted);
        const Evaluator e = evaluator_of(m);
        const auto directional = e.prepare(at(0, 0), at(0, 0));
        EXPECT_LT(directional.blend.power, 0.95F);
        float brightest = 0;
        std::size_t black = 0;
        for (std::size_t i = 0; i < 64 * 64; ++i) {
            if (e.texels(0)[4 * i] > 0) continue;
            ++black;
            const float u = (static_cast<float>(i % 64) + 0.5F) / 64;
            const float v = -(static_cast<float>(i / 64) + 0.5F) / 64;
            brightest = std::max(brightest, e.sample(directional, u, v)[0]);
        }
        EXPECT_GT(black, 64U * 64 / 4);
        return std::pair(brightest, moments_over_texture(e, at(0, 0), at(0, 0)));
    };
    const auto [black, shaped] = black_and_mean(0.98F);
    EXPECT_LT(black, 2e-3F);
    EXPECT_NEAR(shaped.mean, 0.4, 0.02);
    EXPECT_NEAR(shaped.deviation / shaped.mean, 0.98, 0.05);
    // No power of what is black or white has less contrast than the root.
    const auto [lifted, flat] = black_and_mean(0.1F);
    EXPECT_GT(lifted, 0.3F);
    EXPECT_NEAR(flat.mean, 0.4, 1e-3);
    EXPECT_NEAR(flat.deviation / flat.mean, 0.1, 1e-3);
}

TEST(Evaluate, APowerBringsContrastDownToWhatIsStored) {
    Material m = two_subspaces(0.1F);
    for (const float wanted : {0.03F, 0.1F, 0.15F, 0.199F}) {
        m.reflectance = lambertian(m, 0.4F, wanted);
        const Evaluator e = evaluator_of(m);
        // Between subspaces as well.
        for (const float theta : {0.0F, 37.0F}) {
            const Moments found = moments_over_texture(e, at(0, 0), at(theta, 7));
            const double mean =
                0.4 * std::cos(static_cast<double>(theta) * std::numbers::pi / 180);
            EXPECT_NEAR(found.mean, mean, 0.003 * mean);
            EXPECT_NEAR(found.deviation / found.mean, static_cast<double>(wanted),
                        0.02 * static_cast<double>(wanted));
        }
    }
}

// The power and the straight line meet where the blend has the contrast that is stored.
TEST(Evaluate, IsContinuousInTheContrastStored) {
    Material m = two_subspaces(0.1F);
    m.reflectance = lambertian(m, 0.4F, 0.2F);
    const Moments own = moments_over_texture(evaluator_of(m), at(0, 0), at(0, 0));
    const Evaluator plain = evaluator_of(two_subspaces(0.1F));
    const Moments texture = moments_over_texture(plain, at(0, 0), at(0, 0));
    const auto kappa = static_cast<float>(texture.deviation / texture.mean);
    ASSERT_GT(own.deviation, 0);
    m.reflectance = lambertian(m, 0.4F, kappa * 0.999F);
    const Evaluator below = evaluator_of(m);
    m.reflectance = lambertian(m, 0.4F, kappa * 1.001F);
    const Evaluator above = evaluator_of(m);
    EXPECT_LT(below.prepare(at(0, 0), at(0, 0)).blend.power, 1);
    EXPECT_EQ(above.prepare(at(0, 0), at(0, 0)).blend.power, 1);
    for (const float u : {0.05F, 0.3F, 0.41F, 0.77F, 0.9F})
        EXPECT_NEAR(below.evaluate({u, 0.2F, at(0, 0), at(0, 0)})[0],
                    above.evaluate({u, 0.2F, at(0, 0), at(0, 0)})[0], 2e-3F);
}

TEST(Evaluate, AWhitePlateStaysWhite) {
    Material m = two_subspaces(0);
    for (Subspace& s : m.subspaces) s.spectral.mean = {1};
    m.reflectance = lambertian(m, 1, 0);
    const Evaluator e = evaluator_of(m);
    for (const float theta : {0.0F, 15.0F, 45.0F, 75.0F, 82.0F, 89.0F}) {
        const float cosine = std::cos(theta * kRadiansPerDegree);
        for (const float u : {0.0F, 0.3F, -7.7F})
            EXPECT_NEAR(e.evaluate({u, 0.1F, at(30, 80), at(theta, 18)})[0], cosine,
                        2e-3F)
                << theta;
    }
    std::mt19937_64 engine(5);
    std::vector<ShadingPoint> points;
    for (int i = 0; i < 100000; ++i)
        points.push_back({0.01F * static_cast<float>(i), 0.3F,
                          random_direction(engine, 0.01F),
                          random_direction(engine, 0.01F)});
    const std::vector<Vec> values = values_of(e, points);
    for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_NEAR(values[i][0], points[i].light[2], 2e-3F);
    EXPECT_EQ(e.evaluate({0, 0, at(0, 0), {1, 0, 0}})[0], 0);
    EXPECT_EQ(e.evaluate({0, 0, at(0, 0), {0, 0, -1}})[0], 0);
}

// f(l, v) = value / cos θ_l of a million pairs, between directions and past the rim.
TEST(Evaluate, ALambertianMaterialIsReciprocalAndReflectsItsAlbedo) {
    Material m = two_subspaces(0.05F);
    m.reflectance = lambertian(m, 0.8F, 0);
    const Evaluator e = evaluator_of(m);
    std::mt19937_64 engine(3);
    std::vector<ShadingPoint> there;
    std::vector<ShadingPoint> back;
    for (int i = 0; i < 1000000; ++i) {
        const Vec a = random_direction(engine, 0.05F);
        const Vec b = random_direction(engine, 0.05F);
        there.push_back({0.5F, 0.25F, a, b});
        back.push_back({0.5F, 0.25F, b, a});
    }
    const std::vector<Vec> forth = values_of(e, there);
    const std::vector<Vec> reverse = values_of(e, back);
    float worst = 0;
    float furthest = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
        const float f = forth[i][0] / there[i].light[2];
        worst = std::max(worst, std::abs(f - reverse[i][0] / back[i].light[2]));
        furthest = std::max(furthest, std::abs(f - 0.8F));
    }
    EXPECT_LT(worst, 2e-3F);
    EXPECT_LT(furthest, 2e-3F);
    // ∫ value dω / π over the hemisphere of lights, by the midpoint rule.
    for (const float theta : {0.0F, 30.0F, 60.0F, 85.0F}) {
        std::vector<ShadingPoint> points;
        constexpr int kSteps = 100;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const float z = (static_cast<float>(i) + 0.5F) / kSteps;
                const float phi = 360 * (static_cast<float>(j) + 0.5F) / kSteps;
                points.push_back({0.1F, 0.2F, at(theta, 20),
                                  at(std::acos(z) / kRadiansPerDegree, phi)});
            }
        double sum = 0;
        for (const Vec& value : values_of(e, points))
            sum += static_cast<double>(value[0]);
        EXPECT_NEAR(2 * sum / (kSteps * kSteps), 0.8, 0.002) << theta;
    }
}

// Steps of a hundredth of a degree, across the borders of triangles and the rim: what a
// value changes by is in proportion.
TEST(Evaluate, IsContinuousInDirections) {
    Material m = two_subspaces(0.05F);
    m.reflectance = lambertian(m, 0.8F, 0.2F);
    // Neighbours differ as much as the encoding lets them.
    std::mt19937_64 engine(4);
    for (float& base : m.reflectance->base)
        base += 0.2F * static_cast<float>(static_cast<double>(engine() >> 11U) * 0x1p-53);
    const Evaluator e = evaluator_of(m);
    constexpr float kStep = 1.7e-4F;
    std::vector<ShadingPoint> here;
    std::vector<ShadingPoint> near;
    for (int i = 0; i < 200000; ++i) {
        const ShadingPoint p = {0.3F, 0.4F, random_direction(engine, 0.02F),
                                random_direction(engine, 0.02F)};
        ShadingPoint q = p;
        for (Vec* d : {&q.view, &q.light}) {
            const Vec step = random_direction(engine, 0);
            float length = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                (*d)[c] += kStep * step[c];
                length += (*d)[c] * (*d)[c];
            }
            for (float& x : *d) x /= std::sqrt(length);
        }
        here.push_back(p);
        near.push_back(q);
    }
    const std::vector<Vec> a = values_of(e, here);
    const std::vector<Vec> b = values_of(e, near);
    float most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(a[i][0] - b[i][0]));
    EXPECT_LT(most, 0.01F);
}

TEST(Evaluate, WithoutReflectanceItIsTheTexture) {
    const Material m = two_subspaces(0.05F);
    const Evaluator e = evaluator_of(m);
    SerialExecutor executor;
    Progress progress;
    SynthesisOptions options;
    options.rows = options.cols = 64;
    options.tileable = true;
    const auto texture = synthesise(m, 1, options, executor, progress);
    ASSERT_TRUE(texture);
    for (std::size_t r = 0; r < 64; r += 5)
        for (std::size_t c = 0; c < 64; c += 7)
            EXPECT_NEAR(e.evaluate({(static_cast<float>(c) + 0.5F) / 64,
                                    -(static_cast<float>(r) + 0.5F) / 64, at(15, 0),
                                    at(60, 18)})[0],
                        (*texture)(0, r, c), 1e-4);
}

TEST(Evaluate, PhotographsAreLitByTheCosine) {
    Material m = test::plain_material({Car2d{}});
    m.subspaces = {subspace(0.5F, 0)};
    const Evaluator e = evaluator_of(m);
    EXPECT_NEAR(e.evaluate({0, 0, at(40, 0), at(60, 0)})[0], 0.25F, 1e-4);
}

TEST(Evaluate, OneLightAnswersForAllByTheCosine) {
    Material m = two_subspaces(0);
    m.lights = {direction_from_degrees(30, 0)};
    std::erase_if(m.index, [](const IndexEntry& entry) { return entry.light != 0; });
    const Evaluator e = evaluator_of(m);
    EXPECT_NEAR(e.evaluate({0, 0, at(0, 0), at(30, 0)})[0], 0.5F, 1e-4);
    EXPECT_NEAR(e.evaluate({0, 0, at(0, 0), at(60, 90)})[0],
                0.5F * 0.5F / std::cos(30 * kRadiansPerDegree), 1e-4);
}

// The formula as the theory has it, in double, from the public parts.
TEST(Interpolation, BlendsAreThoseOfTheFormula) {
    Material m = two_subspaces(0.1F);
    m.reflectance = lambertian(m, 0.6F, 0.2F);
    const Evaluator e = evaluator_of(m);
    const DirectionMesh& views = *e.interpolation().views();
    const DirectionMesh& lights = *e.interpolation().lights();
    std::mt19937_64 engine(6);
    for (int i = 0; i < 20000; ++i) {
        const Vec view = random_direction(engine, 0.02F);
        const Vec light = random_direction(engine, 0.02F);
        const Blend found = e.prepare(view, light).blend;
        const DirectionWeights v = views.interpolate(view);
        const DirectionWeights l = lights.interpolate(light);
        std::array<double, 2> weight{};
        double root = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            const auto share = static_cast<double>(l.weight[j]);
            root += share *
                    std::cbrt(static_cast<double>(to_vector(m.lights[l.index[j]])[2]));
            for (std::size_t k = 0; k < 3; ++k)
                weight[e.interpolation().index()[l.index[j] * 81U + v.index[k]]] +=
                    share * static_cast<double>(v.weight[k]);
        }
        for (std::size_t k = 0; k < found.count; ++k)
            ASSERT_NEAR(found.weight[k], weight[found.subspace[k]], 2e-5);
        const auto encoded =
            static_cast<double>(encoded_appearance(*m.reflectance, v, l)[0]);
        const double target =
            std::min(4.0, static_cast<double>(light[2]) / (root * root * root)) *
            encoded * encoded * encoded;
        // The mean of the blend is brought to the target: by a line where the power is 1.
        if (found.power != 1) continue;
        const double mean = 0.5 * weight[0] + 0.25 * weight[1];
        ASSERT_NEAR(static_cast<double>(found.offset[0]) +
                        static_cast<double>(found.gain[0]) * mean,
                    target, 0.02 * target);
    }
}

TEST(Evaluate, ABatchGivesTheSameAsItsPoints) {
    Material m = two_subspaces(0.05F);
    m.reflectance = lambertian(m, 0.8F, 0.2F);
    const Evaluator e = evaluator_of(m);
    std::vector<ShadingPoint> points;
    for (int i = 0; i < 100; ++i) {
        const auto t = static_cast<float>(i);
        points.push_back({0.1F * t, -0.3F * t, at(t * 0.8F, t), at(60, 5 * (t / 10))});
    }
    std::vector<Vec> values(points.size());
    e.evaluate(points, values);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(values[i][0], e.evaluate(points[i])[0], 1e-5F);
}

// Ridges along y: a relief whose normals are known.
Material ridged() {
    Material m = two_subspaces(0.02F);
    m.reflectance = lambertian(m, 0.5F, 0.08F);
    Image tile(1, 32, 32);
    for (std::size_t r = 0; r < 32; ++r)
        for (std::size_t c = 0; c < 32; ++c)
            tile(0, r, c) =
                std::sin(static_cast<float>(c) * std::numbers::pi_v<float> / 8);
    const std::vector<Image> tiles = {tile};
    m.surface = *quantise_surface(tiles, 0.001F);
    m.surface->delit = true;
    m.surface->ambient = 0.1F;
    return m;
}

TEST(Evaluate, CountsBrightnessOnceWhenRelit) {
    const Evaluator e = evaluator_of(ridged());
    for (const auto& light : {at(0, 0), at(45, 0), at(45, 90), at(60, 180)}) {
        const Moments found = moments_over_texture(e, at(0, 0), light);
        EXPECT_NEAR(found.mean, 0.5 * static_cast<double>(light[2]), 0.005);
        // On a torus of 64 pixels texture and ridges are not quite independent.
        EXPECT_NEAR(found.deviation / found.mean, 0.08, 0.015);
    }
}

TEST(Evaluate, RidgesShowLitFromTheSideAndNotAlong) {
    Material m = ridged();
    m.reflectance.reset();
    const Evaluator e = evaluator_of(m);
    const auto contrast = [&](const Vec& light) {
        const Moments found = moments_over_texture(e, at(0, 0), light);
        return found.deviation / found.mean;
    };
    EXPECT_GT(contrast(at(45, 0)), 3 * contrast(at(45, 90)));
    // Slopes that face a light from +x are on the side of falling heights.
    const auto lit = e.prepare(at(0, 0), at(45, 0));
    EXPECT_GT(e.sample(lit, 8.0F / 64, 0.5F)[0], e.sample(lit, 0.0F, 0.5F)[0]);
}

TEST(Evaluate, WhatTheLampDoesNotReachIsLitFromElsewhere) {
    Material m = ridged();
    m.reflectance.reset();
    EvaluatorOptions options{.side = 64};
    options.relief = Relief::marched;
    options.self_shadow = true;
    const auto darkest = [&](float ambient) {
        m.surface->ambient = ambient;
        const Evaluator e = evaluator_of(m, options);
        const auto lit = e.prepare(at(0, 0), at(80, 0));
        float least = 1;
        for (int i = 0; i < 64; ++i)
            least = std::min(least, e.sample(lit, static_cast<float>(i) / 64, 0.5F)[0]);
        return least /
               static_cast<float>(moments_over_texture(e, at(0, 0), at(80, 0)).mean);
    };
    // The texture varies by less than a tenth; cast shadows take a part of the mean.
    EXPECT_EQ(darkest(0), 0);
    EXPECT_NEAR(darkest(0.25F), 0.25 / 1.25, 0.06);
}

TEST(Evaluate, MarchingFindsThePointUnderTheRay) {
    const Material m = ridged();
    EvaluatorOptions options{.side = 64};
    options.relief = Relief::marched;
    const Evaluator marched = evaluator_of(m, options);
    // From straight above nothing moves.
    const Evaluator flat = evaluator_of(m);
    const auto a = marched.prepare(at(0, 0), at(30, 0));
    const auto b = flat.prepare(at(0, 0), at(30, 0));
    for (const float u : {0.1F, 0.2F, 0.7F})
        EXPECT_NEAR(marched.sample(a, u, 0.3F)[0], flat.sample(b, u, 0.3F)[0], 1e-5);
    // A top (height 1 pixel at column 4.5) is seen displaced by tan 45° pixels.
    const auto c = marched.prepare(at(45, 0), at(30, 0));
    const auto d = flat.prepare(at(45, 0), at(30, 0));
    const float top = 4.5F / 64;
    EXPECT_NEAR(marched.sample(c, top - 1.0F / 64, 0.3F)[0], flat.sample(d, top, 0.3F)[0],
                0.01);
}

TEST(SynthesiseDirection, ScatteredSetsOfVeryManyPairsHaveTheNearest) {
    Material m = two_subspaces(0.05F);
    m.views.clear();
    m.index.clear();
    for (std::size_t i = 0; i < 1200; ++i) {
        const auto t = static_cast<float>(i);
        m.views.push_back(direction_from_degrees(0.06F * t, 7 * std::fmod(t, 50.0F)));
        m.index.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(i),
                           static_cast<std::uint8_t>(i % 2)});
    }
    m.lights = m.views;
    SerialExecutor executor;
    for (const std::size_t i : {0U, 77U, 1001U}) {
        const auto lit = lit_blend(m, m.views[i], m.lights[i], {}, executor);
        ASSERT_TRUE(lit) << lit.error().message;
        EXPECT_EQ(lit->blend.count, 1U);
        EXPECT_EQ(lit->blend.subspace[0], i % 2);
    }
}

TEST(SynthesiseDirection, WindowsOfABlendAgreeWithTheEvaluator) {
    Material m = two_subspaces(0.05F);
    m.reflectance = lambertian(m, 0.6F, 0.1F);
    SerialExecutor executor;
    Progress progress;
    const auto lit = lit_blend(m, direction_from_degrees(20, 10),
                               direction_from_degrees(37, 7), {}, executor);
    ASSERT_TRUE(lit);
    EXPECT_EQ(lit->blend.count, 2U);
    SynthesisOptions options;
    options.rows = options.cols = 96;
    double sum = 0;
    const auto drawn = synthesise(
        m, *lit, options,
        [&](std::size_t, ImageView<const float> strip) -> Result<void> {
            for (std::size_t i = 0; i < strip.size(); ++i)
                sum += static_cast<double>(strip.data[i]);
            return {};
        },
        executor, progress);
    ASSERT_TRUE(drawn) << drawn.error().message;
    EXPECT_NEAR(sum / (96 * 96), 0.6 * std::cos(37 * std::numbers::pi / 180), 0.02);
}

TEST(Evaluate, RefusesSidesOutOfRange) {
    SerialExecutor executor;
    Progress progress;
    EvaluatorOptions options;
    options.side = 8;
    EXPECT_FALSE(Evaluator::create(two_subspaces(0), options, executor, progress));
}

}  // namespace
}  // namespace sateen
