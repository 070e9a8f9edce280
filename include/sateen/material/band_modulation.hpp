// SPDX-License-Identifier: Apache-2.0
// How the amplitude of the finer bands of a texture goes with what is coarser, as data.
// Theory: docs/theory/band_modulation.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/material/structure.hpp"

namespace sateen {

/// Of the whole material: the clumps in which it is rougher or smoother, the same for all
/// subspaces.
struct BandModulation {
    /// Bands that are modulated, finest first; what is coarser stays as it is.
    static constexpr std::size_t kLevels = 4;
    static constexpr float kMaxDeviation = 4;  ///< of a field, in octaves
    /// h_s, in octaves, on every field_spacing(s)-th pixel; deviation 0: h_s = 0.
    std::array<SmoothField, kLevels> fields;
    friend bool operator==(const BandModulation&, const BandModulation&) = default;
};

[[nodiscard]] constexpr std::size_t field_spacing(std::size_t level) {
    return std::size_t{2} << level;
}

/// Octaves of amplitude over 8 equally spaced knots, linear between and constant outside.
struct AmplitudeCurve {
    static constexpr std::size_t kKnots = 8;
    static constexpr float kStep = 1.0F / 32;
    std::array<std::int8_t, kKnots> values{};  ///< multiples of kStep
    friend bool operator==(const AmplitudeCurve&, const AmplitudeCurve&) = default;
};

/// One band of one plane of one subspace. With v the sum of all coarser bands, finished, and
/// E the local energy of finished bands, of the next coarser one of the same plane (p) and of
/// this level of the first plane (f):
///
///     u = h + c_v(v·value_scale) + c_p(½ L(E_p·scale_p)) + c_f(½ L(E_f·scale_f))
///     band ← gain · 2^u · band
///
/// L is the binary logarithm and 2^u its inverse, both linear between powers of two. The scales
/// are those of the bands E is the energy of.
struct ModulatedBand {
    static constexpr float kValueRange = 2.5F;     ///< knots of c_v from -2.5 to 2.5
    static constexpr float kAmplitudeLow = -2.5F;  ///< and of c_p and c_f from -2.5
    static constexpr float kAmplitudeHigh = 1.5F;  ///< to 1.5 octaves
    float value_scale = 1;                         ///< 1 / deviation of v
    float energy_scale = 1;                        ///< 1 / variance of the finished band
    float gain = 1;
    AmplitudeCurve of_value;
    AmplitudeCurve of_parent;
    AmplitudeCurve of_first;
    friend bool operator==(const ModulatedBand&, const ModulatedBand&) = default;
};

/// Of one subspace.
struct SubspaceModulation {
    std::vector<ModulatedBand> bands;  ///< plane by plane, finest first
    std::vector<float>
        units;  ///< of each plane: what the sum of its bands is multiplied by
    friend bool operator==(const SubspaceModulation&,
                           const SubspaceModulation&) = default;
};

/// Scales, gains and units are stored as the upper halves of binary32 numbers, rounded.
[[nodiscard]] std::uint16_t upper_half(float value);
[[nodiscard]] float from_upper_half(std::uint16_t half);
[[nodiscard]] inline float to_half_of_float(float value) {
    return from_upper_half(upper_half(value));
}

}  // namespace sateen
