// SPDX-License-Identifier: Apache-2.0
// The order of the stored frequencies of a cell. See structure.hpp.
#include "sateen/material/structure.hpp"

#include <algorithm>
#include <tuple>

namespace sateen {

std::vector<Harmonic> half_plane_order(std::size_t rows, std::size_t cols) {
    const int P = static_cast<int>(rows);
    const int Q = static_cast<int>(cols);
    std::vector<Harmonic> order;
    for (int m = -((P - 1) / 2); m <= (P - 1) / 2; ++m)
        for (int n = 0; n <= (Q - 1) / 2; ++n)
            if (n > 0 || m >= 0) order.push_back({m, n});
    // (m/P)² + (n/Q)², times (P Q)²: whole numbers, so that the order is the same anywhere.
    const auto radius = [&](const Harmonic& h) {
        return h.m * h.m * Q * Q + h.n * h.n * P * P;
    };
    std::sort(order.begin(), order.end(), [&](const Harmonic& x, const Harmonic& y) {
        return std::make_tuple(radius(x), x.m, x.n) <
               std::make_tuple(radius(y), y.m, y.n);
    });
    return order;
}

}  // namespace sateen
