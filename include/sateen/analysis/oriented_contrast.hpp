// SPDX-License-Identifier: Apache-2.0
// How strongly the lightness of an image varies in four directions: what histograms do
// not see. Theory: docs/theory/segmentation.md.
#pragma once

#include <array>

#include "sateen/core/image.hpp"

namespace sateen {

/// Root mean square differences of L over steps of about 3 pixels along the columns, the
/// two diagonals and the rows (0°, 45°, 90°, 135°), divided by √2: in Lab units, for
/// white noise its standard deviation.
using OrientedContrast = std::array<double, 4>;

/// Of a plane of L, 0 … 100; it is rounded to 1/255 of that range, so that the sums are of
/// integers, and NaN counts as 0. Directions in which the plane is too small give 0.
/// \param step  (0, step), (d, -d), (step, 0) and (d, d) are compared, d the nearest to
///              step/√2: 3, or less where pixels were left out between those of the plane
/// \cost about 1 ns a pixel
[[nodiscard]] OrientedContrast oriented_contrast(PlaneView<const float> L,
                                                 std::size_t step = 3);

}  // namespace sateen
