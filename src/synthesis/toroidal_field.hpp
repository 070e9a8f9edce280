// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of planes on a torus.
// Theory: docs/theory/spectral_synthesis.md, docs/theory/car3d.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// Fills a plane with the noise of (seed, band), site (0, 0) at the top left.
void draw_noise(std::uint64_t seed, std::uint32_t band, PlaneView<float> out,
                Executor& executor);

/// ŵ, the transform of draw_noise() on the torus of `fft`.
void draw_noise_spectrum(std::uint64_t seed, std::uint32_t band, const Fft2d& fft,
                         SplitComplexView<float> spectrum, Executor& executor);

/// ŷ_t = E_t^{1/2} ŵ_t with ŷ_0 = 0, the positive root: √E_t for one plane, the Hermitian
/// root for planes that are drawn together.
/// \param noise    ŵ, the half spectra of white noise of a (rows, cols) torus, one for each
///                 plane of the field
/// \param spectra  as many, written, may be the noise
/// \returns  for each plane of the field the factor that makes its variance 1: realised, not
///           only expected, so that textures of any seed have the measured colours. 0 for a
///           plane without any power
[[nodiscard]] std::array<float, kMaxBands> colour_noise(
    const PlaneField& field, std::size_t cols, std::span<const SplitComplexPlane> noise,
    std::span<SplitComplexPlane> spectra, Executor& executor);

}  // namespace sateen
