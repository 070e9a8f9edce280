// SPDX-License-Identifier: Apache-2.0
// Sets of directions that measurements have.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "sateen/core/direction.hpp"

namespace sateen::test {

/// The 81 directions of UBO2003, ring by ring.
inline std::vector<Direction> ubo2003_directions() {
    constexpr std::array<std::pair<int, int>, 6> kRings = {
        {{0, 1}, {15, 6}, {30, 12}, {45, 18}, {60, 20}, {75, 24}}};
    std::vector<Direction> out;
    for (const auto& [theta, count] : kRings)
        for (int i = 0; i < count; ++i)
            out.push_back(direction_from_degrees(
                static_cast<float>(theta),
                360.0F / static_cast<float>(count) * static_cast<float>(i)));
    return out;
}

}  // namespace sateen::test
