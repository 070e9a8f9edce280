// SPDX-License-Identifier: Apache-2.0
// The range map of a material in the file.
#pragma once

#include <memory>

#include "material/schema.hpp"
#include "sateen/material/surface.hpp"

namespace sateen {

[[nodiscard]] std::unique_ptr<schema::SurfaceT> pack_surface(const Surface& surface);

/// \error bad_format, limit_exceeded  before memory is taken
[[nodiscard]] Result<Surface> unpack_surface(const schema::Surface& in);

}  // namespace sateen
