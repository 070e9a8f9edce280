// SPDX-License-Identifier: Apache-2.0
// The band modulation of a material in the file and its limits.
#pragma once

#include <memory>

#include "material/schema.hpp"

namespace sateen {

/// \param material  valid, with a modulation
[[nodiscard]] std::unique_ptr<schema::ModulationT> pack_modulation(
    const Material& material);

/// Fills the modulation of a material whose subspaces have been read.
/// \error bad_format
[[nodiscard]] Result<void> unpack_modulation(const schema::Modulation& in, Material& out);

/// The part of validate() for modulations. \error bad_format
[[nodiscard]] Result<void> validate_modulation(const Material& material);

}  // namespace sateen
