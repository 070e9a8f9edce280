// SPDX-License-Identifier: Apache-2.0
// The texture of a material for a view and a light.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/synthesis/interpolate.hpp"
#include "sateen/synthesis/relit_range.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen {

/// What a view and a light see of a material: a blend of smooth textures, and the relit
/// range map to multiply it by where these were fitted to de-lit images.
struct LitBlend {
    Blend blend;
    std::optional<RelitRange> relief;
};

/// From moments of small textures. Of more than kMaxPairs pairs of directions the nearest
/// measured one alone. Photographs keep their brightness, for their exposure is unknown.
/// \param material  outlives the result
/// \cost drawing 128 x 128 pixels of every subspace where the material has a reflectance
[[nodiscard]] Result<LitBlend> lit_blend(const Material& material, Direction view,
                                         Direction light,
                                         const InterpolationOptions& options,
                                         Executor& executor);

/// The light under which a material is drawn if none is asked for: from straight above; a
/// photograph whose shading was divided out from the upper left, at the 45 degrees that
/// shape from shading assumes.
[[nodiscard]] Direction light_of(const Material& material);

/// A subspace as its representative image shows it. \param material  outlives the result
[[nodiscard]] LitBlend lit_subspace(const Material& material, std::size_t subspace);

/// Draws that blend as synthesise() draws one subspace: the same windows, sizes and seeds.
/// All subspaces share their noise; means and contrasts of the directions are applied.
/// \error those of synthesise(); limit_exceeded for a tileable blend, or one with relief, of
///        more than 2^26 pixels
[[nodiscard]] Result<void> synthesise(const Material& material, const LitBlend& lit,
                                      const SynthesisOptions& options,
                                      const StripSink& sink, Executor& executor,
                                      Progress& progress);

/// The same into one image.
[[nodiscard]] Result<Image> synthesise(const Material& material, const LitBlend& lit,
                                       const SynthesisOptions& options,
                                       Executor& executor, Progress& progress);

}  // namespace sateen
