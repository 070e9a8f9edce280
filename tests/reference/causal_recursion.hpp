// SPDX-License-Identifier: Apache-2.0
// The causal recursion site by site, in raster order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sateen/core/image.hpp"
#include "synthesis/causal_recursion.hpp"

namespace sateen::reference {

/// Y_r = σ e_r + Σ a_s Y_{r-s}, summed in raster order of the neighbours; zeros outside.
template <class T>
void causal_recursion(std::span<const CausalTap> unordered, float sigma,
                      PlaneView<T> field) {
    std::vector<CausalTap> taps(unordered.begin(), unordered.end());
    std::sort(taps.begin(), taps.end(), [](const CausalTap& a, const CausalTap& b) {
        return std::pair(a.row, a.col) > std::pair(b.row, b.col);
    });
    const auto at = [&](std::size_t r, std::size_t c, const CausalTap& tap) -> T {
        const auto row = static_cast<std::ptrdiff_t>(r) - tap.row;
        const auto col = static_cast<std::ptrdiff_t>(c) - tap.col;
        if (row < 0 || col < 0 || col >= static_cast<std::ptrdiff_t>(field.cols))
            return 0;
        return field(static_cast<std::size_t>(row), static_cast<std::size_t>(col));
    };
    for (std::size_t r = 0; r < field.rows; ++r) {
        for (std::size_t c = 0; c < field.cols; ++c) {
            T sum = static_cast<T>(sigma) * field(r, c);
            for (const CausalTap& tap : taps)
                sum += static_cast<T>(tap.a) * at(r, c, tap);
            field(r, c) = sum;
        }
    }
}

}  // namespace sateen::reference
