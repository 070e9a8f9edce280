// SPDX-License-Identifier: Apache-2.0
#include "core/fft_plan.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "sateen/core/fft.hpp"

namespace sateen {

bool is_fft_size(std::size_t n) {
    if (n == 0) return false;
    for (const std::size_t prime : {2U, 3U, 5U}) {
        while (n % prime == 0) n /= prime;
    }
    return n == 1;
}

std::size_t fft_size_at_most(std::size_t n, std::size_t multiple_of) {
    assert(is_fft_size(multiple_of));
    for (std::size_t m = n / multiple_of; m > 0; --m) {
        if (is_fft_size(m)) return m * multiple_of;
    }
    return 0;
}

std::size_t fft_size_at_least(std::size_t n, std::size_t multiple_of) {
    assert(is_fft_size(multiple_of));
    std::size_t m = n > multiple_of ? (n + multiple_of - 1) / multiple_of : 1;
    while (!is_fft_size(m)) ++m;
    return m * multiple_of;
}

}  // namespace sateen

namespace sateen::detail {
namespace {

std::vector<std::size_t> radices_of(std::size_t n) {
    std::vector<std::size_t> radices;
    for (const std::size_t radix : {8U, 4U, 2U, 5U, 3U}) {
        // 16 = 4 · 4 costs less than 8 · 2.
        while (n % radix == 0 && !(radix == 8 && n % 32 == 16)) {
            radices.push_back(radix);
            n /= radix;
        }
    }
    return radices;
}

}  // namespace

FftPlan1d::FftPlan1d(std::size_t n) : size(n) {
    assert(is_fft_size(n));
    std::size_t groups = n;
    std::size_t stride = 1;
    for (const std::size_t radix : radices_of(n)) {
        groups /= radix;
        passes.push_back({radix, groups, stride, twiddles.size()});
        const double step = -2 * std::numbers::pi / static_cast<double>(radix * groups);
        for (std::size_t p = 1; p < groups; ++p) {
            for (std::size_t k = 1; k < radix; ++k) {
                const double angle = step * static_cast<double>(p * k);
                twiddles.push_back(static_cast<float>(std::cos(angle)));
                twiddles.push_back(static_cast<float>(std::sin(angle)));
            }
        }
        stride *= radix;
    }
}

}  // namespace sateen::detail
