// SPDX-License-Identifier: Apache-2.0
// One normal at a time: the bits draw_normals must give, and the values it approximates.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sateen/core/normal.hpp"

namespace sateen::reference {

/// The two words behind a site, (radius, angle), and which normal of the pair it is.
struct SiteWords {
    std::uint32_t radius;
    std::uint32_t angle;
    bool second;
};

inline SiteWords site_words(NoiseField field, std::int32_t row, std::int32_t col) {
    const std::int32_t group = col / 4 - (col % 4 < 0 ? 1 : 0);
    const auto place = static_cast<std::size_t>(col - 4 * group);
    const auto words = philox4x32_10({static_cast<std::uint32_t>(group),
                                      static_cast<std::uint32_t>(row), field.band, 0},
                                     {static_cast<std::uint32_t>(field.seed),
                                      static_cast<std::uint32_t>(field.seed >> 32)});
    return {words[place / 2 * 2], words[place / 2 * 2 + 1], place % 2 == 1};
}

/// √(-2 ln u), u = (⌊w / 2⌋ + ½) 2^-31, in float, operation by operation as the kernel
/// does.
inline float radius(std::uint32_t w) {
    const float u = static_cast<float>(w >> 1) + 0.5F;
    const auto bits = std::bit_cast<std::uint32_t>(u);
    const std::int32_t e = static_cast<std::int32_t>(bits - 0x3F3504F3U) >> 23;
    const float f =
        std::bit_cast<float>(bits - (static_cast<std::uint32_t>(e) << 23)) - 1.0F;
    const float k = 31.0F - static_cast<float>(e);
    const float f2 = f * f;
    const float p01 = f * -0.2500174343585968F + 0.33333858847618103F;
    const float p23 = f * -0.16565747559070587F + 0.199654221534729F;
    const float p45 = f * -0.14349184930324554F + 0.14876779913902283F;
    const float p = (f2 * f2) * (f2 * 0.08917124569416046F + p45) + (f2 * p23 + p01);
    const float tail = k * -2.12194440054690583e-4F - (f2 * f) * p;
    const float minus_log = ((f2 * 0.5F + tail) - f) + k * 0.693359375F;
    return std::sqrt(minus_log + minus_log);
}

/// (cos θ, sin θ) of a word, in float, operation by operation as the kernel does.
inline std::array<float, 2> cos_sin(std::uint32_t w) {
    const float y =
        static_cast<float>(static_cast<std::int32_t>(w << 2)) * 3.65729529994141e-10F;
    const float y2 = y * y;
    float s = -0.00013761839363723993F;
    for (const float c :
         {0.0058913202956318855F, -0.11785092204809189F, 0.7071067690849304F}) {
        s = s * y2 + c;
    }
    float c = -0.0009606723324395716F;
    for (const float a :
         {0.029454555362462997F, -0.35355237126350403F, 0.7071067690849304F}) {
        c = c * y2 + a;
    }
    s = y * s;
    return {(w >> 31 & 1U) != 0 ? -(c - s) : c - s,
            (w >> 30 & 1U) != 0 ? -(c + s) : c + s};
}

/// The normal at a site with the bits of draw_normals.
inline float normal(NoiseField field, std::int32_t row, std::int32_t col) {
    const SiteWords words = site_words(field, row, col);
    return radius(words.radius) * cos_sin(words.angle)[words.second ? 1 : 0];
}

/// √(-2 ln u) in double.
inline double exact_radius(std::uint32_t w) {
    return std::sqrt(-2.0 * std::log((static_cast<double>(w >> 1) + 0.5) * 0x1p-31));
}

/// (cos θ, sin θ) in double.
inline std::array<double, 2> exact_cos_sin(std::uint32_t w) {
    const double y = static_cast<double>(static_cast<std::int32_t>(w << 2)) * 0x1p-31;
    const double theta = std::numbers::pi / 4 * (1 + y);
    return {(w >> 31 & 1U) != 0 ? -std::cos(theta) : std::cos(theta),
            (w >> 30 & 1U) != 0 ? -std::sin(theta) : std::sin(theta)};
}

}  // namespace sateen::reference
