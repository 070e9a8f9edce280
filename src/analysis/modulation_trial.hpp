// SPDX-License-Identifier: Apache-2.0
// What trials of band modulation are drawn from: a texture as it will be drawn, Gaussian, and
// realisations of its fields. Theory: docs/theory/band_modulation.md.
#pragma once

#include <cstddef>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/structure.hpp"

namespace sateen {

/// Planes of the same power spectra and random phases.
/// \param planes    accepted FFT sizes
/// \param together  the same phases for all of them
[[nodiscard]] Result<Image> with_random_phases(const Image& planes, bool together,
                                               Executor& executor);

/// A realisation of the field of a level on every pixel of a torus.
[[nodiscard]] Result<void> draw_trial_field(const SmoothField& field, std::size_t level,
                                            PlaneView<float> out, Executor& executor);

}  // namespace sateen
