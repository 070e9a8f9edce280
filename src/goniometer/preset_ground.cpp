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
        const float u1 = u + 0.030F * fractal_noise(key(1), u, v, 14, 14, 3);
        const float v1 = v + 0.030F * fractal_noise(key(2), u, v, 14, 14, 3);
        const Cell pebble = cell_at(key(3), u1, v1, 21, 17);
        const Cell wrinkle = cell_at(key(4), u1, v1, 47, 39);
        // Some creases are deep, others hardly parts two pebbles.
        const float depth = std::clamp(
            0.75F + 1.6F * fractal_noise(key(8), u, v, 16, 16, 2), 0.25F, 1.0F);
        const float dome = smooth_step(-0.10F, 0.42F, pebble.rounded);
        const float fine = smooth_step(-0.06F, 0.30F, wrinkle.rounded);
        const float swell = fractal_noise(key(5), u, v, 3, 3, 2);
        const float grain = fractal_noise(key(6), u, v, 70, 70, 2);
        const float tone = uniform(key(7), pebble.i, pebble.j) - 0.5F;
        Spot spot;
        spot.height = 0.0090F * (1 - depth * (1 - dome)) + 0.0013F * fine * dome +
                      0.0015F * tone * dome + 0.009F * swell + 0.0009F * grain;
        const float shade = (1 - 0.38F * depth * (1 - dome)) * (0.93F + 0.07F * fine) *
                            (1 + 0.07F * tone + 0.35F * swell + 0.12F * grain);
        spot.colour = scaled({0.25F, 0.088F, 0.034F}, shade);
        spot.roughness = 0.58F - 0.10F * dome + 0.08F * grain;
        return spot;
    });
}

SurfaceMaps stone(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        // Grains have grown into each other: large feldspar, quartz between, small mica.
        const float u1 = u + 0.035F * fractal_noise(key(1), u, v, 22, 22, 4, 0.65F);
        const float v1 = v + 0.035F * fractal_noise(key(2), u, v, 22, 22, 4, 0.65F);
        const Cell large = cell_at(key(3), u1, v1, 17, 17);
        const Cell small = cell_at(key(4), u1, v1, 44, 44);
        const float cloud = fractal_noise(key(9), u, v, 7, 7, 2);
        const bool feldspar = uniform(key(5), large.i, large.j) < 0.42F;
        const float kind = uniform(key(10), small.i, small.j) + 0.5F * cloud;
        const bool mica = kind > 0.80F && (!feldspar || kind > 1.0F);
        const float tone =
            uniform(key(11), feldspar ? large.i : small.i, feldspar ? large.j : small.j) -
            0.5F;
        const float broken = fractal_noise(key(6), u, v, 4, 4, 7, 0.6F);
        const float ledge = 1 - std::abs(2 * fractal_noise(key(7), u, v, 3, 3, 5));
        const float dust = fractal_noise(key(8), u, v, 100, 100, 2);
        Spot spot;
        spot.height = 0.045F * broken + 0.020F * ledge + 0.0025F * tone + 0.002F * dust -
                      (mica ? 0.0015F : 0.0F);
        Colour colour = {0.36F, 0.345F, 0.33F};  // quartz
        spot.roughness = 0.6F;
        if (mica) {
            colour = {0.035F, 0.036F, 0.04F};
            spot.roughness = 0.5F;
        } else if (feldspar) {
            colour = {0.53F, 0.40F, 0.325F};
            spot.roughness = 0.7F;
        } else if (kind < 0.18F) {
            colour = {0.58F, 0.57F, 0.54F};
        }
        spot.colour = scaled(colour, 1 + 0.35F * tone + 0.45F * dust + 0.25F * cloud);
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
    constexpr float kRings = 11;
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        // Grain runs down. Rings are wide and narrow in turn, and bend slowly.
        const float bend = 1.1F * gradient_noise(key(1), u, v, 2, 1) +
                           0.45F * gradient_noise(key(2), u, v, 4, 2) +
                           0.10F * gradient_noise(key(3), u, v, 9, 5);
        const float ring = fraction(kRings * u + 2.2F * bend);
        const float late =
            smooth_step(0.05F, 0.90F, ring) * (1 - smooth_step(0.90F, 1.0F, ring));
        const float along = u + 0.016F * bend;
        const float fibre = fractal_noise(key(4), along, v, 64, 2, 4, 0.8F);
        const float cloud = fractal_noise(key(5), u, v, 3, 2, 3);
        // Open pores are short furrows, most of them in early wood.
        float furrow = 0;
        for (const std::uint32_t use : {6U, 8U}) {
            const Cell pore = cell_at(key(use), along, v, 190, 9);
            const bool open =
                uniform(key(use + 1), pore.i, pore.j) < 0.50F - 0.46F * late;
            if (open)
                furrow = std::max(furrow, 1 - smooth_step(0.12F, 0.42F, pore.nearest));
        }
        Spot spot;
        spot.height =
            0.0010F * late + 0.0018F * fibre - 0.0020F * furrow + 0.002F * cloud;
        Colour colour = mixed({0.46F, 0.275F, 0.125F}, {0.27F, 0.130F, 0.048F}, late);
        colour = mixed(colour, {0.13F, 0.058F, 0.022F}, 0.60F * furrow);
        spot.colour = scaled(colour, 1 + 0.85F * fibre + 0.3F * cloud);
        spot.roughness = 0.56F + 0.20F * furrow + 0.06F * late;
        return spot;
    });
}

}  // namespace sateen::goniometer
