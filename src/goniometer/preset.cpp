// SPDX-License-Identifier: Apache-2.0
// Presets by name. See preset.hpp.
#include "sateen/goniometer/preset.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "goniometer/preset_parts.hpp"

namespace sateen {
namespace {

struct Recipe {
    Preset preset;
    SurfaceMaps (*make)(std::size_t side, std::uint64_t seed);
};

constexpr std::array<Recipe, 8> kRecipes = {{
    {{"leather", "brown grained leather, half gloss", 30}, goniometer::leather},
    {{"corduroy", "ribs of cut pile", 30}, goniometer::corduroy},
    {{"plain-weave", "linen, each thread over one and under one", 15},
     goniometer::plain_weave},
    {{"twill", "denim, blue warp over three white wefts", 15}, goniometer::twill},
    {{"knit", "wool in stockinette stitch", 50}, goniometer::knit},
    {{"stone", "rough granite", 60}, goniometer::stone},
    {{"plaster", "white plaster, thrown and levelled", 120}, goniometer::plaster},
    {{"wood", "oak with open pores, oiled", 60}, goniometer::wood},
}};

constexpr std::array<Preset, kRecipes.size()> kPresets = [] {
    std::array<Preset, kRecipes.size()> list{};
    for (std::size_t k = 0; k < kRecipes.size(); ++k) list[k] = kRecipes[k].preset;
    return list;
}();

std::string names() {
    std::string text;
    for (const Preset& preset : kPresets)
        text.append(text.empty() ? "" : ", ").append(preset.name);
    return text;
}

}  // namespace

std::span<const Preset> presets() {
    return kPresets;
}

Result<SurfaceMaps> make_preset(std::string_view name, std::size_t side,
                                std::uint64_t seed) {
    constexpr std::size_t kMaxSide = 8192;
    constexpr std::size_t kFiner = 2;
    if (side < 1 || side > kMaxSide)
        return Error{Errc::invalid_argument, "preset: found " + std::to_string(side) +
                                                 " texels a side, expected 1 to 8192"};
    const auto recipe =
        std::find_if(kRecipes.begin(), kRecipes.end(),
                     [&](const Recipe& each) { return each.preset.name == name; });
    if (recipe == kRecipes.end())
        return Error{Errc::invalid_argument, "unknown preset \"" + std::string(name) +
                                                 "\", expected one of " + names()};
    const SurfaceMaps fine = recipe->make(kFiner * side, seed);
    return SurfaceMaps{resample(fine.height, side, side),
                       {},
                       resample(fine.colour, side, side),
                       resample(fine.roughness, side, side)};
}

}  // namespace sateen
