// SPDX-License-Identifier: Apache-2.0
// Between samples of files and linear planar float: the only place where display encoding
// is applied or undone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sateen/core/image.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::io {

/// Linear value of every 8-bit code; `automatic` is sRGB.
[[nodiscard]] std::span<const float> decode_table8(Encoding encoding);
/// Linear value of every 16-bit code; `automatic` is sRGB.
[[nodiscard]] std::span<const float> decode_table16(Encoding encoding);

/// Decodes `cols` pixels of interleaved codes to row `row` of the planes of `out`; pixels
/// are `channels` apart and the first out.bands() of them are taken.
void decode_row(const std::uint8_t* codes, std::size_t channels,
                std::span<const float> table, std::size_t row, ImageView<float> out);
void decode_row(const std::uint16_t* codes, std::size_t channels,
                std::span<const float> table, std::size_t row, ImageView<float> out);

/// Undoes the encoding of float samples; `automatic` is linear.
void linearise(std::span<float> values, Encoding encoding);
/// Applies it.
void delinearise(std::span<float> values, Encoding encoding);

/// out[i * step] = round(255 encode(clamp(in[i], 0, 1))), correctly rounded; NaN gives 0.
/// `automatic` is sRGB.
void encode_row(const float* in, std::size_t count, std::size_t step, Encoding encoding,
                std::uint8_t* out);
/// The same with 65535.
void encode_row(const float* in, std::size_t count, std::size_t step, Encoding encoding,
                std::uint16_t* out);

}  // namespace sateen::io
