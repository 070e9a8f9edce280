// SPDX-License-Identifier: Apache-2.0
// Moisan's periodic plus smooth decomposition of an image.
// Theory: docs/theory/periodic_part.md.
#pragma once

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// The periodic part p = u - s of an image u: its opposite borders meet, so its DFT is
/// free of the cross that border jumps make. s is smooth, of zero mean, and solves
///
///     Δs = v    on the torus,   v the jumps of u across its borders        [Moisan 2011]
///
/// Deviation: with `border_share` > 0 the jumps are those between the means of bands along
/// opposite borders, that share of the size wide, instead of between single pixels. Only what
/// varies slowly then counts as a jump: the ribs of a corduroy that happen to meet at
/// different phases do not, and leave no ramp behind. Gradients are removed either way.
///
/// \param in   u, (M, N)
/// \param out  p, (M, N), same mean; may be `in`
/// \param border_share  0 for Moisan's decomposition, up to 1/2
/// \error invalid_argument  M or N is not 2^a 3^b 5^c.
/// \cost       one forward and one inverse FFT
Result<void> periodic_part(PlaneView<const float> in, PlaneView<float> out,
                           Executor& executor, double border_share = 0);

}  // namespace sateen
