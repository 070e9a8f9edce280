// SPDX-License-Identifier: Apache-2.0
// A stationary field on the infinite lattice, drawn in windows: white noise of the
// lattice convolved with a zero-phase kernel of finite support, by overlap-save. Theory:
// docs/theory/infinite_plane.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

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

/// Rows and columns of the measured sample, in sites of the lattice that is drawn.
struct SampleExtent {
    double rows = 0;
    double cols = 0;
};

class OverlapSave {
  public:
    /// The kernel √E, cut where it has died out and tapered; for d planes the kernels of
    /// the Hermitian root.
    /// \param density    E on the half spectrum of a block, (d², rows, ⌊cols/2⌋ + 1)
    /// \param cols       of the block
    /// \param pinned     the kernel is made to sum to 0, so that large windows have mean 0,
    ///                   by a notch in the density as narrow as a sample of this extent
    ///                   could tell from 0, or a quarter of the block; nothing for a field
    ///                   whose mean is left alone
    [[nodiscard]] static Result<OverlapSave> create(ImageView<const float> density,
                                                    std::size_t cols,
                                                    std::optional<SampleExtent> pinned,
                                                    Executor& executor);

    /// Fills a window whose top left site is (row, col). The lattice is cut into blocks
    /// fixed to its origin and each block is drawn whole, so windows agree bit for bit.
    /// \param noise  one field for each of the d planes
    /// \param out    d planes of one size
    void draw(std::span<const NoiseField> noise, Period period, std::int32_t row,
              std::int32_t col, std::span<const PlaneView<float>> out,
              Executor& executor) const;

    /// Multiplies one plane of the field by a factor.
    void scale(std::size_t plane, float factor) { gains_[plane] *= factor; }
    [[nodiscard]] std::size_t planes() const { return planes_; }
    /// Rows and columns that one block yields.
    [[nodiscard]] std::size_t block_rows() const { return fft_.rows() - 2 * reach_rows_; }
    [[nodiscard]] std::size_t block_cols() const { return fft_.cols() - 2 * reach_cols_; }

  private:
    explicit OverlapSave(Fft2d fft) : fft_(std::move(fft)) {}
    Fft2d fft_;
    void apply_filter(std::span<SplitComplexPlane> spectra) const;

    /// The transfer function: real since the kernel is even, or a Hermitian matrix laid
    /// out like the density.
    Image filter_;
    std::size_t planes_ = 1;
    std::array<float, 3> gains_{1, 1, 1};
    std::size_t reach_rows_ = 0;
    std::size_t reach_cols_ = 0;
};

}  // namespace sateen
