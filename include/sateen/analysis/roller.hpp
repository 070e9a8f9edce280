// SPDX-License-Identifier: Apache-2.0
// The Roller: interchangeable toroidal tiles from a range map of any borders.
// Theory: docs/theory/roller.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/analysis/integrate.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

struct RollerOptions {
    std::size_t tiles = 4;  ///< interchangeable ones, 1 … 8
    /// Larger samples are cut to so many pixels a side first.
    std::size_t largest_side = 512;
};

struct RolledSurface {
    std::vector<Image> tiles;    ///< (1, rows, cols) each, height in pixels
    std::uint32_t shear_px = 0;  ///< of the lattice, see Surface
    /// The sample was a torus already: its first tile is the sample.
    bool was_toroidal = false;
    std::size_t overlap_rows = 0;
    std::size_t overlap_cols = 0;
    /// Root mean square step across all seams of all tiles over that of all other neighbours
    /// in the same direction: of height, and of the normals derived from it.
    double seam_ratio = 1;
    double normal_seam_ratio = 1;
};

/// Do slopes continue across the borders of the sample? At every lag up to a quarter of the
/// side (64), the mean squared difference of the pairs that straddle a border is compared
/// with the largest of as many pairs beside each other inside: so a weave cut at the wrong
/// thread is told.
/// \cost a quarter of the side passes over every plane
[[nodiscard]] bool is_toroidal(const SlopeField& slopes);

/// Cuts tiles out of a range map [Haindl and Hatka 2005: the Roller]: the lattice is the
/// pair of shifts (rows, shear), (0, cols) under which the sample agrees best with itself,
/// found by correlation; the tile is closed by minimum-error cuts through both overlaps,
/// and further tiles are the same torus shifted, joined to the first by a closed
/// minimum-error loop along its border.
/// \param height  (1, rows, cols), at least 16 pixels a side
/// \error invalid_argument  too small, or the number of tiles
/// \cost about 1 s for 512 x 512 and four tiles
[[nodiscard]] Result<RolledSurface> roll(const BasicImage<double>& height,
                                         const RollerOptions& options);

}  // namespace sateen
