// SPDX-License-Identifier: Apache-2.0
// Spectra and short lags. See lag_transform.hpp.
#include "analysis/lag_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sateen {
namespace {

using Eigen::Index;

/// cos and sin of 2π k/n, k = 0 … n - 1.
struct Circle {
    explicit Circle(Index n) : cosine(n), sine(n) {
        for (Index k = 0; k < n; ++k) {
            const double angle =
                2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
            cosine(k) = std::cos(angle);
            sine(k) = std::sin(angle);
        }
    }
    Eigen::VectorXd cosine;
    Eigen::VectorXd sine;
};

}  // namespace

LagTransform::LagTransform(Index rows, Index cols, int reach)
    : cols_(cols),
      reach_(reach),
      row_cos_(reach + 1, rows),
      row_sin_(reach + 1, rows),
      col_cos_(cols / 2 + 1, reach + 1),
      col_sin_(cols / 2 + 1, reach + 1),
      weight_(cols / 2 + 1) {
    const Circle of_rows(rows);
    const Circle of_cols(cols);
    for (Index s = 0; s <= reach; ++s) {
        for (Index m = 0; m < rows; ++m) {
            row_cos_(s, m) = of_rows.cosine(m * s % rows);
            row_sin_(s, m) = of_rows.sine(m * s % rows);
        }
        for (Index n = 0; n < half_cols(); ++n) {
            col_cos_(n, s) = of_cols.cosine(n * s % cols);
            col_sin_(n, s) = of_cols.sine(n * s % cols);
        }
    }
    for (Index n = 0; n < half_cols(); ++n) weight_(n) = n == 0 || 2 * n == cols ? 1 : 2;
}

template <class Combine>
Autocovariance LagTransform::lags(const RowMatrix& even, const RowMatrix& odd,
                                  Combine combine) const {
    Autocovariance R(reach_, sites());
    for (int row = 0; row <= reach_; ++row)
        for (int col = 0; col <= reach_; ++col) {
            R.at(row, col) = combine(even(row, col), odd(row, col)) / sites();
            R.at(row, -col) = combine(even(row, col), -odd(row, col)) / sites();
        }
    return R;
}

// The cosine or sine of the sum ω1 s1 + ω2 s2 separates, so that each double sum is two
// matrix products: over columns first, then over rows.
Autocovariance LagTransform::even(const RowMatrix& S) const {
    const RowMatrix by_cos = S * (weight_.asDiagonal() * col_cos_);
    const RowMatrix by_sin = S * (weight_.asDiagonal() * col_sin_);
    return lags(row_cos_ * by_cos, row_sin_ * by_sin,
                [](double cc, double ss) { return cc - ss; });
}

Autocovariance LagTransform::odd(const RowMatrix& S) const {
    const RowMatrix by_cos = S * (weight_.asDiagonal() * col_cos_);
    const RowMatrix by_sin = S * (weight_.asDiagonal() * col_sin_);
    return lags(row_sin_ * by_cos, row_cos_ * by_sin,
                [](double sc, double cs) { return sc + cs; });
}

RowMatrix LagTransform::spectrum(const Autocovariance& R) const {
    RowMatrix even(reach_ + 1, reach_ + 1);
    RowMatrix odd(reach_ + 1, reach_ + 1);
    for (int row = 0; row <= reach_; ++row)
        for (int col = 0; col <= reach_; ++col) {
            // Rows above 0 stand for those below as well, columns for both signs.
            const double weight = (row == 0 ? 1 : 2) * (col == 0 ? 0.5 : 1);
            even(row, col) = weight * (R(row, col) + R(row, -col));
            odd(row, col) = weight * (R(row, col) - R(row, -col));
        }
    const RowMatrix by_cos = row_cos_.transpose() * even;
    const RowMatrix by_sin = row_sin_.transpose() * odd;
    RowMatrix S = by_cos * col_cos_.transpose();
    S.noalias() -= by_sin * col_sin_.transpose();
    return S;
}

double LagTransform::mean(const RowMatrix& S) const {
    return (S * weight_).sum() / sites();
}

// A logarithm takes as long as twenty multiplications, so it is taken of products, of few
// enough factors to stay in range: down the columns, which have one weight each.
double LagTransform::mean_log(const RowMatrix& S) const {
    constexpr Index kFactors = 16;
    if (!(S.minCoeff() > 0)) return std::nan("");
    double sum = 0;
    Eigen::VectorXd product(S.cols());
    for (Index first = 0; first < S.rows(); first += kFactors) {
        const Index last = std::min(first + kFactors, S.rows());
        product = S.row(first);
        for (Index m = first + 1; m < last; ++m)
            product.array() *= S.row(m).transpose().array();
        sum += weight_.dot(product.array().log().matrix());
    }
    return sum / sites();
}

}  // namespace sateen
