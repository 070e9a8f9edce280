// SPDX-License-Identifier: Apache-2.0
// Lattices of known patterns, and none in random fields.
#include "sateen/analysis/lattice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "analysis/smooth_part.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "support/joint_fields.hpp"
#include "support/materials.hpp"

namespace sateen {
namespace {

using Vector = std::array<double, 2>;

/// A smooth pattern with harmonics up to the second, plus white noise.
Image pattern(const Vector& a, const Vector& b, double noise, std::size_t rows,
              std::size_t cols, std::uint64_t seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<float> normal;
    Image image(1, rows, cols);
    const double det = a[0] * b[1] - a[1] * b[0];
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            const auto y = static_cast<double>(r);
            const auto x = static_cast<double>(c);
            const double u = 2 * std::numbers::pi * (y * b[1] - x * b[0]) / det;
            const double v = 2 * std::numbers::pi * (x * a[0] - y * a[1]) / det;
            const double value = std::cos(u) + 0.8 * std::cos(v + 0.5) +
                                 0.6 * std::cos(u + v) + 0.5 * std::sin(2 * u - v);
            image(0, r, c) =
                static_cast<float>(value + noise * static_cast<double>(normal(engine)));
        }
    return image;
}

double distance(const Vector& u, const Vector& v) {
    return std::min(std::hypot(u[0] - v[0], u[1] - v[1]),
                    std::hypot(u[0] + v[0], u[1] + v[1]));
}

/// 0.02 pixels, and of long vectors, which repeat less often, 0.06 %.
double tolerance(const Vector& v) {
    return std::max(0.02, 6e-4 * std::hypot(v[0], v[1]));
}

struct Known {
    Vector a;
    Vector b;
};

// Both are reduced bases, of lattices without two shortest vectors, which are unique up to
// sign.
const std::vector<Known>& known_lattices() {
    static const std::vector<Known> lattices = {{{0.4, 7.3}, {9.1, 1.2}},
                                                {{13.37, -2.2}, {3.1, 21.9}},
                                                {{30.25, 0.6}, {-8.3, 47.7}},
                                                {{0.2, 40.4}, {52.3, 11.0}}};
    return lattices;
}

TEST(Lattice, OfKnownPatternsIsFoundToTwoHundredthsOfAPixel) {
    SerialExecutor executor;
    for (const Known& known : known_lattices())
        for (const double noise : {0.0, 1.0}) {
            const Image image = pattern(known.a, known.b, noise, 800, 720, 1);
            const auto found = find_lattice(image.plane(0), executor);
            ASSERT_TRUE(found);
            ASSERT_TRUE(found->has_value()) << known.a[0] << " noise " << noise;
            EXPECT_LT(distance((*found)->a, known.a), tolerance(known.a))
                << (*found)->a[0] << "," << (*found)->a[1];
            EXPECT_LT(distance((*found)->b, known.b), tolerance(known.b))
                << (*found)->b[0] << "," << (*found)->b[1];
            // Var of the pattern is (1 + .64 + .36 + .25)/2 = 1.125.
            const double share = 1.125 / (1.125 + noise * noise);
            EXPECT_NEAR((*found)->periodicity, share, 0.04);
            EXPECT_GT((*found)->area(), 0);
        }
}

// 0.34 of the side, of the largest that is searched at its own resolution, are 348 pixels.
TEST(Lattice, OfLargeCellsOfALargeImageIsFoundInASmallerPictureOfIt) {
    SerialExecutor executor;
    const Known known{{380.5, 20}, {-31, 441.2}};
    const Image image = pattern(known.a, known.b, 0.5, 2080, 2100, 1);
    const auto found = find_lattice(image.plane(0), executor);
    ASSERT_TRUE(found && found->has_value());
    EXPECT_LT(distance((*found)->a, known.a), 2 * tolerance(known.a));
    EXPECT_LT(distance((*found)->b, known.b), 2 * tolerance(known.b));
}

TEST(Lattice, OfStripesNeedsThreeOfThem) {
    SerialExecutor executor;
    const auto stripes = [](double period) {
        Image image(1, 256, 256);
        for (std::size_t r = 0; r < 256; ++r)
            for (std::size_t c = 0; c < 256; ++c)
                image(0, r, c) = static_cast<float>(
                    std::cos(2 * std::numbers::pi * static_cast<double>(c) / period));
        return image;
    };
    const auto narrow = find_lattice(stripes(20.5).plane(0), executor);
    ASSERT_TRUE(narrow && narrow->has_value());
    const Lattice& found = **narrow;
    const double step_a = std::abs(found.a[1] / 20.5 - std::round(found.a[1] / 20.5));
    const double step_b = std::abs(found.b[1] / 20.5 - std::round(found.b[1] / 20.5));
    EXPECT_LT(std::max(step_a, step_b) * 20.5, 0.1);
    const auto wide = find_lattice(stripes(75).plane(0), executor);
    ASSERT_TRUE(wide);
    EXPECT_FALSE(wide->has_value());
}

TEST(Lattice, OfAPlaneThatIsConstantOrTinyIsNone) {
    SerialExecutor executor;
    const Image flat(1, 128, 128);
    EXPECT_FALSE((*find_lattice(flat.plane(0), executor)).has_value());
    const Image tiny(1, 32, 128);
    EXPECT_FALSE((*find_lattice(tiny.plane(0), executor)).has_value());
}

struct Kind {
    const char* name;
    FieldModel field;
    std::size_t levels;
};

/// Three planes, each from its neighbours on all sides.
Sar3d sar3d_field() {
    Sar3d field{{3, {{0, 1}, {1, 0}, {0, -1}, {-1, 0}}, std::vector<float>(36), {}}};
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t plane = 0; plane < 3; ++plane)
            field.A[9 * s + 4 * plane] = plane == 0 ? 0.22F : 0.15F;
    field.Sigma = {1, 0.5F, 0, 0.5F, 1, 0.2F, 0, 0.2F, 1};
    return field;
}

std::vector<Kind> random_kinds() {
    return {
        {"white noise", Car2d{{{0, 1}}, {0.0F}, 1}, 1},
        {"smooth", Car2d{{{0, 1}, {1, 0}, {1, 1}}, {0.9F, 0.9F, -0.81F}, 1}, 1},
        {"pyramid", Car2d{{{0, 1}, {1, 0}, {1, 1}}, {0.5F, 0.5F, -0.25F}, 1}, 4},
        {"streaks", Car2d{{{0, 1}, {1, 0}, {1, 1}}, {0.97F, 0.1F, -0.097F}, 1}, 3},
        {"preferred wavelength", Car2d{{{0, 1}, {0, 2}, {1, 0}}, {0.9F, -0.6F, 0.2F}, 1},
         2},
        {"gmrf2d",
         Gmrf2d{{{0, 1}, {1, 0}, {1, 1}, {1, -1}}, {0.3F, 0.25F, -0.05F, -0.05F}, 1}, 3},
        {"car3d", test::correlated_field(), 2},
        {"sar3d", sar3d_field(), 3},
    };
}

/// Levels of one field with less power the coarser they are; of one plane, or three that are
/// drawn together.
Material material_of(const Kind& kind) {
    Material material = test::plain_material({});
    Subspace& subspace = material.subspaces[0];
    const bool joint = std::holds_alternative<Car3d>(kind.field) ||
                       std::holds_alternative<Sar3d>(kind.field);
    if (joint) {
        material.bands = 3;
        subspace.spectral = {Tone::linear, {100, 100, 100}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        subspace.marginals.assign(3, {1, {}});
    }
    for (std::size_t level = 0; level < kind.levels; ++level)
        subspace.levels.emplace_back().fields.push_back(kind.field);
    return material;
}

// One broad spot is unlike itself at every lag that a vector can have: every lattice is
// worse than none.
TEST(Lattice, OfBroadSpotsIsNone) {
    SerialExecutor executor;
    for (const double width : {4.0, 6.0, 8.0, 12.0, 16.0, 24.0})
        for (const double ripple : {0.0, 0.01, 0.03, 0.1}) {
            Image image(1, 160, 160);
            for (std::size_t r = 0; r < 160; ++r)
                for (std::size_t c = 0; c < 160; ++c) {
                    const double y = static_cast<double>(r) - 80;
                    const double x = static_cast<double>(c) - 80;
                    const double distance = std::hypot(x, y);
                    image(0, r, c) = static_cast<float>(
                        std::exp(-distance * distance / (2 * width * width)) *
                        (1 + ripple * std::cos(distance)));
                }
            const auto lattice = find_lattice(image.plane(0), executor);
            ASSERT_TRUE(lattice) << lattice.error().message;
            EXPECT_FALSE(lattice->has_value()) << width << ' ' << ripple;
        }
}

// Each kind has 100 fields; any lattice found is a false one.
TEST(Lattice, OfRandomFieldsIsNone) {
    SerialExecutor executor;
    Progress progress;
    for (const Kind& kind : random_kinds()) {
        const Material material = material_of(kind);
        ASSERT_TRUE(validate(material)) << kind.name;
        for (std::uint64_t seed = 0; seed < 100; ++seed) {
            SynthesisOptions options;
            options.rows = options.cols = 192;
            options.tileable = true;
            options.seed = seed;
            const auto texture = synthesise(material, 0, options, executor, progress);
            ASSERT_TRUE(texture);
            // The torus would repeat: half of it does not.
            const auto found =
                find_lattice(texture->plane(0).window(0, 0, 160, 160), executor);
            ASSERT_TRUE(found);
            EXPECT_FALSE(found->has_value())
                << kind.name << ", seed " << seed << ": " << (*found)->periodicity
                << " > " << (*found)->threshold;
        }
    }
}

TEST(SmoothPart, OfACosineIsItAndWhatIsLeftOfTheGaussian) {
    SerialExecutor executor;
    Image image(1, 90, 70);
    constexpr double kSigma = 9;
    const double omega = std::numbers::pi * 4 / 70;
    for (std::size_t r = 0; r < 90; ++r)
        for (std::size_t c = 0; c < 70; ++c)
            image(0, r, c) =
                static_cast<float>(3 + std::cos(omega * (static_cast<double>(c) + 0.5)));
    Image rest(1, 90, 70);
    subtract_smooth_part(image.plane(0), kSigma, rest.plane(0), executor);
    const double left = 1 - std::exp(-kSigma * kSigma * omega * omega / 2);
    for (std::size_t c = 0; c < 70; ++c)
        EXPECT_NEAR(rest(0, 40, c),
                    left * std::cos(omega * (static_cast<double>(c) + 0.5)), 1e-4);
}

}  // namespace
}  // namespace sateen
