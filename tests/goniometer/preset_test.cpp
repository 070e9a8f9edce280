// SPDX-License-Identifier: Apache-2.0
#include "sateen/goniometer/preset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace sateen {
namespace {

SurfaceMaps make(std::string_view name, std::size_t side, std::uint64_t seed) {
    auto made = make_preset(name, side, seed);
    if (!made) ADD_FAILURE() << made.error().message;
    return made ? *made : SurfaceMaps();
}

/// Difference across the border over the largest between neighbouring lines inside.
double seam_ratio(const Image& map, bool of_rows) {
    const std::size_t lines = of_rows ? map.rows() : map.cols();
    const std::size_t length = of_rows ? map.cols() : map.rows();
    const auto difference = [&](std::size_t a, std::size_t b) {
        double sum = 0;
        for (std::size_t i = 0; i < length; ++i)
            sum += static_cast<double>(std::abs(of_rows ? map(0, a, i) - map(0, b, i)
                                                        : map(0, i, a) - map(0, i, b)));
        return sum;
    };
    double largest = 0;
    for (std::size_t k = 0; k + 1 < lines; ++k)
        largest = std::max(largest, difference(k, k + 1));
    return difference(lines - 1, 0) / largest;
}

TEST(Preset, ThereAreAtLeastEightOfDifferentNames) {
    std::set<std::string_view> names;
    for (const Preset& preset : presets()) names.insert(preset.name);
    EXPECT_GE(names.size(), 8U);
    EXPECT_EQ(names.size(), presets().size());
}

TEST(Preset, EveryOneIsAPossibleSurfaceWithoutSeams) {
    for (const Preset& preset : presets()) {
        SCOPED_TRACE(preset.name);
        const SurfaceMaps surface = make(preset.name, 96, 0);
        EXPECT_TRUE(validate(surface));
        for (const float v : surface.colour.values()) {
            EXPECT_GE(v, 0);
            EXPECT_LE(v, 1);
        }
        for (const float v : surface.roughness.values()) {
            EXPECT_GE(v, 0.1F);
            EXPECT_LE(v, 1);
        }
        const auto [low, high] = std::minmax_element(surface.height.values().begin(),
                                                     surface.height.values().end());
        EXPECT_GT(*high - *low, 0.002F);
        EXPECT_LT(*high - *low, 0.3F);
        for (const bool of_rows : {false, true}) {
            EXPECT_LT(seam_ratio(surface.height, of_rows), 1.1);
            EXPECT_LT(seam_ratio(surface.colour, of_rows), 1.1);
        }
    }
}

TEST(Preset, SeedsDifferAndOneSeedIsAlwaysTheSame) {
    for (const Preset& preset : presets()) {
        SCOPED_TRACE(preset.name);
        const SurfaceMaps a = make(preset.name, 32, 0);
        const SurfaceMaps again = make(preset.name, 32, 0);
        const SurfaceMaps b = make(preset.name, 32, 1);
        EXPECT_TRUE(std::equal(a.height.values().begin(), a.height.values().end(),
                               again.height.values().begin()));
        EXPECT_FALSE(std::equal(a.height.values().begin(), a.height.values().end(),
                                b.height.values().begin()));
    }
}

TEST(Preset, ThePatternDoesNotDependOnTheResolution) {
    for (const Preset& preset : presets()) {
        SCOPED_TRACE(preset.name);
        const Image coarse = resample(make(preset.name, 128, 5).height, 48, 48);
        const Image fine = resample(make(preset.name, 192, 5).height, 48, 48);
        double difference = 0;
        double spread = 0;
        double mean = 0;
        for (const float z : fine.values()) mean += static_cast<double>(z);
        mean /= 48 * 48;
        for (std::size_t i = 0; i < fine.values().size(); ++i) {
            const auto z = static_cast<double>(fine.values()[i]);
            const double off = static_cast<double>(coarse.values()[i]) - z;
            difference += off * off;
            spread += (z - mean) * (z - mean);
        }
        EXPECT_LT(difference, 0.2 * spread);
    }
}

TEST(Preset, AnUnknownNameIsAnsweredWithTheKnown) {
    const auto made = make_preset("velvet", 16, 0);
    ASSERT_FALSE(made);
    EXPECT_THAT(made.error().message, testing::HasSubstr("\"velvet\""));
    EXPECT_THAT(made.error().message, testing::HasSubstr("leather, corduroy"));
    EXPECT_FALSE(make_preset("leather", 0, 0));
}

}  // namespace
}  // namespace sateen
