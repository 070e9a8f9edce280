// SPDX-License-Identifier: Apache-2.0
// From drawn fields to reflectance: everything of a texture that is not a Gaussian field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/band_modulation.hpp"
#include "synthesis/periodic_layer.hpp"

namespace sateen {

/// Rows [first, first + count) of every plane.
[[nodiscard]] std::vector<PlaneView<float>> windows_of(ImageView<float> image,
                                                       std::size_t first,
                                                       std::size_t count);

/// From fields to reflectance, unless the caller wants the fields: the modulation of bands and
/// the periodic layer, where the material has them, then marginal curves, spectral transform
/// and tone.
class Finish {
  public:
    /// \param material  kept by reference
    /// \param period    of a torus; none for the infinite plane
    static Result<Finish> create(const Material& material,
                                 const SynthesisOptions& options, Period period,
                                 Executor& executor);
    /// Pixels that are needed on every side of a window.
    [[nodiscard]] std::size_t margin() const {
        return amplitudes_ ? kModulationReach : 0;
    }
    /// Of fields that are a whole torus, or that have the margin about them.
    void modulate(const Subspace& subspace, Border border, std::int32_t row,
                  std::int32_t col, ImageView<float> fields, Executor& executor) const;
    /// \param planes  fields whose top left is (row, col), overwritten
    /// \param out     a plane for each band, written; may be the fields
    void operator()(const Subspace& subspace, std::int32_t row, std::int32_t col,
                    ImageView<float> planes, std::span<const PlaneView<float>> out,
                    Executor& executor) const;
    /// In place.
    void operator()(const Subspace& subspace, std::int32_t row, std::int32_t col,
                    ImageView<float> planes, Executor& executor) const {
        (*this)(subspace, row, col, planes, windows_of(planes, 0, planes.rows), executor);
    }

  private:
    bool fields_only_ = false;
    const BandModulation* modulation_ = nullptr;
    std::optional<AmplitudeFields> amplitudes_;
    const Structure* structure_ = nullptr;
    std::optional<PeriodicPhase> phase_;
};

}  // namespace sateen
