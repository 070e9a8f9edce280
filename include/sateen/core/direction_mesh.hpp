// SPDX-License-Identifier: Apache-2.0
// Barycentric interpolation over any set of directions. Theory: docs/theory/directions.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// Up to three directions of a set and how much each counts: weights ≥ 0 of sum 1. An
/// entry that does not count has weight 0 and the number of some direction all the same.
struct DirectionWeights {
    std::array<std::uint16_t, 3> index = {};
    std::array<float, 3> weight = {};
};

/// A triangle of directions, or a sector past the rim. A unit vector d lies in the cell if
/// s_k = row[k] · d ≥ 0 for k = 0, 1, 2; its weights are s_k / Σ s, where the third of a
/// sector counts as 0. Out of a cell the way leads to neighbour[k] of the least s_k.
struct DirectionCell {
    std::array<std::uint16_t, 3> vertex = {};
    std::array<std::uint16_t, 3> neighbour = {};
    std::array<std::array<float, 3>, 3> row = {};
    bool sector = false;
};

/// The spherical Delaunay triangulation of a set of directions: the faces of the convex
/// hull of the unit vectors that hide the origin. For the 81 directions of UBO2003 these
/// are 136 triangles.
///
/// Weights are continuous in d, and exact (one weight of 1) at the directions themselves.
/// - Inside: d ∝ w_a a + w_b b + w_c c of the triangle that d points through [CAR2, 3].
/// - Past the rim: those of the point where the great circle from d towards the centre
///   meets the rim; the centre is the normal, or the mean direction where the set does
///   not surround the normal. Sets that surround the normal are thus held constant along
///   meridians.
/// - All on one great circle, within half a degree (or two directions, or one): linear
///   along the chord between the ends, constant past them.
/// - All on one small circle: the polygon, cut into a fan.
/// Of repeated directions one carries the weight.
///
/// Deviation: [CAR2] takes the three nearest directions, which do not enclose d in 8 % of
/// cases and switch abruptly; nearest_three() is there for paper mode.
class DirectionMesh {
  public:
    /// \error invalid_argument  no direction, more than 20000, or one below the surface
    /// \cost O(n log n): 0.2 ms for 81 directions, 10 ms for 1000
    [[nodiscard]] static Result<DirectionMesh> create(
        std::span<const Direction> directions);

    /// \param d  a unit vector, z ≥ 0
    /// \cost about 15 ns: a table of 64 x 64 starts, then one or two steps from cell to
    /// cell
    [[nodiscard]] DirectionWeights interpolate(const std::array<float, 3>& d) const;
    [[nodiscard]] DirectionWeights interpolate(Direction d) const {
        return interpolate(to_vector(d));
    }

    /// The direction of the set nearest to d.
    [[nodiscard]] std::uint16_t nearest(const std::array<float, 3>& d) const;

    /// Paper mode [CAR2, section III]: barycentric weights of the three directions nearest
    /// to d. Deviation: negative weights become 0 and the rest sum to 1, and where the
    /// three lie on a great circle the nearest counts alone; the paper says of neither.
    [[nodiscard]] DirectionWeights nearest_three(const std::array<float, 3>& d) const;

    [[nodiscard]] std::size_t size() const { return vectors_.size(); }
    /// Triangles first, then sectors; none for sets on one great circle.
    [[nodiscard]] std::span<const DirectionCell> cells() const { return cells_; }
    [[nodiscard]] std::size_t triangles() const { return triangles_; }

    /// The cell in which to start: of the middle of each of kStartSide x kStartSide squares
    /// of the stereographic map (x, y) / (1 + z) ∈ [-1, 1]².
    static constexpr std::size_t kStartSide = 64;
    [[nodiscard]] std::span<const std::uint16_t> starts() const { return starts_; }

    static constexpr std::size_t kMaxSize = 20000;

  private:
    DirectionMesh() = default;
    friend class DirectionMeshBuilder;
    [[nodiscard]] DirectionWeights along_chain(const std::array<float, 3>& d) const;
    [[nodiscard]] std::uint16_t walk(std::uint16_t cell,
                                     const std::array<float, 3>& d) const;

    struct Link {
        float position;  // along the chord
        std::uint16_t index;
    };
    std::vector<std::array<float, 3>> vectors_;
    std::vector<DirectionCell> cells_;
    std::vector<std::uint16_t> starts_;
    std::vector<Link> chain_;  // of sets on one great circle, ascending
    std::array<float, 3> chord_ = {};
    std::size_t triangles_ = 0;
};

}  // namespace sateen
