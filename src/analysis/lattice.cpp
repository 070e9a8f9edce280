// SPDX-License-Identifier: Apache-2.0
// Finding the lattice of a texture. See lattice.hpp.
#include "sateen/analysis/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/smooth_part.hpp"
#include "sateen/core/fft.hpp"

namespace sateen {
namespace {

using Vector = std::array<double, 2>;

constexpr std::size_t kSmallestSide = 64;
constexpr std::size_t kLargestSide = 1024;
/// Vectors: candidates are maxima of the autocorrelation between these lengths.
constexpr double kShortestPeriod = 3.5;
constexpr double kLongestShare = 0.34;  ///< of the side
constexpr double kSmallestArea = 12;
constexpr double kSmallestSine = 0.34;  ///< of the angle between two candidates
/// Candidates: the highest maxima, and the best when short ones are preferred.
constexpr std::size_t kHighest = 36;
constexpr std::size_t kShort = 16;
constexpr double kShortness = 60;  ///< pixels that a correlation of 1 is worth
/// Pairs that are refined: the best, and the smallest cells of those at least half as good,
/// which multiples of the lattice, found to a smaller share of their length, would crowd out.
constexpr std::size_t kBest = 16;
constexpr std::size_t kSmallest = 10;
constexpr double kGoodEnough = 0.5;
/// The mean over more points than this takes every second, third … of them while refining.
constexpr std::size_t kMostPoints = 600;
/// Discs, as shares of the side: of the scoring, of the steps of the refinement, and the last
/// one, which decides. The error of a vector grows with its multiples: the first discs hold
/// no more than a few of them.
struct Disc {
    double share;
    double multiples;
    double step;  ///< pixels that the refinement starts with
};
constexpr Disc kScoreDisc = {0.36, 5, 0};
constexpr Disc kDiscs[] = {{0.25, 5, 0.5}, {0.36, 15, 0.15}, {0.5, 1e9, 0.05}};
constexpr double kLargestDisc = 0.5;
/// Of lattices within this factor of the best, the primitive one.
constexpr double kNearlyBest = 0.9;
constexpr double kNearlySmallest = 1.45;
/// ρ of a pattern exceeds kFloor + kChance/√n.
constexpr double kFloor = 0.07;
constexpr double kChance = 0.24;
/// Half a vector away the pattern is still that much alike: it has one dimension. Only the
/// multiples of its period are then chances to be unlike, and streaks of a random texture
/// repeat more easily.
constexpr double kOneDimensional = 0.3;
constexpr double kChanceOfStreaks = 0.5;
constexpr double kLeastRepeats = 3;

double length(const Vector& v) {
    return std::hypot(v[0], v[1]);
}
double determinant(const Vector& a, const Vector& b) {
    return a[0] * b[1] - a[1] * b[0];
}
Vector combine(double k, const Vector& a, double l, const Vector& b) {
    return {k * a[0] + l * b[0], k * a[1] + l * b[1]};
}

struct Basis {
    Vector a;
    Vector b;
};

/// Gauss' reduction: |a| ≤ |b|, |a·b| ≤ |a|²/2.
Basis reduced(Basis basis) {
    auto& [a, b] = basis;
    for (int step = 0; step < 64; ++step) {
        if (length(a) > length(b)) std::swap(a, b);
        const double squared = a[0] * a[0] + a[1] * a[1];
        if (!(squared > 0)) return basis;
        const double times = std::round((a[0] * b[0] + a[1] * b[1]) / squared);
        if (times == 0) break;
        b = combine(1, b, -times, a);
    }
    if (a[0] < 0 || (a[0] == 0 && a[1] < 0)) a = {-a[0], -a[1]};
    if (determinant(a, b) < 0) b = {-b[0], -b[1]};
    return basis;
}

std::array<double, 4> cubic_weights(double t) {
    return {((2 - t) * t - 1) * t / 2, ((3 * t - 5) * t * t + 2) / 2,
            ((4 - 3 * t) * t + 1) * t / 2, (t - 1) * t * t / 2};
}

/// The autocorrelation at lags up to `reach`, the half disc of all lags.
class Autocorrelation {
  public:
    static Result<Autocorrelation> of(PlaneView<const float> plane, Executor& executor) {
        Autocorrelation A;
        A.side_ = static_cast<double>(std::min(plane.rows, plane.cols));
        A.reach_ = std::min(plane.rows, plane.cols) / 2;
        Image padded(1, fft_size_at_least(plane.rows + A.reach_ + kMargin + 1),
                     fft_size_at_least(plane.cols + A.reach_ + kMargin + 1));
        subtract_smooth_part(plane, A.side_ / 6,
                             padded.plane(0).window(0, 0, plane.rows, plane.cols),
                             executor);
        SATEEN_TRY(const Fft2d fft, Fft2d::create(padded.rows(), padded.cols()));
        SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
        fft.forward(padded.plane(0), spectrum.view(), executor);
        const SplitComplexView<float> S = spectrum.view();
        for (std::size_t m = 0; m < fft.rows(); ++m)
            for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
                S.re(m, n) = S.re(m, n) * S.re(m, n) + S.im(m, n) * S.im(m, n);
                S.im(m, n) = 0;
            }
        fft.inverse(S, padded.plane(0), executor);
        A.gather(padded.plane(0), plane.rows, plane.cols);
        return A;
    }

    [[nodiscard]] double side() const { return side_; }
    [[nodiscard]] std::size_t reach() const { return reach_; }
    /// Rows -kMargin … reach + kMargin, columns ± (reach + kMargin).
    [[nodiscard]] PlaneView<const float> values() const { return values_.plane(0); }

    /// A(v) by the cubic of Catmull and Rom: linear interpolation would lower the maxima
    /// between pixels and draw every vector to whole ones. |v| must not exceed the reach.
    [[nodiscard]] double operator()(Vector v) const {
        if (v[0] < 0) v = {-v[0], -v[1]};
        const double r = v[0] + kMargin;
        const double c = v[1] + static_cast<double>(reach_ + kMargin);
        const auto row = static_cast<std::size_t>(r);
        const auto col = static_cast<std::size_t>(c);
        const auto down = cubic_weights(r - static_cast<double>(row));
        const auto across = cubic_weights(c - static_cast<double>(col));
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const float* A = values_.plane(0).row(row + i - 1) + col - 1;
            sum += down[i] * (across[0] * static_cast<double>(A[0]) +
                              across[1] * static_cast<double>(A[1]) +
                              across[2] * static_cast<double>(A[2]) +
                              across[3] * static_cast<double>(A[3]));
        }
        return sum;
    }

    /// Rows and columns of values() before lag 0 and beyond the reach.
    static constexpr std::size_t kMargin = 2;

  private:
    // Unbiased: every lag divided by the pairs of pixels it has.
    void gather(PlaneView<const float> sums, std::size_t rows, std::size_t cols) {
        const std::size_t margin = reach_ + kMargin;
        values_ = Image(1, margin + kMargin + 1, 2 * margin + 1);
        const double variance =
            static_cast<double>(sums(0, 0)) / static_cast<double>(rows * cols);
        if (!(variance > 0)) return;
        for (std::size_t r = 0; r < values_.rows(); ++r)
            for (std::size_t c = 0; c < values_.cols(); ++c) {
                const std::size_t down = r >= kMargin ? r - kMargin : kMargin - r;
                const std::size_t across = c >= margin ? c - margin : margin - c;
                // A(-s) = A(s): lags of one sign only are looked up with rows ≥ 0.
                const bool mirrored = (r < kMargin) != (c < margin);
                const std::size_t col =
                    mirrored && across > 0 ? sums.cols - across : across;
                const auto pairs = static_cast<double>((rows - down) * (cols - across));
                values_(0, r, c) = static_cast<float>(
                    static_cast<double>(sums(down, col)) / (pairs * variance));
            }
    }

    Image values_;
    double side_ = 0;
    std::size_t reach_ = 0;
};

/// Calls `visit(v)` for the lattice points of a half disc, shifted, in a fixed order. The
/// basis must be reduced.
template <class Visit>
void for_points(const Basis& basis, double radius, Vector shift, Visit visit) {
    const double det = std::abs(determinant(basis.a, basis.b));
    const auto k_most = static_cast<int>(radius * length(basis.b) / det) + 1;
    const auto l_most = static_cast<int>(radius * length(basis.a) / det) + 1;
    for (int k = 0; k <= k_most; ++k)
        for (int l = k == 0 ? 1 : -l_most; l <= l_most; ++l) {
            Vector v = combine(k, basis.a, l, basis.b);
            v = {v[0] + shift[0], v[1] + shift[1]};
            if (v[0] * v[0] + v[1] * v[1] <= radius * radius) visit(v);
        }
}

struct Mean {
    double value = 0;
    std::size_t points = 0;
};

Mean mean_at_points(const Autocorrelation& A, const Basis& basis, double radius,
                    Vector shift = {}, std::size_t most = SIZE_MAX) {
    const double det = std::abs(determinant(basis.a, basis.b));
    if (!(det >= kSmallestArea / 2)) return {-1, 1};
    const double expected = 1.6 * radius * radius / det;
    const auto stride =
        static_cast<std::size_t>(expected / static_cast<double>(most)) + 1;
    Mean mean;
    std::size_t number = 0;
    for_points(basis, radius, shift, [&](Vector v) {
        if (number++ % stride != 0) return;
        mean.value += A(v);
        ++mean.points;
    });
    if (mean.points > 0) mean.value /= static_cast<double>(mean.points);
    return mean;
}

double radius_of(const Disc& disc, const Autocorrelation& A, const Basis& basis) {
    return std::min(disc.share * A.side(), disc.multiples * length(basis.b));
}

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

struct Scored {
    Basis basis;
    double rho = 0;
};

bool same_lattice(const Basis& x, const Basis& y, double tolerance) {
    const auto near = [&](const Vector& u, const Vector& v) {
        return std::min(std::hypot(u[0] - v[0], u[1] - v[1]),
                        std::hypot(u[0] + v[0], u[1] + v[1])) < tolerance;
    };
    return near(x.a, y.a) && near(x.b, y.b);
}

/// The best pairs of candidates, each lattice once.
std::vector<Scored> best_pairs(const Autocorrelation& A,
                               const std::vector<Vector>& vectors) {
    std::vector<Scored> pairs;
    for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const Vector& v = vectors[i];
            const Vector& w = vectors[j];
            const double det = std::abs(determinant(v, w));
            if (det < kSmallestArea || det < kSmallestSine * length(v) * length(w))
                continue;
            const Basis basis = reduced({v, w});
            pairs.push_back(
                {basis, mean_at_points(A, basis, radius_of(kScoreDisc, A, basis), {},
                                       kMostPoints)
                            .value});
        }
    std::ranges::stable_sort(pairs, std::greater(), &Scored::rho);
    std::vector<Scored> best;
    const auto take = [&](std::size_t most) {
        for (const Scored& pair : pairs) {
            if (best.size() == most) return;
            const bool known = std::ranges::any_of(best, [&](const Scored& other) {
                return same_lattice(pair.basis, other.basis, 1.0);
            });
            if (!known) best.push_back(pair);
        }
    };
    take(kBest);
    std::erase_if(pairs, [&](const Scored& pair) {
        return pair.rho < kGoodEnough * best.front().rho;
    });
    std::ranges::stable_sort(pairs, {}, [](const Scored& pair) {
        return std::abs(determinant(pair.basis.a, pair.basis.b));
    });
    take(best.size() + kSmallest);
    return best;
}

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
    std::vector<Scored> pairs = best_pairs(A, candidates(A));
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
    double threshold = kFloor + kChance / std::sqrt(points);
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

}  // namespace

Result<std::optional<Lattice>> find_lattice(PlaneView<const float> plane,
                                            Executor& executor) {
    if (std::min(plane.rows, plane.cols) < kSmallestSide) return std::optional<Lattice>();
    SATEEN_TRY(const Autocorrelation A, Autocorrelation::of(middle(plane), executor));
    const std::vector<Scored> lattices = refined_pairs(A, executor);
    if (lattices.empty()) return std::optional<Lattice>();
    const Scored& best = choose(lattices);
    const Lattice lattice{best.basis.a, best.basis.b, best.rho, threshold_of(A, best)};
    if (lattice.periodicity <= lattice.threshold) return std::optional<Lattice>();
    return std::optional<Lattice>(lattice);
}

}  // namespace sateen
