// SPDX-License-Identifier: Apache-2.0
// Wide Gaussian blurs that take a plane to be mirrored at its borders.
#pragma once

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"

namespace sateen {

/// out = in - G_σ * in, mirrored at the borders, by the cosine series that such a blur is
/// diagonal in: cos(π k (x + ½)/N) comes out as itself times exp(-σ²π²k²/2N²).
/// \param in   (M, N); may be `out`
/// \cost       O(MN·max(M, N)/σ)
void subtract_smooth_part(PlaneView<const float> in, double sigma, PlaneView<float> out,
                          Executor& executor);

}  // namespace sateen
