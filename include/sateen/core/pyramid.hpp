// SPDX-License-Identifier: Apache-2.0
// Gaussian-Laplacian pyramids on the torus, and their expansion on windows of a plane.
// Theory: docs/theory/pyramid.md. Naive reference: tests/reference/pyramid.hpp.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// The transfer function of the kernel [1 4 6 4 1]/16 in one dimension,
///
///     W(ω) = (6 + 8 cos ω + 2 cos 2ω) / 16 = cos⁴(ω/2)
[[nodiscard]] inline double pyramid_transfer(double omega) {
    const double c = std::cos(omega / 2);
    return c * c * c * c;
}

/// Reduces on the torus: filters with w ⊗ w and keeps every second row and column.
///
///     coarse(i, j) = Σ_{a,b=-2}^{2} w_a w_b fine(2 i + a, 2 j + b)         [GMRF, eq. 4]
///
/// \param fine    (2 M, 2 N)
/// \param coarse  (M, N), written
void reduce(PlaneView<const float> fine, PlaneView<float> coarse, Executor& executor);

/// Expands on the torus, fine = ↑coarse: zeros between rows and columns, then the filter
/// with gain 2 an axis.
///
/// \param coarse  (M, N)
/// \param fine    (2 M, 2 N), written
void expand(PlaneView<const float> coarse, PlaneView<float> fine, Executor& executor);

/// fine += ↑coarse on the torus.
void expand_add(PlaneView<const float> coarse, PlaneView<float> fine, Executor& executor);

/// Splits each plane into L - 1 Laplacian bands, finest first, and the low-pass rest.
///
///     G_0 = image,   G_{k+1} = ↓ G_k,   B_k = G_k - ↑ G_{k+1},   B_{L-1} = G_{L-1}
///                                                                       [GMRF, eq. 4, 5]
///
/// The bands B_0 … B_{L-2} have zero mean, up to rounding.
/// \param image   (d, M, N), M and N divisible by 2^(L-1)
/// \param levels  L, at least 1
/// \returns       L images; image k is (d, M / 2^k, N / 2^k)
/// \error invalid_argument  no levels, an empty image or a size not divisible by 2^(L-1).
/// \cost          about 8/3 M N filter outputs a plane. Same result for every executor.
[[nodiscard]] Result<std::vector<Image>> decompose(ImageView<const float> image,
                                                   std::size_t levels,
                                                   Executor& executor);

/// The inverse of `decompose`: G_k = B_k + ↑ G_{k+1}, exact but for rounding, whatever
/// the bands.
///
/// \param levels  as from `decompose`; moved in, it is the memory worked in
/// \error invalid_argument  no levels, or one that is not half the size of the one before
/// it.
[[nodiscard]] Result<Image> collapse(std::vector<Image> levels, Executor& executor);

/// A site of an infinite lattice.
struct LatticePoint {
    std::int32_t row = 0;
    std::int32_t col = 0;
};

/// Consecutive sites along one axis.
struct LatticeRange {
    std::int32_t first = 0;
    std::size_t count = 0;
};

/// The coarse sites on which the expansion to the fine sites of `fine` depends (count >
/// 0):
///
///     ⌈x_0 / 2⌉ - 1  …  ⌊x_1 / 2⌋ + 1    for fine sites x_0 … x_1
[[nodiscard]] LatticeRange expand_support(LatticeRange fine);

/// fine = ↑coarse on windows of an infinite plane, where fine site (2 i, 2 j) lies on
/// coarse site (i, j). The same bits at a site whatever the windows, and those of the
/// toroidal `expand`.
///
/// \param coarse         holds `expand_support` of the fine rows and columns
/// \param coarse_origin  lattice site of coarse(0, 0); may be negative, as the next
/// \param fine           written
/// \param fine_origin    lattice site of fine(0, 0)
void expand_window(PlaneView<const float> coarse, LatticePoint coarse_origin,
                   PlaneView<float> fine, LatticePoint fine_origin, Executor& executor);

/// fine += ↑coarse on windows of an infinite plane.
void expand_add_window(PlaneView<const float> coarse, LatticePoint coarse_origin,
                       PlaneView<float> fine, LatticePoint fine_origin,
                       Executor& executor);

}  // namespace sateen
