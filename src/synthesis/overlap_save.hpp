// SPDX-License-Identifier: Apache-2.0
// A stationary field on the infinite lattice, drawn in windows: white noise of the
// lattice convolved with a zero-phase kernel of finite support, by overlap-save. Theory:
// docs/theory/infinite_plane.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// Noise coordinates are taken modulo this size; 0 for the infinite plane.
struct Period {
    std::int32_t rows = 0;
    std::int32_t cols = 0;
};

class OverlapSave {
  public:
    /// The kernel √E, cut where it has died out and tapered.
    /// \param density    E on the half spectrum of a block, (rows, ⌊cols/2⌋ + 1)
    /// \param cols       of the block
    /// \param pin_mean   make the kernel sum to 0, so that large windows have mean 0
    [[nodiscard]] static Result<OverlapSave> create(PlaneView<const float> density,
                                                    std::size_t cols, bool pin_mean,
                                                    Executor& executor);

    /// Fills a window whose top left site is (row, col). The lattice is cut into blocks
    /// fixed to its origin and each block is drawn whole, so windows agree bit for bit.
    void draw(NoiseField noise, Period period, std::int32_t row, std::int32_t col,
              PlaneView<float> out, Executor& executor) const;

    /// Multiplies the field by a factor.
    void scale(float factor);
    /// Rows and columns that one block yields.
    [[nodiscard]] std::size_t block_rows() const { return fft_.rows() - 2 * reach_rows_; }
    [[nodiscard]] std::size_t block_cols() const { return fft_.cols() - 2 * reach_cols_; }

  private:
    explicit OverlapSave(Fft2d fft) : fft_(std::move(fft)) {}
    Fft2d fft_;
    Image filter_;  ///< the transfer function, real since the kernel is even
    std::size_t reach_rows_ = 0;
    std::size_t reach_cols_ = 0;
};

}  // namespace sateen
