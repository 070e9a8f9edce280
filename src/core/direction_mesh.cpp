// SPDX-License-Identifier: Apache-2.0
// Triangulated directions. See direction_mesh.hpp.
#include "sateen/core/direction_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "core/convex_hull.hpp"

namespace sateen {
namespace {

using Vec = std::array<double, 3>;

// Lattice steps a unit: 2^30, the most that convex_hull() takes.
constexpr double kLattice = 1073741824.0;
// A set this close to a great circle, as the sine of the angle, is taken to lie on it.
constexpr double kThin = 0.0087;
constexpr double kLowest = (std::numbers::pi - 0.021) / 2;
// The normal is the centre only of sets whose rim is at least a degree away from it.
constexpr double kClearance = 0.0175;
// Rounding of weights at the border between two cells.
constexpr float kOutside = -1e-5F;

double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]};
}
Vec normalised(const Vec& a) {
    const double length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}
std::array<float, 3> to_float(const Vec& a) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

// Where the direction stands in the triangulation: half a degree off the horizon at least,
// so that the origin lies below every set and a horizontal ring is no great circle.
Vec position(Direction d) {
    const double theta = std::min(static_cast<double>(d.theta), kLowest);
    const auto phi = static_cast<double>(d.phi);
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
            std::cos(theta)};
}

LatticePoint lattice_point(const Vec& a) {
    return {std::llround(a[0] * kLattice), std::llround(a[1] * kLattice),
            std::llround(a[2] * kLattice)};
}

// Rows of the inverse of [a b c]: row k · d is the weight of corner k.
std::array<Vec, 3> dual_basis(const Vec& a, const Vec& b, const Vec& c) {
    std::array<Vec, 3> rows = {cross(b, c), cross(c, a), cross(a, b)};
    const double determinant = dot(a, rows[0]);
    for (Vec& row : rows)
        for (double& value : row) value /= determinant;
    return rows;
}

struct Rim {
    std::uint16_t from;
    std::uint16_t to;
    std::uint16_t inside;  // the triangle that it bounds
    std::size_t opposite;  // the corner of the triangle that it does not touch
};

}  // namespace

class DirectionMeshBuilder {
  public:
    explicit DirectionMeshBuilder(std::span<const Direction> directions) {
        for (const Direction d : directions) {
            vectors_.push_back(position(d));
            mesh_.vectors_.push_back(to_vector(d));
        }
    }

    DirectionMesh build() {
        if (!make_chain()) {
            make_triangles();
            make_sectors();
            make_starts();
        }
        return std::move(mesh_);
    }

  private:
    [[nodiscard]] std::size_t furthest_from(const Vec& a) const {
        std::size_t best = 0;
        for (std::size_t i = 0; i < vectors_.size(); ++i)
            if (dot(vectors_[i], a) < dot(vectors_[best], a)) best = i;
        return best;
    }

    // True if the set lies on one great circle.
    bool make_chain() {
        const Vec& first = vectors_[furthest_from(vectors_[0])];
        const Vec& last = vectors_[furthest_from(first)];
        const Vec axis = cross(first, last);
        const double length = std::sqrt(dot(axis, axis));
        for (const Vec& v : vectors_)
            if (std::abs(dot(v, axis)) > kThin * length) return false;
        mesh_.chord_ =
            to_float({last[0] - first[0], last[1] - first[1], last[2] - first[2]});
        for (std::size_t i = 0; i < vectors_.size(); ++i)
            mesh_.chain_.push_back(
                {dot(mesh_.vectors_[i], mesh_.chord_), static_cast<std::uint16_t>(i)});
        std::stable_sort(mesh_.chain_.begin(), mesh_.chain_.end(),
                         [](auto a, auto b) { return a.position < b.position; });
        // Of equal ones the first is kept.
        const auto end =
            std::unique(mesh_.chain_.begin(), mesh_.chain_.end(),
                        [](auto a, auto b) { return b.position - a.position <= 1e-6F; });
        mesh_.chain_.erase(end, mesh_.chain_.end());
        return true;
    }

    void make_triangles() {
        std::vector<LatticePoint> points;
        for (const Vec& v : vectors_) points.push_back(lattice_point(v));
        const std::vector<HullFace> faces = convex_hull(points);
        if (faces.empty()) return make_fan();
        std::vector<std::uint32_t> cell_of(faces.size(), kNone);
        std::uint32_t count = 0;
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto& v = faces[f].vertex;
            // The origin is behind the face, and not nearly in its plane.
            if (dot(vectors_[v[0]], cross(vectors_[v[1]], vectors_[v[2]])) > 1e-9)
                cell_of[f] = count++;
        }
        for (std::size_t f = 0; f < faces.size(); ++f) {
            if (cell_of[f] == kNone) continue;
            const auto& v = faces[f].vertex;
            add_triangle(v[0], v[1], v[2]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t next = cell_of[faces[f].neighbour[k]];
                if (next == kNone)
                    add_rim(k);
                else
                    mesh_.cells_.back().neighbour[k] = static_cast<std::uint16_t>(next);
            }
        }
    }

    // All on one small circle: a convex polygon, fanned out from its first corner.
    void make_fan() {
        Vec axis{};
        for (const Vec& v : vectors_)
            for (std::size_t i = 0; i < 3; ++i) axis[i] += v[i];
        axis = normalised(axis);
        const Vec right =
            normalised(cross(axis, axis[2] > 0.5 ? Vec{1, 0, 0} : Vec{0, 0, 1}));
        const Vec up = cross(axis, right);
        std::vector<std::uint32_t> order(vectors_.size());
        std::iota(order.begin(), order.end(), 0U);
        const auto angle = [&](std::uint32_t i) {
            return std::atan2(dot(vectors_[i], up), dot(vectors_[i], right));
        };
        std::stable_sort(order.begin(), order.end(),
                         [&](auto a, auto b) { return angle(a) < angle(b); });
        order.erase(
            std::unique(order.begin(), order.end(),
                        [&](auto a, auto b) { return angle(b) - angle(a) < 1e-9; }),
            order.end());
        const std::size_t corners = order.size();
        for (std::size_t k = 1; k + 1 < corners; ++k) {
            add_triangle(order[0], order[k], order[k + 1]);
            const auto number = static_cast<std::uint16_t>(mesh_.cells_.size() - 1);
            add_rim(0);
            if (k + 2 < corners)
                mesh_.cells_.back().neighbour[1] = static_cast<std::uint16_t>(number + 1);
            else
                add_rim(1);
            if (k > 1)
                mesh_.cells_.back().neighbour[2] = static_cast<std::uint16_t>(number - 1);
            else
                add_rim(2);
        }
    }

    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        DirectionCell cell;
        cell.vertex = {static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b),
                       static_cast<std::uint16_t>(c)};
        const auto rows = dual_basis(vectors_[a], vectors_[b], vectors_[c]);
        for (std::size_t k = 0; k < 3; ++k) cell.row[k] = to_float(rows[k]);
        mesh_.cells_.push_back(cell);
        mesh_.triangles_ = mesh_.cells_.size();
    }

    // The edge of the newest triangle opposite corner k has nothing beyond.
    void add_rim(std::size_t k) {
        const DirectionCell& cell = mesh_.cells_.back();
        rims_.push_back({cell.vertex[(k + 1) % 3], cell.vertex[(k + 2) % 3],
                         static_cast<std::uint16_t>(mesh_.cells_.size() - 1), k});
    }

    [[nodiscard]] Vec centre() const {
        const Vec normal = {0, 0, 1};
        const bool surrounded =
            std::all_of(rims_.begin(), rims_.end(), [&](const Rim& rim) {
                return dot(normalised(cross(vectors_[rim.from], vectors_[rim.to])),
                           normal) > kClearance;
            });
        if (surrounded) return normal;
        Vec mean{};
        for (const DirectionCell& cell : mesh_.cells_)
            for (const std::uint16_t v : cell.vertex)
                for (std::size_t i = 0; i < 3; ++i) mean[i] += vectors_[v][i];
        return normalised(mean);
    }

    // A cell past every rim, bounded by the great circles through its ends and the centre.
    void make_sectors() {
        const Vec c = centre();
        const std::size_t first = mesh_.cells_.size();
        const auto with = [&](auto end, std::uint16_t vertex) {
            std::size_t i = 0;
            while (rims_[i].*end != vertex) ++i;
            return static_cast<std::uint16_t>(first + i);
        };
        for (std::size_t i = 0; i < rims_.size(); ++i) {
            const Rim& rim = rims_[i];
            DirectionCell cell;
            cell.sector = true;
            cell.vertex = {rim.from, rim.to, rim.to};
            const auto rows = dual_basis(vectors_[rim.from], vectors_[rim.to], c);
            cell.row = {to_float(rows[0]), to_float(rows[1]),
                        to_float({-rows[2][0], -rows[2][1], -rows[2][2]})};
            cell.neighbour = {with(&Rim::from, rim.to), with(&Rim::to, rim.from),
                              rim.inside};
            mesh_.cells_.push_back(cell);
            mesh_.cells_[rim.inside].neighbour[rim.opposite] =
                static_cast<std::uint16_t>(first + i);
        }
    }

    void make_starts() {
        constexpr std::size_t n = DirectionMesh::kStartSide;
        mesh_.starts_.resize(n * n);
        std::uint16_t cell = 0;
        for (std::size_t r = 0; r < n; ++r)
            for (std::size_t c = 0; c < n; ++c) {
                const double x = (2.0 * static_cast<double>(c) + 1) / n - 1;
                const double y = (2.0 * static_cast<double>(r) + 1) / n - 1;
                const double s = std::min(1.0, x * x + y * y);
                const Vec d =
                    normalised({2 * x / (1 + s), 2 * y / (1 + s), (1 - s) / (1 + s)});
                cell = mesh_.walk(cell, to_float(d));
                mesh_.starts_[r * n + c] = cell;
            }
    }

    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    DirectionMesh mesh_;
    std::vector<Vec> vectors_;
    std::vector<Rim> rims_;
};

Result<DirectionMesh> DirectionMesh::create(std::span<const Direction> directions) {
    if (directions.empty() || directions.size() > kMaxSize)
        return Error{Errc::invalid_argument,
                     std::to_string(directions.size()) +
                         " directions to interpolate, expected 1 to " +
                         std::to_string(kMaxSize)};
    constexpr float kHorizon = 90.01F * kRadiansPerDegree;
    for (std::size_t i = 0; i < directions.size(); ++i)
        if (!(directions[i].theta >= 0 && directions[i].theta <= kHorizon &&
              std::isfinite(directions[i].phi)))
            return Error{
                Errc::invalid_argument,
                "direction " + std::to_string(i) +
                    " lies below the surface, expected theta from 0 to 90 degrees"};
    return DirectionMeshBuilder(directions).build();
}

namespace {

// The cell that d lies in, found from another, and d's coordinates s in it.
//
// Every step leads through the border that d is furthest beyond. On a Delaunay
// triangulation such a walk ends; the bound and the search of all cells after it are for
// directions on a border, which rounding may put outside either side.
std::uint16_t locate(std::span<const DirectionCell> cells, std::uint16_t cell,
                     const std::array<float, 3>& d, std::array<float, 3>& s) {
    const auto take = [&](const DirectionCell& at) {
        s = {dot(at.row[0], d), dot(at.row[1], d), dot(at.row[2], d)};
    };
    for (std::size_t step = 0; step < cells.size(); ++step) {
        const DirectionCell& at = cells[cell];
        take(at);
        std::size_t least = s[1] < s[0] ? 1 : 0;
        if (s[2] < s[least]) least = 2;
        if (s[least] >= kOutside) return cell;
        cell = at.neighbour[least];
    }
    std::uint16_t best = 0;
    float most = -std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        take(cells[i]);
        const float inside = std::min({s[0], s[1], s[2]});
        if (inside > most) {
            most = inside;
            best = static_cast<std::uint16_t>(i);
        }
    }
    take(cells[best]);
    return best;
}

}  // namespace

std::uint16_t DirectionMesh::walk(std::uint16_t cell,
                                  const std::array<float, 3>& d) const {
    std::array<float, 3> s{};
    return locate(cells_, cell, d, s);
}

DirectionWeights DirectionMesh::interpolate(const std::array<float, 3>& d) const {
    if (!chain_.empty()) return along_chain(d);
    const float scale =
        0.5F * static_cast<float>(kStartSide) / (1 + std::max(0.0F, d[2]));
    const auto square = [&](float x) {
        const float at = x * scale + 0.5F * static_cast<float>(kStartSide);
        return static_cast<std::size_t>(static_cast<std::int32_t>(
            std::clamp(at, 0.0F, static_cast<float>(kStartSide - 1))));
    };
    std::array<float, 3> s{};
    const DirectionCell& cell =
        cells_[locate(cells_, starts_[square(d[1]) * kStartSide + square(d[0])], d, s)];
    s[2] = cell.sector ? 0 : s[2];
    for (float& w : s) w = std::max(0.0F, w);
    const float sum = s[0] + s[1] + s[2];
    if (!(sum > 0)) return {cell.vertex, {1, 0, 0}};
    const float whole = 1 / sum;
    return {cell.vertex, {s[0] * whole, s[1] * whole, s[2] * whole}};
}

DirectionWeights DirectionMesh::along_chain(const std::array<float, 3>& d) const {
    const float at = dot(d, chord_);
    const auto above =
        std::upper_bound(chain_.begin(), chain_.end(), at,
                         [](float x, const Link& l) { return x < l.position; });
    if (above == chain_.begin())
        return {{above->index, above->index, above->index}, {1, 0, 0}};
    const Link& a = *(above - 1);
    if (above == chain_.end()) return {{a.index, a.index, a.index}, {1, 0, 0}};
    const float part = (at - a.position) / (above->position - a.position);
    return {{a.index, above->index, a.index}, {1 - part, part, 0}};
}

std::uint16_t DirectionMesh::nearest(const std::array<float, 3>& d) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < vectors_.size(); ++i)
        if (dot(vectors_[i], d) > dot(vectors_[best], d)) best = i;
    return static_cast<std::uint16_t>(best);
}

DirectionWeights DirectionMesh::nearest_three(const std::array<float, 3>& d) const {
    std::array<std::size_t, 3> near = {};
    std::array<float, 3> cosine;
    cosine.fill(-2);
    for (std::size_t i = 0; i < vectors_.size(); ++i) {
        std::size_t at = 3;
        const float c = dot(vectors_[i], d);
        while (at > 0 && c > cosine[at - 1]) --at;
        if (at == 3) continue;
        for (std::size_t k = 2; k > at; --k) {
            near[k] = near[k - 1];
            cosine[k] = cosine[k - 1];
        }
        near[at] = i;
        cosine[at] = c;
    }
    DirectionWeights out;
    for (std::size_t k = 0; k < 3; ++k)
        out.index[k] = static_cast<std::uint16_t>(near[k]);
    const auto corner = [&](std::size_t k) {
        const auto& v = vectors_[near[k]];
        return Vec{static_cast<double>(v[0]), static_cast<double>(v[1]),
                   static_cast<double>(v[2])};
    };
    out.weight = {1, 0, 0};
    const double determinant = dot(corner(0), cross(corner(1), corner(2)));
    if (vectors_.size() < 3 || std::abs(determinant) < 1e-5) return out;
    const auto rows = dual_basis(corner(0), corner(1), corner(2));
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        out.weight[k] = std::max(0.0F, dot(to_float(rows[k]), d));
        sum += out.weight[k];
    }
    for (float& w : out.weight) w /= sum;
    return out;
}

}  // namespace sateen
