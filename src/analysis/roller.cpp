// SPDX-License-Identifier: Apache-2.0
// The Roller. See roller.hpp.
#include "sateen/analysis/roller.hpp"

#include <algorithm>
#include <string>

#include "analysis/roller_lattice.hpp"
#include "analysis/roller_seams.hpp"
#include "analysis/roller_tiles.hpp"
#include "sateen/analysis/integrate.hpp"
#include "sateen/material/surface.hpp"

namespace sateen {
namespace {

using Plane = BasicImage<double>;

constexpr std::size_t kSmallestSide = 16;

Plane centre(const Plane& height, std::size_t largest) {
    const std::size_t rows = std::min(height.rows(), largest);
    const std::size_t cols = std::min(height.cols(), largest);
    Plane out(1, rows, cols);
    const std::size_t top = (height.rows() - rows) / 2;
    const std::size_t left = (height.cols() - cols) / 2;
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c)
            out(0, r, c) = height(0, top + r, left + c);
    return out;
}

Image to_float(const Plane& plane) {
    Image out(1, plane.rows(), plane.cols());
    for (std::size_t i = 0; i < plane.plane_size(); ++i)
        out.values()[i] = static_cast<float>(plane.values()[i]);
    return out;
}

}  // namespace

Result<RolledSurface> roll(const BasicImage<double>& height,
                           const RollerOptions& options) {
    if (options.tiles < 1 || options.tiles > kMaxSurfaceTiles)
        return Error{Errc::invalid_argument, "roller: " + std::to_string(options.tiles) +
                                                 " tiles, expected 1 to 8"};
    if (std::min(height.rows(), height.cols()) < kSmallestSide)
        return Error{Errc::invalid_argument, "roller: a range map of " +
                                                 std::to_string(height.cols()) + " x " +
                                                 std::to_string(height.rows()) +
                                                 " pixels, expected at least 16 a side"};
    RolledSurface out;
    TileLattice lattice{height.rows(), height.cols(), 0};
    RolledTile first{height,
                     {std::vector<std::uint8_t>(height.plane_size(), 0),
                      std::vector<std::uint8_t>(height.plane_size(), 0)}};
    out.was_toroidal = std::max(height.rows(), height.cols()) <= options.largest_side &&
                       is_toroidal(slopes_of(height, Difference::central));
    if (!out.was_toroidal) {
        Plane sample = centre(height, options.largest_side);
        remove_tilt(sample);
        const FoundLattice found = find_tile_lattice(sample);
        if (!found.to_sample.is_identity()) {
            sample = straightened(sample, found.to_sample);
            remove_tilt(sample);
        }
        lattice = found.tile;
        out.overlap_rows = sample.rows() - lattice.rows;
        out.overlap_cols = sample.cols() - lattice.cols;
        first = cut_tile(sample, lattice);
    }
    out.shear_px = static_cast<std::uint32_t>(lattice.shear);
    SeamRatios ratios;
    const auto take = [&](const RolledTile& tile) {
        ratios.add(tile.z, lattice, tile.seams);
        out.tiles.push_back(to_float(tile.z));
    };
    if (options.tiles > 1) begin_at_plain_border(first, lattice);
    take(first);
    if (options.tiles > 1) {
        Interchange interchange(first, lattice);
        while (out.tiles.size() < options.tiles) take(interchange.another());
    }
    out.seam_ratio = ratios.height();
    out.normal_seam_ratio = ratios.normals();
    return out;
}

}  // namespace sateen
