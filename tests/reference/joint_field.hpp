// SPDX-License-Identifier: Apache-2.0
// Fields of several planes as their definitions read, in double.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "reference/stationary_field.hpp"
#include "sateen/material/field_model.hpp"

namespace sateen::reference {

/// White noise coloured by the root of a density.
inline DoublePlane drawn(const DoublePlane& density, std::uint64_t seed) {
    const DoublePlane white = white_noise(density.rows, density.cols, seed);
    ComplexPlane y(density.rows, density.cols);
    for (std::size_t i = 0; i < y.values.size(); ++i) y.values[i] = white.values[i];
    y = dft2d(std::move(y));
    for (std::size_t i = 0; i < y.values.size(); ++i)
        y.values[i] *= std::sqrt(density.values[i]);
    y = dft2d(std::move(y), 1);
    DoublePlane out(density.rows, density.cols);
    for (std::size_t i = 0; i < y.values.size(); ++i)
        out.values[i] = y.values[i].real() / static_cast<double>(y.values.size());
    return out;
}

using Matrix3 = std::array<std::complex<double>, 9>;

inline Matrix3 product(const Matrix3& a, const Matrix3& b) {
    Matrix3 c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k)
                c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return c;
}

inline Matrix3 adjoint(const Matrix3& a) {
    Matrix3 b{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) b[3 * i + j] = std::conj(a[3 * j + i]);
    return b;
}

/// By Gauss-Jordan elimination.
inline Matrix3 inverse(Matrix3 a) {
    Matrix3 b{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (std::size_t p = 0; p < 3; ++p) {
        std::size_t best = p;
        for (std::size_t i = p; i < 3; ++i)
            if (std::abs(a[3 * i + p]) > std::abs(a[3 * best + p])) best = i;
        for (std::size_t j = 0; j < 3; ++j) {
            std::swap(a[3 * p + j], a[3 * best + j]);
            std::swap(b[3 * p + j], b[3 * best + j]);
        }
        const std::complex<double> pivot = a[3 * p + p];
        for (std::size_t j = 0; j < 3; ++j) {
            a[3 * p + j] /= pivot;
            b[3 * p + j] /= pivot;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            if (i == p) continue;
            const std::complex<double> factor = a[3 * i + p];
            for (std::size_t j = 0; j < 3; ++j) {
                a[3 * i + j] -= factor * a[3 * p + j];
                b[3 * i + j] -= factor * b[3 * p + j];
            }
        }
    }
    return b;
}

/// Λ(ω) = I - Σ A_s e^{-jω·s}, three planes.
inline Matrix3 transfer(const Autoregression3d& field, double omega_1, double omega_2) {
    Matrix3 Lambda{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (std::size_t s = 0; s < field.neighbourhood.size(); ++s)
        for (std::size_t k = 0; k < 9; ++k)
            Lambda[k] -= static_cast<double>(field.A[9 * s + k]) *
                         std::polar(1.0, -(omega_1 * field.neighbourhood[s].row +
                                           omega_2 * field.neighbourhood[s].col));
    return Lambda;
}

/// S(ω) = Λ⁻¹ Σ Λ⁻ᴴ
inline Matrix3 density(const Autoregression3d& field, double omega_1, double omega_2) {
    Matrix3 Sigma{};
    for (std::size_t k = 0; k < 9; ++k) Sigma[k] = static_cast<double>(field.Sigma[k]);
    const Matrix3 inverted = inverse(transfer(field, omega_1, omega_2));
    return product(product(inverted, Sigma), adjoint(inverted));
}

/// R_ij(s) = (1/MN) Σ_t S_ij e^{jω·s} on every site of a torus, 9 planes.
inline std::vector<DoublePlane> covariances(const Autoregression3d& field,
                                            std::size_t rows, std::size_t cols) {
    std::vector<ComplexPlane> S(9, ComplexPlane(rows, cols));
    for (std::size_t m = 0; m < rows; ++m)
        for (std::size_t n = 0; n < cols; ++n) {
            const Matrix3 at = density(field, frequency(m, rows), frequency(n, cols));
            for (std::size_t k = 0; k < 9; ++k) S[k](m, n) = at[k];
        }
    std::vector<DoublePlane> R;
    for (ComplexPlane& element : S) {
        element = dft2d(std::move(element), 1);
        DoublePlane plane(rows, cols);
        for (std::size_t i = 0; i < plane.values.size(); ++i)
            plane.values[i] =
                element.values[i].real() / static_cast<double>(plane.values.size());
        R.push_back(std::move(plane));
    }
    return R;
}

/// Three planes Λ⁻¹ F ê of white noise e, Σ = F Fᵀ by Cholesky: [SAR, eq. 11].
inline std::vector<DoublePlane> drawn(const Autoregression3d& field, std::size_t rows,
                                      std::size_t cols, std::uint64_t seed) {
    std::array<double, 9> F{};
    for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = j; i < 3; ++i) {
            auto rest = static_cast<double>(field.Sigma[3 * i + j]);
            for (std::size_t k = 0; k < j; ++k) rest -= F[3 * i + k] * F[3 * j + k];
            F[3 * i + j] = i == j ? std::sqrt(rest) : rest / F[4 * j];
        }
    std::vector<ComplexPlane> noise;
    for (std::uint64_t k = 0; k < 3; ++k) {
        const DoublePlane white = white_noise(rows, cols, 3 * seed + k);
        ComplexPlane e(rows, cols);
        for (std::size_t i = 0; i < e.values.size(); ++i) e.values[i] = white.values[i];
        noise.push_back(dft2d(std::move(e)));
    }
    std::vector<ComplexPlane> y(3, ComplexPlane(rows, cols));
    for (std::size_t m = 0; m < rows; ++m)
        for (std::size_t n = 0; n < cols; ++n) {
            const Matrix3 inverted =
                inverse(transfer(field, frequency(m, rows), frequency(n, cols)));
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j)
                    for (std::size_t k = 0; k <= j; ++k)
                        y[i](m, n) += inverted[3 * i + j] * F[3 * j + k] * noise[k](m, n);
        }
    std::vector<DoublePlane> planes;
    for (ComplexPlane& plane : y) {
        plane = dft2d(std::move(plane), 1);
        DoublePlane out(rows, cols);
        for (std::size_t i = 0; i < out.values.size(); ++i)
            out.values[i] =
                plane.values[i].real() / static_cast<double>(out.values.size());
        planes.push_back(std::move(out));
    }
    return planes;
}

}  // namespace sateen::reference
