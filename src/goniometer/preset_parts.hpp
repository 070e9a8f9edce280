// SPDX-License-Identifier: Apache-2.0
// The surfaces that presets are made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sateen/goniometer/surface_maps.hpp"

namespace sateen::goniometer {

using Colour = std::array<float, 3>;

inline Colour scaled(const Colour& colour, float factor) {
    return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
}
inline Colour mixed(const Colour& a, const Colour& b, float share_of_b) {
    return {a[0] + share_of_b * (b[0] - a[0]), a[1] + share_of_b * (b[1] - a[1]),
            a[2] + share_of_b * (b[2] - a[2])};
}

/// A point of a surface.
struct Spot {
    float height = 0;  ///< in units of the width of the surface
    Colour colour{};
    float roughness = 1;
};

/// A surface without normals from `spot(u, v)`, or `spot(u, v, row, col)`, of every
/// texel; u right and v down in [0, 1).
template <class F>
[[nodiscard]] SurfaceMaps paint(std::size_t side, const F& spot) {
    SurfaceMaps surface{
        Image(1, side, side), {}, Image(3, side, side), Image(1, side, side)};
    for (std::size_t r = 0; r < side; ++r)
        for (std::size_t c = 0; c < side; ++c) {
            const float u = (static_cast<float>(c) + 0.5F) / static_cast<float>(side);
            const float v = (static_cast<float>(r) + 0.5F) / static_cast<float>(side);
            const Spot here = spot(u, v, r, c);
            surface.height(0, r, c) = here.height;
            for (std::size_t band = 0; band < 3; ++band)
                surface.colour(band, r, c) = here.colour[band];
            surface.roughness(0, r, c) = here.roughness;
        }
    return surface;
}

[[nodiscard]] SurfaceMaps leather(std::size_t side, std::uint64_t seed);
[[nodiscard]] SurfaceMaps stone(std::size_t side, std::uint64_t seed);
[[nodiscard]] SurfaceMaps plaster(std::size_t side, std::uint64_t seed);
[[nodiscard]] SurfaceMaps wood(std::size_t side, std::uint64_t seed);

[[nodiscard]] SurfaceMaps corduroy(std::size_t side, std::uint64_t seed);
[[nodiscard]] SurfaceMaps plain_weave(std::size_t side, std::uint64_t seed);
[[nodiscard]] SurfaceMaps twill(std::size_t side, std::uint64_t seed);
[[nodiscard]] SurfaceMaps knit(std::size_t side, std::uint64_t seed);

}  // namespace sateen::goniometer
