// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "goniometer/surfaces.hpp"

namespace sateen {
namespace {

// Inside a sphere of radius R any two points exchange light alike, so that under light
// from above every point of a dimple of opening radius a gathers
//     J = ρ a² / (4 R²),    v = ρ (n·l + J)
TEST(Interreflection, ASphericalDimpleGathersTheSameEverywhere) {
    constexpr std::size_t kSide = 64;
    constexpr float kRadius = 28;
    constexpr float kOpening = 25;
    constexpr float kAlbedo = 0.7F;
    const float rim = std::sqrt(kRadius * kRadius - kOpening * kOpening);
    const SurfaceMaps dimple =
        test::grey_surface(4 * kSide, kSide, kAlbedo, [&](float x, float y) {
            const float d2 = (x - 32) * (x - 32) + (y + 32) * (y + 32);
            return d2 < kOpening * kOpening ? rim - std::sqrt(kRadius * kRadius - d2)
                                            : 0.0F;
        });
    GoniometerOptions options = test::lambertian(kSide);
    const Image direct = test::image_of(dimple, options, {}, {});
    options.gather_rays = 1024;
    const Image both = test::image_of(dimple, options, {}, {});
    const float expected =
        kAlbedo * kAlbedo * kOpening * kOpening / (4 * kRadius * kRadius);
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c) {
            const float x = static_cast<float>(c) + 0.5F - 32;
            const float y = static_cast<float>(r) + 0.5F - 32;
            const float distance = std::sqrt(x * x + y * y);
            const float gathered = both(0, r, c) - direct(0, r, c);
            if (distance < 0.8F * kOpening) {
                EXPECT_NEAR(gathered, expected, 0.06F * expected) << r << "," << c;
            }
            if (distance > kOpening + 3) {
                EXPECT_LT(gathered, 0.01F) << r << "," << c;
            }
        }
}

}  // namespace
}  // namespace sateen
