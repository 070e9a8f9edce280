// SPDX-License-Identifier: Apache-2.0
// Square tiles of a plane, transposed between rows in memory and rows as lanes.
// Included once per SIMD target.
#if defined(SATEEN_CORE_FFT_TILES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_CORE_FFT_TILES_INL_HPP
#undef SATEEN_CORE_FFT_TILES_INL_HPP
#else
#define SATEEN_CORE_FFT_TILES_INL_HPP
#endif

#include <algorithm>
#include <cstddef>

#include "core/fft_butterflies-inl.hpp"
#include "sateen/core/image.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

inline constexpr std::size_t kTile = detail::kBatchLanes;

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void transpose_tile(const float* in, std::size_t in_stride, float* out,
                               std::size_t out_stride) {
    for (std::size_t r = 0; r < kTile; ++r) {
        for (std::size_t c = 0; c < kTile; ++c) {
            out[c * out_stride + r] = in[r * in_stride + c];
        }
    }
}

#else

/// Blocks of four columns from rows 0, 4, 8, … of `in`, one row a block.
template <class D>
HWY_INLINE hn::Vec<D> load_blocks(D d, const float* in, std::size_t stride) {
    if constexpr (hn::MaxLanes(D()) == 4) {
        return hn::LoadU(d, in);
    } else {
        const hn::Half<D> half;
        const std::size_t rows = hn::MaxLanes(half);
        return hn::Combine(d, load_blocks(half, in + rows * stride, stride),
                           load_blocks(half, in, stride));
    }
}

/// Four columns of as many rows as a vector has lanes: each column becomes a vector.
HWY_INLINE void transpose_strip(const float* in, std::size_t in_stride, float* out,
                                std::size_t out_stride) {
    const Lanes d;
    const hn::Repartition<std::uint64_t, Lanes> pairs;
    const auto a = load_blocks(d, in, in_stride);
    const auto b = load_blocks(d, in + in_stride, in_stride);
    const auto e = load_blocks(d, in + 2 * in_stride, in_stride);
    const auto f = load_blocks(d, in + 3 * in_stride, in_stride);
    const auto ab0 = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto ab1 = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto ef0 = hn::BitCast(pairs, hn::InterleaveLower(d, e, f));
    const auto ef1 = hn::BitCast(pairs, hn::InterleaveUpper(d, e, f));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, ab0, ef0)), d, out);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, ab0, ef0)), d, out + out_stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, ab1, ef1)), d,
               out + 2 * out_stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, ab1, ef1)), d,
               out + 3 * out_stride);
}

HWY_INLINE void transpose_tile(const float* in, std::size_t in_stride, float* out,
                               std::size_t out_stride) {
    // Whole lines of `out` at a time: its rows may share a cache set.
    for (std::size_t c = 0; c < kTile; c += 4) {
        for (std::size_t r = 0; r < kTile; r += hn::MaxLanes(Lanes())) {
            transpose_strip(in + r * in_stride + c, in_stride, out + c * out_stride + r,
                            out_stride);
        }
    }
}

#endif

/// tile(c, r) = plane(row + r, col + c), zero outside the plane; point c is row c of
/// `tile`.
HWY_INLINE void load_tile(PlaneView<const float> plane, std::size_t row, std::size_t col,
                          float* tile) {
    const std::size_t rows = row < plane.rows ? std::min(plane.rows - row, kTile) : 0;
    const std::size_t cols = std::min(plane.cols - col, kTile);
    // Staged through a contiguous copy: rows a power of two apart share a cache set, so
    // each of their lines is to be touched once.
    HWY_ALIGN float staged[kTile * kTile];
    if (rows < kTile || cols < kTile) std::fill_n(staged, kTile * kTile, 0.0F);
    for (std::size_t r = 0; r < rows; ++r) {
        const float* from = plane.row(row + r) + col;
        float* to = staged + r * kTile;
        if (cols == kTile) {
            std::copy_n(from, kTile, to);
        } else {
            std::copy_n(from, cols, to);
        }
    }
    transpose_tile(staged, kTile, tile, kTile);
}

/// plane(row + r, col + c) = tile(c, r) where that is inside the plane.
HWY_INLINE void store_tile(const float* tile, PlaneView<float> plane, std::size_t row,
                           std::size_t col) {
    if (row >= plane.rows) return;
    const std::size_t rows = std::min(plane.rows - row, kTile);
    const std::size_t cols = std::min(plane.cols - col, kTile);
    if (rows == kTile && cols == kTile) {
        transpose_tile(tile, kTile, plane.row(row) + col, plane.stride);
        return;
    }
    HWY_ALIGN float staged[kTile * kTile];
    transpose_tile(tile, kTile, staged, kTile);
    for (std::size_t r = 0; r < rows; ++r) {
        std::copy_n(staged + r * kTile, cols, plane.row(row + r) + col);
    }
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
