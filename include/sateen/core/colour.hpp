// SPDX-License-Identifier: Apache-2.0
// Colour: the sRGB transfer curve, linear sRGB to CIE Lab (D65, 2° observer), and
// colour differences.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <span>

namespace sateen {

/// Linear light to sRGB code value [IEC 61966-2-1], both nominally in [0, 1].
///
///     12.92 v  for v ≤ 0.0031308,   1.055 v^(1/2.4) - 0.055  above
///
/// Odd: srgb_encode(-v) = -srgb_encode(v), and the curve goes on beyond 1.
template <std::floating_point T>
[[nodiscard]] T srgb_encode(T linear) {
    const T v = std::abs(linear);
    const T code = v <= T(0.0031308) ? T(12.92) * v
                                     : T(1.055) * std::pow(v, T(1) / T(2.4)) - T(0.055);
    return std::copysign(code, linear);
}

/// sRGB code value to linear light, the inverse of srgb_encode, odd as well.
template <std::floating_point T>
[[nodiscard]] T srgb_decode(T code) {
    const T c = std::abs(code);
    const T v =
        c <= T(0.04045) ? c / T(12.92) : std::pow((c + T(0.055)) / T(1.055), T(2.4));
    return std::copysign(v, code);
}

/// CIE L*a*b* 1976. L is 0 for black and 100 for the white of the display.
struct Lab {
    double L = 0;
    double a = 0;
    double b = 0;
};

/// Linear sRGB to X/X_n, Y/Y_n, Z/Z_n, where (X_n, Y_n, Z_n) is the white (1, 1, 1): the
/// primaries and the white (x, y) = (0.3127, 0.3290) of [IEC 61966-2-1] in full
/// precision, each row divided by its sum, so that white is (100, 0, 0) in Lab.
inline constexpr std::array<std::array<double, 3>, 3> kRelativeXyzOfLinearSrgb = [] {
    std::array<std::array<double, 3>, 3> xyz = {
        {{0.41239079926595948, 0.35758433938387796, 0.18048078840183429},
         {0.21263900587151036, 0.71516867876775593, 0.072192315360733715},
         {0.019330818715591851, 0.11919477979462599, 0.95053215224966058}}};
    for (auto& row : xyz) {
        const double white = row[0] + row[1] + row[2];
        for (double& value : row) value /= white;
    }
    return xyz;
}();

/// The two pieces of the Lab function f(t): t^(1/3) above kLabThreshold = (6/29)³,
/// (kLabSlope t + 16) / 116 with kLabSlope = (29/3)³ up to it [CIE 15:2004].
inline constexpr double kLabThreshold = 216.0 / 24389.0;
inline constexpr double kLabSlope = 24389.0 / 27.0;

/// Linear sRGB to CIE Lab. Negative tristimulus values follow the linear piece of f,
/// values beyond 1 its cube root: the map has no bounds.
///
///     L = 116 f(Y/Y_n) - 16,  a = 500 (f(X/X_n) - f(Y/Y_n)),
///     b = 200 (f(Y/Y_n) - f(Z/Z_n))                                    [CIE 15:2004]
[[nodiscard]] inline Lab lab_from_linear_srgb(double red, double green, double blue) {
    const auto f = [&](const std::array<double, 3>& row) {
        const double t = row[0] * red + row[1] * green + row[2] * blue;
        return t > kLabThreshold ? std::cbrt(t) : (kLabSlope * t + 16.0) / 116.0;
    };
    const double fx = f(kRelativeXyzOfLinearSrgb[0]);
    const double fy = f(kRelativeXyzOfLinearSrgb[1]);
    const double fz = f(kRelativeXyzOfLinearSrgb[2]);
    return {116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)};
}

/// The same for pixels in planes of one length, within 2e-4 for components in [0, 1];
/// the last bits depend on the SIMD target. Outputs must not overlap inputs.
/// \cost about 1 ns a pixel with AVX2
void lab_from_linear_srgb(std::span<const float> red, std::span<const float> green,
                          std::span<const float> blue, std::span<float> L,
                          std::span<float> a, std::span<float> b);

/// L of grey pixels of linear luminance `Y`, whose a and b are 0.
void lightness_from_linear(std::span<const float> Y, std::span<float> L);

/// The Euclidean distance in Lab [CIE 15:2004]; about 2.3 is just noticeable.
[[nodiscard]] double delta_e_76(const Lab& first, const Lab& second);

/// CIEDE2000 with k_L = k_C = k_H = 1 [Sharma, Wu & Dalal 2005].
[[nodiscard]] double delta_e_2000(const Lab& first, const Lab& second);

}  // namespace sateen
