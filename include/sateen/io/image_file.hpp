// SPDX-License-Identifier: Apache-2.0
// Image files: JPEG, PNG 8 and 16 bit, OpenEXR, TIFF, Radiance HDR (reading only); by
// content on reading, by extension on writing. In memory linear planar float; display
// encoding happens here and nowhere else.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// How integer or float samples of a file map to linear values.
enum class Encoding {
    automatic,  ///< integer samples sRGB, float samples linear
    srgb,
    gamma22,
    linear,
};

/// Decodes an image from bytes; `name` is used in messages. Alpha is dropped; the result
/// has 1 or 3 bands.
/// \error bad_format      truncated or damaged data (never a partly decoded image)
/// \error unsupported     a format or sample type that is not read here
/// \error limit_exceeded  more than 2^15 pixels a side or 2^29 in all
[[nodiscard]] Result<Image> decode_image(std::span<const std::uint8_t> bytes,
                                         std::string_view name,
                                         Encoding encoding = Encoding::automatic);
[[nodiscard]] Result<Image> read_image(const std::string& path,
                                       Encoding encoding = Encoding::automatic);

/// Size and sample type, from the header alone.
struct ImageHeader {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::size_t bands = 0;
    int bits = 8;  ///< a sample
    bool floating_point = false;
    std::string format;  ///< "JPEG", "PNG", "OpenEXR", "TIFF", "Radiance"
};
[[nodiscard]] Result<ImageHeader> read_image_header(const std::string& path);
[[nodiscard]] Result<ImageHeader> decode_image_header(std::span<const std::uint8_t> bytes,
                                                      std::string_view name);

struct WriteOptions {
    /// PNG: 8, 16; TIFF: 8, 16, 32 (float); EXR: 16 (half, also for the 8 of the
    /// default), 32; JPEG: 8.
    int bits = 8;
    Encoding encoding = Encoding::automatic;  ///< automatic: integers sRGB, floats linear
    int jpeg_quality = 92;
    /// 0 stores, 1 is fast (own Huffman coder), 2 … 9 are the levels of zlib: on 8-bit
    /// photographs a few per cent smaller, at a fifth of the speed and less.
    int png_compression = 1;
    /// Compresses blocks of a PNG side by side, to the same bytes; must outlive the
    /// writer.
    Executor* executor = nullptr;
};

/// Writes an image strip by strip, in constant memory. The file appears under its name
/// only in finish(); until then, and if it is never called, nothing is left behind.
class ImageWriter {
  public:
    virtual ~ImageWriter() = default;
    /// Appends rows; `strip` has the bands and columns given to open(). Integer samples
    /// are clamped to [0, 1] and correctly rounded; NaN is written as 0.
    [[nodiscard]] virtual Result<void> write_rows(ImageView<const float> strip) = 0;
    [[nodiscard]] virtual Result<void> finish() = 0;

    /// Format by extension: .png .jpg .jpeg .exr .tif .tiff
    /// \error unsupported  another extension, or one that cannot hold the options or size
    /// \error io           the folder does not exist or is not writable
    [[nodiscard]] static Result<std::unique_ptr<ImageWriter>> open(
        const std::string& path, std::size_t bands, std::size_t rows, std::size_t cols,
        const WriteOptions& options);
};

[[nodiscard]] Result<void> write_image(const std::string& path,
                                       ImageView<const float> image,
                                       const WriteOptions& options = {});

}  // namespace sateen
