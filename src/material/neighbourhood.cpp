// SPDX-License-Identifier: Apache-2.0
// Hierarchical half-plane neighbourhoods. See neighbourhood.hpp.
#include "sateen/material/neighbourhood.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace sateen {
namespace {

// Squared distances at which the integer lattice has sites, one for each order.
constexpr std::array<int, kMaxOrder> kSquaredDistances = {1,  2,  4,  5,  8,  9, 10,
                                                          13, 16, 17, 18, 20, 25};

}  // namespace

std::vector<Offset> hierarchical_half_plane(int order) {
    assert(order >= 1 && order <= kMaxOrder);
    const int furthest = kSquaredDistances[static_cast<std::size_t>(order - 1)];
    std::vector<Offset> offsets;
    for (int row = 0; row * row <= furthest; ++row)
        for (int col = -kMaxReach; col <= kMaxReach; ++col) {
            const Offset s{static_cast<std::int8_t>(row), static_cast<std::int8_t>(col)};
            if (is_causal(s) && row * row + col * col <= furthest) offsets.push_back(s);
        }
    std::stable_sort(offsets.begin(), offsets.end(), [](Offset a, Offset b) {
        return a.row * a.row + a.col * a.col < b.row * b.row + b.col * b.col;
    });
    return offsets;
}

}  // namespace sateen
