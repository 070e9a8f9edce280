// SPDX-License-Identifier: Apache-2.0
// Lists of directions that measurements use.
#pragma once

#include <vector>

#include "sateen/core/direction.hpp"

namespace sateen {

/// The 81 directions of UBO2003, for views and for lights, in the order that its file
/// names count: rings of 1, 6, 12, 18, 20 and 24 at theta 0, 15, 30, 45, 60 and 75
/// degrees, each beginning at phi 0.
[[nodiscard]] std::vector<Direction> ubo2003_directions();

/// 25 directions for quick measurements: 1, 12 and 12 at theta 0, 30 and 60 degrees.
[[nodiscard]] std::vector<Direction> coarse_directions();

}  // namespace sateen
