// SPDX-License-Identifier: Apache-2.0
// Smooth Gaussian fields on a coarse lattice, on tori and in windows of the infinite one.
// Theory: docs/theory/periodic_layer.md. Partner: analysis/smooth_field.
#pragma once

#include <cstdint>
#include <optional>

#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/smooth_density.hpp"
#include "sateen/material/structure.hpp"
#include "synthesis/overlap_save.hpp"

namespace sateen {

/// One realisation. Small tori are drawn when created, by one transform; windows of the
/// infinite lattice, and large tori, as they are asked for.
class SmoothLattice {
  public:
    /// \param period  of a torus, accepted FFT sizes; none: the infinite lattice
    [[nodiscard]] static Result<SmoothLattice> create(const SmoothField& field,
                                                      NoiseField noise, Period period,
                                                      double scale_rows,
                                                      double scale_cols,
                                                      Executor& executor);
    /// The window with site (row, col) at the top left: the same bits at a site whatever the
    /// window.
    void draw(std::int32_t row, std::int32_t col, PlaneView<float> out,
              Executor& executor) const;

  private:
    SmoothLattice() = default;
    NoiseField noise_;
    Period period_;
    Image whole_;
    std::optional<OverlapSave> blocks_;
};

}  // namespace sateen
