// SPDX-License-Identifier: Apache-2.0
// Rows of Hermitian 3 × 3 matrices, one a frequency, element by element: roots, products.
// Theory: docs/theory/car3d.md.
#pragma once

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

/// S ← S^{1/2}, the positive root: ‖X² - S‖ ≤ 1e-5 ‖S‖, also where S is singular. Negative
/// eigenvalues are taken as 0.
void hermitian_root(const HermitianRows<float>& S, std::size_t count);

/// Three complex rows.
struct ComplexRows {
    std::array<float*, 3> re{};
    std::array<float*, 3> im{};
};

/// y_i = g_i Σ_j X_ij w_j. The rows may be the same.
void multiply_hermitian(const HermitianRows<const float>& X,
                        const std::array<float, 3>& gains, const ComplexRows& w,
                        const ComplexRows& y, std::size_t count);

}  // namespace sateen
