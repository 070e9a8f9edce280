// SPDX-License-Identifier: Apache-2.0
// Rows of Hermitian 3 × 3 matrices, one a frequency, element by element: roots, products.
// Theory: docs/theory/car3d.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "sateen/core/image.hpp"

namespace sateen {

/// Element (i, j) of the matrices of one row of frequencies is row 3i + j: Re H_ij for
/// i <= j, Im H_ji for i > j.
template <class T>
using HermitianRows = std::array<T*, 9>;

template <class T>
[[nodiscard]] HermitianRows<T> hermitian_rows(ImageView<T> matrix, std::size_t m) {
    HermitianRows<T> rows{};
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = matrix.plane(k).row(m);
    return rows;
}

[[nodiscard]] inline HermitianRows<const float> readable(
    const HermitianRows<float>& rows) {
    HermitianRows<const float> result{};
    std::copy(rows.begin(), rows.end(), result.begin());
    return result;
}

/// S ← S^{1/2}, the positive root: ‖X² - S‖ ≤ 1e-5 ‖S‖, and 5e-4 ‖S‖ where two eigenvalues
/// are below 1e-6 of the third. Zero rows stay zero; negative eigenvalues are taken as 0.
void hermitian_root(const HermitianRows<float>& S, std::size_t count);

/// Three complex rows.
template <class T>
struct ComplexRows {
    std::array<T*, 3> re{};
    std::array<T*, 3> im{};
};

/// y = S^{1/2} w, the root of hermitian_root(). The rows may be the same.
void multiply_by_root(const HermitianRows<const float>& S,
                      const ComplexRows<const float>& w, const ComplexRows<float>& y,
                      std::size_t count);

/// y_i = g_i Σ_j X_ij w_j. The rows may be the same.
void multiply_hermitian(const HermitianRows<const float>& X,
                        const std::array<float, 3>& gains,
                        const ComplexRows<const float>& w, const ComplexRows<float>& y,
                        std::size_t count);

}  // namespace sateen
