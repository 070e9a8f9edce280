// SPDX-License-Identifier: Apache-2.0
// Maps of a surface as files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sateen/analysis/range_map.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen::cli {

/// Makes a folder, or takes one that exists. \error io
[[nodiscard]] Result<void> make_folder(const std::string& path);

/// Writes height.png (16 bit, from the lowest to the highest point), normal.png (16 bit,
/// (n + 1) / 2, y up), colour under `colour_name`, and maps.json, which says what the
/// height means. \returns the paths
[[nodiscard]] Result<std::vector<std::string>> write_maps(
    const std::string& folder, const Image& height_px, const Image& normals,
    const Image& colour, const std::string& colour_name,
    std::optional<float> pixels_per_mm, Executor& executor);

/// Draws aligned toroidal maps of a material: base colour, and height and normals where it
/// has a surface, else flat ones. \returns the paths
[[nodiscard]] Result<std::vector<std::string>> draw_maps(const std::string& folder,
                                                         const Material& material,
                                                         SynthesisOptions options,
                                                         Executor& executor,
                                                         Progress& progress);

}  // namespace sateen::cli
