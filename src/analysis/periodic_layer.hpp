// SPDX-License-Identifier: Apache-2.0
// The periodic layer of a texture: lattice, displacement, cells, residual.
// Theory: docs/theory/periodic_layer.md. Partner: synthesis/periodic_layer.
#pragma once

#include <optional>
#include <vector>

#include "sateen/analysis/lattice.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The layer of a material, and the displacement of the sample it was found on.
struct AlignedLayer {
    PeriodicLayer layer;
    Image displacement;  ///< (2, rows, cols): of rows and columns, in pixels
    double periodicity = 0;
};

/// Finds the lattice of the first plane, and bends it until the cells of all planes lie on
/// each other: alternately the mean cell m is folded and the displacement D improved by
///
///     (Σ g gᵀ + ¼ mean I) δ = Σ g (Y - m(u)),   g = ∇m      [Lucas & Kanade]
///
/// in Gaussian windows that shrink from 0.45 of the cell. What of D is affine goes into the
/// basis.
/// \param planes  (d, rows, cols) of one image, in one unit
/// \returns       nothing for a texture without a lattice
/// \cost          about 1 s a megapixel of three planes
[[nodiscard]] Result<std::optional<AlignedLayer>> align_layer(const Image& planes,
                                                              Executor& executor);

/// An image of which the periodic layer has been taken away.
struct SeparatedImage {
    SpectralTransform spectral;   ///< of the residual, about the mean of the image
    SubspaceStructure structure;  ///< cells without curves yet
    Image planes;                 ///< T (y - mean)
    Image residual;               ///< (planes - m(u)) / s(u)
};

/// \param image      in the tone, of the same pixels as those the layer was aligned on
/// \param reference  the transform to align with, or null
[[nodiscard]] SeparatedImage separate(const Image& image, const AlignedLayer& aligned,
                                      Tone tone, const SpectralTransform* reference,
                                      Executor& executor);

/// The mean cells of the planes of an image that is aligned, folded and quantised, with no
/// deviations and no curves yet.
/// \param planes  of the same pixels as those that the layer was aligned on
[[nodiscard]] std::vector<PeriodicCell> fold_mean_cells(const Image& planes,
                                                        const AlignedLayer& aligned,
                                                        Executor& executor);

/// planes - m(u), as synthesis will read the cells.
[[nodiscard]] Image residual_of(const Image& planes, const AlignedLayer& aligned,
                                const std::vector<PeriodicCell>& cells,
                                Executor& executor);

/// Folds the energy of the residual into the deviation cells, of mean square 1, and divides
/// the residual by them.
void fold_deviations(const AlignedLayer& aligned, std::vector<PeriodicCell>& cells,
                     Image& residual, Executor& executor);

/// The curves that give m(u) + s(u) q(g), u uniform and g normal, the distribution of the
/// planes.
/// \param planes     of the image
/// \param marginals  q of every plane
void fit_tone_curves(const Image& planes, const PeriodicLayer& layer,
                     const std::vector<Marginal>& marginals,
                     std::vector<PeriodicCell>& cells);

}  // namespace sateen
