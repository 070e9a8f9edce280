// SPDX-License-Identifier: Apache-2.0
// One plane of a material on the infinite lattice, in windows. Also tori too large for,
// or of a size unknown to, one Fourier transform. Theory: docs/theory/infinite_plane.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "sateen/core/result.hpp"
#include "synthesis/overlap_save.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// The finest levels have short kernels and are drawn at full resolution; the coarser
/// ones together on a lattice of every 2^k-th site, and expanded. Both are stationary
/// fields, so the sum has the density of the whole pyramid.
class InfiniteField {
  public:
    /// \param period  of a tileable texture, or none
    [[nodiscard]] static Result<InfiniteField> create(const PlaneField& field,
                                                      Period period, Executor& executor);
    /// A window of variance 1 and mean 0 in expectation.
    /// \param plane  numbers the noise; the first of several
    /// \param out    as many planes as the field has, of one size
    [[nodiscard]] Result<void> draw(std::uint64_t seed, std::uint32_t plane,
                                    std::int32_t row, std::int32_t col,
                                    std::span<const PlaneView<float>> out,
                                    Executor& executor) const;
    [[nodiscard]] Result<void> draw(std::uint64_t seed, std::uint32_t plane,
                                    std::int32_t row, std::int32_t col,
                                    PlaneView<float> out, Executor& executor) const {
        return draw(seed, plane, row, col, std::span(&out, 1), executor);
    }
    /// A good number of rows to draw at a time.
    [[nodiscard]] std::size_t strip_rows() const;

  private:
    InfiniteField() = default;
    Period period_;
    std::size_t split_ = 0;  ///< levels in the fine part; 0: all
    std::optional<OverlapSave> fine_;
    std::optional<OverlapSave> coarse_;
};

}  // namespace sateen
