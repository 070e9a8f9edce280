// SPDX-License-Identifier: Apache-2.0
// Drawing the periodic layer. Theory: docs/theory/periodic_layer.md. Partner:
// analysis/periodic_layer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/cell_table.hpp"
#include "sateen/material/material.hpp"
#include "synthesis/cubic_taps.hpp"
#include "synthesis/smooth_field.hpp"

namespace sateen {

/// The lattice nearest to that of a layer which closes on a torus,
///
///     B' = diag(M, N) K⁻¹,   K = round(B⁻¹ diag(M, N))
///
/// and one cell for the whole torus where that is too small for the lattice.
[[nodiscard]] LatticeMap closed_lattice(const PeriodicLayer& layer, std::size_t rows,
                                        std::size_t cols);

/// The lattice and the realised displacement of one texture: the same for all subspaces.
class PeriodicPhase {
  public:
    /// \param period  of a tileable texture, or none
    [[nodiscard]] static Result<PeriodicPhase> create(const PeriodicLayer& layer,
                                                      std::uint64_t seed, Period period,
                                                      Executor& executor);

    /// u(x) = B⁻¹ (x + D(x)), D by cubic interpolation, row by row of a window: the same bits
    /// at a pixel whatever the window.
    class Window {
      public:
        Window(const PeriodicPhase& phase, std::int32_t row, std::int32_t col,
               std::size_t rows, std::size_t cols, Executor& executor);
        /// Row `r` of the window. \param u, v  of its pixels
        void phases(std::size_t r, std::span<double> u, std::span<double> v) const;

      private:
        const PeriodicPhase& phase_;
        std::int32_t row_;
        std::int32_t col_;
        std::int32_t first_row_;  ///< site of the first row of sites_
        std::vector<CubicTaps> col_taps_;
        Image sites_;  ///< (2, …)
    };

  private:
    explicit PeriodicPhase(std::array<SmoothLattice, 2> displacement)
        : displacement_(std::move(displacement)) {}
    LatticeMap map_;
    double row_step_ = 1;  ///< pixels between sites
    double col_step_ = 1;
    std::array<SmoothLattice, 2> displacement_;
};

/// X = c(m(u) + s(u) q(g) + Σ l(u) q(g)) in place: standard normal fields g in, planes out, to which only
/// the spectral transform and the tone are left to be applied.
/// \param planes  the window whose top left pixel is (row, col)
/// \cost  about 30 ns a pixel
void apply_periodic_layer(const Structure& structure, const Subspace& subspace,
                          const PeriodicPhase& phase, std::int32_t row, std::int32_t col,
                          ImageView<float> planes, Executor& executor);

}  // namespace sateen
