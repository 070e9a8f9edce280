// SPDX-License-Identifier: Apache-2.0
// The convex hull of points in space, without rounding errors.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sateen {

/// Coordinates of at most 2^30 in size, so that every determinant fits 128 bits.
using LatticePoint = std::array<std::int64_t, 3>;

struct HullFace {
    std::array<std::uint32_t, 3> vertex;     ///< counter-clockwise, seen from outside
    std::array<std::uint32_t, 3> neighbour;  ///< across the edge opposite each vertex
};

/// The sign of det [b - a, c - a, p - a]: +1 where p lies on the side of the plane from
/// which a, b, c turn counter-clockwise, 0 on the plane. Exact.
[[nodiscard]] int side_of_plane(const LatticePoint& a, const LatticePoint& b,
                                const LatticePoint& c, const LatticePoint& p);

/// Triangles of the hull; facets of more corners are cut into triangles. Repeated points
/// and points inside belong to none. No faces if all points lie in one plane.
/// \cost O(n log n) on a sphere
[[nodiscard]] std::vector<HullFace> convex_hull(std::span<const LatticePoint> points);

}  // namespace sateen
