// SPDX-License-Identifier: Apache-2.0
// Trigonometric polynomials over the lattice, one row of frequencies at a time: what the
// spectral densities of all field models are made of.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/material/neighbourhood.hpp"

namespace sateen {

/// Operator * of std::complex looks for infinities, which takes longer.
[[nodiscard]] constexpr std::complex<double> product(std::complex<double> a,
                                                     std::complex<double> b) {
    return {a.real() * b.real() - a.imag() * b.imag(),
            a.real() * b.imag() + a.imag() * b.real()};
}

/// e^{-jω1 r} for r = -kMaxReach … kMaxReach.
class RowPhases {
  public:
    explicit RowPhases(double omega_1) {
        const std::complex<double> step = std::polar(1.0, -omega_1);
        std::complex<double> phase = 1;
        for (std::size_t row = 0; row <= kMaxReach; ++row) {
            phases_[kMaxReach + row] = phase;
            phases_[kMaxReach - row] = std::conj(phase);
            phase = product(phase, step);
        }
    }
    [[nodiscard]] std::complex<double> operator()(int row) const {
        return phases_[static_cast<std::size_t>(row + kMaxReach)];
    }

  private:
    std::array<std::complex<double>, 2 * kMaxReach + 1> phases_;
};

/// P(ω) = Σ_s c_s e^{-jω·s} along one row of frequencies, a polynomial in ω2:
///
///     Re P = even_re_0 + Σ_q (even_re_q cos qω2 + odd_im_q sin qω2)
///     Im P = even_im_0 + Σ_q (even_im_q cos qω2 - odd_re_q sin qω2)
struct RowPolynomial {
    static constexpr std::size_t kTerms = kMaxReach + 1;
    std::array<float, kTerms> even_re{};
    std::array<float, kTerms> even_im{};
    std::array<float, kTerms> odd_re{};
    std::array<float, kTerms> odd_im{};
    std::size_t terms = 1;
};

/// A polynomial of the whole lattice: its coefficients c_s, real.
class TrigonometricPolynomial {
  public:
    explicit TrigonometricPolynomial(double constant) { add({0, 0}, constant); }
    void add(Offset s, double coefficient) { terms_.push_back({s, coefficient}); }
    [[nodiscard]] RowPolynomial row(const RowPhases& phases) const;

  private:
    struct Term {
        Offset s;
        double coefficient;
    };
    std::vector<Term> terms_;
};

/// cos qω2 and sin qω2 for n = 0 … ⌊N/2⌋, a row for each q, padded to whole vectors.
struct ColumnTables {
    explicit ColumnTables(std::size_t cols);
    Image cosines;
    Image sines;
};

}  // namespace sateen
