// SPDX-License-Identifier: Apache-2.0
// What image_file.cpp asks of each format. One file a format: whatever its library
// throws, jumps or prints ends there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::io {

using Bytes = std::span<const std::uint8_t>;

inline constexpr std::size_t kMaxSide = std::size_t{1} << 15;
inline constexpr std::size_t kMaxPixels = std::size_t{1} << 29;

/// A reader; `decode` never returns a partly decoded image.
struct Format {
    const char* name;
    bool (*matches)(Bytes bytes);
    Result<ImageHeader> (*header)(Bytes bytes, std::string_view name);
    Result<Image> (*decode)(Bytes bytes, std::string_view name, Encoding encoding);
};
extern const Format kJpegFormat;
extern const Format kPngFormat;
extern const Format kExrFormat;
extern const Format kTiffFormat;
extern const Format kRadianceFormat;

/// Shape of an image to write.
struct Shape {
    std::size_t bands = 0;
    std::size_t rows = 0;
    std::size_t cols = 0;
};

using Writer = Result<std::unique_ptr<ImageWriter>>;
Writer open_jpeg_writer(AtomicFile file, const Shape& shape, const WriteOptions& options);
Writer open_png_writer(AtomicFile file, const Shape& shape, const WriteOptions& options);
Writer open_exr_writer(AtomicFile file, const Shape& shape, const WriteOptions& options);
Writer open_tiff_writer(AtomicFile file, const Shape& shape, const WriteOptions& options);

[[nodiscard]] inline Error bad_format(std::string_view name, std::string_view what) {
    return {Errc::bad_format, std::string(name) + ": " + std::string(what)};
}
[[nodiscard]] inline Error unsupported(std::string_view name, std::string_view what) {
    return {Errc::unsupported, std::string(name) + ": " + std::string(what)};
}

/// Checks a size found in a header before anything is allocated for it.
/// \param max_ratio  samples that a byte of the format's best compression can stand for:
///                   a short file that states a huge image is refused
[[nodiscard]] Result<void> check_size(std::string_view name, std::uint64_t rows,
                                      std::uint64_t cols, std::size_t file_bytes,
                                      std::uint64_t max_ratio);

/// Checks that rows given to a writer fit what it was opened for.
[[nodiscard]] Result<void> check_strip(const std::string& path, const Shape& shape,
                                       std::size_t rows_written,
                                       ImageView<const float> strip);
/// The error of finish() before all rows have come.
[[nodiscard]] Error missing_rows(const std::string& path, const Shape& shape,
                                 std::size_t rows_written);

}  // namespace sateen::io
