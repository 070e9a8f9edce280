// SPDX-License-Identifier: Apache-2.0
// The recursion that draws a two-dimensional causal autoregressive field from noise.
// Theory: docs/theory/causal_recursion.md. Naive reference:
// tests/reference/causal_recursion.hpp.
#pragma once

#include <span>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// One coefficient a_s of a causal neighbourhood, s = (row, col): row > 0, or row = 0 and
/// col > 0.
struct CausalTap {
    int row = 0;
    int col = 0;
    float a = 0;
};

/// The furthest a tap may reach, |s_1| and |s_2|.
inline constexpr int kCausalReach = 8;

/// Turns noise into a causal autoregressive field, in place:
///
///     Y_r = Σ_{s ∈ I^c} a_s Y_{r-s} + σ e_r                                 [CAR2, eq.
///     1]
///
/// Y is zero left and right of the columns, and above `above`. Each sum starts with σ e_r
/// and goes on over the neighbours in raster order, in float: the same bits on every
/// target.
///
/// \param taps   any number, in any order, no site twice; without any, Y_r = σ e_r
/// \param sigma  σ
/// \param above  the rows above the field, of as many columns: the last rows of the strip
///               before, for a field drawn strip by strip. The lowest max s_1 of them are
///               used; rows that are not there are zero. Must not overlap `field`.
/// \param field  in: e_r, out: Y_r
/// \error invalid_argument  a tap that is not causal or reaches too far, or `above` of
/// another
///                          number of columns.
/// \cost O(taps) a site, 16 rows at a time with AVX-512, 8 with AVX2: strips should be of
/// as
///       many rows, or more. Works in about 30 KB for taps up to three rows away.
[[nodiscard]] Result<void> causal_recursion(std::span<const CausalTap> taps, float sigma,
                                            PlaneView<const float> above,
                                            PlaneView<float> field);

/// The same with zeros above.
[[nodiscard]] Result<void> causal_recursion(std::span<const CausalTap> taps, float sigma,
                                            PlaneView<float> field);

}  // namespace sateen
