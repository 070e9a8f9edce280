// SPDX-License-Identifier: Apache-2.0
// Leather, stone, plaster, wood: random fields and cells.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "goniometer/preset_parts.hpp"
#include "goniometer/toroidal_noise.hpp"

namespace sateen::goniometer {
namespace {

float fraction(float x) {
    return x - std::floor(x);
}

}  // namespace

SurfaceMaps leather(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        // Creases wander, so that pebbles are not the straight-edged cells of a diagram.
        const float u1 = u + 0.012F * fractal_noise(key(1), u, v, 10, 10, 3);
        const float v1 = v + 0.012F * fractal_noise(key(2), u, v, 10, 10, 3);
        const Cell pebble = cell_at(key(3), u1, v1, 19, 19);
        const Cell wrinkle = cell_at(key(4), u1, v1, 52, 52);
        const float crease = smooth_step(-0.02F, 0.17F, pebble.border);
        const float fine = smooth_step(-0.1F, 0.3F, wrinkle.border);
        const float swell = fractal_noise(key(5), u, v, 3, 3, 2);
        const float grain = fractal_noise(key(6), u, v, 60, 60, 2);
        const float tone = uniform(key(7), pebble.i, pebble.j) - 0.5F;
        Spot spot;
        spot.height = 0.0062F * crease * (1.1F - 0.5F * pebble.nearest * pebble.nearest) +
                      0.0011F * fine * crease + 0.009F * swell + 0.0006F * grain;
        const float shade = (0.5F + 0.5F * crease) * (0.9F + 0.1F * fine) *
                            (1 + 0.14F * tone + 0.3F * swell + 0.15F * grain);
        spot.colour = scaled({0.27F, 0.095F, 0.036F}, shade);
        spot.roughness = 0.56F - 0.16F * crease + 0.08F * grain;
        return spot;
    });
}

SurfaceMaps stone(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        const float u1 = u + 0.02F * fractal_noise(key(1), u, v, 16, 16, 3);
        const float v1 = v + 0.02F * fractal_noise(key(2), u, v, 16, 16, 3);
        const Cell grain = cell_at(key(3), u1, v1, 34, 34);
        const float mineral = uniform(key(4), grain.i, grain.j);
        const float facet = uniform(key(5), grain.i, grain.j) - 0.5F;
        const float broken = fractal_noise(key(6), u, v, 4, 4, 7, 0.55F);
        const float ledge = 1 - std::abs(2 * fractal_noise(key(7), u, v, 3, 3, 5));
        const float dust = fractal_noise(key(8), u, v, 90, 90, 2);
        Spot spot;
        spot.height = 0.05F * broken + 0.022F * ledge + 0.0035F * facet +
                      0.003F * smooth_step(0, 0.15F, grain.border) + 0.002F * dust;
        Colour colour = {0.40F, 0.37F, 0.34F};  // quartz
        spot.roughness = 0.6F;
        if (mineral < 0.40F) {
            colour = {0.50F, 0.37F, 0.29F};  // feldspar
            spot.roughness = 0.7F;
        } else if (mineral > 0.80F) {
            colour = {0.045F, 0.045F, 0.05F};  // mica
            spot.roughness = 0.35F;
        } else if (mineral > 0.68F) {
            colour = {0.62F, 0.60F, 0.57F};
        }
        spot.colour = scaled(colour, 0.95F + 0.3F * facet + 0.35F * dust);
        return spot;
    });
}

SurfaceMaps plaster(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        // Thrown splashes whose tops a trowel has pressed flat along one direction.
        const float u1 = u + 0.02F * fractal_noise(key(1), u, v, 8, 8, 3);
        const float splash = fractal_noise(key(2), u1, v, 7, 7, 4, 0.55F);
        const float flat = smooth_step(-0.14F, 0.12F, splash);
        const float stroke = fractal_noise(key(3), u + 0.3F * v, v, 5, 40, 3);
        const float sand = fractal_noise(key(4), u, v, 64, 64, 2);
        const float swell = fractal_noise(key(5), u, v, 3, 3, 2);
        Spot spot;
        spot.height = 0.018F * flat + 0.006F * (1 - flat) * splash +
                      0.0015F * flat * stroke + (0.0045F - 0.003F * flat) * sand +
                      0.008F * swell;
        const float shade = 0.9F + 0.1F * flat + 0.1F * sand + 0.06F * swell;
        spot.colour = scaled({0.74F, 0.70F, 0.62F}, shade);
        spot.roughness = 0.95F - 0.2F * flat;
        return spot;
    });
}

SurfaceMaps wood(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    constexpr float kRings = 9;
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        // Grain runs down. Rings are wide and narrow in turn, and bend slowly.
        const float bend = 1.1F * gradient_noise(key(1), u, v, 2, 1) +
                           0.45F * gradient_noise(key(2), u, v, 4, 2) +
                           0.10F * gradient_noise(key(3), u, v, 9, 5);
        const float ring = fraction(kRings * u + 2.2F * bend);
        const float late =
            smooth_step(0.15F, 0.92F, ring) * (1 - smooth_step(0.93F, 1.0F, ring));
        const float fibre = fractal_noise(key(4), u, v, 90, 3, 3, 0.75F);
        const float cloud = fractal_noise(key(5), u, v, 3, 2, 3);
        // Open pores are short furrows, most of them in early wood.
        const Cell pore = cell_at(key(6), u + 0.004F * bend, v, 150, 15);
        const float has_pore =
            uniform(key(7), pore.i, pore.j) < 0.62F - 0.52F * late ? 1.0F : 0.0F;
        const float furrow = has_pore * (1 - smooth_step(0.10F, 0.34F, pore.nearest));
        Spot spot;
        spot.height =
            0.0012F * late + 0.0016F * fibre - 0.0034F * furrow + 0.002F * cloud;
        Colour colour = mixed({0.50F, 0.29F, 0.125F}, {0.24F, 0.105F, 0.036F}, late);
        colour = mixed(colour, {0.10F, 0.042F, 0.016F}, 0.7F * furrow);
        spot.colour = scaled(colour, 1 + 0.65F * fibre + 0.3F * cloud);
        spot.roughness = 0.40F + 0.35F * furrow + 0.08F * late;
        return spot;
    });
}

}  // namespace sateen::goniometer
