// SPDX-License-Identifier: Apache-2.0
// What the writer and the reader of the material file share beyond the schema.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <variant>
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

/// Values of Fields.models: the numbers of the alternatives of FieldModel. A field of one
/// plane has one coefficient an offset and one variance; a field of d planes has d² an
/// offset and the lower triangle of Σ.
inline constexpr const char* kKnownModels = "0 (car2d), 1 (gmrf2d), 2 (car3d), 3 (sar3d)";
static_assert(std::is_same_v<FieldModel, std::variant<Car2d, Gmrf2d, Car3d, Sar3d>>,
              "the order of the models is part of the format");

inline constexpr std::size_t kMaxFields = kMaxSubspaces * kMaxLevels * kMaxBands;

/// Values of Neighbourhoods.orders: an order, or this and the offsets themselves.
inline constexpr std::uint8_t kExplicitOffsets = 0;

}  // namespace sateen
