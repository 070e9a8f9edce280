// SPDX-License-Identifier: Apache-2.0
#include "sateen/core/colour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "support/simd_targets.hpp"

namespace sateen {
namespace {

TEST(SrgbCurve, HitsItsPublishedValues) {
    // 8-bit codes and their linear values, rounded to 6 digits.
    EXPECT_DOUBLE_EQ(srgb_decode(0.0), 0.0);
    EXPECT_NEAR(srgb_decode(1.0 / 255), 0.000303527, 1e-9);
    EXPECT_NEAR(srgb_decode(128.0 / 255), 0.215861, 5e-7);
    EXPECT_NEAR(srgb_decode(188.0 / 255), 0.502886, 5e-7);
    EXPECT_DOUBLE_EQ(srgb_decode(1.0), 1.0);
    EXPECT_NEAR(srgb_encode(0.5), 0.735357, 5e-7);
}

TEST(SrgbCurve, IsItsOwnInverseForCodesBelowZeroAndBeyondOne) {
    for (int i = -600; i <= 600; ++i) {
        const double code = i / 255.0;
        EXPECT_NEAR(srgb_encode(srgb_decode(code)), code, 1e-12);
        EXPECT_NEAR(srgb_encode(srgb_decode(static_cast<float>(code))), code, 1e-6);
        EXPECT_DOUBLE_EQ(srgb_decode(-code), -srgb_decode(code));
        EXPECT_DOUBLE_EQ(srgb_encode(-code), -srgb_encode(code));
    }
}

TEST(Lab, OfThePrimariesIsThePublishedOne) {
    // Lindbloom's calculator, whose white (0.95047, 1, 1.08883) differs in the 5th digit.
    const auto expect = [](const Lab& lab, double L, double a, double b) {
        EXPECT_NEAR(lab.L, L, 0.02);
        EXPECT_NEAR(lab.a, a, 0.02);
        EXPECT_NEAR(lab.b, b, 0.02);
    };
    expect(lab_from_linear_srgb(1, 0, 0), 53.2408, 80.0925, 67.2032);
    expect(lab_from_linear_srgb(0, 1, 0), 87.7347, -86.1827, 83.1793);
    expect(lab_from_linear_srgb(0, 0, 1), 32.2970, 79.1875, -107.8602);
}

TEST(Lab, OfGreysHasNoColour) {
    for (const double v : {0.0, 1e-4, 0.0088, 0.0089, 0.18, 1.0, 7.0}) {
        const Lab lab = lab_from_linear_srgb(v, v, v);
        EXPECT_NEAR(lab.a, 0, 1e-12);
        EXPECT_NEAR(lab.b, 0, 1e-12);
    }
    EXPECT_NEAR(lab_from_linear_srgb(1, 1, 1).L, 100, 1e-12);
    EXPECT_NEAR(lab_from_linear_srgb(0.18418651851244416, 0.18418651851244416,
                                     0.18418651851244416)
                    .L,
                50, 1e-9);
    EXPECT_NEAR(lab_from_linear_srgb(0, 0, 0).L, 0, 1e-12);
}

struct Planes {
    explicit Planes(std::size_t count)
        : red(count), green(count), blue(count), L(count), a(count), b(count) {}
    std::vector<float> red, green, blue, L, a, b;
};

void convert(Planes& p) {
    lab_from_linear_srgb(p.red, p.green, p.blue, p.L, p.a, p.b);
}

void expect_like_scalar(const Planes& p, double tolerance) {
    for (std::size_t i = 0; i < p.red.size(); ++i) {
        const Lab lab = lab_from_linear_srgb(static_cast<double>(p.red[i]),
                                             static_cast<double>(p.green[i]),
                                             static_cast<double>(p.blue[i]));
        ASSERT_NEAR(p.L[i], lab.L, tolerance) << i;
        ASSERT_NEAR(p.a[i], lab.a, tolerance) << i;
        ASSERT_NEAR(p.b[i], lab.b, tolerance) << i;
    }
}

TEST(Lab, OfPlanesIsLikeTheScalarOnTheWholeCube) {
    // 41³ colours, denser near black, where f changes its piece.
    constexpr std::size_t kSteps = 41;
    Planes p(kSteps * kSteps * kSteps);
    const auto level = [](std::size_t i) {
        const float v = static_cast<float>(i) / (kSteps - 1);
        return v * v * v;
    };
    for (std::size_t i = 0; i < p.red.size(); ++i) {
        p.red[i] = level(i % kSteps);
        p.green[i] = level(i / kSteps % kSteps);
        p.blue[i] = level(i / kSteps / kSteps);
    }
    test::for_each_simd_target([&] {
        convert(p);
        expect_like_scalar(p, 2e-4);
    });
}

TEST(Lab, OfPlanesIsLikeTheScalarOutsideTheCube) {
    Planes p(4000);
    for (std::size_t i = 0; i < p.red.size(); ++i) {
        const float x = static_cast<float>(i) / 100.0F;
        p.red[i] = 20.0F - x;
        p.green[i] = x * x;
        p.blue[i] = 0.3F * x - 2.0F;
    }
    test::for_each_simd_target([&] {
        convert(p);
        expect_like_scalar(p, 1e-2);
    });
}

TEST(Lab, OfPlanesDoesNotDependOnTheirLengthAndWritesNothingBeyond) {
    constexpr std::size_t kCount = 70;
    Planes all(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
        all.red[i] = static_cast<float>(i) / 64.0F;
        all.green[i] = static_cast<float>((i * 37) % 64) / 64.0F;
        all.blue[i] = static_cast<float>((i * 11) % 64) / 64.0F;
    }
    convert(all);
    for (std::size_t count = 0; count < kCount; ++count) {
        Planes part(count);
        std::copy_n(all.red.begin(), count, part.red.begin());
        std::copy_n(all.green.begin(), count, part.green.begin());
        std::copy_n(all.blue.begin(), count, part.blue.begin());
        convert(part);
        EXPECT_TRUE(std::equal(part.L.begin(), part.L.end(), all.L.begin()));
        EXPECT_TRUE(std::equal(part.a.begin(), part.a.end(), all.a.begin()));
        EXPECT_TRUE(std::equal(part.b.begin(), part.b.end(), all.b.begin()));
    }
}

TEST(Lab, LightnessOfGreyPlanesIsThatOfTheColour) {
    for (const std::size_t count : {0U, 1U, 7U, 333U}) {
        std::vector<float> grey(count);
        for (std::size_t i = 0; i < count; ++i) {
            grey[i] = 1.2F * static_cast<float>(i) / static_cast<float>(count);
        }
        std::vector<float> L(count);
        lightness_from_linear(grey, L);
        for (std::size_t i = 0; i < count; ++i) {
            const auto v = static_cast<double>(grey[i]);
            EXPECT_NEAR(L[i], lab_from_linear_srgb(v, v, v).L, 1e-4);
        }
    }
}

TEST(DeltaE, Of1976IsTheDistance) {
    EXPECT_DOUBLE_EQ(delta_e_76({50, 1, 2}, {52, 4, 8}), 7.0);
}

struct Pair {
    Lab first, second;
    double difference;
};

// Table 1 of Sharma, Wu & Dalal, The CIEDE2000 color-difference formula, 2005.
constexpr std::array<Pair, 34> kSharmaPairs = {{
    {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
    {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
    {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
    {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
    {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
    {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
    {{50, 0, 0}, {50, -1, 2}, 2.3669},
    {{50, -1, 2}, {50, 0, 0}, 2.3669},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0010}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0012}, 7.2195},
    {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0010, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
    {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
    {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
    {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
    {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
    {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
    {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
    {{50, 2.5, 0}, {50, 3.2972, 0}, 1.0000},
    {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1.0000},
    {{50, 2.5, 0}, {50, 3.2592, 0.3350}, 1.0000},
    {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
    {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
    {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
    {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
    {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
    {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
    {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
    {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
    {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
    {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
}};

TEST(DeltaE, Of2000IsThePublishedOneForAllPairsOfSharma) {
    for (std::size_t i = 0; i < kSharmaPairs.size(); ++i) {
        const Pair& pair = kSharmaPairs[i];
        EXPECT_NEAR(delta_e_2000(pair.first, pair.second), pair.difference, 5e-5) << i;
    }
}

TEST(DeltaE, Of2000IsSymmetricAndZeroForEqualColours) {
    for (const Pair& pair : kSharmaPairs) {
        EXPECT_NEAR(delta_e_2000(pair.second, pair.first),
                    delta_e_2000(pair.first, pair.second), 1e-12);
        EXPECT_EQ(delta_e_2000(pair.first, pair.first), 0.0);
    }
}

}  // namespace
}  // namespace sateen
