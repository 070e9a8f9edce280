// SPDX-License-Identifier: Apache-2.0
// Planar float images and non-owning views of them.
// Shape is (bands, rows, cols), row-major, column contiguous; values are linear unless
// said.
#pragma once

#include <cassert>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace sateen {

/// Asks for memory as it comes, where all of it is written before it is read: zeroing a
/// texture takes as long as drawing its noise.
struct Uninitialised {};
inline constexpr Uninitialised uninitialised;

namespace detail {
/// std::vector<T, …>(n) leaves its elements uninitialised.
template <class T, class Base = std::allocator<T>>
struct UninitialisedAllocator : Base {
    using value_type = T;
    template <class U>
    struct rebind {
        using other = UninitialisedAllocator<
            U, typename std::allocator_traits<Base>::template rebind_alloc<U>>;
    };
    UninitialisedAllocator() = default;
    template <class U, class B>
    UninitialisedAllocator(const UninitialisedAllocator<U, B>&) {}
    template <class U>
    void construct(U* at) {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Args>
    void construct(U* at, Args&&... args) {
        ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }
};
}  // namespace detail

/// One plane of an image: rows of contiguous columns, rows `stride` elements apart.
template <class T>
struct PlaneView {
    T* data = nullptr;
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::size_t stride = 0;

    PlaneView() = default;
    PlaneView(T* data_, std::size_t rows_, std::size_t cols_, std::size_t stride_)
        : data(data_), rows(rows_), cols(cols_), stride(stride_) {}
    PlaneView(T* data_, std::size_t rows_, std::size_t cols_)
        : PlaneView(data_, rows_, cols_, cols_) {}
    /// A writable view is also a readable one.
    template <class U>
    requires(std::is_same_v<T, const U>) PlaneView(const PlaneView<U>& other)
        : PlaneView(other.data, other.rows, other.cols, other.stride) {}

    [[nodiscard]] T* row(std::size_t r) const {
        assert(r < rows);
        return data + r * stride;
    }
    [[nodiscard]] T& operator()(std::size_t r, std::size_t c) const {
        assert(r < rows && c < cols);
        return data[r * stride + c];
    }
    [[nodiscard]] std::size_t size() const { return rows * cols; }
    [[nodiscard]] bool contiguous() const { return stride == cols; }
    [[nodiscard]] PlaneView window(std::size_t r0, std::size_t c0, std::size_t height,
                                   std::size_t width) const {
        assert(r0 + height <= rows && c0 + width <= cols);
        return {data + r0 * stride + c0, height, width, stride};
    }
};

/// Planes of equal size.
template <class T>
struct ImageView {
    T* data = nullptr;
    std::size_t bands = 0;
    std::size_t rows = 0;
    std::size_t cols = 0;

    ImageView() = default;
    ImageView(T* data_, std::size_t bands_, std::size_t rows_, std::size_t cols_)
        : data(data_), bands(bands_), rows(rows_), cols(cols_) {}
    template <class U>
    requires(std::is_same_v<T, const U>) ImageView(const ImageView<U>& other)
        : ImageView(other.data, other.bands, other.rows, other.cols) {}

    [[nodiscard]] PlaneView<T> plane(std::size_t band) const {
        assert(band < bands);
        return {data + band * rows * cols, rows, cols};
    }
    [[nodiscard]] std::size_t plane_size() const { return rows * cols; }
    [[nodiscard]] std::size_t size() const { return bands * rows * cols; }
};

/// An owning planar image, zero on construction unless said.
template <class T>
class BasicImage {
  public:
    BasicImage() = default;
    BasicImage(std::size_t bands, std::size_t rows, std::size_t cols)
        : values_(bands * rows * cols, T()), bands_(bands), rows_(rows), cols_(cols) {}
    BasicImage(std::size_t bands, std::size_t rows, std::size_t cols, Uninitialised)
        : values_(bands * rows * cols), bands_(bands), rows_(rows), cols_(cols) {}

    [[nodiscard]] std::size_t bands() const { return bands_; }
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t cols() const { return cols_; }
    [[nodiscard]] std::size_t plane_size() const { return rows_ * cols_; }
    [[nodiscard]] bool empty() const { return values_.empty(); }

    [[nodiscard]] ImageView<T> view() { return {values_.data(), bands_, rows_, cols_}; }
    [[nodiscard]] ImageView<const T> view() const {
        return {values_.data(), bands_, rows_, cols_};
    }
    [[nodiscard]] PlaneView<T> plane(std::size_t band) { return view().plane(band); }
    [[nodiscard]] PlaneView<const T> plane(std::size_t band) const {
        return view().plane(band);
    }
    [[nodiscard]] T& operator()(std::size_t band, std::size_t row, std::size_t col) {
        return plane(band)(row, col);
    }
    [[nodiscard]] const T& operator()(std::size_t band, std::size_t row,
                                      std::size_t col) const {
        return plane(band)(row, col);
    }
    [[nodiscard]] std::span<T> values() { return values_; }
    [[nodiscard]] std::span<const T> values() const { return values_; }

  private:
    std::vector<T, detail::UninitialisedAllocator<T>> values_;
    std::size_t bands_ = 0;
    std::size_t rows_ = 0;
    std::size_t cols_ = 0;
};

using Image = BasicImage<float>;

}  // namespace sateen
