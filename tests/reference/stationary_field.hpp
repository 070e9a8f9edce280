// SPDX-License-Identifier: Apache-2.0
// Stationary fields as their definitions read, in double: spectral densities frequency by
// frequency, draws by the naive DFT, autocovariances by direct sums.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "reference/dft.hpp"
#include "reference/pyramid.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen::reference {

inline double frequency(std::size_t k, std::size_t n) {
    return 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
}

/// W(ω) of the kernel [1 4 6 4 1]/16 in two dimensions, as the sum over its taps.
inline double kernel_transfer(double omega_1, double omega_2) {
    const auto one = [](double w) {
        return (6 + 8 * std::cos(w) + 2 * std::cos(2 * w)) / 16;
    };
    return one(omega_1) * one(omega_2);
}

/// S(ω) = σ² / |1 - Σ a_s e^{-jω·s}|²
inline double density(const Car2d& field, double omega_1, double omega_2) {
    std::complex<double> Lambda = 1;
    for (std::size_t i = 0; i < field.a.size(); ++i)
        Lambda -= static_cast<double>(field.a[i]) *
                  std::polar(1.0, -(omega_1 * field.neighbourhood[i].row +
                                    omega_2 * field.neighbourhood[i].col));
    return static_cast<double>(field.variance) / std::norm(Lambda);
}

/// S(ω) = σ² / (1 - 2 Σ a_s cos ω·s)
inline double density(const Gmrf2d& field, double omega_1, double omega_2) {
    double denominator = 1;
    for (std::size_t i = 0; i < field.a.size(); ++i)
        denominator -= 2 * static_cast<double>(field.a[i]) *
                       std::cos(omega_1 * field.neighbourhood[i].row +
                                omega_2 * field.neighbourhood[i].col);
    return static_cast<double>(field.variance) / denominator;
}

/// E_0(ω) of a pyramid: E_k(ω) = S_k(ω) + 4 W²(ω) E_{k+1}(2ω).
inline double density(std::span<const Car2d> levels, double omega_1, double omega_2) {
    double sum = density(levels.front(), omega_1, omega_2);
    if (levels.size() > 1) {
        const double W = kernel_transfer(omega_1, omega_2);
        sum += 4 * W * W * density(levels.subspan(1), 2 * omega_1, 2 * omega_2);
    }
    return sum;
}

/// |F{plane}|² / MN
inline DoublePlane periodogram(const DoublePlane& plane) {
    ComplexPlane complex(plane.rows, plane.cols);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
        complex.values[i] = plane.values[i];
    complex = dft2d(std::move(complex));
    DoublePlane S(plane.rows, plane.cols);
    for (std::size_t i = 0; i < S.values.size(); ++i)
        S.values[i] =
            std::norm(complex.values[i]) / static_cast<double>(plane.values.size());
    return S;
}

/// R(s) = (1/MN) Σ_t S_t e^{jω·s} for every s of the torus.
inline DoublePlane autocovariance_of_density(const DoublePlane& S) {
    ComplexPlane complex(S.rows, S.cols);
    for (std::size_t i = 0; i < S.values.size(); ++i) complex.values[i] = S.values[i];
    complex = dft2d(std::move(complex), 1);
    DoublePlane R(S.rows, S.cols);
    for (std::size_t i = 0; i < R.values.size(); ++i)
        R.values[i] = complex.values[i].real() / static_cast<double>(S.values.size());
    return R;
}

/// The density of a field on the frequencies of a torus.
template <class Field>
DoublePlane density_on_torus(const Field& field, std::size_t rows, std::size_t cols) {
    DoublePlane S(rows, cols);
    for (std::size_t m = 0; m < rows; ++m) {
        for (std::size_t n = 0; n < cols; ++n)
            S(m, n) = density(field, frequency(m, rows), frequency(n, cols));
    }
    return S;
}

inline DoublePlane white_noise(std::size_t rows, std::size_t cols, std::uint64_t seed) {
    DoublePlane plane(rows, cols);
    std::vector<float> row(cols);
    for (std::size_t r = 0; r < rows; ++r) {
        draw_normals({seed, 77}, static_cast<std::int32_t>(r), 0, row);
        for (std::size_t c = 0; c < cols; ++c) plane(r, c) = static_cast<double>(row[c]);
    }
    return plane;
}

/// A draw of the field on a torus: white noise coloured by the root of its density.
inline DoublePlane toroidal_field(const Car2d& field, std::size_t rows, std::size_t cols,
                                  std::uint64_t seed) {
    const DoublePlane white = white_noise(rows, cols, seed);
    ComplexPlane complex(rows, cols);
    for (std::size_t i = 0; i < white.values.size(); ++i)
        complex.values[i] = white.values[i];
    complex = dft2d(std::move(complex));
    for (std::size_t m = 0; m < rows; ++m) {
        for (std::size_t n = 0; n < cols; ++n)
            complex(m, n) *=
                std::sqrt(density(field, frequency(m, rows), frequency(n, cols)));
    }
    complex = dft2d(std::move(complex), 1);
    DoublePlane plane(rows, cols);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
        plane.values[i] =
            complex.values[i].real() / static_cast<double>(plane.values.size());
    return plane;
}

/// (1/MN) Σ_r Y_r Y_{r-s} on the torus.
inline double autocovariance(const DoublePlane& plane, int row, int col) {
    const auto wrap = [](std::size_t at, int step, std::size_t size) {
        const auto n = static_cast<std::ptrdiff_t>(size);
        return static_cast<std::size_t>(
            ((static_cast<std::ptrdiff_t>(at) - step) % n + n) % n);
    };
    double sum = 0;
    for (std::size_t r = 0; r < plane.rows; ++r) {
        const std::size_t from = wrap(r, row, plane.rows);
        for (std::size_t c = 0; c < plane.cols; ++c)
            sum += plane(r, c) * plane(from, wrap(c, col, plane.cols));
    }
    return sum / static_cast<double>(plane.values.size());
}

inline DoublePlane to_double(PlaneView<const float> plane) {
    DoublePlane out(plane.rows, plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c)
            out(r, c) = static_cast<double>(plane(r, c));
    }
    return out;
}

inline Image to_image(const DoublePlane& plane) {
    Image image(1, plane.rows, plane.cols);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
        image.values()[i] = static_cast<float>(plane.values[i]);
    return image;
}

}  // namespace sateen::reference
