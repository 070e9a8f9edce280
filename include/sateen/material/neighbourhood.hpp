// SPDX-License-Identifier: Apache-2.0
// Contextual neighbourhoods of the random fields.
//
// The sign convention of the whole code base: an offset s stands for the value at r - s,
// as in [CAR2] and [GMRF]. ([SAR] writes r ⊕ s: its coefficients belong to the mirrored
// offsets.)
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

namespace sateen {

/// A lattice offset s = (row, column).
struct Offset {
    std::int8_t row = 0;
    std::int8_t col = 0;
    friend auto operator<=>(const Offset&, const Offset&) = default;
};

/// No offset reaches further than this in either direction.
inline constexpr int kMaxReach = 8;
/// No neighbourhood holds more offsets than this.
inline constexpr std::size_t kMaxNeighbours = 64;
/// Hierarchical orders 1 … 13 are tabulated.
inline constexpr int kMaxOrder = 13;

/// The non-symmetric half plane {s1 = 0, s2 > 0} ∪ {s1 > 0}: sites that a raster scan has
/// visited before r. Of every pair {s, -s} exactly one lies in it.
[[nodiscard]] constexpr bool is_causal(Offset s) {
    return s.row > 0 || (s.row == 0 && s.col > 0);
}

/// The half-plane part of the hierarchical neighbourhood of an order: orders count the
/// distinct Euclidean distances, nearest first [GMRF].
/// \param order  1 … 13; 2, 4, 6, 10, 12, 14, 18, 22, 24, 28, 30, 34, 40 offsets
[[nodiscard]] std::vector<Offset> hierarchical_half_plane(int order);

}  // namespace sateen
