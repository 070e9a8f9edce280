// SPDX-License-Identifier: Apache-2.0
// Finding the lattice of a texture. See lattice.hpp.
#include "sateen/analysis/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "analysis/lattice_search.hpp"

namespace sateen {
namespace {

using namespace lattice_search;

constexpr std::size_t kSmallestSide = 64;
constexpr std::size_t kLargestSide = 1024;
constexpr Disc kDiscs[] = {{0.25, 5, 0.5}, {0.36, 15, 0.15}, {0.5, 1e9, 0.05}};
constexpr double kLargestDisc = 0.5;
/// Of lattices within this factor of the best, the primitive one.
constexpr double kNearlyBest = 0.9;
constexpr double kNearlySmallest = 1.45;
/// ρ of a pattern exceeds kFloor + kChance/√n + kFew/n.
constexpr double kFloor = 0.07;
constexpr double kChance = 0.24;
constexpr double kFew = 1.5;
/// Half a vector away the pattern is still that much alike: it has one dimension. Only the
/// multiples of its period are then chances to be unlike, and streaks of a random texture
/// repeat more easily.
constexpr double kOneDimensional = 0.3;
constexpr double kChanceOfStreaks = 0.7;
constexpr double kLeastRepeats = 3;

/// Maximises ρ over the four components by the simplex of Nelder and Mead.
Basis refine(const Autocorrelation& A, const Basis& start, double radius, double step) {
    using Point = std::array<double, 4>;
    struct Vertex {
        Point at;
        double value;
    };
    const auto rho = [&](const Point& p) {
        const Basis basis{{p[0], p[1]}, {p[2], p[3]}};
        return mean_at_points(A, basis, radius, {}, kMostPoints).value;
    };
    const Point first{start.a[0], start.a[1], start.b[0], start.b[1]};
    std::array<Vertex, 5> simplex;
    for (std::size_t i = 0; i < simplex.size(); ++i) {
        Point p = first;
        if (i > 0) p[i - 1] += step;
        simplex[i] = {p, rho(p)};
    }
    const auto along = [](const Point& from, const Point& to, double share) {
        Point p{};
        for (std::size_t i = 0; i < 4; ++i) p[i] = from[i] + share * (to[i] - from[i]);
        return p;
    };
    for (int iteration = 0; iteration < 60; ++iteration) {
        std::ranges::stable_sort(simplex, std::greater(), &Vertex::value);
        Vertex& worst = simplex[4];
        Point centre{};
        for (std::size_t v = 0; v < 4; ++v)
            for (std::size_t i = 0; i < 4; ++i) centre[i] += simplex[v].at[i] / 4;
        const auto probe = [&](double share) {
            const Point p = along(centre, worst.at, share);
            return Vertex{p, rho(p)};
        };
        Vertex next = probe(-1);
        if (next.value > simplex[0].value) {
            const Vertex further = probe(-2);
            if (further.value > next.value) next = further;
        } else if (next.value <= simplex[3].value) {
            next = probe(next.value > worst.value ? -0.5 : 0.5);
        }
        if (next.value > worst.value) {
            worst = next;
            continue;
        }
        for (std::size_t v = 1; v < 5; ++v) {
            simplex[v].at = along(simplex[0].at, simplex[v].at, 0.5);
            simplex[v].value = rho(simplex[v].at);
        }
    }
    const auto best = std::ranges::max_element(simplex, {}, &Vertex::value);
    const Point& p = best->at;
    return reduced({{p[0], p[1]}, {p[2], p[3]}});
}

std::vector<Scored> refined_pairs(const Autocorrelation& A, Executor& executor) {
    std::vector<Scored> pairs = best_pairs(A);
    for (const Disc& disc : kDiscs)
        parallel_for(executor, pairs.size(), [&](std::size_t i) {
            Basis& basis = pairs[i].basis;
            basis = refine(A, basis, radius_of(disc, A, basis), disc.step);
        });
    std::vector<Scored> valid;
    for (Scored& pair : pairs) {
        const double longest = std::max(length(pair.basis.a), length(pair.basis.b));
        if (std::abs(determinant(pair.basis.a, pair.basis.b)) < kSmallestArea ||
            longest > kLargestDisc * A.side())
            continue;
        pair.rho = mean_at_points(A, pair.basis, kLargestDisc * A.side()).value;
        // Less than nothing is no pattern, and shares of the best would mean more than it.
        if (pair.rho > 0) valid.push_back(pair);
    }
    return valid;
}

/// Of the lattices nearly as good as the best, the smallest; and of those about as small as
/// that, the best: the primitive cell rather than its multiples, but not its neighbour that
/// is one thread off.
const Scored& choose(const std::vector<Scored>& lattices) {
    const auto area = [](const Scored& lattice) {
        return std::abs(determinant(lattice.basis.a, lattice.basis.b));
    };
    const double best = std::ranges::max_element(lattices, {}, &Scored::rho)->rho;
    double smallest = 1e300;
    for (const Scored& lattice : lattices)
        if (lattice.rho >= kNearlyBest * best)
            smallest = std::min(smallest, area(lattice));
    const Scored* chosen = nullptr;
    for (const Scored& lattice : lattices) {
        if (lattice.rho < kNearlyBest * best ||
            area(lattice) >= kNearlySmallest * smallest)
            continue;
        if (chosen == nullptr || lattice.rho > chosen->rho) chosen = &lattice;
    }
    return *chosen;
}

/// What ρ of a lattice must exceed. Of a pattern of one dimension infinity, if it does not
/// repeat often enough along the other.
double threshold_of(const Autocorrelation& A, const Scored& lattice) {
    const double radius = kLargestDisc * A.side();
    const Basis& basis = lattice.basis;
    const auto points = static_cast<double>(mean_at_points(A, basis, radius).points);
    double threshold = kFloor + kChance / std::sqrt(points) + kFew / points;
    for (const Vector& along : {basis.a, basis.b}) {
        const double between =
            mean_at_points(A, basis, radius, {along[0] / 2, along[1] / 2}).value;
        if (between <= kOneDimensional * lattice.rho) continue;
        const double spacing = std::abs(determinant(basis.a, basis.b)) / length(along);
        const double repeats = radius / spacing;
        if (repeats < kLeastRepeats) return std::numeric_limits<double>::infinity();
        threshold = std::max(threshold, kFloor + kChanceOfStreaks / std::sqrt(repeats));
    }
    return threshold;
}

PlaneView<const float> middle(PlaneView<const float> plane) {
    const std::size_t rows = std::min(plane.rows, kLargestSide);
    const std::size_t cols = std::min(plane.cols, kLargestSide);
    return plane.window((plane.rows - rows) / 2, (plane.cols - cols) / 2, rows, cols);
}

/// Means of 2 x 2 pixels.
Image halved(PlaneView<const float> plane) {
    Image half(1, plane.rows / 2, plane.cols / 2, uninitialised);
    for (std::size_t r = 0; r < half.rows(); ++r)
        for (std::size_t c = 0; c < half.cols(); ++c)
            half(0, r, c) = (plane(2 * r, 2 * c) + plane(2 * r, 2 * c + 1) +
                             plane(2 * r + 1, 2 * c) + plane(2 * r + 1, 2 * c + 1)) /
                            4;
    return half;
}

Result<std::optional<Lattice>> search(PlaneView<const float> plane, Executor& executor) {
    SATEEN_TRY(const Autocorrelation A, Autocorrelation::of(plane, executor));
    const std::vector<Scored> lattices = refined_pairs(A, executor);
    if (lattices.empty()) return std::optional<Lattice>();
    const Scored& best = choose(lattices);
    const Lattice lattice{best.basis.a, best.basis.b, best.rho, threshold_of(A, best)};
    if (lattice.periodicity <= lattice.threshold) return std::optional<Lattice>();
    return std::optional<Lattice>(lattice);
}

}  // namespace

Result<std::optional<Lattice>> find_lattice(PlaneView<const float> plane,
                                            Executor& executor) {
    if (std::min(plane.rows, plane.cols) < kSmallestSide) return std::optional<Lattice>();
    SATEEN_TRY(std::optional<Lattice> found, search(middle(plane), executor));
    // Cells too large, or too bent, to repeat in the middle of a large image may repeat in
    // a smaller picture of it.
    Image smaller;
    for (double scale = 2; !found && std::max(plane.rows, plane.cols) > kLargestSide &&
                           std::min(plane.rows, plane.cols) >= 2 * kSmallestSide;
         scale *= 2) {
        smaller = halved(plane);
        plane = std::as_const(smaller).plane(0);
        SATEEN_TRY(found, search(middle(plane), executor));
        if (!found) continue;
        for (Vector* vector : {&found->a, &found->b})
            for (double& part : *vector) part *= scale;
    }
    return found;
}

}  // namespace sateen
