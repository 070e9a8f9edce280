// SPDX-License-Identifier: Apache-2.0
// Batched split-complex fast Fourier transforms of sizes 2^a 3^b 5^c, single precision.
// Theory: docs/theory/fft.md. Naive oracle: tests/reference/dft.hpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// True for sizes the transforms accept: 2^a 3^b 5^c, at least 1.
[[nodiscard]] bool is_fft_size(std::size_t n);
/// The largest accepted size <= n that is a multiple of `multiple_of` (itself accepted),
/// or 0.
[[nodiscard]] std::size_t fft_size_at_most(std::size_t n, std::size_t multiple_of = 1);
/// The smallest accepted size >= n that is a multiple of `multiple_of` (itself accepted).
[[nodiscard]] std::size_t fft_size_at_least(std::size_t n, std::size_t multiple_of = 1);

/// Real and imaginary part in planes of their own.
template <class T>
struct SplitComplexView {
    PlaneView<T> re;
    PlaneView<T> im;
};

/// Ranges to cut work into that needs memory of its own: a few a thread.
[[nodiscard]] inline std::size_t ranges_of(const Executor& executor) {
    constexpr std::size_t kRangesPerThread = 4;
    const std::size_t threads = executor.concurrency();
    return threads == 1 ? 1 : threads * kRangesPerThread;
}

namespace detail {
struct FftPlan2d;

/// Allocates whole cache lines.
template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t kLine{64};

    CacheLineAllocator() = default;
    template <class U>
    CacheLineAllocator(const CacheLineAllocator<U>&) {}
    T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new(n * sizeof(T), kLine));
    }
    void deallocate(T* p, std::size_t) { ::operator delete(p, kLine); }
    friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};
}  // namespace detail

/// An owning split-complex plane, zero on construction unless said. Rows start on cache lines, so the
/// stride of its views is not always the number of columns.
class SplitComplexPlane {
  public:
    SplitComplexPlane() = default;
    SplitComplexPlane(std::size_t rows, std::size_t cols)
        : rows_(rows),
          cols_(cols),
          stride_((cols + kLine - 1) / kLine * kLine),
          values_(2 * rows * stride_, 0.0F) {}
    SplitComplexPlane(std::size_t rows, std::size_t cols, Uninitialised)
        : rows_(rows),
          cols_(cols),
          stride_((cols + kLine - 1) / kLine * kLine),
          values_(2 * rows * stride_) {}
    [[nodiscard]] SplitComplexView<float> view() {
        return {{values_.data(), rows_, cols_, stride_},
                {values_.data() + rows_ * stride_, rows_, cols_, stride_}};
    }
    [[nodiscard]] SplitComplexView<const float> view() const {
        return {{values_.data(), rows_, cols_, stride_},
                {values_.data() + rows_ * stride_, rows_, cols_, stride_}};
    }
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t cols() const { return cols_; }

  private:
    static constexpr std::size_t kLine = 64 / sizeof(float);
    std::size_t rows_ = 0;
    std::size_t cols_ = 0;
    std::size_t stride_ = 0;
    std::vector<float,
                detail::UninitialisedAllocator<float, detail::CacheLineAllocator<float>>>
        values_;
};

/// The two-dimensional DFT of one real plane and its inverse.
///
///     Ŷ(m, n) = Σ_r Y_r exp(-2πi (m r1 / M + n r2 / N)),   n = 0 … ⌊N/2⌋
///
/// unnormalised forward; the inverse divides by MN. A plan is immutable and may be used
/// by several threads at a time; scratch memory is allocated per call.
class Fft2d {
  public:
    /// \error invalid_argument  rows or cols is not an accepted size.
    [[nodiscard]] static Result<Fft2d> create(std::size_t rows, std::size_t cols);
    Fft2d(Fft2d&&) noexcept;
    Fft2d& operator=(Fft2d&&) noexcept;
    ~Fft2d();

    [[nodiscard]] std::size_t rows() const;
    [[nodiscard]] std::size_t cols() const;
    /// Columns of the half spectrum, ⌊N/2⌋ + 1.
    [[nodiscard]] std::size_t spectrum_cols() const;

    /// \param plane     (M, N)
    /// \param spectrum  (M, ⌊N/2⌋ + 1), written
    void forward(PlaneView<const float> plane, SplitComplexView<float> spectrum,
                 Executor& executor) const;
    /// \param spectrum  (M, ⌊N/2⌋ + 1), destroyed; what in it no real plane has is
    /// ignored \param plane     (M, N), written
    void inverse(SplitComplexView<float> spectrum, PlaneView<float> plane,
                 Executor& executor) const;

    /// Both in two steps, for callers that make the rows, or go on with them, while they
    /// are in the cache. Rows come in blocks: `first` is a multiple of kRowBlock, and as
    /// many rows as that, or what is left of the plane.
    static constexpr std::size_t kRowBlock = 32;
    class Scratch;
    /// body(first, count, scratch) for every block of rows.
    template <class Body>
    void for_row_blocks(Executor& executor, const Body& body) const;
    void forward_rows(PlaneView<const float> rows, std::size_t first,
                      SplitComplexView<float> spectrum, Scratch& scratch) const;
    void forward_columns(SplitComplexView<float> spectrum, Executor& executor) const;
    void inverse_columns(SplitComplexView<float> spectrum, Executor& executor) const;
    /// \param rows  written, times `gain`
    void inverse_rows(SplitComplexView<const float> spectrum, std::size_t first,
                      float gain, PlaneView<float> rows, Scratch& scratch) const;

  private:
    explicit Fft2d(std::unique_ptr<detail::FftPlan2d> plan);
    [[nodiscard]] Scratch scratch() const;
    std::unique_ptr<detail::FftPlan2d> plan_;
};

/// Memory for the rows of one thread.
class Fft2d::Scratch {
  public:
    /// Memory for the caller's use, until the next call.
    [[nodiscard]] float* floats(std::size_t count) {
        own_.resize(std::max(count, own_.size()));
        return own_.data();
    }

  private:
    friend class Fft2d;
    explicit Scratch(std::size_t floats) : values_(floats) {}
    using Values = std::vector<
        float, detail::UninitialisedAllocator<float, detail::CacheLineAllocator<float>>>;
    Values values_;
    Values own_;
};

template <class Body>
void Fft2d::for_row_blocks(Executor& executor, const Body& body) const {
    const std::size_t blocks = (rows() + kRowBlock - 1) / kRowBlock;
    const std::size_t ranges = std::min(blocks, ranges_of(executor));
    parallel_for(executor, ranges, [&](std::size_t range) {
        Scratch memory = scratch();
        for (std::size_t block = range * blocks / ranges;
             block < (range + 1) * blocks / ranges; ++block) {
            const std::size_t first = block * kRowBlock;
            body(first, std::min(kRowBlock, rows() - first), memory);
        }
    });
}

/// The two-dimensional DFT of a complex plane, in place, and its inverse.
///
///     Ŷ(m, n) = Σ_r Y_r exp(-2πi (m r1 / M + n r2 / N)),   n = 0 … N - 1
///
/// unnormalised forward; the inverse divides by MN. Shared between threads like Fft2d.
class Fft2dComplex {
  public:
    /// \error invalid_argument  rows or cols is not an accepted size.
    [[nodiscard]] static Result<Fft2dComplex> create(std::size_t rows, std::size_t cols);
    Fft2dComplex(Fft2dComplex&&) noexcept;
    Fft2dComplex& operator=(Fft2dComplex&&) noexcept;
    ~Fft2dComplex();

    [[nodiscard]] std::size_t rows() const;
    [[nodiscard]] std::size_t cols() const;

    /// \param plane  (M, N), replaced by its transform
    void forward(SplitComplexView<float> plane, Executor& executor) const;
    void inverse(SplitComplexView<float> plane, Executor& executor) const;

  private:
    explicit Fft2dComplex(std::unique_ptr<detail::FftPlan2d> plan);
    void run(SplitComplexView<float> plane, bool inverse, Executor& executor) const;
    std::unique_ptr<detail::FftPlan2d> plan_;
};

}  // namespace sateen
