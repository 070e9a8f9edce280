// SPDX-License-Identifier: Apache-2.0
// Transforms of all columns and of all rows of planes, in blocks that are independent of
// each other. Theory: docs/theory/fft.md. Included once per SIMD target.
#if defined(SATEEN_CORE_FFT_PLANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_CORE_FFT_PLANES_INL_HPP
#undef SATEEN_CORE_FFT_PLANES_INL_HPP
#else
#define SATEEN_CORE_FFT_PLANES_INL_HPP
#endif

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/fft_hermitian.hpp"
#include "core/fft_passes-inl.hpp"
#include "core/fft_tiles-inl.hpp"
#include "sateen/core/fft.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

/// The two buffers that passes alternate between, cut from `scratch`.
struct Buffers {
    Points<float> odd;
    Points<float> even;

    Buffers(const FftPlan1d& plan, float* scratch) {
        const std::size_t size = detail::scratch_part_floats(plan);
        odd = {scratch, scratch + size, kBatchLanes};
        even = {scratch + 2 * size, scratch + 3 * size, kBatchLanes};
    }
    /// Transforms what is in `even`; \returns where the result is.
    HWY_INLINE Points<float> transform_even(const FftPlan1d& plan, bool inverse) const {
        // Exchanging real and imaginary part before and after conjugates the kernel.
        Points<float> from = even;
        Points<float> other = odd;
        Points<float> to = plan.passes.size() % 2 == 0 ? even : odd;
        if (inverse) {
            std::swap(from.re, from.im);
            std::swap(other.re, other.im);
            std::swap(to.re, to.im);
        }
        transform(plan, {from.re, from.im, from.step}, other, from, to);
        if (inverse) std::swap(to.re, to.im);
        return to;
    }
};

/// Columns [16 block, 16 block + 16) in place: lanes are columns.
HWY_INLINE void transform_column_block(const FftPlan1d& plan,
                                       SplitComplexView<float> plane, bool inverse,
                                       std::size_t block, float* scratch) {
    const Buffers buffers(plan, scratch);
    const std::size_t col = block * kBatchLanes;
    const std::size_t cols = std::min(plane.re.cols - col, kBatchLanes);
    if (cols == kBatchLanes && plane.re.stride == plane.im.stride) {
        Points<float> points = {plane.re.data + col, plane.im.data + col,
                                plane.re.stride};
        if (inverse) std::swap(points.re, points.im);
        transform(plan, {points.re, points.im, points.step}, buffers.odd, buffers.even,
                  points);
        return;
    }
    const Points<float> points = buffers.even;
    for (std::size_t r = 0; r < plan.size; ++r) {
        std::fill_n(points.re + r * kBatchLanes, kBatchLanes, 0.0F);
        std::fill_n(points.im + r * kBatchLanes, kBatchLanes, 0.0F);
        std::copy_n(plane.re.row(r) + col, cols, points.re + r * kBatchLanes);
        std::copy_n(plane.im.row(r) + col, cols, points.im + r * kBatchLanes);
    }
    const Points<float> result = buffers.transform_even(plan, inverse);
    for (std::size_t r = 0; r < plan.size; ++r) {
        std::copy_n(result.re + r * kBatchLanes, cols, plane.re.row(r) + col);
        std::copy_n(result.im + r * kBatchLanes, cols, plane.im.row(r) + col);
    }
}

/// Rows [16 block, 16 block + 16) in place: lanes are rows.
HWY_INLINE void transform_row_block(const FftPlan1d& plan, SplitComplexView<float> plane,
                                    bool inverse, float factor, std::size_t block,
                                    float* scratch) {
    const Buffers buffers(plan, scratch);
    const std::size_t row = block * kBatchLanes;
    for (std::size_t c = 0; c < plan.size; c += kTile) {
        load_tile(plane.re, row, c, buffers.even.re + c * kBatchLanes);
        load_tile(plane.im, row, c, buffers.even.im + c * kBatchLanes);
    }
    const Points<float> result = buffers.transform_even(plan, inverse);
    if (inverse) {
        const Reals f = constant(factor);
        for (std::size_t i = 0; i < plan.size * kBatchLanes; i += hn::MaxLanes(Lanes())) {
            hn::Store(hn::Mul(f, hn::Load(Lanes(), result.re + i)), Lanes(),
                      result.re + i);
            hn::Store(hn::Mul(f, hn::Load(Lanes(), result.im + i)), Lanes(),
                      result.im + i);
        }
    }
    for (std::size_t c = 0; c < plan.size; c += kTile) {
        store_tile(result.re + c * kBatchLanes, plane.re, row, c);
        store_tile(result.im + c * kBatchLanes, plane.im, row, c);
    }
}

// Two real rows a and b make one complex row z = a + i b, and its transform Z gives
//     A(k) = (Z(k) + conj Z(N - k)) / 2,    B(k) = (Z(k) - conj Z(N - k)) / (2 i)

/// Rows [32 block, 32 block + 32) of a real plane to rows of its half spectrum, column
/// N/2 of an even N in place of the imaginary part of column 0, which is zero.
HWY_INLINE void forward_real_row_block(const FftPlan1d& plan,
                                       PlaneView<const float> plane,
                                       SplitComplexView<float> spectrum,
                                       std::size_t block, float* scratch) {
    const Buffers buffers(plan, scratch);
    const std::size_t row_a = block * 2 * kBatchLanes;
    const std::size_t row_b = row_a + kBatchLanes;
    for (std::size_t c = 0; c < plan.size; c += kTile) {
        load_tile(plane, row_a, c, buffers.even.re + c * kBatchLanes);
        load_tile(plane, row_b, c, buffers.even.im + c * kBatchLanes);
    }
    const Points<float> z = buffers.transform_even(plan, false);

    HWY_ALIGN float a_re[kTile * kTile];
    HWY_ALIGN float a_im[kTile * kTile];
    HWY_ALIGN float b_re[kTile * kTile];
    HWY_ALIGN float b_im[kTile * kTile];
    const Lanes d;
    const Reals half = constant(0.5F);
    const std::size_t middle = plan.size / 2 * kBatchLanes;
    for (std::size_t col = 0; col < spectrum.re.cols; col += kTile) {
        const std::size_t count = std::min(spectrum.re.cols - col, kTile);
        for (std::size_t c = 0; c < count; ++c) {
            const std::size_t k = (col + c) * kBatchLanes;
            const std::size_t mirrored = (plan.size - col - c) % plan.size * kBatchLanes;
            for (std::size_t lane = 0; lane < kBatchLanes; lane += hn::MaxLanes(d)) {
                const Reals re = hn::Mul(half, hn::Load(d, z.re + k + lane));
                const Reals im = hn::Mul(half, hn::Load(d, z.im + k + lane));
                const Reals re_m = hn::Load(d, z.re + mirrored + lane);
                const Reals im_m = hn::Load(d, z.im + mirrored + lane);
                const std::size_t at = c * kTile + lane;
                hn::Store(hn::MulAdd(half, re_m, re), d, a_re + at);
                hn::Store(hn::NegMulAdd(half, im_m, im), d, a_im + at);
                hn::Store(hn::MulAdd(half, im_m, im), d, b_re + at);
                hn::Store(hn::MulSub(half, re_m, re), d, b_im + at);
            }
        }
        if (col == 0 && plan.size % 2 == 0) {
            std::copy_n(z.re + middle, kBatchLanes, a_im);
            std::copy_n(z.im + middle, kBatchLanes, b_im);
        }
        store_tile(a_re, spectrum.re, row_a, col);
        store_tile(a_im, spectrum.im, row_a, col);
        store_tile(b_re, spectrum.re, row_b, col);
        store_tile(b_im, spectrum.im, row_b, col);
    }
}

/// Rows [32 block, 32 block + 32) of a half spectrum, packed as above, to rows of
/// the real plane, times `factor`.
HWY_INLINE void inverse_real_row_block(const FftPlan1d& plan,
                                       SplitComplexView<const float> spectrum,
                                       PlaneView<float> plane, float factor,
                                       std::size_t block, float* scratch) {
    const Buffers buffers(plan, scratch);
    const Points<float> z = buffers.even;
    const std::size_t row_a = block * 2 * kBatchLanes;
    const std::size_t row_b = row_a + kBatchLanes;
    HWY_ALIGN float a_re[kTile * kTile];
    HWY_ALIGN float a_im[kTile * kTile];
    HWY_ALIGN float b_re[kTile * kTile];
    HWY_ALIGN float b_im[kTile * kTile];
    const Lanes d;
    const Reals f = constant(factor);
    const std::size_t middle = plan.size / 2 * kBatchLanes;
    for (std::size_t col = 0; col < spectrum.re.cols; col += kTile) {
        load_tile(spectrum.re, row_a, col, a_re);
        load_tile(spectrum.im, row_a, col, a_im);
        load_tile(spectrum.re, row_b, col, b_re);
        load_tile(spectrum.im, row_b, col, b_im);
        const std::size_t count = std::min(spectrum.re.cols - col, kTile);
        for (std::size_t c = 0; c < count; ++c) {
            const std::size_t k = (col + c) * kBatchLanes;
            const std::size_t mirrored = (plan.size - col - c) % plan.size * kBatchLanes;
            const Reals f_im = constant(k == 0 ? 0.0F : factor);
            for (std::size_t lane = 0; lane < kBatchLanes; lane += hn::MaxLanes(d)) {
                const std::size_t at = c * kTile + lane;
                const Reals re = hn::Mul(f, hn::Load(d, a_re + at));
                const Reals im = hn::Mul(f_im, hn::Load(d, a_im + at));
                const Reals re_b = hn::Mul(f, hn::Load(d, b_re + at));
                const Reals im_b = hn::Mul(f_im, hn::Load(d, b_im + at));
                hn::Store(hn::Add(re, im_b), d, z.re + mirrored + lane);
                hn::Store(hn::Sub(re_b, im), d, z.im + mirrored + lane);
                hn::Store(hn::Sub(re, im_b), d, z.re + k + lane);
                hn::Store(hn::Add(im, re_b), d, z.im + k + lane);
            }
        }
        if (col == 0 && plan.size % 2 == 0) {
            for (std::size_t lane = 0; lane < kBatchLanes; ++lane) {
                z.re[middle + lane] = factor * a_im[lane];
                z.im[middle + lane] = factor * b_im[lane];
            }
        }
    }
    const Points<float> result = buffers.transform_even(plan, true);
    for (std::size_t c = 0; c < plan.size; c += kTile) {
        store_tile(result.re + c * kBatchLanes, plane, row_a, c);
        store_tile(result.im + c * kBatchLanes, plane, row_b, c);
    }
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
