// SPDX-License-Identifier: Apache-2.0
// Material files on disk: the payload of material/file.hpp wrapped whole in gzip.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// gzip of a payload, header time 0: equal materials give equal bytes with the same zlib.
[[nodiscard]] Result<std::vector<std::uint8_t>> pack_material(const Material& material);
/// \error bad_format      not gzip, truncated, trailing bytes, not a material
/// \error limit_exceeded  unpacks to more than kMaxPayloadBytes
[[nodiscard]] Result<Material> unpack_material(std::span<const std::uint8_t> file);

/// \returns the size of the file in bytes
[[nodiscard]] Result<std::size_t> save_material(const std::string& path,
                                                const Material& material);
[[nodiscard]] Result<Material> load_material(const std::string& path);

}  // namespace sateen
