// SPDX-License-Identifier: Apache-2.0
// Minimum-error cuts of the Roller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/image.hpp"

namespace sateen {

/// The path of least error through a strip, one site a step, that moves by at most one site
/// between steps [Efros and Freeman 2001; Haindl and Richtr 2013, corrected]:
///
///     Ψ(i, s) = ψ(i, s) + min(Ψ(i-1, s-1), Ψ(i-1, s), Ψ(i-1, s+1))
///
/// \param error   (1, steps, sites)
/// \param closed  the last site is a neighbour of the first, as on a torus
/// \returns the site of every step
[[nodiscard]] std::vector<std::size_t> minimum_error_path(const BasicImage<double>& error,
                                                          bool closed);

/// The inside of the closed loop of least error around the middle of a rectangle, 1 or 0 a
/// pixel; loop pixels count as outside.
/// \param error  (1, rows, cols)
/// \param band   the loop runs through pixels 1 … band from the border
[[nodiscard]] std::vector<std::uint8_t> minimum_error_inside(
    const BasicImage<double>& error, std::size_t band);

}  // namespace sateen
