// SPDX-License-Identifier: Apache-2.0
// What the search for a lattice reads: the autocorrelation of a plane at any lag, and its
// mean at the points of a lattice. Theory: docs/theory/lattice.md.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen::lattice_search {

/// (row, column) in pixels.
using Vector = std::array<double, 2>;

/// Cells are no smaller, in pixels.
inline constexpr double kSmallestArea = 12;
/// The mean over more points than this takes every second, third … of them while searching.
inline constexpr std::size_t kMostPoints = 600;

inline double length(const Vector& v) {
    return std::hypot(v[0], v[1]);
}
inline double determinant(const Vector& a, const Vector& b) {
    return a[0] * b[1] - a[1] * b[0];
}
inline Vector combine(double k, const Vector& a, double l, const Vector& b) {
    return {k * a[0] + l * b[0], k * a[1] + l * b[1]};
}

struct Basis {
    Vector a;
    Vector b;
};

/// Gauss' reduction: |a| ≤ |b|, |a·b| ≤ |a|²/2.
[[nodiscard]] Basis reduced(Basis basis);

/// The autocorrelation at lags up to `reach`, the half disc of all lags.
class Autocorrelation {
  public:
    [[nodiscard]] static Result<Autocorrelation> of(PlaneView<const float> plane,
                                                    Executor& executor);

    [[nodiscard]] double side() const { return side_; }
    [[nodiscard]] std::size_t reach() const { return reach_; }
    /// Rows -kMargin … reach + kMargin, columns ± (reach + kMargin).
    [[nodiscard]] PlaneView<const float> values() const { return values_.plane(0); }

    /// A(v) by the cubic of Catmull and Rom: linear interpolation would lower the maxima
    /// between pixels and draw every vector to whole ones. |v| must not exceed the reach.
    [[nodiscard]] double operator()(Vector v) const;

    /// Rows and columns of values() before lag 0 and beyond the reach.
    static constexpr std::size_t kMargin = 2;

  private:
    void gather(PlaneView<const float> sums, std::size_t rows, std::size_t cols);

    Image values_;
    double side_ = 0;
    std::size_t reach_ = 0;
};

struct Mean {
    double value = 0;
    std::size_t points = 0;
};

/// The mean of A at the lattice points of a half disc, shifted; the basis must be reduced.
/// \param most  about so many points are enough
[[nodiscard]] Mean mean_at_points(const Autocorrelation& A, const Basis& basis,
                                  double radius, Vector shift = {},
                                  std::size_t most = SIZE_MAX);

/// Discs, as shares of the side: of the scoring, of the steps of the refinement, and the last
/// one, which decides. The error of a vector grows with its multiples: the first discs hold
/// no more than a few of them.
struct Disc {
    double share;
    double multiples;
    double step;  ///< pixels that the refinement starts with
};

[[nodiscard]] double radius_of(const Disc& disc, const Autocorrelation& A,
                               const Basis& basis);

/// A lattice and ρ, the mean of A at its points.
struct Scored {
    Basis basis;
    double rho = 0;
};

/// The best pairs of maxima of A, and the smallest of the good ones, each lattice once.
[[nodiscard]] std::vector<Scored> best_pairs(const Autocorrelation& A);

}  // namespace sateen::lattice_search
