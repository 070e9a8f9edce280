// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/neighbourhood.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/stationary_field.hpp"
#include "support/fields.hpp"

namespace sateen {
namespace {

using testing::UnorderedElementsAre;

TEST(ReachOf, BoundsEveryOffsetOfTheRule) {
    EXPECT_EQ(reach_of({NeighbourhoodRule::order, 1}), 1);
    EXPECT_EQ(reach_of({NeighbourhoodRule::order, 2}), 1);
    EXPECT_EQ(reach_of({NeighbourhoodRule::evidence, 6}), 3);
    EXPECT_EQ(reach_of({NeighbourhoodRule::order, 13}), 5);
    EXPECT_EQ(reach_of({NeighbourhoodRule::nearest, 3}), 1);
    for (const int count : {1, 60}) {
        Autocovariance R(20, 1e6);
        R.at(0, 0) = 1;
        const NeighbourhoodOptions options{NeighbourhoodRule::correlation, count};
        const auto offsets = select_neighbourhood(R, options);
        ASSERT_TRUE(offsets);
        EXPECT_EQ(offsets->size(), static_cast<std::size_t>(count));
        for (const Offset s : *offsets) {
            EXPECT_TRUE(is_causal(s));
            EXPECT_LE(std::max<int>(s.row, std::abs(s.col)), reach_of(options));
        }
    }
}

TEST(SelectByCorrelation, FindsPlantedLagsOfEitherSign) {
    Autocovariance R(5, 10000);
    R.at(0, 0) = 1;
    R.at(0, 4) = -0.9;
    R.at(3, -2) = 0.8;
    R.at(2, 2) = 0.7;
    R.at(0, -3) = 0.95;  // not causal, its mirror image is counted once, at (0, 3)
    R.at(0, 3) = 0.95;
    R.at(5, 0) = 0.99;  // beyond the reach given
    EXPECT_THAT(
        select_by_correlation(R, 4, 4),
        UnorderedElementsAre(Offset{0, 4}, Offset{3, -2}, Offset{2, 2}, Offset{0, 3}));
    EXPECT_EQ(select_by_correlation(R, 1, 5), std::vector{(Offset{5, 0})});
    EXPECT_EQ(select_by_correlation(R, 1000, 2).size(), 12U);
}

// Evidence is consistent, so a clear field of order k is found but for rare overfitting.
TEST(SelectByEvidence, FindsThePlantedOrderOfMostFields) {
    const Car2d order_1{{{0, 1}, {1, 0}}, {0.4F, 0.4F}, 1};
    const Car2d order_2 = test::half_plane_field();
    Car2d order_4{hierarchical_half_plane(4), std::vector<float>(10, 0.0F), 1};
    order_4.a = {0.3F, 0.2F, 0.05F, -0.1F, 0.1F, 0.05F, 0.1F, 0.15F, -0.15F, 0.1F};
    struct Planted {
        Car2d field;
        std::size_t offsets;
    };
    for (const Planted& planted :
         {Planted{order_1, 2}, Planted{order_2, 4}, Planted{order_4, 10}}) {
        int found = 0;
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const auto R = test::direct_autocovariance(
                reference::toroidal_field(planted.field, 64, 60, seed), 6);
            const auto offsets = select_by_evidence(R, 6);
            ASSERT_TRUE(offsets);
            found += offsets->size() == planted.offsets ? 1 : 0;
        }
        EXPECT_GE(found, 9) << planted.offsets;
    }
}

TEST(SelectNeighbourhood, KeepsEightSitesForEveryCoefficient) {
    Autocovariance R(10, 8 * 10);
    R.at(0, 0) = 1;
    EXPECT_EQ(select_neighbourhood(R, {NeighbourhoodRule::order, 6})->size(), 10U);
    EXPECT_EQ(select_neighbourhood(R, {NeighbourhoodRule::correlation, 50})->size(), 10U);
    Autocovariance tiny(10, 1);
    tiny.at(0, 0) = 1;
    EXPECT_EQ(select_neighbourhood(tiny, {NeighbourhoodRule::order, 6})->size(), 2U);
    EXPECT_EQ(select_neighbourhood(tiny, {NeighbourhoodRule::evidence, 6})->size(), 2U);
    EXPECT_EQ(select_neighbourhood(tiny, {NeighbourhoodRule::nearest, 3})->size(), 1U);
}

TEST(SelectNeighbourhood, NearestAreThoseOfThePapers) {
    const Autocovariance R(2, 1000);
    EXPECT_EQ(*select_neighbourhood(R, {NeighbourhoodRule::nearest, 3}),
              (std::vector<Offset>{{0, 1}, {1, 0}, {1, 1}}));
}

TEST(ParseNeighbourhood, ReadsEveryRuleAndWritesItBack) {
    for (const char* text : {"order:1", "order:13", "correlation:14", "correlation:60",
                             "evidence:10", "nearest:2"}) {
        const auto options = parse_neighbourhood(text);
        ASSERT_TRUE(options) << text;
        EXPECT_EQ(to_string(*options), text);
    }
    EXPECT_EQ(to_string(*parse_neighbourhood("auto")), to_string(NeighbourhoodOptions{}));
}

// A rib of period 6 (a_s at (0,6)) beside a weak neighbour: nothing else pays for itself.
TEST(SelectForward, FindsALongPeriodAndStops) {
    const Car2d ribs{{{0, 6}, {1, 0}}, {0.6F, 0.3F}, 1};
    const auto exact =
        reference::autocovariance_of_density(reference::density_on_torus(ribs, 96, 96));
    Autocovariance R(2 * kMaxReach, 10000);
    for (int row = 0; row <= R.reach(); ++row)
        for (int col = -R.reach(); col <= R.reach(); ++col)
            R.at(row, col) = exact(static_cast<std::size_t>(row),
                                   static_cast<std::size_t>((col + 96) % 96));
    EXPECT_THAT(select_forward(R, 20, kMaxReach),
                UnorderedElementsAre(Offset{0, 6}, Offset{1, 0}));
    EXPECT_EQ(select_forward(R, 1, kMaxReach), std::vector{(Offset{0, 6})});
}

TEST(ParseNeighbourhood, SaysWhatCanBeGiven) {
    const auto wrong = parse_neighbourhood("order:14");
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().code, Errc::invalid_argument);
    EXPECT_THAT(wrong.error().message,
                testing::StartsWith("neighbourhood \"order:14\" is not one of auto, "
                                    "order:N with N from 1 to 13, correlation:N with N "
                                    "from 1 to 60, evidence:N with N from 1 to 13"));
    for (const char* text :
         {"", "order", "order:", ":3", "order:0", "order:-1", "order:3x", "order: 3",
          "order:99999999999", "nearest:4", "correlation:61", "Order:3", "auto:3"})
        EXPECT_FALSE(parse_neighbourhood(text)) << text;
}

}  // namespace
}  // namespace sateen
