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
#include "sateen/core/normal.hpp"
#include "sateen/core/parallel.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// Fills a plane with the noise of (seed, band), site (0, 0) at the top left.
void draw_noise(std::uint64_t seed, std::uint32_t band, PlaneView<float> out,
                Executor& executor);

/// White noise on a (rows, cols) torus by its Fourier transform ŵ, whose numbers are normal and
/// independent but for ŵ(-ω) = conj ŵ(ω): a transform of noise that was drawn site by site would
/// have the same law. E|ŵ|² = 2 everywhere, a scale that pinned variances take out again. The
/// number at a frequency depends on (seed, band, row, column) of it and on whether `cols` is
/// even.
/// \param spectrum  (rows, ⌊cols/2⌋ + 1), written
void draw_noise_spectrum(NoiseField noise, std::size_t cols,
                         SplitComplexView<float> spectrum, Executor& executor);

/// What textures of one material have in common.
struct TorusNoise {
    std::uint64_t seed = 0;
    /// draw_noise_spectrum() of (seed, noise_band(plane)) for every plane of the material; or
    /// nothing, and rows are drawn where they are coloured: faster where one texture needs them.
    std::span<const SplitComplexPlane> kept;
};

/// ŷ_t = E_t^{1/2} ŵ_t with ŷ_0 = 0, the positive root: √E_t for one plane, the Hermitian
/// root for planes that are drawn together.
/// \param spectra  the half spectra of a (rows, cols) torus, one for each plane of the field,
///                 written
/// \returns  for each plane of the field the factor that makes its variance 1: realised, not
///           only expected, so that textures of any seed have the measured colours. 0 for a
///           plane without any power
[[nodiscard]] std::array<float, kMaxBands> colour_noise(
    const PlaneField& field, std::size_t cols, const TorusNoise& noise,
    std::span<SplitComplexPlane> spectra, Executor& executor);

}  // namespace sateen
