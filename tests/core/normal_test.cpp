// SPDX-License-Identifier: Apache-2.0
// Fixed seeds throughout. Statistical limits are 4.5 standard errors (two-sided
// significance 7e-6 a comparison) unless said.
#include "sateen/core/normal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "reference/normal.hpp"

#if __has_include(<Random123/philox.h>)
#include <Random123/philox.h>
#define SATEEN_HAVE_RANDOM123
#endif

namespace sateen {
namespace {

constexpr double kStandardErrors = 4.5;

using Counter = std::array<std::uint32_t, 4>;
using Key = std::array<std::uint32_t, 2>;

std::vector<float> draw(NoiseField field, std::int32_t row, std::int32_t col,
                        std::size_t count) {
    std::vector<float> values(count, std::numeric_limits<float>::quiet_NaN());
    draw_normals(field, row, col, values);
    return values;
}

// Rows of 1024 columns, one after the other.
std::vector<float> draw_plane(NoiseField field, std::int32_t rows) {
    constexpr std::size_t kCols = 1024;
    std::vector<float> values(static_cast<std::size_t>(rows) * kCols);
    for (std::int32_t r = 0; r < rows; ++r) {
        draw_normals(
            field, r, 0,
            std::span(values).subspan(static_cast<std::size_t>(r) * kCols, kCols));
    }
    return values;
}

double normal_cdf(double x) {
    return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

double mean_product(std::span<const float> a, std::span<const float> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    return sum / static_cast<double>(a.size());
}

std::vector<float> squares_less_one(std::span<const float> values) {
    std::vector<float> out(values.size());
    std::transform(values.begin(), values.end(), out.begin(),
                   [](float x) { return x * x - 1.0F; });
    return out;
}

// Runs a check on every target that was compiled and that this machine has.
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

TEST(Philox, GivesTheKnownAnswersOfRandom123) {
    EXPECT_EQ(philox4x32_10(Counter{0, 0, 0, 0}, Key{0, 0}),
              (Counter{0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8}));
    constexpr std::uint32_t kOnes = 0xFFFFFFFF;
    EXPECT_EQ(philox4x32_10(Counter{kOnes, kOnes, kOnes, kOnes}, Key{kOnes, kOnes}),
              (Counter{0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD}));
    EXPECT_EQ(philox4x32_10(Counter{0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344},
                            Key{0xA4093822, 0x299F31D0}),
              (Counter{0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1}));
}

TEST(Philox, EqualsRandom123OnManyCounters) {
#ifdef SATEEN_HAVE_RANDOM123
    Counter counter = {1, 2, 3, 4};
    Key key = {5, 6};
    for (int i = 0; i < 1000; ++i) {
        const philox4x32_ctr_t c = {{counter[0], counter[1], counter[2], counter[3]}};
        const philox4x32_key_t k = {{key[0], key[1]}};
        const philox4x32_ctr_t expected = philox4x32_R(10, c, k);
        counter = philox4x32_10(counter, key);
        ASSERT_THAT(counter, testing::ElementsAreArray(expected.v));
        key = {counter[1] ^ 7U, counter[3]};
    }
#else
    GTEST_SKIP() << "Random123 is not installed";
#endif
}

TEST(Normal, HasTheBitsOfTheReferenceOnEveryTarget) {
    for_each_target([] {
        for (const NoiseField field :
             {NoiseField{0, 0}, NoiseField{0x0123456789ABCDEF, 7}}) {
            for (const std::int32_t row :
                 {0, -1, 12345, std::numeric_limits<int>::min()}) {
                const auto values = draw(field, row, -300, 700);
                for (std::size_t i = 0; i < values.size(); ++i) {
                    const std::int32_t col = static_cast<std::int32_t>(i) - 300;
                    ASSERT_EQ(
                        std::bit_cast<std::uint32_t>(values[i]),
                        std::bit_cast<std::uint32_t>(reference::normal(field, row, col)))
                        << "row " << row << " column " << col;
                }
            }
        }
    });
}

TEST(Normal, DoesNotDependOnWhereAPieceStartsOrEnds) {
    const NoiseField field{3, 1};
    constexpr std::int32_t kStart = -100;
    const auto row = draw(field, 5, kStart, 400);
    for_each_target([&] {
        for (const std::int32_t col :
             {-100, -99, -65, -3, -2, -1, 0, 1, 2, 3, 4, 63, 64, 65}) {
            for (const std::size_t count :
                 {0U, 1U, 2U, 3U, 4U, 5U, 31U, 64U, 67U, 130U, 191U}) {
                const auto piece = draw(field, 5, col, count);
                const auto expected =
                    std::span(row).subspan(static_cast<std::size_t>(col - kStart), count);
                ASSERT_THAT(piece,
                            testing::ElementsAreArray(expected.begin(), expected.end()))
                    << "column " << col << " count " << count;
            }
        }
    });
}

TEST(Normal, WritesNothingOutsideItsSpan) {
    for_each_target([] {
        for (std::size_t count = 0; count < 140; ++count) {
            std::vector<float> guarded(count + 2, 42.0F);
            draw_normals({1, 2}, 3, -7, std::span(guarded).subspan(1, count));
            ASSERT_EQ(guarded.front(), 42.0F);
            ASSERT_EQ(guarded.back(), 42.0F);
        }
    });
}

TEST(Normal, ReachesTheEndsOfTheLattice) {
    constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
    constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
    const auto left = draw({0, 0}, kMin, kMin, 9);
    const auto right = draw({0, 0}, kMax, kMax - 8, 9);
    for (std::int32_t i = 0; i < 9; ++i) {
        const auto at = static_cast<std::size_t>(i);
        EXPECT_EQ(left[at], reference::normal({0, 0}, kMin, kMin + i));
        EXPECT_EQ(right[at], reference::normal({0, 0}, kMax, kMax - 8 + i));
    }
}

// The words of all sizes: the ends, every power of two and its neighbours, and a stride.
std::vector<std::uint32_t> telling_words() {
    std::vector<std::uint32_t> words;
    for (int bit = 0; bit < 32; ++bit) {
        for (std::uint32_t offset = 0; offset < 5; ++offset) {
            words.push_back((1U << bit) + offset - 2U);
        }
    }
    for (std::uint64_t w = 0; w < std::uint64_t{1} << 32; w += 9973) {
        words.push_back(static_cast<std::uint32_t>(w));
    }
    return words;
}

TEST(Normal, RadiusIsAccurateAndNeverInfinite) {
    for (const std::uint32_t w : telling_words()) {
        const double exact = reference::exact_radius(w);
        // u rounds to 24 bits, which moves -2 ln u by up to 2^-24.
        const double allowed = 3e-7 * exact + (exact > 1e-3 ? 0x1p-24 / exact : 3.5e-4);
        ASSERT_NEAR(static_cast<double>(reference::radius(w)), exact, allowed) << w;
    }
    EXPECT_NEAR(static_cast<double>(reference::radius(0)), 6.6604, 1e-4);
    EXPECT_EQ(reference::radius(0xFFFFFFFF), 0.0F);
}

TEST(Normal, CosineAndSineAreAccurate) {
    for (const std::uint32_t w : telling_words()) {
        const auto exact = reference::exact_cos_sin(w);
        const auto got = reference::cos_sin(w);
        ASSERT_NEAR(static_cast<double>(got[0]), exact[0], 1.8e-7) << w;
        ASSERT_NEAR(static_cast<double>(got[1]), exact[1], 1.8e-7) << w;
    }
}

TEST(Normal, HasTheMomentsOfTheNormalDistribution) {
    const auto values = draw_plane({11, 0}, 1024);
    const auto n = static_cast<double>(values.size());
    std::array<double, 7> moment{};
    for (const float value : values) {
        double power = 1;
        for (double& m : moment) {
            m += power;
            power *= static_cast<double>(value);
        }
    }
    for (double& m : moment) m /= n;
    // Var x^k = E x^2k - (E x^k)²: 1, 2, 15, 96, 945, 10170.
    EXPECT_NEAR(moment[1], 0, kStandardErrors * std::sqrt(1 / n));
    EXPECT_NEAR(moment[2], 1, kStandardErrors * std::sqrt(2 / n));
    EXPECT_NEAR(moment[3], 0, kStandardErrors * std::sqrt(15 / n));
    EXPECT_NEAR(moment[4], 3, kStandardErrors * std::sqrt(96 / n));
    EXPECT_NEAR(moment[5], 0, kStandardErrors * std::sqrt(945 / n));
    EXPECT_NEAR(moment[6], 15, kStandardErrors * std::sqrt(10170 / n));
}

TEST(Normal, PassesKolmogorovSmirnov) {
    // √n D > 2.23 has probability 1e-4 under the null hypothesis.
    for (const std::uint64_t seed : {0U, 1U, 2U, 3U}) {
        auto values = draw_plane({seed, 0}, 256);
        std::sort(values.begin(), values.end());
        const auto n = static_cast<double>(values.size());
        double distance = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double cdf = normal_cdf(static_cast<double>(values[i]));
            distance = std::max({distance, cdf - static_cast<double>(i) / n,
                                 static_cast<double>(i + 1) / n - cdf});
        }
        EXPECT_LT(std::sqrt(n) * distance, 2.23) << "seed " << seed;
    }
}

TEST(Normal, HasTheTailsOfTheNormalDistribution) {
    const auto values = draw_plane({5, 0}, 4096);
    const auto n = static_cast<double>(values.size());
    for (const double x : {2.0, 3.0, 4.0, 4.5}) {
        const auto count = [&](auto beyond) {
            return static_cast<double>(
                std::count_if(values.begin(), values.end(), beyond));
        };
        const double expected = n * normal_cdf(-x);
        const double allowed = kStandardErrors * std::sqrt(expected);
        EXPECT_NEAR(count([x](float v) { return static_cast<double>(v) > x; }), expected,
                    allowed)
            << x;
        EXPECT_NEAR(count([x](float v) { return static_cast<double>(v) < -x; }), expected,
                    allowed)
            << x;
    }
    EXPECT_LT(*std::max_element(values.begin(), values.end()), 6.67F);
    EXPECT_GT(*std::min_element(values.begin(), values.end()), -6.67F);
}

TEST(Normal, IsWhiteOverRowsColumnsBandsAndSeeds) {
    constexpr std::int32_t kSize = 512;
    constexpr std::size_t kCount = std::size_t{kSize} * kSize;
    const auto window = [](NoiseField field, std::int32_t row, std::int32_t col) {
        std::vector<float> values(kCount);
        for (std::int32_t r = 0; r < kSize; ++r) {
            draw_normals(
                field, row + r, col,
                std::span(values).subspan(static_cast<std::size_t>(r) * kSize, kSize));
        }
        return values;
    };
    const auto origin = window({0, 0}, 0, 0);
    const auto origin_energy = squares_less_one(origin);
    const double limit = kStandardErrors / std::sqrt(static_cast<double>(kCount));
    struct Shift {
        std::uint64_t seed;
        std::uint32_t band;
        std::int32_t row;
        std::int32_t col;
    };
    std::vector<Shift> shifts;
    for (std::int32_t lag = 1; lag <= 8; ++lag) {
        shifts.push_back({0, 0, 0, lag});
        shifts.push_back({0, 0, lag, 0});
        shifts.push_back({0, 0, lag, -lag});
    }
    shifts.insert(shifts.end(), {{0, 0, -1, 4},
                                 {0, 0, 0, 1 << 20},
                                 {0, 1, 0, 0},
                                 {0, 2, 0, 0},
                                 {0, 1U << 31, 0, 0},
                                 {1, 0, 0, 0},
                                 {2, 0, 0, 0},
                                 {std::uint64_t{1} << 32, 0, 0, 0},
                                 {1, 1, 1, 1}});
    for (const Shift& s : shifts) {
        const auto other = window({s.seed, s.band}, s.row, s.col);
        EXPECT_NEAR(mean_product(origin, other), 0, limit)
            << s.seed << ' ' << s.band << ' ' << s.row << ' ' << s.col;
        // Energies too: a pair of Box-Muller is uncorrelated even if its radii are not
        // random.
        EXPECT_NEAR(mean_product(origin_energy, squares_less_one(other)), 0, 2 * limit)
            << s.seed << ' ' << s.band << ' ' << s.row << ' ' << s.col;
    }
}

TEST(Normal, PairsAreJointlyNormal) {
    // (r cos θ, r sin θ): the angle is uniform over 64 sectors, also given the radius. χ²
    // with 63 degrees of freedom exceeds 121.1 with probability 1.6e-5.
    const auto values = draw_plane({21, 4}, 512);
    std::array<std::array<double, 64>, 2> sectors{};
    std::array<double, 2> totals{};
    for (std::size_t i = 0; i < values.size(); i += 2) {
        const auto x = static_cast<double>(values[i]);
        const auto y = static_cast<double>(values[i + 1]);
        const double turn = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
        const std::size_t ring = x * x + y * y < 2 * std::numbers::ln2 ? 0 : 1;
        sectors[ring][std::min<std::size_t>(63, static_cast<std::size_t>(turn * 64))] +=
            1;
        totals[ring] += 1;
    }
    const auto pairs = static_cast<double>(values.size()) / 2;
    EXPECT_NEAR(totals[0], pairs / 2, kStandardErrors * std::sqrt(pairs) / 2);
    for (std::size_t ring = 0; ring < 2; ++ring) {
        double chi2 = 0;
        for (const double count : sectors[ring]) {
            const double expected = totals[ring] / 64;
            chi2 += (count - expected) * (count - expected) / expected;
        }
        EXPECT_LT(chi2, 121.1) << "ring " << ring;
    }
}

}  // namespace
}  // namespace sateen
