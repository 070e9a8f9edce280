// SPDX-License-Identifier: Apache-2.0
// A Lambertian body under a GGX layer.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sateen::goniometer {

/// Cosines below are taken for this one in the specular term, which divides by them. The
/// same for light and view, so that reflectance stays reciprocal.
inline constexpr float kMinCosine = 1e-4F;
/// Smoother surfaces would need more samples than a pixel has.
inline constexpr float kMinRoughness = 0.1F;

[[nodiscard]] inline float alpha_of(float roughness) {
    const float clamped = std::clamp(roughness, kMinRoughness, 1.0F);
    return clamped * clamped;
}

/// Fresnel's reflectance after Schlick (1994): F(c) = F0 + (1 - F0) (1 - c)⁵.
[[nodiscard]] inline float fresnel(float f0, float cosine) {
    const float x = 1 - std::clamp(cosine, 0.0F, 1.0F);
    const float squared = x * x;
    return f0 + (1 - f0) * squared * squared * x;
}

/// What the layer lets in and out again: (1 - F(n·l)) (1 - F(n·v)). The factor of glTF,
/// 1 - F(v·h), makes a white body return up to a fifth more than it receives.
[[nodiscard]] inline float through_layer(float f0, float normal_light,
                                         float normal_view) {
    return (1 - fresnel(f0, normal_light)) * (1 - fresnel(f0, normal_view));
}

/// π D V of GGX with the height-correlated masking of Smith: what the layer reflects,
/// but for F.
///
///     D = α² / (π ((n·h)² (α² - 1) + 1)²)                  [Walter et al. 2007, eq. 33]
///     V = ½ / (n·l √((n·v)² (1 - α²) + α²) + n·v √((n·l)² (1 - α²) + α²))
///                                                            [Heitz 2014, eq. 99]
[[nodiscard]] inline float ggx(float normal_light, float normal_view, float normal_half,
                               float alpha) {
    const float nl = std::max(normal_light, kMinCosine);
    const float nv = std::max(normal_view, kMinCosine);
    const float a2 = alpha * alpha;
    const float spread = normal_half * normal_half * (a2 - 1) + 1;
    const float mask =
        nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2);
    return a2 / (2 * spread * spread * mask);
}

}  // namespace sateen::goniometer
