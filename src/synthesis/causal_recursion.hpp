// SPDX-License-Identifier: Apache-2.0
// The recursion that draws a two-dimensional causal autoregressive field from noise.
// Theory: docs/theory/causal_recursion.md. Naive reference:
// tests/reference/causal_recursion.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

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

/// Turns noise into a causal autoregressive field, row after row:
///
///     Y_r = Σ_{s ∈ I^c} a_s Y_{r-s} + σ e_r                             [CAR2, eq. 1]
///
/// Y is zero above the first row and left and right of the columns. Sums are in float, in
/// an order that depends on the neighbourhood alone: the same bits on every target.
class CausalRecursion {
  public:
    CausalRecursion(CausalRecursion&&) = default;
    CausalRecursion& operator=(CausalRecursion&&) = default;

    /// \param taps   any number, in any order, no site twice; without any, Y_r = σ e_r
    /// \param sigma  σ
    /// \param cols   of every row
    /// \error invalid_argument  a tap that is not causal or reaches too far
    [[nodiscard]] static Result<CausalRecursion> create(std::span<const CausalTap> taps,
                                                        float sigma, std::size_t cols);

    /// e of the next row, for the caller to fill in.
    [[nodiscard]] std::span<float> noise() { return {noise_, cols_}; }

    /// Draws the next row.
    /// \returns Y; holds until the next call
    /// \cost    a multiplication and an addition a site for each tap of the rows above,
    ///          eight for each of the row itself. The rows worked in, max s_1 + 4 of
    ///          them, should fit into the first-level cache.
    [[nodiscard]] std::span<const float> next_row();

    /// A sum along a row: to(x) = scale from(x) + Σ_i a_i from_i(x).
    struct Sum {
        struct Term {
            const float* from;
            float a;
        };
        float scale = 1;
        const float* from = nullptr;
        float* to = nullptr;
        std::vector<Term> terms;
    };

  private:
    CausalRecursion() = default;
    void allocate(std::size_t rows, std::size_t reach);
    void add_row_sums(std::span<const CausalTap> taps);

    std::size_t cols_ = 0;
    std::size_t width_ = 0;  // columns worked on
    std::vector<float> memory_;
    float* noise_ = nullptr;
    std::array<float*, 2> work_ = {};
    std::vector<float*> rows_;  // the present one and those above, upwards
    std::vector<Sum> sums_;
    std::vector<CausalTap> above_;  // the terms of the first sum
    // How far back the last terms of the last sum look, in the row it draws.
    std::vector<std::ptrdiff_t> feedback_;
};

/// The same for a plane of noise, in place.
[[nodiscard]] Result<void> causal_recursion(std::span<const CausalTap> taps, float sigma,
                                            PlaneView<float> field);

}  // namespace sateen
