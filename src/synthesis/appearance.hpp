// SPDX-License-Identifier: Apache-2.0
// From drawn planes to reflectance: marginal curves, inverse Karhunen-Loève transform,
// tone. Theory: docs/theory/marginal.md, docs/theory/spectral.md. Partner:
// analysis/spectral.
#pragma once

#include <span>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// v = tone⁻¹(Tᵀ q(g) + mean), negative values clipped to 0.
/// \param fields  (d, rows, cols), standard normal fields g
/// \param out     a plane for each band, linear reflectance; may be the fields
void invert_spectral(const Subspace& subspace, ImageView<const float> fields,
                     std::span<const PlaneView<float>> out, Executor& executor);
/// In place.
void invert_spectral(const Subspace& subspace, ImageView<float> planes,
                     Executor& executor);

}  // namespace sateen
