// SPDX-License-Identifier: Apache-2.0
// From drawn planes to reflectance: marginal curves, inverse Karhunen-Loève transform,
// tone. Theory: docs/theory/marginal.md, docs/theory/spectral.md. Partner:
// analysis/spectral.
#pragma once

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// v = tone⁻¹(Tᵀ q(g) + mean), negative values clipped to 0, in place.
/// \param planes  (d, rows, cols): standard normal fields g in, linear reflectance out
void invert_spectral(const Subspace& subspace, ImageView<float> planes,
                     Executor& executor);

}  // namespace sateen
