// SPDX-License-Identifier: Apache-2.0
// Octave bands by short filters, on tori and in windows.
// Theory: docs/theory/band_modulation.md. Naive reference: tests/reference/band_split.hpp.
#pragma once

#include <cstddef>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"

namespace sateen {

/// What lies beyond the border of a plane. Windows of the infinite plane may take either: what
/// is further from the border than the reach of the filters does not depend on it.
enum class Border { wrap, mirror };

/// out = B_s * in, rest = in - out: the kernel [1 4 6 4 1]/16 along both axes with its taps
/// `spacing` pixels apart ["à trous", Holschneider et al. 1989], which reaches 2·spacing far.
/// Repeated with spacings 1, 2, 4, … the rests are the bands of a plane, which add up to it
/// with the last `out`.
/// \param in, rest, out  of one size, none of them the same
void split_band(PlaneView<const float> in, std::size_t spacing, Border border,
                PlaneView<float> rest, PlaneView<float> out, Executor& executor);

/// The energy of a band about each pixel: E = B_{2^s} * B_{2^(s-1)} * band², a window of a
/// deviation of 1.1·2^s pixels (1.4 for s = 0). The first kernel has no gain at twice the
/// centre frequency of the band, where its square has its ripple.
/// \param level  s, the band that split_band() made with spacing 2^s
/// \param work   of the same size, written
void local_energy(PlaneView<const float> band, std::size_t level, Border border,
                  PlaneView<float> work, PlaneView<float> out, Executor& executor);

/// How far local_energy() reaches.
[[nodiscard]] constexpr std::size_t energy_reach(std::size_t level) {
    return level == 0 ? 4 : 3 * (std::size_t{1} << level);
}

}  // namespace sateen
