// SPDX-License-Identifier: Apache-2.0
// Deflate (RFC 1951) with Huffman codes and runs, without the search for earlier matches:
// on the filtered rows of a texture, whose noise hardly repeats, that search takes most
// of the time and saves a few per cent.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sateen::io {

/// Appends `bytes` as one block with codes of its own, then an empty stored block that
/// ends on a byte boundary; neither is marked as the last of the stream. \cost  about ten
/// operations a byte
void append_huffman_deflate(std::span<const std::uint8_t> bytes,
                            std::vector<std::uint8_t>& out);

}  // namespace sateen::io
