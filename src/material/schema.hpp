// SPDX-License-Identifier: Apache-2.0
// What the writer and the reader of the material file share beyond the schema.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "material_generated.h"

#include "sateen/material/file.hpp"

namespace sateen {

/// Raised when an older reader would misunderstand the file, not when a field is
/// appended.
inline constexpr std::uint16_t kFormatVersion = 1;

/// The payload starts with its own length, so that truncation and extra bytes show.
inline constexpr std::size_t kLengthBytes = sizeof(flatbuffers::uoffset_t);
/// Length, offset of the root table, file identifier.
inline constexpr std::size_t kEnvelopeBytes = 12;

/// Values of Fields.models. A field of one plane has one coefficient an offset and one
/// variance.
enum class ModelTag : std::uint8_t { car2d = 0 };

inline constexpr std::size_t kMaxFields = kMaxSubspaces * kMaxLevels * kMaxBands;

/// Values of Neighbourhoods.orders: an order, or this and the offsets themselves.
inline constexpr std::uint8_t kExplicitOffsets = 0;

}  // namespace sateen
