// SPDX-License-Identifier: Apache-2.0
// Material to texture, one call a stage, the mirror of analysis/analyse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// Textures have at most so many pixels a side.
inline constexpr std::size_t kMaxTextureSide = std::size_t{1} << 20U;

struct SynthesisOptions {
    std::size_t rows = 512;
    std::size_t cols = 512;
    /// Top left corner of the window of the infinite plane. Windows of one material and seed
    /// agree bit for bit where they overlap. Ignored for tileable textures.
    std::int32_t offset_row = 0;
    std::int32_t offset_col = 0;
    /// The texture continues across its borders: a torus of rows x cols.
    bool tileable = false;
    /// Draw by causal recursion where the fields allow it, as paper-mode materials do.
    bool recursive = false;
    /// Leave out curves, spectral transform and tone, for a renderer that applies them: fields
    /// of variance 1; planes in units of plane_deviations() where there is a structure.
    bool fields_only = false;
    std::uint64_t seed = 0;
};

/// Takes a strip of the texture: rows [first_row, first_row + strip.rows), in order.
using StripSink =
    std::function<Result<void>(std::size_t first_row, ImageView<const float> strip)>;

/// Draws the texture of one subspace, linear reflectance, strip by strip: memory does not grow
/// with the number of rows unless a small tileable texture is drawn at once.
/// \error invalid_argument  no such subspace, a size of 0 or beyond kMaxTextureSide
/// \error cancelled, or what the sink returned
[[nodiscard]] Result<void> synthesise(const Material& material, std::size_t subspace,
                                      const SynthesisOptions& options,
                                      const StripSink& sink, Executor& executor,
                                      Progress& progress);

/// The same into one image.
[[nodiscard]] Result<Image> synthesise(const Material& material, std::size_t subspace,
                                       const SynthesisOptions& options,
                                       Executor& executor, Progress& progress);

/// Tileable textures of several subspaces; the noise is drawn once for all.
/// \param take  called for each subspace of the list, in order
[[nodiscard]] Result<void> synthesise_tiles(
    const Material& material, std::span<const std::size_t> subspaces,
    const SynthesisOptions& options,
    const std::function<Result<void>(std::size_t subspace, Image texture)>& take,
    Executor& executor, Progress& progress);

/// The subspace of the measured pair of directions nearest to (view, light): the one with the
/// largest sum of cosines between the two views and between the two lights.
/// Materials of photographs have one subspace for all directions.
[[nodiscard]] std::size_t nearest_subspace(const Material& material, Direction view,
                                           Direction light);

}  // namespace sateen
