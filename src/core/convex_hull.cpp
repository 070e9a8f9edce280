// SPDX-License-Identifier: Apache-2.0
// Incremental hull with conflict lists (quickhull): every point that is still outside is
// kept with one face that it sees; the point of a face replaces all faces that it sees by
// a fan over their horizon. Points in the plane of a face do not see it, which keeps the
// seen faces connected; signs are exact, so nothing else can go wrong.
#include "core/convex_hull.hpp"

#include <cstddef>
#include <utility>

namespace sateen {
namespace {

__extension__ using Wide = __int128;

struct Face {
    std::array<std::uint32_t, 3> vertex;
    std::array<std::uint32_t, 3> neighbour;
    std::vector<std::uint32_t> outside;  // points that see it
    bool alive = true;
};

Wide volume(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
            const LatticePoint& p) {
    const auto minus = [&a](const LatticePoint& q) {
        return std::array<Wide, 3>{q[0] - a[0], q[1] - a[1], q[2] - a[2]};
    };
    const auto u = minus(b);
    const auto v = minus(c);
    const auto w = minus(p);
    return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
           w[2] * (u[0] * v[1] - u[1] * v[0]);
}

class Builder {
  public:
    explicit Builder(std::span<const LatticePoint> points) : points_(points) {}

    std::vector<HullFace> build() {
        if (!start()) return {};
        while (!pending_.empty()) {
            const std::uint32_t face = pending_.back();
            pending_.pop_back();
            if (faces_[face].alive && !faces_[face].outside.empty()) add_furthest(face);
        }
        return result();
    }

  private:
    [[nodiscard]] Wide above(const Face& face, std::uint32_t p) const {
        return volume(points_[face.vertex[0]], points_[face.vertex[1]],
                      points_[face.vertex[2]], points_[p]);
    }

    // A first tetrahedron: corners that are distinct, not on one line, not in one plane.
    bool start() {
        const auto n = static_cast<std::uint32_t>(points_.size());
        if (n < 4) return false;
        std::array<std::uint32_t, 4> corner = {0, n, n, n};
        for (std::uint32_t p = 1; p < n && corner[1] == n; ++p)
            if (points_[p] != points_[0]) corner[1] = p;
        if (corner[1] == n) return false;
        for (std::uint32_t p = 1; p < n && corner[2] == n; ++p)
            if (!on_line(corner[0], corner[1], p)) corner[2] = p;
        if (corner[2] == n) return false;
        Wide height = 0;
        for (std::uint32_t p = 1; p < n && corner[3] == n; ++p) {
            height = volume(points_[corner[0]], points_[corner[1]], points_[corner[2]],
                            points_[p]);
            if (height != 0) corner[3] = p;
        }
        if (corner[3] == n) return false;
        if (height > 0) std::swap(corner[1], corner[2]);  // the fourth is below the base
        const auto [a, b, c, d] = corner;
        faces_ = {{{a, b, c}, {2, 3, 1}, {}},
                  {{a, d, b}, {2, 0, 3}, {}},
                  {{b, d, c}, {3, 0, 1}, {}},
                  {{a, c, d}, {2, 1, 0}, {}}};
        std::vector<std::uint32_t> all(n);
        for (std::uint32_t p = 0; p < n; ++p) all[p] = p;
        distribute(all, 0);
        return true;
    }

    [[nodiscard]] bool on_line(std::uint32_t a, std::uint32_t b, std::uint32_t p) const {
        const auto difference = [&](std::uint32_t q, std::size_t i) {
            return Wide{points_[q][i] - points_[a][i]};
        };
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            if (difference(b, i) * difference(p, j) !=
                difference(b, j) * difference(p, i))
                return false;
        }
        return true;
    }

    // Gives each point to the first face from `first` on that it sees.
    void distribute(const std::vector<std::uint32_t>& points, std::size_t first) {
        for (const std::uint32_t p : points)
            for (std::size_t f = first; f < faces_.size(); ++f)
                if (above(faces_[f], p) > 0) {
                    faces_[f].outside.push_back(p);
                    break;
                }
        for (std::size_t f = first; f < faces_.size(); ++f)
            if (!faces_[f].outside.empty())
                pending_.push_back(static_cast<std::uint32_t>(f));
    }

    struct HorizonEdge {
        std::uint32_t from;
        std::uint32_t to;
        std::uint32_t beyond;  // the face that stays
    };

    void add_furthest(std::uint32_t seen_first) {
        std::uint32_t apex = faces_[seen_first].outside[0];
        for (const std::uint32_t p : faces_[seen_first].outside)
            if (above(faces_[seen_first], p) > above(faces_[seen_first], apex)) apex = p;

        std::vector<std::uint32_t> seen = {seen_first};
        std::vector<HorizonEdge> horizon;
        faces_[seen_first].alive = false;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const Face& face = faces_[seen[i]];
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t next = face.neighbour[k];
                if (!faces_[next].alive) continue;
                if (above(faces_[next], apex) > 0) {
                    faces_[next].alive = false;
                    seen.push_back(next);
                }
            }
        }
        for (const std::uint32_t f : seen)
            for (std::size_t k = 0; k < 3; ++k)
                if (faces_[faces_[f].neighbour[k]].alive)
                    horizon.push_back({faces_[f].vertex[(k + 1) % 3],
                                       faces_[f].vertex[(k + 2) % 3],
                                       faces_[f].neighbour[k]});
        replace(seen, horizon, apex);
    }

    // The fan over the horizon, linked with its surroundings and within itself.
    void replace(const std::vector<std::uint32_t>& seen,
                 const std::vector<HorizonEdge>& horizon, std::uint32_t apex) {
        const std::size_t first = faces_.size();
        const auto starting_at = [&](std::uint32_t vertex) {
            std::size_t i = 0;
            while (horizon[i].from != vertex) ++i;
            return static_cast<std::uint32_t>(first + i);
        };
        const auto ending_at = [&](std::uint32_t vertex) {
            std::size_t i = 0;
            while (horizon[i].to != vertex) ++i;
            return static_cast<std::uint32_t>(first + i);
        };
        for (const HorizonEdge& edge : horizon) {
            const auto number = static_cast<std::uint32_t>(faces_.size());
            Face& beyond = faces_[edge.beyond];
            for (std::size_t k = 0; k < 3; ++k)
                if (beyond.vertex[(k + 1) % 3] == edge.to &&
                    beyond.vertex[(k + 2) % 3] == edge.from)
                    beyond.neighbour[k] = number;
            faces_.push_back({{edge.from, edge.to, apex},
                              {starting_at(edge.to), ending_at(edge.from), edge.beyond},
                              {}});
        }
        std::vector<std::uint32_t> orphans;
        for (const std::uint32_t f : seen) {
            for (const std::uint32_t p : faces_[f].outside)
                if (p != apex) orphans.push_back(p);
            faces_[f].outside = {};
        }
        distribute(orphans, first);
    }

    [[nodiscard]] std::vector<HullFace> result() const {
        std::vector<std::uint32_t> number(faces_.size());
        std::uint32_t count = 0;
        for (std::size_t f = 0; f < faces_.size(); ++f)
            if (faces_[f].alive) number[f] = count++;
        std::vector<HullFace> out;
        for (const Face& face : faces_) {
            if (!face.alive) continue;
            HullFace kept{face.vertex, {}};
            for (std::size_t k = 0; k < 3; ++k)
                kept.neighbour[k] = number[face.neighbour[k]];
            out.push_back(kept);
        }
        return out;
    }

    std::span<const LatticePoint> points_;
    std::vector<Face> faces_;
    std::vector<std::uint32_t> pending_;
};

}  // namespace

int side_of_plane(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                  const LatticePoint& p) {
    const Wide v = volume(a, b, c, p);
    return v > 0 ? 1 : v < 0 ? -1 : 0;
}

std::vector<HullFace> convex_hull(std::span<const LatticePoint> points) {
    return Builder(points).build();
}

}  // namespace sateen
