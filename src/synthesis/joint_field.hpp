// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of planes that one field draws together, on a torus.
// Theory: docs/theory/car3d.md.
#pragma once

#include <cstddef>
#include <span>

#include "sateen/core/fft.hpp"
#include "sateen/core/parallel.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen {

/// ŷ_t = E_t^{1/2} ŵ_t, the Hermitian root, with ŷ_0 = 0; every plane scaled to mean 0 and
/// variance 1 as colour_noise() does.
/// \param noise    half spectra of white noise, one for each plane of the field
/// \param spectra  as many, written, may be the noise; those of constant planes become zero
void colour_joint_noise(const PlaneField& field, std::size_t cols,
                        std::span<const SplitComplexPlane> noise,
                        std::span<SplitComplexPlane> spectra, Executor& executor);

/// S ← S^{1/2} at every frequency.
void hermitian_root(ImageView<float> density, Executor& executor);

}  // namespace sateen
