// SPDX-License-Identifier: Apache-2.0
// Trigonometric polynomials of one row. See trigonometric_row.hpp.
#include "synthesis/trigonometric_row.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>

namespace sateen {

RowPolynomial TrigonometricPolynomial::row(const RowPhases& phases) const {
    std::array<std::complex<double>, 2 * kMaxReach + 1> c{};
    std::size_t reach = 0;
    for (const Term& term : terms_) {
        c[static_cast<std::size_t>(kMaxReach + term.s.col)] +=
            term.coefficient * phases(term.s.row);
        reach = std::max(reach, static_cast<std::size_t>(std::abs(term.s.col)));
    }
    RowPolynomial polynomial;
    polynomial.terms = reach + 1;
    polynomial.even_re[0] = static_cast<float>(c[kMaxReach].real());
    polynomial.even_im[0] = static_cast<float>(c[kMaxReach].imag());
    for (std::size_t q = 1; q <= reach; ++q) {
        const std::complex<double> even = c[kMaxReach + q] + c[kMaxReach - q];
        const std::complex<double> odd = c[kMaxReach + q] - c[kMaxReach - q];
        polynomial.even_re[q] = static_cast<float>(even.real());
        polynomial.even_im[q] = static_cast<float>(even.imag());
        polynomial.odd_re[q] = static_cast<float>(odd.real());
        polynomial.odd_im[q] = static_cast<float>(odd.imag());
    }
    return polynomial;
}

ColumnTables::ColumnTables(std::size_t cols) {
    constexpr std::size_t kPadding = 64;
    const std::size_t count = cols / 2 + 1;
    cosines = Image(1, RowPolynomial::kTerms, count + kPadding);
    sines = Image(1, RowPolynomial::kTerms, count + kPadding);
    std::vector<float> cosine(cols);
    std::vector<float> sine(cols);
    // The rotation is repeated in double precision: exact to 1e-11 at the largest size.
    const std::complex<double> step =
        std::polar(1.0, 2 * std::numbers::pi / static_cast<double>(cols));
    std::complex<double> phase = 1;
    for (std::size_t k = 0; k < cols; ++k) {
        cosine[k] = static_cast<float>(phase.real());
        sine[k] = static_cast<float>(phase.imag());
        phase = product(phase, step);
    }
    for (std::size_t q = 0; q < RowPolynomial::kTerms; ++q) {
        std::size_t k = 0;  // q n, modulo the number of columns
        for (std::size_t n = 0; n < count; ++n) {
            cosines(0, q, n) = cosine[k];
            sines(0, q, n) = sine[k];
            k += q % cols;
            if (k >= cols) k -= cols;
        }
    }
}

}  // namespace sateen
