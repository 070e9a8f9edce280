// SPDX-License-Identifier: Apache-2.0
// The periodic layer of a texture: lattice, displacement, cells, residual.
// Theory: docs/theory/periodic_layer.md. Partner: synthesis/periodic_layer.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sateen/analysis/lattice.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The layer of a material, and the displacements of the images it lies under.
struct AlignedLayer {
    PeriodicLayer layer;
    std::vector<Image>
        displacements;  ///< (2, rows, cols): of rows and columns, in pixels
    /// Which of several photographs these are, ascending; one representative: {0}.
    std::vector<std::size_t> photographs = {0};
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

/// One layer under several photographs of a material, each of which has been aligned by
/// itself: that of the plainest pattern. The cells of the others are shifted onto its cell,
/// where their cross-correlation is largest. Left out are those whose lattice or cell is
/// another: basis off by more than a tenth of the shorter vector, correlation below ½.
/// \param layers  of the photographs; nothing where there is no lattice
/// \param planes  of the photographs, by one transform
/// \cost          5 ms a photograph, and a fold of it
[[nodiscard]] std::optional<AlignedLayer> join_layers(
    std::vector<std::optional<AlignedLayer>> layers, std::span<const Image> planes,
    Executor& executor);

/// Images of which the periodic layer has been taken away.
struct SeparatedImages {
    SpectralTransform spectral;    ///< of the residual, about the mean of the images
    SubspaceStructure structure;   ///< cells without curves yet
    std::vector<Image> planes;     ///< T (y - mean)
    std::vector<Image> residuals;  ///< L(u)⁻¹ (planes - m(u))
};

/// \param images     in the tone, of the same pixels as those the layer was aligned on
/// \param reference  the transform to align with, or null
[[nodiscard]] SeparatedImages separate(std::span<const Image> images,
                                       const AlignedLayer& aligned, Tone tone,
                                       const SpectralTransform* reference,
                                       Executor& executor);

/// The mean cells of the planes of images that are aligned, folded and quantised, with
/// nothing else yet.
/// \param planes  of the same pixels as those that the layer was aligned on
[[nodiscard]] std::vector<PeriodicCell> fold_mean_cells(std::span<const Image> planes,
                                                        const AlignedLayer& aligned,
                                                        Executor& executor);

/// planes - m(u), as synthesis will read the cells.
[[nodiscard]] std::vector<Image> residuals_of(std::span<const Image> planes,
                                              const AlignedLayer& aligned,
                                              const std::vector<PeriodicCell>& cells,
                                              Executor& executor);

/// Folds the covariance of the planes of the residual, place by place, into the deviation
/// and mixing cells, and solves for what these are applied to:
///
///     r_i = s_i(u) R_i + Σ_{j<i} l_ij(u) R_j,   l_ij = E[r_i R_j | u]/E[R_j² | u]
///
/// the Cholesky factorisation of E[r rᵀ | u], plane by plane. s has the mean square of 1.
/// Planes of which the others explain less than 4 % are not mixed.
/// \param residuals  r; becomes R
void fold_residual(const AlignedLayer& aligned, std::vector<PeriodicCell>& cells,
                   std::vector<Image>& residuals, Executor& executor);

/// The curves that give m(u) + s(u) q(g) + Σ l(u) q(g), u uniform and g normal, the
/// distribution of the planes.
/// \param planes     of the images
/// \param marginals  q of every plane
void fit_tone_curves(std::span<const Image> planes, const PeriodicLayer& layer,
                     const std::vector<Marginal>& marginals,
                     std::vector<PeriodicCell>& cells);

}  // namespace sateen
