// SPDX-License-Identifier: Apache-2.0
// Drawing the range map: windows of the infinite plane, tori of any size, normals.
// Theory: docs/theory/surface_storage.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/surface.hpp"

namespace sateen {

/// A window of the infinite plane, its top left corner at (row, col).
struct PlaneWindow {
    std::int32_t row = 0;
    std::int32_t col = 0;
    std::size_t rows = 0;
    std::size_t cols = 0;
};

/// Height in pixels, (1, rows, cols): tiles of the lattice, interchangeable ones by
/// tile_at(). Windows of one surface and seed agree bit for bit where they overlap.
/// \error invalid_argument  an empty window, or one beyond ±2^30
[[nodiscard]] Result<Image> draw_range(const Surface& surface, const PlaneWindow& window,
                                       std::uint64_t seed);

/// A torus of whole tiles, and what it took to fit them to the size asked for.
struct ToroidalRange {
    Image height_px;  ///< (1, rows, cols)
    std::size_t tile_rows = 0;
    std::size_t tile_cols = 0;
    /// The plane was stretched by 1 + strain; 0 where the size is a multiple of the tile.
    double strain_rows = 0;
    double strain_cols = 0;
    /// Columns a row that it was sheared by, because the tile rows are shifted and have to
    /// close; 0 for tiles in columns.
    double strain_shear = 0;
};

/// Fills a torus of rows x cols with the whole number of tiles that strains them least, at
/// least one each way. What is strained is resampled by cubic convolution; heights stay.
/// \error invalid_argument  a size of 0 or beyond 2^20
[[nodiscard]] Result<ToroidalRange> draw_toroidal_range(const Surface& surface,
                                                        std::size_t rows,
                                                        std::size_t cols,
                                                        std::uint64_t seed);

/// What lies beyond the border of a range map.
enum class Border { wraps, repeats_last };

/// Unit normals n ∝ (-p, -q, 1), (3, rows, cols), of a range map in pixels, from central
/// differences p = (z(x+1) - z(x-1)) / 2 along the columns and q likewise along y, which
/// points up: against the rows.
/// \param scale  heights are multiplied by it first
[[nodiscard]] Image normals_of(PlaneView<const float> height_px, Border border,
                               float scale = 1);

}  // namespace sateen
