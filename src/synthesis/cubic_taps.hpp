// SPDX-License-Identifier: Apache-2.0
// Between the sites of a coarse lattice and the pixels of a texture.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sateen {

/// Four neighbouring sites and their weights, by the cubic of Catmull and Rom.
struct CubicTaps {
    std::size_t first = 0;  ///< counted from the first site of a window
    std::array<float, 4> weights{};
};

/// The site at or before a pixel. \param step  pixels between sites
inline std::int32_t site_before(std::int64_t pixel, double step) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(pixel) / step));
}

inline CubicTaps cubic_taps(std::int64_t pixel, double step, std::int32_t first_site) {
    const std::int32_t site = site_before(pixel, step);
    const double t = static_cast<double>(pixel) / step - static_cast<double>(site);
    const double t2 = t * t;
    const double t3 = t2 * t;
    return {static_cast<std::size_t>(site - 1 - first_site),
            {static_cast<float>((-t3 + 2 * t2 - t) / 2),
             static_cast<float>((3 * t3 - 5 * t2 + 2) / 2),
             static_cast<float>((-3 * t3 + 4 * t2 + t) / 2),
             static_cast<float>((t3 - t2) / 2)}};
}

}  // namespace sateen
