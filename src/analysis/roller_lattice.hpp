// SPDX-License-Identifier: Apache-2.0
// The lattice by which tiles of the Roller repeat.
#pragma once

#include <array>
#include <cstddef>

#include "sateen/core/image.hpp"

namespace sateen {

/// (rows, shear), (0, cols) in whole pixels.
struct TileLattice {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::size_t shear = 0;

    /// Number of the site (r, c) of the plane in a tile.
    [[nodiscard]] std::size_t site(std::size_t r, std::size_t c) const {
        const std::size_t turns = r / rows;
        const std::size_t shifted = c + (cols - shear) % cols * turns;
        return r % rows * cols + shifted % cols;
    }
    [[nodiscard]] std::size_t above(std::size_t r, std::size_t c) const {
        return r > 0 ? site(r - 1, c) : (rows - 1) * cols + (c + shear) % cols;
    }
    [[nodiscard]] std::size_t left(std::size_t r, std::size_t c) const {
        return site(r, c + cols - 1);
    }
};

/// A linear map of (row, column), by columns: what (1, 0) and (0, 1) become.
struct PixelMap {
    std::array<double, 2> row = {1, 0};
    std::array<double, 2> col = {0, 1};
    [[nodiscard]] bool is_identity() const {
        return row == std::array<double, 2>{1, 0} && col == std::array<double, 2>{0, 1};
    }
};

struct FoundLattice {
    TileLattice tile;
    /// From pixels in which the lattice is whole to those of the sample: the identity but for
    /// near-regular samples, whose periods are neither whole nor along the rows.
    PixelMap to_sample;
};

/// The shifts under which a sample agrees best with itself, between 2/3 and 11/12 of its
/// sides: the least mean squared difference over the overlap, for all shifts at once
///
///     Σ (a - b)² = Σ a² + Σ b² - 2 Σ a b
///
/// by a summed-area table and one correlation. Near-regular samples have their minima at whole
/// numbers of periods.
/// \param height  without tilt
[[nodiscard]] FoundLattice find_tile_lattice(const BasicImage<double>& height);

/// The largest rectangle of the sample in pixels where the lattice is whole, by cubic
/// convolution [Keys 1981, a = -1/2].
[[nodiscard]] BasicImage<double> straightened(const BasicImage<double>& sample,
                                              const PixelMap& to_sample);

}  // namespace sateen
