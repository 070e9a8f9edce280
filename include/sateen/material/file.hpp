// SPDX-License-Identifier: Apache-2.0
// The material file on bytes; docs/format.md is normative. The gzip wrapping is in io, in
// the browser or in Python.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// Payloads larger than this are refused, unread.
inline constexpr std::size_t kMaxPayloadBytes = std::size_t{16} << 20U;

/// Encodes a material. Coefficients, knots and directions are quantised: reading back
/// gives the quantised material, and writing that again the same bytes. \error bad_format
/// the material is not valid
[[nodiscard]] Result<std::vector<std::uint8_t>> write_material(const Material& material);

/// Decodes and checks a payload. Memory stays below 64 MB for any input.
/// \error bad_format, limit_exceeded, unsupported (a later version)
[[nodiscard]] Result<Material> read_material(std::span<const std::uint8_t> payload);

/// How many payload bytes each part takes, for `sateen info`.
struct PartBytes {
    std::string part;
    std::size_t bytes = 0;
};
[[nodiscard]] Result<std::vector<PartBytes>> material_part_bytes(
    const Material& material);

}  // namespace sateen
