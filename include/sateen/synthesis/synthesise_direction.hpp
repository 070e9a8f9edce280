// SPDX-License-Identifier: Apache-2.0
// The texture of a material for a view and a light.
#pragma once

#include <array>
#include <cstddef>

#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/synthesis/interpolate.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen {

/// What a view and a light see of a material, from moments of small textures. Of more than
/// kMaxPairs pairs of directions the nearest measured one alone.
/// \cost drawing 128 x 128 pixels of every subspace where the material has a reflectance
[[nodiscard]] Result<Blend> blend_of(const Material& material, Direction view,
                                     Direction light, const InterpolationOptions& options,
                                     Executor& executor);

/// Draws that blend as synthesise() draws one subspace: the same windows, sizes and seeds.
/// All subspaces share their noise; means and contrasts of the directions are applied.
/// Photographs, whose directions are unknown, are drawn as they are.
/// \error those of synthesise(); limit_exceeded for a tileable blend of more than 2^26
///        pixels
[[nodiscard]] Result<void> synthesise(const Material& material, const Blend& blend,
                                      const SynthesisOptions& options,
                                      const StripSink& sink, Executor& executor,
                                      Progress& progress);

}  // namespace sateen
