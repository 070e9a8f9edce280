// SPDX-License-Identifier: Apache-2.0
// What a front end must know of a material besides its textures, as JSON.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sateen/material/material.hpp"

namespace sateen::wasm {

/// {"name", "source", "bands", "sampleRows", "sampleCols", "pixelsPerMm" or null,
///  "cosineIncluded", "views": [[θ, φ], …] in radians, "lights",
///  "index": a subspace for every pair (lights outermost), -1 where none was measured,
///  "subspaces": [{"members", "view", "light", "tone": "srgb" or "linear", "mean", "T",
///                 "scale": (d), "knots": (d) lists of 16 or none,
///                 "curves": of a pattern (d) times {"low", "high", "values"}}, …],
///  "pattern": {"rows", "cols" of its table of cells, "inverse": B⁻¹ by rows}, or null,
///  "surface": {"rows", "cols", "delit"} of a tile of the range map, or null}
[[nodiscard]] std::string describe(const Material& material);

/// The triangulation of directions for a shader (core/direction_mesh.hpp): the number of cells;
/// the cell to start from for every square of kStartSide x kStartSide; then for each cell and
/// k = 0, 1, 2 the bits of row[k] (three words) and vertex[k] | neighbour[k] << 16, the top bit
/// of vertex[2] set in a sector. Sets on one great circle have a cell around each direction,
/// without interpolation. Empty for no directions.
[[nodiscard]] std::vector<std::uint32_t> packed_cells(
    std::span<const Direction> directions);

/// The subspace of every pair, (lights, views), also of those that were not measured: the index of
/// synthesis/interpolate.hpp.
[[nodiscard]] std::vector<std::uint8_t> complete_index(const Material& material);

/// e_0 … e_3 of every pair, (lights, views, 4): material/reflectance.hpp; empty without one.
[[nodiscard]] std::vector<float> appearance_of_pairs(const Material& material);

}  // namespace sateen::wasm
