// SPDX-License-Identifier: Apache-2.0
// Animated PNG (APNG, PNG third edition): one file of many pictures.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "sateen/core/result.hpp"

namespace sateen {

/// Joins PNG files of one size and sample type, played in turn, for ever. The first is what
/// programs show that know no animation. One frame is held in memory at a time.
/// \param milliseconds  of each frame
/// \error invalid_argument  no frames;  bad_format  a file that is no PNG, or whose header
///        differs from the first's;  io
[[nodiscard]] Result<void> join_png_frames(const std::string& path,
                                           std::span<const std::string> frames,
                                           std::uint16_t milliseconds);

}  // namespace sateen
