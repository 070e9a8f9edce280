// SPDX-License-Identifier: Apache-2.0
// The lattice on which a texture repeats, if it does. Theory: docs/theory/lattice.md.
#pragma once

#include <array>
#include <optional>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// Vectors are (row, column) in pixels.
struct Lattice {
    std::array<double, 2> a{};  ///< reduced: the shortest vector, its row ≥ 0
    std::array<double, 2> b{};  ///< and the shortest that is not a multiple; det(a b) > 0
    /// ρ, the mean autocorrelation at the lattice points: an unbiased estimate of the share of
    /// the variance that is periodic.
    double periodicity = 0;
    /// What ρ had to exceed.
    double threshold = 0;
    [[nodiscard]] double area() const { return a[0] * b[1] - a[1] * b[0]; }
};

/// Finds the lattice a, b of largest
///
///     ρ(a, b) = mean of A(k a + l b),  (k, l) ≠ 0,  |k a + l b| ≤ side/2
///
/// A the autocorrelation of the plane without its slow changes, and of nearly equal ones the
/// primitive. Nothing where ρ ≤ 0.07 + 0.24/√n + 1.5/n, n lattice points in the half disc. Where the
/// pattern changes along one direction only, ρ must exceed 0.07 + 0.7/√k as well, k ≥ 3
/// periods of it in half the side: a purely random texture of streaks repeats by chance.
/// \param plane  any size of at least 64 pixels a side, nothing for smaller ones; of large
///               ones a window of 1024 in the middle counts, and if there is nothing in it that
///               of the picture at half the size, a quarter …
/// \returns      vectors up to 0.34 of the side
/// \cost         two Fourier transforms of 1.5 times the side, and 0.1 s, for each size
[[nodiscard]] Result<std::optional<Lattice>> find_lattice(PlaneView<const float> plane,
                                                          Executor& executor);

}  // namespace sateen
