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

namespace detail {

template <bool kForward>
void transform_rows_and_columns(Spectrum& spectrum) {
    Eigen::FFT<double> fft;
    std::vector<std::complex<double>> in;
    std::vector<std::complex<double>> out;
    const auto line = [&](std::size_t first, std::size_t count, std::size_t step) {
        if (count < 2) return;
        in.resize(count);
        for (std::size_t i = 0; i < count; ++i) in[i] = spectrum.values[first + i * step];
        if constexpr (kForward)
            fft.fwd(out, in);
        else
            fft.inv(out, in);
        for (std::size_t i = 0; i < count; ++i)
            spectrum.values[first + i * step] = out[i];
    };
    for (std::size_t r = 0; r < spectrum.rows; ++r)
        line(r * spectrum.cols, spectrum.cols, 1);
    for (std::size_t c = 0; c < spectrum.cols; ++c) line(c, spectrum.rows, spectrum.cols);
}

}  // namespace detail

/// Unnormalised.
inline void forward(Spectrum& spectrum) {
    detail::transform_rows_and_columns<true>(spectrum);
}
/// With 1/MN.
inline void inverse(Spectrum& spectrum) {
    detail::transform_rows_and_columns<false>(spectrum);
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

}  // namespace sateen
