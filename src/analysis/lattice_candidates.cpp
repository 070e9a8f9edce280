// SPDX-License-Identifier: Apache-2.0
// The first lattices to be tried: pairs of maxima of the autocorrelation. See
// lattice_search.hpp.
#include <algorithm>
#include <functional>
#include <numbers>

#include "analysis/lattice_search.hpp"

namespace sateen::lattice_search {
namespace {

/// Vectors: candidates are maxima of the autocorrelation between these lengths.
constexpr double kShortestPeriod = 3.5;
constexpr double kLongestShare = 0.34;  ///< of the side
constexpr double kSmallestSine = 0.34;  ///< of the angle between two candidates
/// Candidates: the highest maxima, and the best when short ones are preferred.
constexpr std::size_t kHighest = 36;
constexpr std::size_t kShort = 16;
constexpr double kShortness = 60;  ///< pixels that a correlation of 1 is worth
/// Pairs that are refined: the best; the smallest cells of those nearly as good, among which
/// is the primitive one of a regular grid, all of whose multiples are the best; and of those
/// half as good, which multiples of the lattice, found to a smaller share of their length,
/// would crowd out.
constexpr std::size_t kBest = 16;
struct Smallest {
    double good_enough;
    std::size_t count;
};
constexpr Smallest kSmallest[] = {{0.9, 8}, {0.5, 10}};
/// Directions that are tried across a maximum that has no partner.
constexpr int kDirections = 90;
constexpr Disc kScoreDisc = {0.36, 5, 0};

struct Peak {
    Vector at;
    double height;
};

/// Local maxima of A, a little smoothed, in 5 x 5 sites, to a fraction of a pixel.
std::vector<Peak> find_peaks(const Autocorrelation& A) {
    const PlaneView<const float> raw = A.values();
    Image smooth(1, raw.rows, raw.cols);
    // [1 2 1]/4 a way, σ = 0.7.
    constexpr float kWeights[] = {0.25F, 0.5F, 0.25F};
    for (std::size_t r = 1; r + 1 < raw.rows; ++r)
        for (std::size_t c = 1; c + 1 < raw.cols; ++c) {
            float sum = 0;
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    sum += kWeights[i] * kWeights[j] * raw(r + i - 1, c + j - 1);
            smooth(0, r, c) = sum;
        }
    const auto parabola = [](float before, float at, float after) {
        const double curvature = static_cast<double>(before) -
                                 2 * static_cast<double>(at) + static_cast<double>(after);
        return curvature < 0
                   ? (static_cast<double>(before) - static_cast<double>(after)) /
                         (2 * curvature)
                   : 0.0;
    };
    const PlaneView<const float> S = smooth.plane(0);
    const double longest = kLongestShare * A.side();
    constexpr std::size_t kTop = Autocorrelation::kMargin;
    const std::size_t origin = A.reach() + kTop;
    const auto last = std::min(kTop + static_cast<std::size_t>(longest) + 1, S.rows - 3);
    std::vector<Peak> peaks;
    for (std::size_t r = kTop; r <= last; ++r)
        for (std::size_t c = 3; c + 3 < S.cols; ++c) {
            const double row = static_cast<double>(r - kTop);
            const double col = static_cast<double>(c) - static_cast<double>(origin);
            const double distance = std::hypot(row, col);
            if (distance <= kShortestPeriod || distance >= longest ||
                (row == 0 && col < 0))
                continue;
            bool highest = true;
            for (std::size_t i = 0; i < 5 && highest; ++i)
                for (std::size_t j = 0; j < 5; ++j)
                    if (S(r + i - 2, c + j - 2) > S(r, c)) highest = false;
            if (!highest) continue;
            peaks.push_back({{row + parabola(S(r - 1, c), S(r, c), S(r + 1, c)),
                              col + parabola(S(r, c - 1), S(r, c), S(r, c + 1))},
                             static_cast<double>(S(r, c))});
        }
    return peaks;
}

std::vector<Vector> candidates(const Autocorrelation& A) {
    std::vector<Peak> peaks = find_peaks(A);
    std::ranges::stable_sort(peaks, std::greater(), &Peak::height);
    std::vector<Vector> chosen;
    const std::size_t highest = std::min(kHighest, peaks.size());
    for (std::size_t i = 0; i < highest; ++i) chosen.push_back(peaks[i].at);
    peaks.erase(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(highest));
    std::ranges::stable_sort(peaks, std::less(), [](const Peak& peak) {
        return length(peak.at) - kShortness * peak.height;
    });
    for (std::size_t i = 0; i < std::min(kShort, peaks.size()); ++i)
        chosen.push_back(peaks[i].at);
    return chosen;
}

bool parallel(const Vector& v, const Vector& w) {
    const double det = std::abs(determinant(v, w));
    return det < kSmallestArea || det < kSmallestSine * length(v) * length(w);
}

/// Of a pattern that changes along one direction and bends slowly there are maxima along a
/// line only.
bool all_parallel(const std::vector<Vector>& vectors) {
    return !vectors.empty() && std::ranges::all_of(vectors, [&](const Vector& v) {
        return parallel(v, vectors.front());
    });
}

/// The vector as long as v, but not along it, at which A is largest.
Vector along_ridge(const Autocorrelation& A, const Vector& v) {
    Vector best{};
    double highest = -2;
    for (int k = 0; k < kDirections; ++k) {
        const double angle = std::numbers::pi * k / kDirections;
        const Vector w = {length(v) * std::sin(angle), length(v) * std::cos(angle)};
        if (parallel(v, w) || A(w) <= highest) continue;
        highest = A(w);
        best = w;
    }
    return best;
}

bool same_lattice(const Basis& x, const Basis& y, double tolerance) {
    const auto near = [&](const Vector& u, const Vector& v) {
        return std::min(std::hypot(u[0] - v[0], u[1] - v[1]),
                        std::hypot(u[0] + v[0], u[1] + v[1])) < tolerance;
    };
    return near(x.a, y.a) && near(x.b, y.b);
}

}  // namespace

std::vector<Scored> best_pairs(const Autocorrelation& A) {
    std::vector<Vector> vectors = candidates(A);
    if (all_parallel(vectors)) vectors.push_back(along_ridge(A, vectors.front()));
    std::vector<Scored> pairs;
    for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const Vector& v = vectors[i];
            const Vector& w = vectors[j];
            if (parallel(v, w)) continue;
            const Basis basis = reduced({v, w});
            pairs.push_back(
                {basis, mean_at_points(A, basis, radius_of(kScoreDisc, A, basis), {},
                                       kMostPoints)
                            .value});
        }
    std::ranges::stable_sort(pairs, std::greater(), &Scored::rho);
    std::vector<Scored> best;
    const auto take = [&](std::size_t most, double least) {
        for (const Scored& pair : pairs) {
            if (best.size() == most) return;
            if (pair.rho < least) continue;
            const bool known = std::ranges::any_of(best, [&](const Scored& other) {
                return same_lattice(pair.basis, other.basis, 1.0);
            });
            if (!known) best.push_back(pair);
        }
    };
    take(kBest, -1);
    if (best.empty()) return best;
    std::ranges::stable_sort(pairs, {}, [](const Scored& pair) {
        return std::abs(determinant(pair.basis.a, pair.basis.b));
    });
    for (const Smallest& smallest : kSmallest)
        take(best.size() + smallest.count, smallest.good_enough * best.front().rho);
    return best;
}

}  // namespace sateen::lattice_search
