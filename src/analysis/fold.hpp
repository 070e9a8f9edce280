// SPDX-License-Identifier: Apache-2.0
// Folding images into the cell of a bent lattice, and reading the cell back.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {

/// u(x) = B⁻¹ (x + D(x)) of one pixel.
/// \param displacement  (2, rows, cols)
[[nodiscard]] inline std::array<double, 2> phase_at(const LatticeMap& map,
                                                    const Image& displacement,
                                                    std::size_t r, std::size_t c) {
    return map.to_cell(
        static_cast<double>(r) + static_cast<double>(displacement(0, r, c)),
        static_cast<double>(c) + static_cast<double>(displacement(1, r, c)));
}

/// The mean of the pixels of each phase, of all images: every pixel is shared among the four
/// sites around it, linearly. Sites without pixels become the mean of all.
/// \param displacements  one an image
/// \param first  phase of the first site, in steps
/// \param stride every so many rows and columns only
/// \returns      (d, P, Q)
[[nodiscard]] Image fold(std::span<const Image> images, const LatticeMap& map,
                         std::span<const Image> displacements, std::size_t P,
                         std::size_t Q, Executor& executor, double first = 0,
                         std::size_t stride = 1);

/// planes - cells at the phases of the pixels, linear between sites.
[[nodiscard]] Image subtract_cells(const Image& planes, const LatticeMap& map,
                                   const Image& displacement, const Image& cells,
                                   Executor& executor);

/// Four sites around a phase on a periodic grid, and their weights.
struct CellTaps {
    std::array<std::size_t, 4> sites;
    std::array<float, 4> weights;

    CellTaps(double u, double v, std::size_t P, std::size_t Q, double first = 0) {
        // One more turn where `first` takes the position below 0.
        double r = (u - whole_part(u)) * static_cast<double>(P) - first;
        double c = (v - whole_part(v)) * static_cast<double>(Q) - first;
        if (r < 0) r += static_cast<double>(P);
        if (c < 0) c += static_cast<double>(Q);
        auto row = static_cast<std::size_t>(r);
        auto col = static_cast<std::size_t>(c);
        const auto dr = static_cast<float>(r - static_cast<double>(row));
        const auto dc = static_cast<float>(c - static_cast<double>(col));
        // What rounds up to 1 is 0.
        if (row >= P) row = 0;
        if (col >= Q) col = 0;
        const std::size_t below = row + 1 == P ? 0 : row + 1;
        const std::size_t right = col + 1 == Q ? 0 : col + 1;
        sites = {row * Q + col, row * Q + right, below * Q + col, below * Q + right};
        weights = {(1 - dr) * (1 - dc), (1 - dr) * dc, dr * (1 - dc), dr * dc};
    }
    /// The value there of a grid.
    [[nodiscard]] float read(const float* grid) const {
        return weights[0] * grid[sites[0]] + weights[1] * grid[sites[1]] +
               weights[2] * grid[sites[2]] + weights[3] * grid[sites[3]];
    }
};

}  // namespace sateen
