// SPDX-License-Identifier: Apache-2.0
// How mean colour and contrast of a material change with view and light, beyond what its
// subspaces hold. Theory: docs/theory/reflectance.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/direction_mesh.hpp"

namespace sateen {

/// Mean colour and contrast of every pair of directions, as a matrix of low rank:
///
///     e_c(l, v) = base_c(v) + Σ_k lights_k(l) views_k,c(v),   c = 0 … d
///     mean of band c = max(0, e_c)³ for c < d,   contrast = max(0, e_d)
///
/// The cube root is near what the eye sees, as in Lab. The contrast is the standard
/// deviation of the luminance divided by its mean. An addition, not in the papers.
struct Reflectance {
    static constexpr std::size_t kMaxRank = 16;
    static constexpr float kMaxFactor = 1e3F;

    std::uint32_t channels = 4;  ///< d + 1
    std::uint32_t rank = 0;
    std::vector<float> base;    ///< (views, channels)
    std::vector<float> lights;  ///< (lights, rank)
    std::vector<float> views;   ///< (views, channels, rank)
    friend bool operator==(const Reflectance&, const Reflectance&) = default;
};

/// e_0 … e_d of one view and light; entries past d are 0.
using EncodedAppearance = std::array<float, 4>;

/// Between directions: factors are interpolated, then multiplied.
/// \cost 3 (d + 2) rank multiplications
[[nodiscard]] EncodedAppearance encoded_appearance(const Reflectance& reflectance,
                                                   const DirectionWeights& view,
                                                   const DirectionWeights& light);

/// Of a pair of measured directions.
[[nodiscard]] EncodedAppearance encoded_appearance(const Reflectance& reflectance,
                                                   std::size_t view, std::size_t light);

}  // namespace sateen
