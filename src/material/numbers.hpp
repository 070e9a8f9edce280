// SPDX-License-Identifier: Apache-2.0
// Checks of single numbers, for validate().
#pragma once

#include <span>
#include <string_view>

#include "material/message.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

[[nodiscard]] inline Result<void> check_range(std::string_view what, float value,
                                              float low, float high) {
    if (value >= low && value <= high) return {};  // false for NaN
    return bad_format(what, ": ", text(value), ", expected ", text(low), " to ",
                      text(high));
}

[[nodiscard]] inline Result<void> check_numbers(std::string_view what,
                                                std::span<const float> values) {
    for (const float value : values)
        SATEEN_CHECK(check_range(what, value, -kMaxMagnitude, kMaxMagnitude));
    return {};
}

}  // namespace sateen
