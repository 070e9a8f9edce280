// SPDX-License-Identifier: Apache-2.0
// The discrete Fourier transform by its definition, in double. O(n²) a line.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace sateen::reference {

/// Row-major complex plane.
struct ComplexPlane {
    std::size_t rows;
    std::size_t cols;
    std::vector<std::complex<double>> values;

    ComplexPlane(std::size_t rows_, std::size_t cols_)
        : rows(rows_), cols(cols_), values(rows_ * cols_) {}
    std::complex<double>& operator()(std::size_t r, std::size_t c) {
        return values[r * cols + c];
    }
    const std::complex<double>& operator()(std::size_t r, std::size_t c) const {
        return values[r * cols + c];
    }
};

/// X(k) = Σ_j x(j) exp(sign 2πi j k / n), unnormalised.
inline std::vector<std::complex<double>> dft(const std::vector<std::complex<double>>& x,
                                             double sign = -1) {
    const std::size_t n = x.size();
    std::vector<std::complex<double>> roots(n);
    for (std::size_t j = 0; j < n; ++j) {
        roots[j] = std::polar(1.0, sign * 2 * std::numbers::pi * static_cast<double>(j) /
                                       static_cast<double>(n));
    }
    std::vector<std::complex<double>> X(n);
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t turn = 0;  // j k mod n
        for (std::size_t j = 0; j < n; ++j) {
            X[k] += x[j] * roots[turn];
            turn += k;
            if (turn >= n) turn -= n;
        }
    }
    return X;
}

/// The two-dimensional transform: every row, then every column.
inline ComplexPlane dft2d(ComplexPlane plane, double sign = -1) {
    std::vector<std::complex<double>> line(plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c) line[c] = plane(r, c);
        const auto X = dft(line, sign);
        for (std::size_t c = 0; c < plane.cols; ++c) plane(r, c) = X[c];
    }
    line.resize(plane.rows);
    for (std::size_t c = 0; c < plane.cols; ++c) {
        for (std::size_t r = 0; r < plane.rows; ++r) line[r] = plane(r, c);
        const auto X = dft(line, sign);
        for (std::size_t r = 0; r < plane.rows; ++r) plane(r, c) = X[r];
    }
    return plane;
}

}  // namespace sateen::reference
