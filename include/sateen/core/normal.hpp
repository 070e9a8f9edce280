// SPDX-License-Identifier: Apache-2.0
// Counter-based Gaussian noise: the value at a site depends on (seed, band, row, column)
// alone. Theory: docs/theory/noise.md. Scalar reference: tests/reference/normal.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace sateen {

/// The constants of Philox4x32 [Salmon et al. 2011, Table 2 and section 3.3].
struct Philox4x32 {
    static constexpr int kRounds = 10;
    static constexpr std::array<std::uint32_t, 2> kMultiplier = {0xD2511F53U,
                                                                 0xCD9E8D57U};
    static constexpr std::array<std::uint32_t, 2> kKeyStep = {0x9E3779B9U, 0xBB67AE85U};
};

/// Philox4x32-10 [Salmon et al. 2011]: four random words of a 128-bit counter and a
/// 64-bit key.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox4x32_10(
    std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
    const auto high = [](std::uint64_t product) {
        return static_cast<std::uint32_t>(product >> 32);
    };
    for (int round = 0; round < Philox4x32::kRounds; ++round) {
        const std::uint64_t p0 = std::uint64_t{Philox4x32::kMultiplier[0]} * counter[0];
        const std::uint64_t p1 = std::uint64_t{Philox4x32::kMultiplier[1]} * counter[2];
        counter = {high(p1) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
                   high(p0) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
        key[0] += Philox4x32::kKeyStep[0];
        key[1] += Philox4x32::kKeyStep[1];
    }
    return counter;
}

/// Which noise field: all subspaces of a material use the same ones.
struct NoiseField {
    std::uint64_t seed = 0;
    std::uint32_t band =
        0;  ///< numbers independent fields: a plane, or a plane and a level
};

/// N(0, 1) at row `row`, columns [col, col + out.size()) of the infinite lattice, by
/// Box-Muller.
///
///     counter = (⌊col / 4⌋, row, band, 0),  key = seed;  words (0,1) and (2,3) make two
///     normals each, for columns 4 j … 4 j + 3
///
/// Same bits on every target, for any alignment and length. Rows and columns may be
/// negative; col + out.size() must not exceed 2³¹. No value is larger than 6.67 in
/// magnitude. \cost about 2.2 ns a value with AVX2, 1.4 with AVX-512 (docs/theory/noise.md)
void draw_normals(NoiseField field, std::int32_t row, std::int32_t col,
                  std::span<float> out);

}  // namespace sateen
