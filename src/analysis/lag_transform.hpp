// SPDX-License-Identifier: Apache-2.0
// Between a spectrum on a torus and its covariances at short lags, both ways, as matrix
// products. Theory: docs/theory/gmrf2d.md.
#pragma once

#include <Eigen/Core>

#include "sateen/analysis/autocovariance.hpp"

namespace sateen {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Spectra S(m, n) of a real (rows, cols) torus are kept for n = 0 … ⌊cols/2⌋.
class LagTransform {
  public:
    LagTransform(Eigen::Index rows, Eigen::Index cols, int reach);

    /// R(s) = (1/MN) Σ_t S_t cos ω·s of a spectrum with S(-ω) = S(ω).
    [[nodiscard]] Autocovariance even(const RowMatrix& S) const;
    /// Q(s) = (1/MN) Σ_t S_t sin ω·s of one with S(-ω) = -S(ω); Q(-s) = -Q(s), and what
    /// is returned holds the lags of rows >= 0.
    [[nodiscard]] Autocovariance odd(const RowMatrix& S) const;
    /// S(ω) = Σ_s R(s) cos ω·s over all |s1|, |s2| <= reach.
    [[nodiscard]] RowMatrix spectrum(const Autocovariance& R) const;
    /// (1/MN) Σ_t S_t of an even spectrum.
    [[nodiscard]] double mean(const RowMatrix& S) const;
    /// (1/MN) Σ_t ln S_t of a positive even spectrum; NaN where it is not positive.
    [[nodiscard]] double mean_log(const RowMatrix& S) const;

    [[nodiscard]] Eigen::Index rows() const { return row_cos_.cols(); }
    [[nodiscard]] Eigen::Index half_cols() const { return col_cos_.rows(); }

  private:
    [[nodiscard]] double sites() const { return static_cast<double>(rows() * cols_); }
    /// Lags of both signs from sums over products of cosines or sines.
    template <class Combine>
    [[nodiscard]] Autocovariance lags(const RowMatrix& even, const RowMatrix& odd,
                                      Combine combine) const;

    Eigen::Index cols_;
    int reach_;
    RowMatrix row_cos_;  ///< (reach + 1, rows)
    RowMatrix row_sin_;
    RowMatrix col_cos_;  ///< (half columns, reach + 1)
    RowMatrix col_sin_;
    Eigen::VectorXd weight_;  ///< 2 for the columns that stand for two
};

}  // namespace sateen
