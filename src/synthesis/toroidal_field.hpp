// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of a plane on a torus.  Theory: docs/theory/spectral_synthesis.md.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// Fills a plane with the noise of (seed, band), site (0, 0) at the top left.
void draw_noise(std::uint64_t seed, std::uint32_t band, PlaneView<float> out,
                Executor& executor);

/// ŷ_t = √(E_t) ŵ_t with ŷ_0 = 0, scaled so that the drawn plane has mean 0 and variance
/// 1: realised, not only expected, so that textures of any seed have the measured
/// colours. \param noise     ŵ, the half spectrum of white noise of a (rows, cols) torus
/// \param spectrum  written, may be the noise; a plane without any power becomes zero
void colour_noise(const PlaneField& field, std::size_t cols,
                  SplitComplexView<const float> noise, SplitComplexView<float> spectrum,
                  Executor& executor);

}  // namespace sateen
