// SPDX-License-Identifier: Apache-2.0
#include "sateen/render/environment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sateen {
namespace {

/// Dim everywhere, with a bright spot of one pixel.
Image map_with_sun() {
    Image map(3, 16, 32);
    for (std::size_t r = 0; r < 16; ++r)
        for (std::size_t c = 0; c < 32; ++c)
            for (std::size_t band = 0; band < 3; ++band)
                map(band, r, c) = 0.1F + 0.05F * static_cast<float>(band) +
                                  (r == 3 && c == 20 ? 50.0F : 0.0F);
    return map;
}

/// ∫ L dω by the map's own pixels.
double integral(const Image& map, std::size_t band) {
    double sum = 0;
    for (std::size_t r = 0; r < map.rows(); ++r) {
        const double step = std::numbers::pi / static_cast<double>(map.rows());
        const double angle = (std::cos(static_cast<double>(r) * step) -
                              std::cos(static_cast<double>(r + 1) * step)) *
                             2 * std::numbers::pi / static_cast<double>(map.cols());
        for (std::size_t c = 0; c < map.cols(); ++c)
            sum += angle * static_cast<double>(map(band, r, c));
    }
    return sum;
}

TEST(Environment, SamplesAddUpToTheIntegralOfTheMap) {
    const Image map = map_with_sun();
    const auto made = Environment::create(map);
    ASSERT_TRUE(made);
    constexpr int kSide = 200;
    std::array<double, 3> sums{};
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const auto sample = made->sample({(static_cast<float>(i) + 0.5F) / kSide,
                                              (static_cast<float>(j) + 0.5F) / kSide});
            ASSERT_GT(sample.density, 0);
            const Vector3& d = sample.direction;
            EXPECT_NEAR(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1, 1e-4F);
            EXPECT_NEAR(made->density(d), sample.density, 1e-3F * sample.density);
            EXPECT_EQ(made->radiance(d), sample.radiance);
            for (std::size_t band = 0; band < 3; ++band)
                sums[band] += static_cast<double>(sample.radiance[band] / sample.density);
        }
    for (std::size_t band = 0; band < 3; ++band)
        EXPECT_NEAR(sums[band] / (kSide * kSide), integral(map, band),
                    0.02 * integral(map, band));
}

TEST(Environment, TheTopRowIsAbove) {
    Image map = map_with_sun();
    for (std::size_t c = 0; c < 32; ++c) map(0, 0, c) = 7;
    const auto made = Environment::create(map);
    ASSERT_TRUE(made);
    EXPECT_EQ(made->radiance({0, 0, 1})[0], 7);
    EXPECT_LT(made->radiance({0, 0, -1})[0], 1);
    // The middle column is +y, a quarter further right +x.
    Image ahead(3, 8, 16);
    for (float& v : ahead.values()) v = 0.1F;
    ahead(1, 3, 8) = 5;
    ahead(2, 3, 12) = 6;
    const auto turned = Environment::create(ahead);
    ASSERT_TRUE(turned);
    EXPECT_EQ(turned->radiance({0.05F, 0.98F, 0.1F})[1], 5);
    EXPECT_EQ(turned->radiance({0.98F, -0.05F, 0.1F})[2], 6);
}

TEST(Environment, WhatIsNoLightIsRefused) {
    EXPECT_FALSE(Environment::create(Image(3, 4, 8)));
    EXPECT_FALSE(Environment::create(Image(1, 4, 8)));
    Image negative = map_with_sun();
    negative(0, 1, 1) = -1;
    EXPECT_FALSE(Environment::create(negative));
}

}  // namespace
}  // namespace sateen
