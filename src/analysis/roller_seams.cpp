// SPDX-License-Identifier: Apache-2.0
// Steps across seams. See roller_seams.hpp.
#include "analysis/roller_seams.hpp"

#include <array>
#include <cmath>

namespace sateen {
namespace {

using Normal = std::array<double, 3>;

std::vector<Normal> normals_of(const BasicImage<double>& tile,
                               const TileLattice& lattice) {
    std::vector<Normal> out;
    out.reserve(tile.plane_size());
    const auto z = tile.values();
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c) {
            const double p = (z[lattice.site(r, c + 1)] - z[lattice.left(r, c)]) / 2;
            const double q = (z[lattice.above(r, c)] - z[lattice.site(r + 1, c)]) / 2;
            const double length = std::sqrt(1 + p * p + q * q);
            out.push_back({-p / length, -q / length, 1 / length});
        }
    return out;
}

double squared_step(const Normal& a, const Normal& b) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

}  // namespace

double SeamRatios::Map::value() const {
    double found = 0;
    double expected = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        found += seam[i].square;
        expected += static_cast<double>(seam[i].count) * inside[i].mean();
    }
    return expected > 0 ? std::sqrt(found / expected) : 1;
}

void SeamRatios::add(const BasicImage<double>& tile, const TileLattice& lattice,
                     const Seams& seams) {
    const std::vector<Normal> normals = normals_of(tile, lattice);
    const auto z = tile.values();
    const auto consider = [&](std::size_t a, std::size_t b, bool seam, std::size_t way) {
        (seam ? height_.seam : height_.inside)[way].add((z[b] - z[a]) * (z[b] - z[a]));
        (seam ? normals_.seam : normals_.inside)[way].add(
            squared_step(normals[a], normals[b]));
    };
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c) {
            const std::size_t at = lattice.site(r, c);
            consider(at, lattice.site(r, c + 1), seams.right[at] != 0, 0);
            consider(at, lattice.site(r + 1, c), seams.down[at] != 0, 1);
        }
}

}  // namespace sateen
