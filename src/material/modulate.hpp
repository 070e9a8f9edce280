// SPDX-License-Identifier: Apache-2.0
// Band modulation applied: analysis finds the gains with the same code that synthesis draws
// with. Theory: docs/theory/band_modulation.md.
#pragma once

#include <functional>
#include <vector>

#include "sateen/core/band_split.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/band_modulation.hpp"

namespace sateen {

/// Fills a plane with h_s of a level; not asked for where there is none.
using DrawAmplitudeField =
    std::function<void(std::size_t level, PlaneView<float> out, Executor& executor)>;

/// Pixels that a modulated one depends on lie no further away along either axis: 30 for the
/// bands, and for the energies of each level in turn, of the first plane and then of another.
inline constexpr std::size_t kModulationReach =
    30 + energy_reach(3) + energy_reach(3) + energy_reach(2) + energy_reach(1);

/// The planes of one texture, band by band.
class BandModulator {
  public:
    BandModulator(const BandModulation& fields, DrawAmplitudeField draw, Border border,
                  ImageView<float> planes, Executor& executor);

    /// Splits a plane into bands; planes in order. `bands` and `low` are then those of it.
    void split(std::size_t plane);
    /// Modulates one level of it, levels in order from the coarsest, and adds it to `low`.
    void modulate(std::size_t plane, std::size_t level,
                  const SubspaceModulation& modulation);
    /// The same for a trial: leaves bands as they are. \returns  the band modulated
    [[nodiscard]] PlaneView<const float> tried(std::size_t plane, std::size_t level,
                                               const SubspaceModulation& modulation);
    /// Puts what has become of a plane in its place.
    void finish(std::size_t plane, float unit);

    [[nodiscard]] PlaneView<const float> low() const { return low_; }
    [[nodiscard]] PlaneView<const float> band(std::size_t level) const {
        return bands_.plane(level);
    }

  private:
    void run(std::size_t plane, std::size_t level, const SubspaceModulation& modulation,
             PlaneView<float> band, PlaneView<float> low);

    const BandModulation& fields_;
    DrawAmplitudeField draw_;
    Border border_;
    ImageView<float> planes_;
    Executor& executor_;
    Image bands_;
    Image first_;  ///< energies of the first plane
    Image work_;
    PlaneView<float> low_;
    PlaneView<float> spare_;
    PlaneView<float> energy_;
    PlaneView<float> field_;
};

/// All planes of a subspace in place.
/// \param planes  standard normal fields, with kModulationReach more pixels on every side of a
///                window than are wanted of it; or a whole torus
/// \cost  see bench/modulation_bench
void modulate_bands(const BandModulation& fields, const SubspaceModulation& modulation,
                    DrawAmplitudeField draw, Border border, ImageView<float> planes,
                    Executor& executor);

}  // namespace sateen
