// SPDX-License-Identifier: Apache-2.0
// Fourier transforms of planes in double precision and of any size, where exactness counts
// more than speed (core/fft has neither).
#pragma once

#include <complex>
#include <cstddef>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "sateen/core/image.hpp"

namespace sateen {

/// A complex spectrum (rows, cols), row-major; frequencies as in core/fft.hpp.
struct Spectrum {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::vector<std::complex<double>> values;

    Spectrum(std::size_t rows_, std::size_t cols_)
        : rows(rows_), cols(cols_), values(rows_ * cols_) {}
    [[nodiscard]] std::complex<double>& operator()(std::size_t r, std::size_t c) {
        return values[r * cols + c];
    }
    [[nodiscard]] const std::complex<double>& operator()(std::size_t r,
                                                         std::size_t c) const {
        return values[r * cols + c];
    }
};

/// 2πk/n in (-π, π].
inline double frequency(std::size_t k, std::size_t n) {
    const double turns = static_cast<double>(k) / static_cast<double>(n);
    return 2 * std::numbers::pi * (2 * k > n ? turns - 1 : turns);
}

enum class Transform { forward, inverse };

/// One-dimensional transforms of `count` lines of `length` values `step` apart; the inverse
/// divides by the length.
inline void transform_lines(Spectrum& spectrum, Transform direction, std::size_t count,
                            std::size_t next, std::size_t length, std::size_t step) {
    if (length < 2) return;
    Eigen::FFT<double> fft;
    std::vector<std::complex<double>> in(length);
    std::vector<std::complex<double>> out;
    for (std::size_t line = 0; line < count; ++line) {
        const std::size_t first = line * next;
        for (std::size_t i = 0; i < length; ++i)
            in[i] = spectrum.values[first + i * step];
        if (direction == Transform::forward)
            fft.fwd(out, in);
        else
            fft.inv(out, in);
        for (std::size_t i = 0; i < length; ++i)
            spectrum.values[first + i * step] = out[i];
    }
}

inline void transform_rows(Spectrum& spectrum, Transform direction) {
    transform_lines(spectrum, direction, spectrum.rows, spectrum.cols, spectrum.cols, 1);
}
inline void transform_columns(Spectrum& spectrum, Transform direction) {
    transform_lines(spectrum, direction, spectrum.cols, 1, spectrum.rows, spectrum.cols);
}

/// Unnormalised.
inline void forward(Spectrum& spectrum) {
    transform_rows(spectrum, Transform::forward);
    transform_columns(spectrum, Transform::forward);
}
/// With 1/MN.
inline void inverse(Spectrum& spectrum) {
    transform_columns(spectrum, Transform::inverse);
    transform_rows(spectrum, Transform::inverse);
}

template <class T>
Spectrum spectrum_of(PlaneView<const T> plane) {
    Spectrum out(plane.rows, plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r)
        for (std::size_t c = 0; c < plane.cols; ++c)
            out(r, c) = static_cast<double>(plane(r, c));
    forward(out);
    return out;
}

/// Makes a function of the lattice (rows, shear), (0, cols), transformed along its rows,
/// periodic down its columns, or takes that back: f(r + rows, c + shear) = f(r, c) means
/// F(r + rows, n) exp(2πi n shear / cols) = F(r, n).
inline void straighten(Spectrum& F, std::size_t shear, double sign) {
    if (shear == 0) return;
    for (std::size_t r = 0; r < F.rows; ++r)
        for (std::size_t n = 0; n < F.cols; ++n)
            F(r, n) *= std::polar(1.0, sign * frequency(n, F.cols) *
                                           static_cast<double>(shear * r) /
                                           static_cast<double>(F.rows));
}

/// Of one period of a function of the lattice (rows, shear), (0, cols).
inline Spectrum lattice_spectrum(PlaneView<const double> plane, std::size_t shear) {
    Spectrum out(plane.rows, plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r)
        for (std::size_t c = 0; c < plane.cols; ++c) out(r, c) = plane(r, c);
    transform_rows(out, Transform::forward);
    straighten(out, shear, 1);
    transform_columns(out, Transform::forward);
    return out;
}

/// The inverse. The spectrum is destroyed.
inline BasicImage<double> lattice_plane(Spectrum& spectrum, std::size_t shear) {
    transform_columns(spectrum, Transform::inverse);
    straighten(spectrum, shear, -1);
    transform_rows(spectrum, Transform::inverse);
    BasicImage<double> out(1, spectrum.rows, spectrum.cols);
    for (std::size_t i = 0; i < spectrum.values.size(); ++i)
        out.values()[i] = spectrum.values[i].real();
    return out;
}

}  // namespace sateen
