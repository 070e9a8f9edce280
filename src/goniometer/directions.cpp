// SPDX-License-Identifier: Apache-2.0
// Rings of directions. See directions.hpp.
#include "sateen/goniometer/directions.hpp"

#include <span>

namespace sateen {
namespace {

struct Ring {
    int theta_deg;
    int count;
};

std::vector<Direction> rings(std::span<const Ring> rings) {
    std::vector<Direction> directions;
    for (const Ring& ring : rings)
        for (int i = 0; i < ring.count; ++i)
            directions.push_back(
                direction_from_degrees(static_cast<float>(ring.theta_deg),
                                       static_cast<float>(360 * i / ring.count)));
    return directions;
}

}  // namespace

std::vector<Direction> ubo2003_directions() {
    constexpr Ring kRings[] = {{0, 1}, {15, 6}, {30, 12}, {45, 18}, {60, 20}, {75, 24}};
    return rings(kRings);
}

std::vector<Direction> coarse_directions() {
    constexpr Ring kRings[] = {{0, 1}, {30, 12}, {60, 12}};
    return rings(kRings);
}

}  // namespace sateen
