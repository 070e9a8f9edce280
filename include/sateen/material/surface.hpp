// SPDX-License-Identifier: Apache-2.0
// The range map of a material as data: toroidal tiles of quantised height.
// docs/format.md, section 10, is normative; theory: docs/theory/surface_storage.md.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

inline constexpr std::size_t kMaxSurfaceTiles = 8;
/// Rows and columns of a tile.
inline constexpr std::uint32_t kMaxSurfaceSide = 2048;
/// Height values of all tiles together.
inline constexpr std::size_t kMaxSurfaceValues = std::size_t{1} << 21U;
/// Light from elsewhere, of the lamp's.
inline constexpr float kMaxAmbient = 16;

/// Tiles of the range map, in pixels of the measurement. They are fundamental domains of the
/// lattice spanned by (row, column) steps
///
///     a = (rows, shear_px)   and   b = (0, cols)
///
/// (the Hermite normal form that every integer lattice has), so that tile (i, j) covers rows
/// i·rows … and, in them, columns j·cols + i·shear_px … of the plane. Their borders are
/// equal: any tile fits beside any other, and tile_at() says which one is where.
struct Surface {
    std::uint32_t rows = 0;
    std::uint32_t cols = 0;
    std::uint32_t shear_px = 0;  ///< less than cols
    /// Height along +z in pixels: z = offset_px + scale_px · code.
    float offset_px = 0;
    float scale_px = 0;
    /// The smooth texture was fitted to images divided by the shading of this surface, and
    /// is to be multiplied by it.
    bool delit = false;
    /// Light that reaches the surface from elsewhere, and does not shade it, over that of the
    /// lamp: its shading is s = (d + ambient) / (1 + ambient), d = max(0, n·l) / mean.
    float ambient = 0;
    std::vector<std::vector<std::uint16_t>> tiles;  ///< (rows, cols) row-major each
    friend bool operator==(const Surface&, const Surface&) = default;

    [[nodiscard]] float height_px(std::uint16_t code) const {
        return offset_px + scale_px * static_cast<float>(code);
    }
};

/// A permutation of 32-bit numbers that mixes all bits (H. Wellons' lowbias32).
[[nodiscard]] constexpr std::uint32_t mix_bits(std::uint32_t x) {
    x ^= x >> 16U;
    x *= 0x7FEB352DU;
    x ^= x >> 15U;
    x *= 0x846CA68BU;
    return x ^ (x >> 16U);
}

/// Which of `tiles` interchangeable tiles is tile (i, j) of the plane. Part of the format:
/// every reader draws the same plane.
[[nodiscard]] constexpr std::size_t tile_at(std::int32_t i, std::int32_t j,
                                            std::uint64_t seed, std::size_t tiles) {
    const auto low = static_cast<std::uint32_t>(seed);
    const auto high = static_cast<std::uint32_t>(seed >> 32U);
    const std::uint32_t row = mix_bits(static_cast<std::uint32_t>(i) ^ mix_bits(low));
    const std::uint32_t site = mix_bits(static_cast<std::uint32_t>(j) ^ row);
    return mix_bits(site ^ high) % tiles;
}

/// Quantises tiles of equal size together.
/// \param step_px  wanted distance of two codes; made larger where the range has more than
///                 2^16 of them. The error of a height is at most half a step.
/// \error bad_format  no tile, too many, or sizes that differ or exceed the limits
[[nodiscard]] Result<Surface> quantise_surface(std::span<const Image> tiles,
                                               float step_px, std::uint32_t shear_px = 0);

/// \error bad_format  names the field, what it holds and what was expected
[[nodiscard]] Result<void> validate(const Surface& surface);

}  // namespace sateen
