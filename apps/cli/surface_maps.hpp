// SPDX-License-Identifier: Apache-2.0
// Maps of a surface as files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sateen/analysis/range_map.hpp"
#include "sateen/core/direction.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen::cli {

/// Makes a folder, or takes one that exists. \error io
[[nodiscard]] Result<void> make_folder(const std::string& path);

/// Writes height.png (16 bit, from the lowest to the highest point), normal.png (16 bit,
/// (n + 1) / 2, y up), albedo.png, and maps.json, which says what the height means.
/// \returns the paths
[[nodiscard]] Result<std::vector<std::string>> write_maps(
    const std::string& folder, const RangeMap& range, std::optional<float> pixels_per_mm,
    Executor& executor);

/// Draws aligned toroidal maps of a material: base colour, and height and normals where it
/// has a surface, else flat ones; with a light, relit.png as well, seen from above.
/// \returns the paths
[[nodiscard]] Result<std::vector<std::string>> draw_maps(
    const std::string& folder, const Material& material, SynthesisOptions options,
    std::optional<Direction> light, Executor& executor, Progress& progress);

}  // namespace sateen::cli
