// SPDX-License-Identifier: Apache-2.0
// Trigonometric polynomials of one row. See trigonometric_row.hpp.
#include "synthesis/trigonometric_row.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>

namespace sateen {

namespace {

/// Operator * of std::complex looks for infinities, which takes longer.
constexpr std::complex<double> product(std::complex<double> a, std::complex<double> b) {
    return {a.real() * b.real() - a.imag() * b.imag(),
            a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

// The rotation is repeated in double precision: exact to 1e-11 at the largest size.
Frequencies::Frequencies(std::size_t n) : values_(n) {
    const std::complex<double> step =
        std::polar(1.0, 2 * std::numbers::pi / static_cast<double>(n));
    std::complex<double> phase = 1;
    for (std::complex<double>& value : values_) {
        value = phase;
        phase = product(phase, step);
    }
}

template <std::size_t K>
void TrigonometricPolynomials<K>::add(Offset s,
                                      const std::array<double, K>& coefficients) {
    const auto q = static_cast<std::size_t>(std::abs(s.col));
    if (columns_.size() <= q) columns_.resize(q + 1);
    auto& terms = s.col < 0 ? columns_[q].left : columns_[q].right;
    terms.push_back({s.row, coefficients});
}

template <std::size_t K>
RowPolynomials<K> TrigonometricPolynomials<K>::row(const RowPhases& phases) const {
    RowPolynomials<K> polynomials;
    polynomials.terms = columns_.size();
    for (std::size_t q = 0; q < columns_.size(); ++q) {
        // Σ c_s e^{-jω1 s1} over the offsets of columns ±q: their sum and difference.
        std::array<double, K> even_re{};
        std::array<double, K> even_im{};
        std::array<double, K> odd_re{};
        std::array<double, K> odd_im{};
        for (const auto* terms : {&columns_[q].right, &columns_[q].left}) {
            const double sign = terms == &columns_[q].right ? 1 : -1;
            for (const Term& term : *terms) {
                const std::complex<double> phase = phases(term.row);
                for (std::size_t k = 0; k < K; ++k) {
                    const double re = term.coefficients[k] * phase.real();
                    const double im = term.coefficients[k] * phase.imag();
                    even_re[k] += re;
                    even_im[k] += im;
                    odd_re[k] += sign * re;
                    odd_im[k] += sign * im;
                }
            }
        }
        typename RowPolynomials<K>::Term& term = polynomials.term[q];
        for (std::size_t k = 0; k < K; ++k) {
            term.even_re[k] = static_cast<float>(even_re[k]);
            term.even_im[k] = static_cast<float>(even_im[k]);
            term.odd_re[k] = static_cast<float>(odd_re[k]);
            term.odd_im[k] = static_cast<float>(odd_im[k]);
        }
    }
    return polynomials;
}

template class TrigonometricPolynomials<1>;
template class TrigonometricPolynomials<9>;

ColumnTables::ColumnTables(const Frequencies& frequencies) {
    const std::size_t cols = frequencies.size();
    const std::size_t count = cols / 2 + 1;
    cosines = Image(1, kMaxReach + 1, padded_columns(count));
    sines = Image(1, kMaxReach + 1, padded_columns(count));
    for (std::size_t q = 0; q <= kMaxReach; ++q) {
        std::size_t k = 0;  // q n, modulo the number of columns
        for (std::size_t n = 0; n < count; ++n) {
            cosines(0, q, n) = static_cast<float>(frequencies[k].real());
            sines(0, q, n) = static_cast<float>(frequencies[k].imag());
            k += q % cols;
            if (k >= cols) k -= cols;
        }
    }
}

}  // namespace sateen
