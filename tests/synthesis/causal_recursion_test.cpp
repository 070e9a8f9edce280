// SPDX-License-Identifier: Apache-2.0
#include "synthesis/causal_recursion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "reference/causal_recursion.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

using Taps = std::vector<CausalTap>;

Image noise(std::size_t rows, std::size_t cols) {
    Image image(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        draw_normals({4, 0}, static_cast<std::int32_t>(r), 0,
                     {image.plane(0).row(r), cols});
    }
    return image;
}

// Every site of the half plane at most `reach` away, Σ|a| = 0.9: stable.
Taps half_plane(int reach) {
    Taps taps;
    for (int row = 0; row <= reach; ++row) {
        for (int col = row == 0 ? 1 : -reach; col <= reach; ++col) {
            taps.push_back(
                {row, col, static_cast<float>((row * 7 + col * 3 + 50) % 11) - 5.0F});
        }
    }
    float sum = 0;
    for (const CausalTap& tap : taps) sum += std::abs(tap.a);
    for (CausalTap& tap : taps) tap.a *= 0.9F / sum;
    return taps;
}

const std::vector<Taps> kModels = {
    {},
    {{0, 1, 0.9F}},
    {{1, 0, 0.8F}},
    {{0, 1, 0.55F}, {1, 0, 0.5F}, {1, 1, -0.12F}},
    {{0, 1, 0.4F}, {1, -1, 0.3F}, {1, 0, 0.2F}},
    {{1, -5, 0.7F}},
    {{5, 5, 0.5F}, {5, -5, 0.4F}},
    {{0, 5, -0.8F}, {2, -3, 0.15F}},
    half_plane(1),
    half_plane(2),
    half_plane(5),
    half_plane(kCausalReach),
};

template <class Check>
void for_each_target(Check&& check) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        SCOPED_TRACE(hwy::TargetName(target));
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().DeInit();
        check();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
}

TEST(CausalRecursion, HasTheBitsOfTheReferenceOnEveryTarget) {
    for_each_target([] {
        for (const Taps& taps : kModels) {
            for (const std::size_t rows : {1U, 3U, 16U, 21U, 50U}) {
                for (const std::size_t cols : {1U, 2U, 7U, 31U, 300U}) {
                    Image expected = noise(rows, cols);
                    Image got = expected;
                    reference::causal_recursion(taps, 0.7F, expected.plane(0));
                    ASSERT_TRUE(causal_recursion(taps, 0.7F, got.plane(0)));
                    ASSERT_TRUE(std::equal(got.values().begin(), got.values().end(),
                                           expected.values().begin()))
                        << taps.size() << " taps, " << rows << " x " << cols;
                }
            }
        }
    });
}

TEST(CausalRecursion, IsAccurateToFloatRounding) {
    const Taps taps = half_plane(3);
    Image got = noise(64, 200);
    BasicImage<double> expected(1, 64, 200);
    std::copy(got.values().begin(), got.values().end(), expected.values().begin());
    reference::causal_recursion(taps, 1.0F, expected.plane(0));
    ASSERT_TRUE(causal_recursion(taps, 1.0F, got.plane(0)));
    for (std::size_t i = 0; i < expected.plane_size(); ++i) {
        ASSERT_NEAR(static_cast<double>(got.values()[i]), expected.values()[i], 1e-5);
    }
}

TEST(CausalRecursion, StripByStripGivesTheSameField) {
    for (const Taps& taps : kModels) {
        const Image e = noise(70, 130);
        Image whole = e;
        ASSERT_TRUE(causal_recursion(taps, 1.5F, whole.plane(0)));
        Image strips = e;
        std::size_t first = 0;
        for (const std::size_t height : {5U, 1U, 2U, 32U, 30U}) {
            const auto strip = strips.plane(0).window(first, 0, height, 130);
            const std::size_t kept = std::min<std::size_t>(first, kCausalReach);
            const auto above = strips.plane(0).window(first - kept, 0, kept, 130);
            ASSERT_TRUE(causal_recursion(taps, 1.5F, above, strip));
            first += height;
        }
        ASSERT_EQ(first, 70U);
        ASSERT_THAT(strips.values(), testing::ElementsAreArray(whole.values().begin(),
                                                               whole.values().end()));
    }
}

TEST(CausalRecursion, LeavesTheRestOfAWindowAlone) {
    Image image(1, 40, 60);
    std::fill(image.values().begin(), image.values().end(), 2.0F);
    ASSERT_TRUE(
        causal_recursion(half_plane(2), 1.0F, image.plane(0).window(3, 5, 30, 41)));
    for (std::size_t r = 0; r < 40; ++r) {
        for (std::size_t c = 0; c < 60; ++c) {
            const bool inside = r >= 3 && r < 33 && c >= 5 && c < 46;
            if (inside) continue;
            ASSERT_EQ(image(0, r, c), 2.0F);
        }
    }
}

TEST(CausalRecursion, HasTheVarianceOfItsModel) {
    // Y_c = a Y_{c-1} + σ e along rows: variance σ² / (1 - a²). n independent rows of N
    // sites hold about n N (1 - a²) / (1 + a²) independent squares; 4.5 standard errors.
    constexpr double kA = 0.6;
    Image field = noise(256, 1024);
    ASSERT_TRUE(causal_recursion(Taps{{0, 1, 0.6F}}, 2.0F, field.plane(0)));
    double sum = 0;
    for (std::size_t r = 0; r < 256; ++r) {
        for (std::size_t c = 64; c < 1024; ++c) {
            const auto y = static_cast<double>(field(0, r, c));
            sum += y * y;
        }
    }
    constexpr double kCount = 256 * 960;
    constexpr double kExpected = 4 / (1 - kA * kA);
    const double independent = kCount * (1 - kA * kA) / (1 + kA * kA);
    EXPECT_NEAR(sum / kCount, kExpected, 4.5 * kExpected * std::sqrt(2 / independent));
}

TEST(CausalRecursion, RefusesTapsThatAreNotCausal) {
    Image field(1, 4, 4);
    for (const CausalTap tap :
         {CausalTap{0, 0, 1}, CausalTap{0, -1, 1}, CausalTap{-1, 2, 1},
          CausalTap{kCausalReach + 1, 0, 1}, CausalTap{1, -kCausalReach - 1, 1}}) {
        const auto result = causal_recursion(Taps{tap}, 1.0F, field.plane(0));
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, Errc::invalid_argument);
    }
}

TEST(CausalRecursion, RefusesRowsAboveOfAnotherWidth) {
    Image field(1, 4, 4);
    const Image above(1, 2, 5);
    const auto result = causal_recursion({}, 1.0F, above.plane(0), field.plane(0));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().message,
              "causal recursion: expected rows above of 4 columns, found 5");
}

}  // namespace
}  // namespace sateen
