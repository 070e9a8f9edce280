// SPDX-License-Identifier: Apache-2.0
// What a stationary field cannot hold, as data: a pattern that repeats on a lattice.
// Theory: docs/theory/periodic_layer.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sateen {

/// A smooth zero-mean Gaussian random field of one plane, on a lattice of its own, whose
/// covariance is a mixture of products of Gaussian bells,
///
///     R(r, c) = σ² Σ_jk w_jk exp(-r²/4s_j² - c²/4s_k²) / Σ_jk w_jk,   s_k = 2^k sites
///
/// Its spectral density is positive whatever the weights; fields that are long across and
/// short down, as along the threads of a weave, are part of it.
struct SmoothField {
    static constexpr std::size_t kScales = 5;
    float deviation = 0;                                    ///< σ
    std::array<std::uint8_t, kScales * kScales> weights{};  ///< w_jk, j outermost
    friend bool operator==(const SmoothField&, const SmoothField&) = default;
};

/// The periodic layer of a material [Wold decomposition]: one cell repeated on a lattice that
/// a smooth random displacement D bends,
///
///     u(x) = B⁻¹ (x + D(x)) mod 1,   B = (a b)
///
/// x and all vectors are (row, column) in pixels.
struct PeriodicLayer {
    static constexpr std::size_t kMaxCellSide = 96;
    /// A vector is no longer, and the cell no smaller.
    static constexpr float kMaxPeriod = 4096;
    static constexpr float kMinArea = 4;
    static constexpr unsigned kMaxSpacing = 128;

    std::array<float, 2> a{};   ///< first lattice vector
    std::array<float, 2> b{};   ///< second
    std::uint16_t rows = 0;     ///< of the mean cells: samples along a, at least 2
    std::uint16_t cols = 0;     ///< and along b
    std::uint16_t spacing = 1;  ///< pixels between the sites of the displacement
    std::array<SmoothField, 2> displacement;  ///< of rows and of columns, in pixels
    friend bool operator==(const PeriodicLayer&, const PeriodicLayer&) = default;
};

/// A monotone curve: linear between equally spaced abscissae, of slope 1 outside.
struct ToneCurve {
    static constexpr std::size_t kKnots = 16;
    float low = 0;              ///< abscissa of the first knot
    float high = 0;             ///< and of the last, > low
    std::vector<float> values;  ///< kKnots, non-decreasing; none: the identity
    friend bool operator==(const ToneCurve&, const ToneCurve&) = default;
};

/// The periodic layer of one plane of one subspace,
///
///     X_i(x) = c_i(m_i(u) + s_i(u) R_i(x) + Σ_{j<i} l_ij(u) R_j(x))
///
/// R_i the residual field of plane i after its marginal curve. m is a truncated Fourier
/// series over the cell: the coefficients of half_plane_order(), quantised; s and l are coarse
/// grids. l turns the colours of the residual from place to place: threads of two colours
/// vary along two lines.
struct PeriodicCell {
    float step = 0;                          ///< of the quantiser of m
    std::vector<std::int16_t> coefficients;  ///< multiples of it: a real part, or a pair
    float deviation_step = 0;                ///< of s; 0: s = 1 everywhere
    std::vector<std::uint8_t> deviations;    ///< deviation_side() of rows · of cols
    float mixing_step = 0;                   ///< of l; 0: l = 0 everywhere
    std::vector<std::int8_t>
        mixing;       ///< mixing_side() of rows · of cols, for every j < i
    ToneCurve curve;  ///< c
    friend bool operator==(const PeriodicCell&, const PeriodicCell&) = default;
};

/// The grid of a deviation cell is a third as fine as that of the mean cell.
[[nodiscard]] constexpr std::size_t deviation_side(std::size_t side) {
    return (side + 2) / 3;
}

/// That of a mixing cell a quarter: finer ones would give the colours of a plane the fine
/// detail of another.
[[nodiscard]] constexpr std::size_t mixing_side(std::size_t side) {
    return (side + 3) / 4;
}

/// A frequency of the mean cell: the harmonic e^{2πi (m u + n v)}.
struct Harmonic {
    int m = 0;
    int n = 0;
    friend bool operator==(const Harmonic&, const Harmonic&) = default;
};

/// The frequencies of a real (rows, cols) cell that are stored, one of every pair {k, -k}, in
/// order of (m/rows)² + (n/cols)², then m, then n. The first is (0, 0), which alone is real:
/// 1 + 2 (h - 1) numbers are h coefficients. Frequencies on the Nyquist rows and columns of
/// even sizes are left out.
[[nodiscard]] std::vector<Harmonic> half_plane_order(std::size_t rows, std::size_t cols);

/// Of the whole material: the same for all subspaces, so that colour, relief and light stay
/// registered.
struct Structure {
    PeriodicLayer periodic;
    friend bool operator==(const Structure&, const Structure&) = default;
};

/// Of one subspace.
struct SubspaceStructure {
    std::vector<PeriodicCell> cells;  ///< one a plane
    friend bool operator==(const SubspaceStructure&, const SubspaceStructure&) = default;
};

}  // namespace sateen
