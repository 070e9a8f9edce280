// SPDX-License-Identifier: Apache-2.0
// The viewer's page as it was built, and the page with a material inside.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sateen/core/result.hpp"

namespace sateen::cli {

/// share/sateen/viewer.html beside the program's own folder.
/// \error io  the viewer was not built; the message says how to
[[nodiscard]] Result<std::string> viewer_page();

/// The page with a material file in it, which it shows when opened, from a disk as well.
/// \error bad_format  the page has no place for one
[[nodiscard]] Result<std::string> page_with_material(std::string page,
                                                     std::string_view name,
                                                     std::span<const std::uint8_t> file);

}  // namespace sateen::cli
