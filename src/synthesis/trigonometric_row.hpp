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

/// e^{jω}, ω = 2πk/n, for k = 0 … n - 1.
class Frequencies {
  public:
    explicit Frequencies(std::size_t n);
    [[nodiscard]] std::size_t size() const { return values_.size(); }
    [[nodiscard]] const std::complex<double>& operator[](std::size_t k) const {
        return values_[k];
    }

  private:
    std::vector<std::complex<double>> values_;
};

/// e^{-jω1 r} for r = -kMaxReach … kMaxReach, ω1 = 2πm/M.
class RowPhases {
  public:
    RowPhases(const Frequencies& frequencies, std::size_t m) {
        std::size_t k = 0;  // r m, modulo M
        for (std::size_t row = 0; row <= kMaxReach; ++row) {
            phases_[kMaxReach - row] = frequencies[k];
            phases_[kMaxReach + row] = std::conj(frequencies[k]);
            k += m;
            if (k >= frequencies.size()) k -= frequencies.size();
        }
    }
    [[nodiscard]] std::complex<double> operator()(int row) const {
        return phases_[static_cast<std::size_t>(row + kMaxReach)];
    }

  private:
    std::array<std::complex<double>, 2 * kMaxReach + 1> phases_;
};

/// P_k(ω) = Σ_s c_{k,s} e^{-jω·s}, k < K, along one row of frequencies, polynomials in ω2:
///
///     Re P = even_re_0 + Σ_q (even_re_q cos qω2 + odd_im_q sin qω2)
///     Im P = even_im_0 + Σ_q (even_im_q cos qω2 - odd_re_q sin qω2)
template <std::size_t K>
struct RowPolynomials {
    struct Term {
        std::array<float, K> even_re, even_im, odd_re, odd_im;
    };
    std::array<Term, kMaxReach + 1> term;
    std::size_t terms = 0;  ///< of them are there
};

/// Polynomials of the whole lattice: their coefficients c_{k,s}, real.
template <std::size_t K>
class TrigonometricPolynomials {
  public:
    void add(Offset s, const std::array<double, K>& coefficients);
    [[nodiscard]] RowPolynomials<K> row(const RowPhases& phases) const;

  private:
    struct Term {
        int row;
        std::array<double, K> coefficients;
    };
    /// Offsets of column q, and of column -q.
    struct Columns {
        std::vector<Term> right;
        std::vector<Term> left;
    };
    std::vector<Columns> columns_;
};

/// Columns of whole vectors on every target.
[[nodiscard]] constexpr std::size_t padded_columns(std::size_t count) {
    constexpr std::size_t kWidest = 16;
    return (count + kWidest - 1) / kWidest * kWidest;
}

/// cos qω2 and sin qω2 for n = 0 … ⌊N/2⌋, a row for each q, padded to whole vectors.
struct ColumnTables {
    explicit ColumnTables(const Frequencies& frequencies);
    Image cosines;
    Image sines;
};

}  // namespace sateen
