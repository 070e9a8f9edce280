// SPDX-License-Identifier: Apache-2.0
#include "goniometer/reflectance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace sateen::goniometer {
namespace {

/// ∫ f(l) n·l dω over the hemisphere, by midpoints in cos θ and φ.
template <class F>
double hemisphere(const F& f) {
    constexpr int kRings = 400;
    constexpr int kSpokes = 800;
    double sum = 0;
    for (int i = 0; i < kRings; ++i) {
        const double z = (i + 0.5) / kRings;
        const double radius = std::sqrt(1 - z * z);
        for (int j = 0; j < kSpokes; ++j) {
            const double phi = 2 * std::numbers::pi * (j + 0.5) / kSpokes;
            sum += z * static_cast<double>(f(std::array<float, 3>{
                           static_cast<float>(radius * std::cos(phi)),
                           static_cast<float>(radius * std::sin(phi)),
                           static_cast<float>(z)}));
        }
    }
    return sum * 2 * std::numbers::pi / (kRings * kSpokes);
}

struct Cosines {
    float nl, nv, nh, vh;
};
Cosines cosines(const std::array<float, 3>& l, float theta) {
    const std::array<float, 3> v = {std::sin(theta), 0, std::cos(theta)};
    std::array<float, 3> h = {l[0] + v[0], l[1] + v[1], l[2] + v[2]};
    const float length = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    for (float& x : h) x /= length;
    return {l[2], v[2], h[2], v[0] * h[0] + v[2] * h[2]};
}

TEST(Reflectance, NoGgxLayerReflectsMoreThanItReceives) {
    for (const float roughness : {0.4F, 0.6F, 0.8F, 1.0F})
        for (const float theta_deg : {0.0F, 30.0F, 60.0F, 75.0F, 85.0F}) {
            const double energy = hemisphere([&](const std::array<float, 3>& l) {
                const Cosines c = cosines(l, theta_deg * std::numbers::pi_v<float> / 180);
                return ggx(c.nl, c.nv, c.nh, alpha_of(roughness)) /
                       std::numbers::pi_v<float>;
            });
            EXPECT_LE(energy, 1.001) << roughness << " at " << theta_deg;
        }
}

// Light scattered more than once between microfacets is lost: at α = 1 and from above
// 1 - ln 2 is left.
TEST(Reflectance, TheRoughestGgxLayerReflectsTheShareOfItsClosedForm) {
    const double energy = hemisphere([](const std::array<float, 3>& l) {
        const Cosines c = cosines(l, 0);
        return ggx(c.nl, c.nv, c.nh, 1) / std::numbers::pi_v<float>;
    });
    EXPECT_NEAR(energy, 1 - std::numbers::ln2, 1e-4);
}

TEST(Reflectance, ASmoothGgxLayerReflectsNearlyAll) {
    const double energy = hemisphere([](const std::array<float, 3>& l) {
        const Cosines c = cosines(l, 0.3F);
        return ggx(c.nl, c.nv, c.nh, alpha_of(0.3F)) / std::numbers::pi_v<float>;
    });
    EXPECT_NEAR(energy, 1, 0.01);
}

TEST(Reflectance, AWhiteBodyUnderALayerReflectsNoMoreThanItReceives) {
    for (const float roughness : {0.4F, 0.7F, 1.0F})
        for (const float theta_deg : {0.0F, 45.0F, 75.0F, 85.0F}) {
            const double energy = hemisphere([&](const std::array<float, 3>& l) {
                const Cosines c = cosines(l, theta_deg * std::numbers::pi_v<float> / 180);
                const float f = fresnel(0.04F, c.vh);
                return (through_layer(0.04F, c.nl, c.nv) +
                        f * ggx(c.nl, c.nv, c.nh, alpha_of(roughness))) /
                       std::numbers::pi_v<float>;
            });
            EXPECT_LE(energy, 1.001) << roughness << " at " << theta_deg;
        }
}

TEST(Reflectance, LightAndViewCanBeExchanged) {
    for (const float nl : {0.01F, 0.3F, 0.9F})
        for (const float nv : {0.02F, 0.5F, 1.0F})
            EXPECT_FLOAT_EQ(ggx(nl, nv, 0.8F, 0.2F), ggx(nv, nl, 0.8F, 0.2F));
}

TEST(Reflectance, FresnelRunsFromF0ToOne) {
    EXPECT_FLOAT_EQ(fresnel(0.04F, 1), 0.04F);
    EXPECT_FLOAT_EQ(fresnel(0.04F, 0), 1);
}

}  // namespace
}  // namespace sateen::goniometer
