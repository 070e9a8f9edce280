// SPDX-License-Identifier: Apache-2.0
// The range map to payload and back; docs/format.md, section 10, is normative.
#include "material/surface_file.hpp"

#include "material/quantise.hpp"
#include "material/surface_codec.hpp"
#include "material/vectors.hpp"

namespace sateen {

std::unique_ptr<schema::SurfaceT> pack_surface(const Surface& surface) {
    auto out = std::make_unique<schema::SurfaceT>();
    out->rows = static_cast<std::uint16_t>(surface.rows);
    out->cols = static_cast<std::uint16_t>(surface.cols);
    out->shear = static_cast<std::uint16_t>(surface.shear_px);
    out->tiles = static_cast<std::uint8_t>(surface.tiles.size());
    out->delit = surface.delit;
    out->ambient = canonical(surface.ambient);
    out->offset = canonical(surface.offset_px);
    out->scale = canonical(surface.scale_px);
    for (const auto& tile : surface.tiles)
        append_residuals(tile, surface.cols, out->low, out->high);
    return out;
}

Result<Surface> unpack_surface(const schema::Surface& in) {
    Surface out;
    out.rows = in.rows();
    out.cols = in.cols();
    out.shear_px = in.shear();
    out.offset_px = in.offset();
    out.scale_px = in.scale();
    out.delit = in.delit();
    out.ambient = in.ambient();
    const std::size_t size = std::size_t{out.rows} * out.cols;
    SATEEN_CHECK(expect_at_most("surface.tiles", in.tiles(), kMaxSurfaceTiles));
    SATEEN_CHECK(expect_at_most("surface.low", in.tiles() * size, kMaxSurfaceValues));
    SATEEN_CHECK(expect_count("surface.low", count(in.low()), in.tiles() * size));
    SATEEN_CHECK(expect_count("surface.high", count(in.high()), in.tiles() * size));
    for (std::size_t tile = 0; tile < in.tiles(); ++tile)
        out.tiles.push_back(restore_codes([&](std::size_t i) { return at(in.low(), i); },
                                          [&](std::size_t i) { return at(in.high(), i); },
                                          tile * size, out.rows, out.cols));
    return out;
}

}  // namespace sateen
