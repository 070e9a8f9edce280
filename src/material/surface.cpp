// SPDX-License-Identifier: Apache-2.0
// Limits and quantisation of the range map. See surface.hpp.
#include "sateen/material/surface.hpp"

#include <cmath>
#include <limits>

#include "material/message.hpp"
#include "sateen/material/material.hpp"

namespace sateen {
namespace {

constexpr std::uint16_t kLargestCode = std::numeric_limits<std::uint16_t>::max();

Result<void> check_side(std::string_view what, std::size_t side) {
    if (side >= 1 && side <= kMaxSurfaceSide) return {};
    return bad_format("surface.", what, ": ", text(side), ", expected 1 to ",
                      text(std::size_t{kMaxSurfaceSide}));
}

Result<void> check_height(std::string_view what, float value, float low) {
    if (value >= low && value <= kMaxMagnitude) return {};  // false for NaN
    return bad_format("surface.", what, ": ", text(value), ", expected ", text(low),
                      " to ", text(kMaxMagnitude));
}

Result<void> check_tile_count(std::size_t tiles, std::size_t tile_size) {
    if (tiles < 1 || tiles > kMaxSurfaceTiles)
        return bad_format("surface.tiles: ", text(tiles), ", expected 1 to ",
                          text(kMaxSurfaceTiles));
    if (tiles * tile_size > kMaxSurfaceValues)
        return bad_format("surface.tiles: ", text(tiles * tile_size),
                          " values, expected at most ", text(kMaxSurfaceValues));
    return {};
}

}  // namespace

Result<void> validate(const Surface& surface) {
    SATEEN_CHECK(check_side("rows", surface.rows));
    SATEEN_CHECK(check_side("cols", surface.cols));
    if (surface.shear_px >= surface.cols)
        return bad_format("surface.shear_px: ", text(std::size_t{surface.shear_px}),
                          ", expected less than ", text(std::size_t{surface.cols}));
    SATEEN_CHECK(check_height("offset_px", surface.offset_px, -kMaxMagnitude));
    SATEEN_CHECK(check_height("scale_px", surface.scale_px, 0));
    if (!(surface.ambient >= 0) || surface.ambient > kMaxAmbient)
        return bad_format("surface.ambient: ", text(surface.ambient),
                          ", expected 0 to 16");
    const std::size_t size = std::size_t{surface.rows} * surface.cols;
    SATEEN_CHECK(check_tile_count(surface.tiles.size(), size));
    for (const auto& tile : surface.tiles)
        SATEEN_CHECK(expect_count("surface.tiles", tile.size(), size));
    return {};
}

Result<Surface> quantise_surface(std::span<const Image> tiles, float step_px,
                                 std::uint32_t shear_px) {
    if (tiles.empty()) return bad_format("surface.tiles: 0, expected 1 to 8");
    Surface out;
    SATEEN_CHECK(check_side("rows", tiles[0].rows()));
    SATEEN_CHECK(check_side("cols", tiles[0].cols()));
    SATEEN_CHECK(check_tile_count(tiles.size(), tiles[0].plane_size()));
    out.rows = static_cast<std::uint32_t>(tiles[0].rows());
    out.cols = static_cast<std::uint32_t>(tiles[0].cols());
    out.shear_px = shear_px;
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (const Image& tile : tiles) {
        if (tile.bands() != 1 || tile.rows() != out.rows || tile.cols() != out.cols)
            return bad_format("surface.tiles: sizes that differ");
        for (const float z : tile.values()) {
            SATEEN_CHECK(check_height("tiles", z, -kMaxMagnitude));
            low = std::min(low, z);
            high = std::max(high, z);
        }
    }
    out.offset_px = low;
    out.scale_px = std::max(step_px, (high - low) / static_cast<float>(kLargestCode));
    const float codes_per_px = out.scale_px > 0 ? 1 / out.scale_px : 0;
    for (const Image& tile : tiles) {
        std::vector<std::uint16_t>& codes = out.tiles.emplace_back();
        codes.reserve(tile.plane_size());
        for (const float z : tile.values()) {
            const float code = std::round((z - low) * codes_per_px);
            codes.push_back(static_cast<std::uint16_t>(
                std::clamp(code, 0.0F, static_cast<float>(kLargestCode))));
        }
    }
    SATEEN_CHECK(validate(out));
    return out;
}

}  // namespace sateen
