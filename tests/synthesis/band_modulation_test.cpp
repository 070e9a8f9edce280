// SPDX-License-Identifier: Apache-2.0
// Modulated bands: against their definition, on tori and in windows.
#include "synthesis/band_modulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "reference/band_modulation.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "support/random_material.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

Material modulated() {
    return test::random_material(
        {.seed = 21, .levels = 3, .order = 2, .modulation = true});
}

Image drawn(const Material& material, const SynthesisOptions& options,
            Executor& executor) {
    Progress progress;
    return *synthesise(material, 0, options, executor, progress);
}

Image noise(std::size_t bands, std::size_t rows, std::size_t cols) {
    Image image(bands, rows, cols);
    for (std::size_t band = 0; band < bands; ++band)
        for (std::size_t r = 0; r < rows; ++r)
            draw_normals({3, static_cast<std::uint32_t>(band)},
                         static_cast<std::int32_t>(r), 0,
                         {image.plane(band).row(r), cols});
    return image;
}

float field_at(std::size_t level, std::size_t r, std::size_t c) {
    return 0.25F * std::sin(0.1F * static_cast<float>(r + 2 * c + level));
}

TEST(ModulateBands, IsWhatItsDefinitionSays) {
    const Material material = modulated();
    SerialExecutor executor;
    for (const Border border : {Border::wrap, Border::mirror}) {
        Image planes = noise(3, 40, 45);
        std::vector<reference::Plane> expected;
        for (std::size_t k = 0; k < 3; ++k)
            expected.push_back(reference::plane_of(std::as_const(planes).plane(k)));
        expected = reference::modulated(
            std::move(expected), *material.subspaces[0].modulation,
            [](std::size_t level, std::int64_t r, std::int64_t c) {
                return level == 2 ? 0.0
                                  : static_cast<double>(
                                        field_at(level, static_cast<std::size_t>(r),
                                                 static_cast<std::size_t>(c)));
            },
            border);
        modulate_bands(
            *material.modulation, *material.subspaces[0].modulation,
            [](std::size_t level, PlaneView<float> out, Executor&) {
                for (std::size_t r = 0; r < out.rows; ++r)
                    for (std::size_t c = 0; c < out.cols; ++c)
                        out(r, c) = field_at(level, r, c);
            },
            border, planes.view(), executor);
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t i = 0; i < planes.plane_size(); ++i)
                ASSERT_NEAR(static_cast<double>(planes.plane(k).data[i]),
                            expected[k].values[i], 2e-4);
    }
}

TEST(ModulateBands, WithoutCurvesOrFieldsLeavesThePlanes) {
    SerialExecutor executor;
    SubspaceModulation none;
    none.bands.resize(BandModulation::kLevels);
    none.units = {1};
    const Image before = noise(1, 64, 64);
    Image planes = before;
    modulate_bands({}, none, nullptr, Border::wrap, planes.view(), executor);
    for (std::size_t i = 0; i < planes.values().size(); ++i)
        ASSERT_NEAR(planes.values()[i], before.values()[i], 2e-6F);
}

TEST(ModulatedTexture, WindowsAgreeBitForBit) {
    const Material material = modulated();
    SerialExecutor executor;
    SynthesisOptions options;
    options.rows = 300;
    options.cols = 150;
    options.offset_row = -37;
    options.offset_col = 1000;
    const Image whole = drawn(material, options, executor);
    SynthesisOptions part = options;
    part.rows = 61;
    part.cols = 45;
    part.offset_row += 205;
    part.offset_col += 77;
    const Image window = drawn(material, part, executor);
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t r = 0; r < part.rows; ++r)
            for (std::size_t c = 0; c < part.cols; ++c)
                ASSERT_EQ(window(band, r, c), whole(band, r + 205, c + 77));
}

TEST(ModulatedTexture, HasTheSameBytesForAnyNumberOfThreads) {
    const Material material = modulated();
    SerialExecutor serial;
    test::ThreadedExecutor threads(3);
    for (const bool tileable : {true, false}) {
        SynthesisOptions options;
        options.rows = options.cols = 160;
        options.tileable = tileable;
        const Image a = drawn(material, options, serial);
        const Image b = drawn(material, options, threads);
        EXPECT_TRUE(std::ranges::equal(a.values(), b.values()));
    }
}

double step_between(const Image& image, std::size_t row, std::size_t next) {
    double sum = 0;
    for (std::size_t c = 0; c < image.cols(); ++c) {
        const auto difference = static_cast<double>(image(0, row, c) - image(0, next, c));
        sum += difference * difference;
    }
    return sum;
}

// Both of the sizes that one transform draws and of others.
TEST(ModulatedTexture, HasNoSeamOnATorus) {
    const Material material = modulated();
    SerialExecutor executor;
    for (const std::size_t side : {240U, 251U}) {
        SynthesisOptions options;
        options.rows = options.cols = side;
        options.tileable = true;
        const Image texture = drawn(material, options, executor);
        double inside = 0;
        for (std::size_t r = 0; r + 1 < side; ++r)
            inside += step_between(texture, r, r + 1) / static_cast<double>(side - 1);
        // A mean square over 240 correlated pixels: within a factor of 2 at any level of
        // significance that matters.
        EXPECT_LT(step_between(texture, side - 1, 0), 2 * inside);
        EXPECT_GT(step_between(texture, side - 1, 0), inside / 2);
    }
}

TEST(AmplitudeFields, HaveTheDeviationThatTheySay) {
    BandModulation modulation;
    SmoothField& field = modulation.fields[0];
    field.deviation = 0.5F;
    field.weights[0] = 255;
    SerialExecutor executor;
    const auto fields = AmplitudeFields::create(modulation, 5, {512, 512}, executor);
    ASSERT_TRUE(fields);
    Image h(1, 512, 512);
    fields->draw(0, 0, 0, h.plane(0), executor);
    double squares = 0;
    for (const float value : h.values())
        squares += static_cast<double>(value) * static_cast<double>(value);
    // Cubic interpolation leaves 0.99 of the variance of bells as wide as a spacing; the
    // standard error of 10^4 independent squares is 1.4 %.
    EXPECT_NEAR(std::sqrt(squares / (512.0 * 512.0)), 0.5, 0.03);
}

}  // namespace
}  // namespace sateen
