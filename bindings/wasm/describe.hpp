// SPDX-License-Identifier: Apache-2.0
// What a front end must know of a material besides its textures, as JSON.
#pragma once

#include <string>

#include "sateen/material/material.hpp"

namespace sateen::wasm {

/// {"name", "source", "bands", "sampleRows", "sampleCols", "pixelsPerMm" or null,
///  "cosineIncluded", "views": [[θ, φ], …] in radians, "lights",
///  "index": a subspace for every pair (lights outermost), -1 where none was measured,
///  "subspaces": [{"members", "view", "light", "tone": "srgb" or "linear", "mean", "T",
///                 "scale": (d), "knots": (d) lists of 16 or none}, …]}
[[nodiscard]] std::string describe(const Material& material);

}  // namespace sateen::wasm
