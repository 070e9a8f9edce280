// SPDX-License-Identifier: Apache-2.0
// Columns 0 and N/2 of the spectrum of a real plane, as one complex column.
// Theory: docs/theory/fft.md.
#pragma once

#include <cstddef>

#include "sateen/core/fft.hpp"

namespace sateen::detail {

// For even N the rows' transforms are real in columns 0 and N/2, so the column pass takes
// z = a + i b, a and b those columns. Their transforms A, B are Hermitian in m:
//     A(m) = (Z(m) + conj Z(M - m)) / 2,    B(m) = (Z(m) - conj Z(M - m)) / (2 i)

/// Columns that the column pass works on: one less than the half spectrum has for even N.
[[nodiscard]] inline std::size_t packed_cols(std::size_t cols) {
    return (cols + 1) / 2;
}

/// Z in column 0 to A in column 0 and B in the last.
inline void unpack_real_columns(SplitComplexView<float> spectrum) {
    const std::size_t rows = spectrum.re.rows;
    const std::size_t last = spectrum.re.cols - 1;
    for (std::size_t m = 0; m <= rows / 2; ++m) {
        const std::size_t mirrored = (rows - m) % rows;
        const float re = 0.5F * spectrum.re(m, 0);
        const float im = 0.5F * spectrum.im(m, 0);
        const float re_m = 0.5F * spectrum.re(mirrored, 0);
        const float im_m = 0.5F * spectrum.im(mirrored, 0);
        spectrum.re(m, 0) = spectrum.re(mirrored, 0) = re + re_m;
        spectrum.im(m, 0) = im - im_m;
        spectrum.im(mirrored, 0) = im_m - im;
        spectrum.re(m, last) = spectrum.re(mirrored, last) = im + im_m;
        spectrum.im(m, last) = re_m - re;
        spectrum.im(mirrored, last) = re - re_m;
    }
}

/// A in column 0 and B in the last to Z in column 0. What is not Hermitian in them is
/// dropped: it would turn up in the other one.
inline void pack_real_columns(SplitComplexView<float> spectrum) {
    const std::size_t rows = spectrum.re.rows;
    const std::size_t last = spectrum.re.cols - 1;
    for (std::size_t m = 0; m <= rows / 2; ++m) {
        const std::size_t mirrored = (rows - m) % rows;
        const float a_re = 0.5F * (spectrum.re(m, 0) + spectrum.re(mirrored, 0));
        const float a_im = 0.5F * (spectrum.im(m, 0) - spectrum.im(mirrored, 0));
        const float b_re = 0.5F * (spectrum.re(m, last) + spectrum.re(mirrored, last));
        const float b_im = 0.5F * (spectrum.im(m, last) - spectrum.im(mirrored, last));
        spectrum.re(m, 0) = a_re - b_im;
        spectrum.im(m, 0) = b_re + a_im;
        spectrum.re(mirrored, 0) = a_re + b_im;
        spectrum.im(mirrored, 0) = b_re - a_im;
    }
}

}  // namespace sateen::detail
