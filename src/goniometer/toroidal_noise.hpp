// SPDX-License-Identifier: Apache-2.0
// Noise on the unit torus, at any point: lattices of so many cells across and down.
#pragma once

#include <cstdint>

namespace sateen::goniometer {

/// Which noise: the seed of the surface, and a number for each use.
struct NoiseKey {
    std::uint64_t seed = 0;
    std::uint32_t use = 0;
};

/// Uniform in [0, 1) at a cell of a lattice, or of any pair of numbers.
[[nodiscard]] float uniform(NoiseKey key, std::int32_t i, std::int32_t j);

/// Gradient noise [Perlin 2002]: mean 0, about ±0.7, features one cell wide.
[[nodiscard]] float gradient_noise(NoiseKey key, float u, float v, int across, int down);

/// Octaves of it, each of half the size and `gain` times the amplitude of the one before;
/// the amplitudes sum to 1.
[[nodiscard]] float fractal_noise(NoiseKey key, float u, float v, int across, int down,
                                  int octaves, float gain = 0.5F);

/// A jittered point a cell: which one is nearest [Worley 1996], and how far it is to
/// the line from which another is as near.
struct Cell {
    float nearest = 0;  ///< distance to the nearest point, in cells
    float border = 0;   ///< distance to the border with the second nearest, in cells
    /// The softened minimum of the distances to all borders, in cells: round where several
    /// cells meet, below 0 near corners.
    float rounded = 0;
    std::int32_t i = 0;  ///< whose it is
    std::int32_t j = 0;
};
[[nodiscard]] Cell cell_at(NoiseKey key, float u, float v, int across, int down);

/// 0 below `low`, 1 above `high`, smooth between.
[[nodiscard]] float smooth_step(float low, float high, float x);

}  // namespace sateen::goniometer
