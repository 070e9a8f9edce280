// SPDX-License-Identifier: Apache-2.0
// Karhunen-Loève spectral factorisation. Theory: docs/theory/spectral.md.
// Partner: synthesis/spectral.
#pragma once

#include <span>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The transform that decorrelates the channels of images of one material, pooled:
///
///     Φ = E ỸỸᵀ of the centred values,   rows of T the unit eigenvectors of Φ   [GMRF,
///     eq. 3]
///
/// largest eigenvalue first, the largest component of every row positive.
/// \param images  (d, rows, cols) each, in the tone already
[[nodiscard]] SpectralTransform fit_spectral_transform(std::span<const Image> images,
                                                       Tone tone);

/// Reorders and flips the rows of T so that each is as parallel as can be to the same row
/// of `reference`. All subspaces are driven by the same noise: it must move them the same
/// way.
void align(SpectralTransform& transform, const SpectralTransform& reference);

/// Applies the tone to linear values.
[[nodiscard]] Image apply_tone(const Image& linear, Tone tone);

/// ȳ = T (y - mean) at every pixel. \param image  (d, rows, cols), in the tone already
[[nodiscard]] Image decorrelate(const Image& image, const SpectralTransform& transform);

}  // namespace sateen
