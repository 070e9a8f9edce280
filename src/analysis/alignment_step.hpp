// SPDX-License-Identifier: Apache-2.0
// The two steps that alignment repeats. Theory: docs/theory/periodic_layer.md.
#pragma once

#include <cstddef>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {

struct AlignmentStep {
    std::size_t rows = 0;  ///< samples of the mean cell
    std::size_t cols = 0;
    double window = 0;   ///< deviation of the Gaussian window, in pixels
    double longest = 0;  ///< no pixel is moved further
};

/// One step of Lucas and Kanade: folds the planes Y into the mean cell m, and adds to the
/// displacement the δ of
///
///     (Σ g gᵀ + ¼ mean I) δ = Σ g (Y - m(u)),   g = ∇m
///
/// the sums over all planes in Gaussian windows, kept on a grid 2.5 times as fine as the
/// window.
/// \param displacement  (2, rows, cols)
/// \cost  30 ns a pixel and plane
void move_towards_cells(const Image& Y, const LatticeMap& map, const AlignmentStep& step,
                        Image& displacement, Executor& executor);

/// Moves what of D is affine into the basis:
///
///     x + D = (I + A) x + t + D',   B ← (I + A)⁻¹ B,   D ← (I + A)⁻¹ D'
///
/// and drops t, a shift of the cell.
/// \returns  the new basis
[[nodiscard]] LatticeMap straighten(const LatticeMap& map, Image& displacement,
                                    Executor& executor);

}  // namespace sateen
