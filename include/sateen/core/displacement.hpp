// SPDX-License-Identifier: Apache-2.0
// Where a slanted ray meets a range map.
#pragma once

namespace sateen {

/// The height z at which a ray that passes (0, 0, 0) first meets a surface: from `highest`
/// down in equal steps until the surface is not below the ray, then by bisection.
/// \param height_at  height_at(z) is that of the surface under the ray's point of height z
template <class HeightAt>
[[nodiscard]] float meeting_height(const HeightAt& height_at, float lowest, float highest,
                                   int steps, int bisections) {
    const float step = (highest - lowest) / static_cast<float>(steps);
    float above = highest;
    float below = lowest;
    for (int i = 1; i <= steps; ++i) {
        const float z = highest - step * static_cast<float>(i);
        if (height_at(z) >= z) {
            below = z;
            break;
        }
        above = z;
    }
    for (int i = 0; i < bisections; ++i) {
        const float z = 0.5F * (above + below);
        (height_at(z) >= z ? below : above) = z;
    }
    return 0.5F * (above + below);
}

}  // namespace sateen
