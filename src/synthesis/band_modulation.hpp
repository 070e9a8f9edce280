// SPDX-License-Identifier: Apache-2.0
// Drawing the modulation of bands. Theory: docs/theory/band_modulation.md.
// Partner: analysis/band_modulation.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "material/modulate.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "synthesis/smooth_field.hpp"

namespace sateen {

/// The fields of amplitude of one texture, the same for all subspaces.
class AmplitudeFields {
  public:
    /// \param period  of a tileable texture, or none
    [[nodiscard]] static Result<AmplitudeFields> create(const BandModulation& fields,
                                                        std::uint64_t seed, Period period,
                                                        Executor& executor);
    /// h_s at the pixels of a window, by cubic interpolation: the same bits at a pixel
    /// whatever the window.
    void draw(std::size_t level, std::int32_t row, std::int32_t col, PlaneView<float> out,
              Executor& executor) const;

  private:
    struct Lattice {
        SmoothLattice sites;
        double row_step;  ///< pixels between sites
        double col_step;
    };
    std::array<std::optional<Lattice>, BandModulation::kLevels> lattices_;
};

/// The modulated planes of a subspace in place of the Gaussian ones.
/// \param planes  a whole torus, or a window whose outer kModulationReach pixels are lost
/// \param row, col  of the top left pixel
void modulate_planes(const BandModulation& fields, const Subspace& subspace,
                     const AmplitudeFields& amplitudes, Border border, std::int32_t row,
                     std::int32_t col, ImageView<float> planes, Executor& executor);

}  // namespace sateen
