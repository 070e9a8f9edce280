// SPDX-License-Identifier: Apache-2.0
// The reflectance of a material in the file and its limits.
#pragma once

#include <memory>

#include "material/schema.hpp"

namespace sateen {

/// \param material  valid, with a reflectance
[[nodiscard]] std::unique_ptr<schema::ReflectanceT> pack_reflectance(
    const Material& material);

/// Fills the reflectance of a material whose directions have been read.
/// \error bad_format, limit_exceeded
[[nodiscard]] Result<void> unpack_reflectance(const schema::Reflectance& in,
                                              Material& out);

/// The part of validate() for reflectances. \error bad_format
[[nodiscard]] Result<void> validate_reflectance(const Material& material);

}  // namespace sateen
