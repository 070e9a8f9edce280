// SPDX-License-Identifier: Apache-2.0
// Whole windows are relit as the evaluator relights points.
#include "sateen/synthesis/relit_range.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sateen/synthesis/evaluate.hpp"
#include "sateen/synthesis/surface.hpp"
#include "sateen/synthesis/synthesise_direction.hpp"
#include "support/materials.hpp"
#include "support/relief.hpp"

namespace sateen {
namespace {

constexpr std::size_t kSide = 64;

/// A photograph's material of grain and gentle relief.
Material material_with_relief(double slope) {
    Material m = test::plain_material({Car2d{}});
    const test::Relief relief = test::cosine_relief(kSide, kSide, 5, slope, 4);
    Image tile(1, kSide, kSide);
    std::copy(relief.height.values().begin(), relief.height.values().end(),
              tile.values().begin());
    auto surface = quantise_surface({&tile, 1}, 1e-3F);
    EXPECT_TRUE(surface);
    m.surface = std::move(*surface);
    m.surface->delit = true;
    m.surface->ambient = 0.1F;
    return m;
}

Image drawn(const Material& m, const LitBlend& lit, const SynthesisOptions& options) {
    SerialExecutor executor;
    Progress progress;
    auto image = synthesise(m, lit, options, executor, progress);
    EXPECT_TRUE(image) << image.error().message;
    return std::move(*image);
}

LitBlend lit_from(const Material& m, Direction view, Direction light) {
    SerialExecutor executor;
    auto lit = lit_blend(m, view, light, {}, executor);
    EXPECT_TRUE(lit) << lit.error().message;
    return std::move(*lit);
}

SynthesisOptions tile_of(std::size_t side) {
    SynthesisOptions options;
    options.rows = options.cols = side;
    options.tileable = true;
    return options;
}

double mean_of(const Image& image) {
    double sum = 0;
    for (const float v : image.values()) sum += static_cast<double>(v);
    return sum / static_cast<double>(image.values().size());
}

TEST(RelitRange, IsWhatTheEvaluatorShowsFromAbove) {
    const Material m = material_with_relief(0.6);
    SerialExecutor executor;
    Progress progress;
    EvaluatorOptions options;
    options.side = kSide;
    const auto evaluator = Evaluator::create(m, options, executor, progress);
    ASSERT_TRUE(evaluator);
    for (const Direction light :
         {direction_from_degrees(45, 30), direction_from_degrees(65, 200)}) {
        const Image image = drawn(m, lit_from(m, {}, light), tile_of(kSide));
        const auto at = evaluator->prepare({0, 0, 1}, to_vector(light));
        const float cosine = to_vector(light)[2];  // photographs keep their brightness
        for (std::size_t r = 0; r < kSide; r += 3)
            for (std::size_t c = 0; c < kSide; c += 5) {
                const float expected =
                    evaluator->sample(at, (static_cast<float>(c) + 0.5F) / kSide,
                                      -(static_cast<float>(r) + 0.5F) / kSide)[0] /
                    cosine;
                // The evaluator's moments come from a table: 1 %.
                EXPECT_NEAR(image(0, r, c), expected, 0.015F * expected + 1e-4F);
            }
    }
}

TEST(RelitRange, KeepsBrightness) {
    const Material m = material_with_relief(0.8);
    const Image smooth = drawn(m, {lit_subspace(m, 0).blend, {}}, tile_of(192));
    for (const float theta : {0.0F, 40.0F, 75.0F})
        for (const float view : {0.0F, 50.0F, 75.0F}) {
            const Image lit = drawn(m,
                                    lit_from(m, direction_from_degrees(view, 120),
                                             direction_from_degrees(theta, 60)),
                                    tile_of(192));
            EXPECT_NEAR(mean_of(lit), mean_of(smooth), 0.03 * mean_of(smooth))
                << theta << " " << view;
        }
}

TEST(RelitRange, WindowsAgree) {
    const Material m = material_with_relief(0.8);
    const LitBlend lit =
        lit_from(m, direction_from_degrees(60, 40), direction_from_degrees(50, 300));
    SynthesisOptions all;
    all.rows = 90;
    all.cols = 80;
    SynthesisOptions part;
    part.rows = 30;
    part.cols = 33;
    part.offset_row = 41;
    part.offset_col = 17;
    const Image whole = drawn(m, lit, all);
    const Image window = drawn(m, lit, part);
    for (std::size_t r = 0; r < part.rows; ++r)
        for (std::size_t c = 0; c < part.cols; ++c)
            ASSERT_NEAR(window(0, r, c), whole(0, r + 41, c + 17), 1e-4F)
                << r << " " << c;
}

TEST(RelitRange, TilesContinueAcrossTheirBorders) {
    const Material m = material_with_relief(0.8);
    const LitBlend lit =
        lit_from(m, direction_from_degrees(45, 40), direction_from_degrees(50, 300));
    const Image tile = drawn(m, lit, tile_of(100));
    double across = 0;
    double inside = 0;
    for (std::size_t i = 0; i < 100; ++i) {
        across += std::abs(static_cast<double>(tile(0, 99, i) - tile(0, 0, i)));
        inside += std::abs(static_cast<double>(tile(0, 49, i) - tile(0, 50, i)));
    }
    EXPECT_LT(across, 1.6 * inside);
}

TEST(RelitRange, LeavesMaterialsAloneThatHoldTheirShading) {
    Material m = material_with_relief(0.8);
    m.surface->delit = false;
    EXPECT_EQ(light_of(m).theta, 0);
    EXPECT_FALSE(lit_from(m, {}, direction_from_degrees(50, 300)).relief);
    m.surface.reset();
    EXPECT_FALSE(lit_subspace(m, 0).relief);
}

TEST(RelitRange, APhotographIsLitFromTheUpperLeft) {
    Material m = material_with_relief(0.8);
    EXPECT_NEAR(light_of(m).theta / kRadiansPerDegree, 45, 1e-3);
    EXPECT_NEAR(light_of(m).phi / kRadiansPerDegree, 135, 1e-3);
    const Image one = drawn(m, lit_subspace(m, 0), tile_of(kSide));
    const Image two = drawn(m, lit_from(m, {}, light_of(m)), tile_of(kSide));
    EXPECT_TRUE(std::equal(one.values().begin(), one.values().end(), two.values().begin(),
                           two.values().end()));
}

}  // namespace
}  // namespace sateen
