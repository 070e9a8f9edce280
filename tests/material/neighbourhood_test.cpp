// SPDX-License-Identifier: Apache-2.0
#include "sateen/material/neighbourhood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

namespace sateen {
namespace {

int squared_length(Offset s) {
    return s.row * s.row + s.col * s.col;
}

TEST(Neighbourhood, HierarchicalOrdersHaveTheSizesOfThePaper) {
    constexpr std::array<std::size_t, kMaxOrder> kSizes = {2,  4,  6,  10, 12, 14, 18,
                                                           22, 24, 28, 30, 34, 40};
    for (int order = 1; order <= kMaxOrder; ++order)
        EXPECT_EQ(hierarchical_half_plane(order).size(),
                  kSizes[static_cast<std::size_t>(order - 1)])
            << "order " << order;
}

TEST(Neighbourhood, HierarchicalOrdersAreEverySiteOfTheHalfPlaneWithinTheirDistance) {
    for (int order = 1; order <= kMaxOrder; ++order) {
        const auto offsets = hierarchical_half_plane(order);
        const int furthest = squared_length(offsets.back());
        std::set<Offset> expected;
        for (int row = -kMaxReach; row <= kMaxReach; ++row)
            for (int col = -kMaxReach; col <= kMaxReach; ++col) {
                const Offset s{static_cast<std::int8_t>(row),
                               static_cast<std::int8_t>(col)};
                if (is_causal(s) && squared_length(s) <= furthest) expected.insert(s);
            }
        EXPECT_EQ(std::set<Offset>(offsets.begin(), offsets.end()), expected);
        EXPECT_EQ(offsets.size(), expected.size());
        EXPECT_TRUE(std::ranges::is_sorted(offsets, {}, squared_length));
    }
}

TEST(Neighbourhood, ExactlyOneOfAnOffsetAndItsMirrorImageIsCausal) {
    for (int row = -3; row <= 3; ++row)
        for (int col = -3; col <= 3; ++col) {
            if (row == 0 && col == 0) continue;
            const Offset s{static_cast<std::int8_t>(row), static_cast<std::int8_t>(col)};
            const Offset mirrored{static_cast<std::int8_t>(-row),
                                  static_cast<std::int8_t>(-col)};
            EXPECT_NE(is_causal(s), is_causal(mirrored));
        }
    EXPECT_FALSE(is_causal({0, 0}));
}

}  // namespace
}  // namespace sateen
