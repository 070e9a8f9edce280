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

// The largest error of a field against the recursion in double.
double largest_error(const Image& field, const BasicImage<double>& exact) {
    double largest = 0;
    for (std::size_t i = 0; i < exact.plane_size(); ++i)
        largest = std::max(largest, std::abs(static_cast<double>(field.values()[i]) -
                                             exact.values()[i]));
    return largest;
}

struct Drawn {
    Image field;
    Image naive;
    BasicImage<double> exact;
};

Drawn draw(const Taps& taps, float sigma, std::size_t rows, std::size_t cols) {
    Drawn drawn{noise(rows, cols), noise(rows, cols), {1, rows, cols}};
    std::copy(drawn.field.values().begin(), drawn.field.values().end(),
              drawn.exact.values().begin());
    EXPECT_TRUE(causal_recursion(taps, sigma, drawn.field.plane(0)));
    reference::causal_recursion(taps, sigma, drawn.naive.plane(0));
    reference::causal_recursion(taps, sigma, drawn.exact.plane(0));
    return drawn;
}

TEST(CausalRecursion, EqualsTheRecursionSiteBySite) {
    // Σ|a| ≤ 0.97 and |e| < 5, so |Y| < 0.7 · 5 / 0.03; in fact it is below 10, and each
    // of the sums rounds by a few units of 2^-24 of it.
    for (const Taps& taps : kModels) {
        for (const std::size_t rows : {1U, 3U, 21U, 50U}) {
            for (const std::size_t cols : {1U, 2U, 7U, 31U, 32U, 33U, 300U}) {
                const Drawn drawn = draw(taps, 0.7F, rows, cols);
                ASSERT_LT(largest_error(drawn.field, drawn.exact), 1e-5)
                    << taps.size() << " taps, " << rows << " x " << cols;
            }
        }
    }
}

TEST(CausalRecursion, IsAsAccurateAsFloatsSiteBySiteNearAUnitRoot) {
    const std::vector<Taps> models = {
        {{0, 1, 0.97F}},
        {{0, 1, 1.94F}, {0, 2, -0.9409F}},                 // twice
        {{0, 1, 1.2F}, {0, 2, -0.95F}},                    // a pair of complex ones
        {{0, 1, 0.95F}, {1, 0, 0.95F}, {1, 1, -0.9025F}},  // in rows and columns
        {{0, 1, -0.97F}, {0, 3, 0.01F}, {1, 0, 0.01F}}};
    for (const Taps& taps : models) {
        const Drawn drawn = draw(taps, 1, 100, 500);
        EXPECT_LT(largest_error(drawn.field, drawn.exact),
                  2 * largest_error(drawn.naive, drawn.exact))
            << taps.size() << " taps, the first " << taps.front().a;
    }
}

TEST(CausalRecursion, HasTheSameBitsOnEveryTarget) {
    for (const Taps& taps : kModels) {
        const Image expected = draw(taps, 0.7F, 20, 300).field;
        for_each_target([&] {
            const Image got = draw(taps, 0.7F, 20, 300).field;
            ASSERT_TRUE(std::equal(got.values().begin(), got.values().end(),
                                   expected.values().begin()))
                << taps.size() << " taps";
        });
    }
}

TEST(CausalRecursion, RowByRowGivesThePlane) {
    for (const Taps& taps : kModels) {
        const Image e = noise(40, 130);
        Image plane = e;
        ASSERT_TRUE(causal_recursion(taps, 1.5F, plane.plane(0)));
        auto recursion = CausalRecursion::create(taps, 1.5F, 130);
        ASSERT_TRUE(recursion);
        for (std::size_t r = 0; r < 40; ++r) {
            ASSERT_EQ(recursion->noise().size(), 130U);
            std::copy_n(e.plane(0).row(r), 130, recursion->noise().begin());
            const auto row = recursion->next_row();
            ASSERT_TRUE(std::equal(row.begin(), row.end(), plane.plane(0).row(r)));
            ASSERT_EQ(row.size(), 130U);
        }
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

}  // namespace
}  // namespace sateen
