// SPDX-License-Identifier: Apache-2.0
// Surfaces generated in code that people recognise as materials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sateen/core/result.hpp"
#include "sateen/goniometer/surface_maps.hpp"

namespace sateen {

struct Preset {
    std::string_view name;
    std::string_view about;
    float width_mm = 0;  ///< what one period would measure
};

/// leather, corduroy, plain-weave, twill, knit, stone, plaster, wood.
[[nodiscard]] std::span<const Preset> presets();

/// A square toroidal surface. Patterns do not depend on the resolution, only on the name
/// and the seed; what is finer than a texel is averaged.
/// \param side  texels
/// \return heights in units of the width of the surface
/// \error invalid_argument  an unknown name (the message lists the known), or no texels
[[nodiscard]] Result<SurfaceMaps> make_preset(std::string_view name, std::size_t side,
                                              std::uint64_t seed);

}  // namespace sateen
