// SPDX-License-Identifier: Apache-2.0
#include "sateen/core/fft.hpp"

#include <algorithm>
#include <cassert>
#include <new>
#include <string>
#include <utility>

#include "core/fft_hermitian.hpp"
#include "core/fft_plan.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/fft.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/fft_planes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

using detail::BlockRange;

void transform_columns(const FftPlan1d& plan, SplitComplexView<float> plane, bool inverse,
                       BlockRange range) {
    for (std::size_t b = range.first; b < range.last; ++b) {
        transform_column_block(plan, plane, inverse, b, range.scratch);
    }
}

void transform_rows(const FftPlan1d& plan, SplitComplexView<float> plane, bool inverse,
                    float factor, BlockRange range) {
    for (std::size_t b = range.first; b < range.last; ++b) {
        transform_row_block(plan, plane, inverse, factor, b, range.scratch);
    }
}

void forward_real_rows(const FftPlan1d& plan, PlaneView<const float> plane,
                       SplitComplexView<float> spectrum, BlockRange range) {
    for (std::size_t b = range.first; b < range.last; ++b) {
        forward_real_row_block(plan, plane, spectrum, b, range.scratch);
    }
}

void inverse_real_rows(const FftPlan1d& plan, SplitComplexView<const float> spectrum,
                       PlaneView<float> plane, float factor, BlockRange range) {
    for (std::size_t b = range.first; b < range.last; ++b) {
        inverse_real_row_block(plan, spectrum, plane, factor, b, range.scratch);
    }
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

struct detail::FftPlan2d {
    FftPlan1d rows;  ///< the transform of a row
    FftPlan1d cols;  ///< the transform of a column
};

namespace {

using detail::BlockRange;
using detail::FftPlan1d;
using detail::FftPlan2d;
using detail::kBatchLanes;

HWY_EXPORT(transform_columns);
HWY_EXPORT(transform_rows);
HWY_EXPORT(forward_real_rows);
HWY_EXPORT(inverse_real_rows);

constexpr std::align_val_t kCacheLine{64};

struct AlignedDelete {
    void operator()(float* p) const { ::operator delete[](p, kCacheLine); }
};

std::unique_ptr<float[], AlignedDelete> make_scratch(std::size_t floats) {
    return std::unique_ptr<float[], AlignedDelete>(new (kCacheLine) float[floats]);
}

std::size_t blocks_of(std::size_t size, std::size_t block) {
    return (size + block - 1) / block;
}

/// Runs `body(BlockRange)` over all blocks, a few ranges a thread, each with scratch for
/// `plan`. Blocks do not depend on each other, so the cut does not change the result.
template <class F>
void for_block_ranges(Executor& executor, const FftPlan1d& plan, std::size_t blocks,
                      const F& body) {
    const std::size_t ranges = std::min(blocks, ranges_of(executor));
    parallel_for(executor, ranges, [&](std::size_t i) {
        const auto scratch = make_scratch(detail::scratch_floats(plan));
        body(BlockRange{i * blocks / ranges, (i + 1) * blocks / ranges, scratch.get()});
    });
}

void all_columns(const FftPlan1d& plan, SplitComplexView<float> plane, bool inverse,
                 Executor& executor) {
    if (plan.size == 1) return;
    const auto run = HWY_DYNAMIC_DISPATCH(transform_columns);
    for_block_ranges(executor, plan, blocks_of(plane.re.cols, kBatchLanes),
                     [&](BlockRange range) { run(plan, plane, inverse, range); });
}

static_assert(Fft2d::kRowBlock == 2 * kBatchLanes);

Result<std::unique_ptr<FftPlan2d>> make_plan(std::size_t rows, std::size_t cols) {
    if (is_fft_size(rows) && is_fft_size(cols)) {
        return std::make_unique<FftPlan2d>(FftPlan2d{FftPlan1d(cols), FftPlan1d(rows)});
    }
    return Error{Errc::invalid_argument,
                 "FFT of " + std::to_string(rows) + " x " + std::to_string(cols) +
                     ": expected rows and columns of the form 2^a 3^b 5^c"};
}

SplitComplexView<float> first_cols(SplitComplexView<float> plane, std::size_t cols) {
    return {plane.re.window(0, 0, plane.re.rows, cols),
            plane.im.window(0, 0, plane.im.rows, cols)};
}

/// Asserted only.
template <class T>
[[maybe_unused]] bool has_shape(const PlaneView<T>& plane, std::size_t rows,
                                std::size_t cols) {
    return plane.rows == rows && plane.cols == cols;
}

}  // namespace

Result<Fft2d> Fft2d::create(std::size_t rows, std::size_t cols) {
    return make_plan(rows, cols).transform([](std::unique_ptr<FftPlan2d> plan) {
        return Fft2d(std::move(plan));
    });
}

Fft2d::Fft2d(std::unique_ptr<FftPlan2d> plan) : plan_(std::move(plan)) {}
Fft2d::Fft2d(Fft2d&&) noexcept = default;
Fft2d& Fft2d::operator=(Fft2d&&) noexcept = default;
Fft2d::~Fft2d() = default;

std::size_t Fft2d::rows() const {
    return plan_->cols.size;
}
std::size_t Fft2d::cols() const {
    return plan_->rows.size;
}
std::size_t Fft2d::spectrum_cols() const {
    return cols() / 2 + 1;
}

Fft2d::Scratch Fft2d::scratch() const {
    return Scratch(detail::scratch_floats(plan_->rows));
}

void Fft2d::forward(PlaneView<const float> plane, SplitComplexView<float> spectrum,
                    Executor& executor) const {
    assert(has_shape(plane, rows(), cols()));
    for_row_blocks(executor, [&](std::size_t first, std::size_t count, Scratch& scratch) {
        forward_rows(plane.window(first, 0, count, cols()), first, spectrum, scratch);
    });
    forward_columns(spectrum, executor);
}

void Fft2d::inverse(SplitComplexView<float> spectrum, PlaneView<float> plane,
                    Executor& executor) const {
    assert(has_shape(plane, rows(), cols()));
    inverse_columns(spectrum, executor);
    for_row_blocks(executor, [&](std::size_t first, std::size_t count, Scratch& scratch) {
        inverse_rows({spectrum.re, spectrum.im}, first, 1,
                     plane.window(first, 0, count, cols()), scratch);
    });
}

void Fft2d::forward_rows(PlaneView<const float> block, std::size_t first,
                         SplitComplexView<float> spectrum, Scratch& scratch) const {
    assert(has_shape(spectrum.re, rows(), spectrum_cols()));
    assert(has_shape(spectrum.im, rows(), spectrum_cols()));
    assert(has_shape(block, std::min(kRowBlock, rows() - first), cols()));
    const std::size_t packed = detail::packed_cols(cols());
    HWY_DYNAMIC_DISPATCH(forward_real_rows)
    (plan_->rows, block,
     {spectrum.re.window(first, 0, block.rows, packed),
      spectrum.im.window(first, 0, block.rows, packed)},
     {0, 1, scratch.values_.data()});
}

void Fft2d::forward_columns(SplitComplexView<float> spectrum, Executor& executor) const {
    all_columns(plan_->cols, first_cols(spectrum, detail::packed_cols(cols())), false,
                executor);
    if (cols() % 2 == 0) detail::unpack_real_columns(spectrum);
}

void Fft2d::inverse_columns(SplitComplexView<float> spectrum, Executor& executor) const {
    assert(has_shape(spectrum.re, rows(), spectrum_cols()));
    assert(has_shape(spectrum.im, rows(), spectrum_cols()));
    if (cols() % 2 == 0) detail::pack_real_columns(spectrum);
    all_columns(plan_->cols, first_cols(spectrum, detail::packed_cols(cols())), true,
                executor);
}

void Fft2d::inverse_rows(SplitComplexView<const float> spectrum, std::size_t first,
                         float gain, PlaneView<float> block, Scratch& scratch) const {
    assert(has_shape(block, std::min(kRowBlock, rows() - first), cols()));
    const std::size_t packed = detail::packed_cols(cols());
    const float factor = gain / static_cast<float>(rows() * cols());
    HWY_DYNAMIC_DISPATCH(inverse_real_rows)
    (plan_->rows,
     {spectrum.re.window(first, 0, block.rows, packed),
      spectrum.im.window(first, 0, block.rows, packed)},
     block, factor, {0, 1, scratch.values_.data()});
}

Result<Fft2dComplex> Fft2dComplex::create(std::size_t rows, std::size_t cols) {
    return make_plan(rows, cols).transform([](std::unique_ptr<FftPlan2d> plan) {
        return Fft2dComplex(std::move(plan));
    });
}

Fft2dComplex::Fft2dComplex(std::unique_ptr<FftPlan2d> plan) : plan_(std::move(plan)) {}
Fft2dComplex::Fft2dComplex(Fft2dComplex&&) noexcept = default;
Fft2dComplex& Fft2dComplex::operator=(Fft2dComplex&&) noexcept = default;
Fft2dComplex::~Fft2dComplex() = default;

std::size_t Fft2dComplex::rows() const {
    return plan_->cols.size;
}
std::size_t Fft2dComplex::cols() const {
    return plan_->rows.size;
}

void Fft2dComplex::forward(SplitComplexView<float> plane, Executor& executor) const {
    run(plane, false, executor);
}

void Fft2dComplex::inverse(SplitComplexView<float> plane, Executor& executor) const {
    run(plane, true, executor);
}

void Fft2dComplex::run(SplitComplexView<float> plane, bool inverse,
                       Executor& executor) const {
    assert(has_shape(plane.re, rows(), cols()));
    assert(has_shape(plane.im, rows(), cols()));
    const float factor = 1.0F / static_cast<float>(rows() * cols());
    const auto run = HWY_DYNAMIC_DISPATCH(transform_rows);
    for_block_ranges(
        executor, plan_->rows, blocks_of(rows(), kBatchLanes),
        [&](BlockRange range) { run(plan_->rows, plane, inverse, factor, range); });
    all_columns(plan_->cols, plane, inverse, executor);
}

}  // namespace sateen
#endif
