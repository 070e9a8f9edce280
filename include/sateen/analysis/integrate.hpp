// SPDX-License-Identifier: Apache-2.0
// Slopes to height: the projection of Frankot and Chellappa on a torus.
// Theory: docs/theory/integration.md.
#pragma once

#include <cstddef>

#include "sateen/core/image.hpp"

namespace sateen {

/// Slopes (p, q) = (∂z/∂x, ∂z/∂y), (2, rows, cols): x along the columns, y up, against the
/// rows.
using SlopeField = BasicImage<double>;

/// What a slope is of the heights around it, as its factor D(ω) of the spectrum.
enum class Difference {
    band_limited,  ///< the derivative: jω
    central,       ///< (z(x+1) - z(x-1)) / 2: j sin ω
    forward,       ///< z(x+1) - z(x): exp(jω) - 1
};

/// How the slopes continue beyond the borders.
enum class Periodicity {
    torus,   ///< as they are: the height wraps, its mean slope is removed
    mirror,  ///< the height is mirrored, as for photographs of a piece of something larger
};

/// The height whose differences are nearest to the slopes, mean 0:
///
///     Ẑ = (D̄x P + D̄y Q) / (|Dx|² + |Dy|²),   Ẑ(0) = 0
///
/// [Frankot and Chellappa 1988, with the symbols of the differences used]. Slopes that are
/// differences of a torus are inverted exactly; for `central` up to 0.7 of the Nyquist
/// frequency, above which they hardly see the height, and the noise in them is damped.
/// \param shear  the torus is that of the lattice (rows, shear), (0, cols)
/// \returns (1, rows, cols), in pixels
/// \cost O(n log n) in double precision for any size; 4 times as much for a mirror
[[nodiscard]] BasicImage<double> integrate(const SlopeField& slopes,
                                           Difference difference, Periodicity periodicity,
                                           std::size_t shear = 0);

/// The differences of a torus: the inverse of integrate().
[[nodiscard]] SlopeField slopes_of(const BasicImage<double>& height,
                                   Difference difference);

/// Slopes of unit normals (3, rows, cols): p = -n_x / n_z, q = -n_y / n_z, with n_z no less
/// than 0.15.
[[nodiscard]] SlopeField slopes_of_normals(const Image& normals);

/// Subtracts the plane z = a + b x + c y of least squares.
void remove_tilt(BasicImage<double>& height);

}  // namespace sateen
