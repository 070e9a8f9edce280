// SPDX-License-Identifier: Apache-2.0
// The structure of a material in the file and its limits.
#pragma once

#include <memory>

#include "material/schema.hpp"

namespace sateen {

/// \param material  valid, with a structure
[[nodiscard]] std::unique_ptr<schema::StructureT> pack_structure(
    const Material& material);

/// Fills the structure of a material whose subspaces have been read.
/// \error bad_format, limit_exceeded
[[nodiscard]] Result<void> unpack_structure(const schema::Structure& in, Material& out);

/// The part of validate() for structures. \error bad_format
[[nodiscard]] Result<void> validate_structure(const Material& material);

}  // namespace sateen
