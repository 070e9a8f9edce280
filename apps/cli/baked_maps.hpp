// SPDX-License-Identifier: Apache-2.0
// A tileable patch of a material as the maps of a physically based renderer: an approximation,
// since one colour, normal and roughness cannot hold how a material changes with view and light.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen::cli {

struct BakeOptions {
    std::size_t rows = 1024;
    std::size_t cols = 1024;
    std::uint64_t seed = 0;
};

struct BakedMaps {
    Image base_colour;  ///< (3, rows, cols): seen and lit from the normal, linear
    Image normal;       ///< (3, rows, cols): 0.5 + 0.5 n, y up
    std::optional<Image>
        height_px;      ///< (1, rows, cols), where the material has a surface
    Image roughness;    ///< (1, rows, cols): √α of GGX; see fitted_roughness()
    float width_m = 0;  ///< of the patch; 0 where the scale is not known
    float height_m = 0;
};

[[nodiscard]] Result<BakedMaps> bake_maps(const Material& material,
                                          const BakeOptions& options, Executor& executor,
                                          Progress& progress);

/// α = roughness² of the GGX lobe over a matt ground, F0 = 0.04, that fits the mean
/// reflectance of up to 512 pairs of directions best (of the subspaces where no more is stored),
/// in steps of 0.05 of the roughness. The map takes the slopes of the range map off it and
/// adds those around each texel (LEAN mapping, α² + 2σ²).
/// \returns 1 for photographs, and where fewer than 4 pairs tell of it
[[nodiscard]] float fitted_roughness(const Material& material);

/// A binary glTF 2.0 of one quad with the maps, images as PNG inside.
[[nodiscard]] Result<std::vector<std::uint8_t>> gltf_of(const BakedMaps& maps,
                                                        const std::string& name);

}  // namespace sateen::cli
