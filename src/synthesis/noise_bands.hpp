// SPDX-License-Identifier: Apache-2.0
// Which noise field drives what. All subspaces of a material use the same ones, so that
// their textures move together and keep their contrast when blended; planes, and levels
// where they are drawn apart, use different ones.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sateen {

/// Zero-phase drawing: one field a plane, and one more for the coarse part where split.
inline std::uint32_t noise_band(std::uint32_t plane) {
    return plane;
}
inline std::uint32_t coarse_noise_band(std::uint32_t plane) {
    return 4 + plane;
}
/// Causal recursion: one field a plane and level.
inline std::uint32_t recursion_noise_band(std::uint32_t plane, std::size_t level) {
    return 8 + 4 * static_cast<std::uint32_t>(level) + plane;
}
/// The displacement of a periodic layer: rows, columns.
inline std::uint32_t displacement_noise_band(std::uint32_t axis) {
    return 64 + axis;
}
/// The fields of amplitude of a band.
inline std::uint32_t modulation_noise_band(std::size_t level) {
    return 96 + static_cast<std::uint32_t>(level);
}

}  // namespace sateen
