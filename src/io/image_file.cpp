// SPDX-License-Identifier: Apache-2.0
// Finds the format of an image file. See image_file.hpp.
#include "sateen/io/image_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

#include "io/codecs.hpp"

namespace sateen {
namespace io {
namespace {

// Larger files than the largest image, 32-bit float RGB uncompressed, are no image.
constexpr std::size_t kMaxFileBytes = kMaxPixels * 12 + (std::size_t{1} << 24);

constexpr std::array kFormats = {&kJpegFormat, &kPngFormat, &kExrFormat, &kTiffFormat,
                                 &kRadianceFormat};

std::string first_bytes(Bytes bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes.first(std::min<std::size_t>(4, bytes.size()))) {
        if (!text.empty()) text += ' ';
        text += kDigits[byte >> 4];
        text += kDigits[byte & 15];
    }
    return text;
}

Result<const Format*> find_format(Bytes bytes, std::string_view name) {
    for (const Format* format : kFormats)
        if (format->matches(bytes)) return format;
    return bad_format(name, "is not an image: found " +
                                (bytes.empty() ? "no bytes at all"
                                               : "first bytes " + first_bytes(bytes)) +
                                ", expected a JPEG, PNG, OpenEXR, TIFF or Radiance file");
}

std::string size_text(std::uint64_t cols, std::uint64_t rows) {
    return std::to_string(cols) + " x " + std::to_string(rows);
}

using OpenWriter = Writer (*)(AtomicFile, const Shape&, const WriteOptions&);

OpenWriter writer_of(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    std::string extension = dot == std::string::npos ? "" : path.substr(dot + 1);
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension == "png") return open_png_writer;
    if (extension == "jpg" || extension == "jpeg") return open_jpeg_writer;
    if (extension == "exr") return open_exr_writer;
    if (extension == "tif" || extension == "tiff") return open_tiff_writer;
    return nullptr;
}

}  // namespace

Result<void> check_size(std::string_view name, std::uint64_t rows, std::uint64_t cols,
                        std::size_t file_bytes, std::uint64_t max_ratio) {
    if (rows == 0 || cols == 0) return bad_format(name, "has no pixels");
    if (rows > kMaxSide || cols > kMaxSide || rows * cols > kMaxPixels)
        return Error{Errc::limit_exceeded,
                     std::string(name) + ": has " + size_text(cols, rows) +
                         " pixels, expected at most 32768 a side and 2^29 in all"};
    if (rows * cols / max_ratio > file_bytes)
        return bad_format(name, "states " + size_text(cols, rows) + " pixels, which " +
                                    std::to_string(file_bytes) + " bytes cannot hold");
    return {};
}

Result<void> check_strip(const std::string& path, const Shape& shape,
                         std::size_t rows_written, ImageView<const float> strip) {
    if (strip.bands == shape.bands && strip.cols == shape.cols &&
        strip.rows <= shape.rows - rows_written)
        return {};
    return Error{Errc::invalid_argument,
                 path + ": found a strip of " + std::to_string(strip.bands) + " bands, " +
                     size_text(strip.cols, strip.rows) + " pixels, expected " +
                     std::to_string(shape.bands) + " bands, " +
                     std::to_string(shape.cols) + " columns and at most " +
                     std::to_string(shape.rows - rows_written) + " rows"};
}

Error missing_rows(const std::string& path, const Shape& shape,
                   std::size_t rows_written) {
    return {Errc::invalid_argument, path + ": found " + std::to_string(rows_written) +
                                        " rows, expected " + std::to_string(shape.rows)};
}

}  // namespace io

Result<ImageHeader> decode_image_header(std::span<const std::uint8_t> bytes,
                                        std::string_view name) {
    SATEEN_TRY(const io::Format* format, io::find_format(bytes, name));
    return format->header(bytes, name);
}

Result<Image> decode_image(std::span<const std::uint8_t> bytes, std::string_view name,
                           Encoding encoding) {
    SATEEN_TRY(const io::Format* format, io::find_format(bytes, name));
    return format->decode(bytes, name, encoding);
}

Result<ImageHeader> read_image_header(const std::string& path) {
    SATEEN_TRY(const std::vector<std::uint8_t> bytes, read_file(path, io::kMaxFileBytes));
    return decode_image_header(bytes, path);
}

Result<Image> read_image(const std::string& path, Encoding encoding) {
    SATEEN_TRY(const std::vector<std::uint8_t> bytes, read_file(path, io::kMaxFileBytes));
    return decode_image(bytes, path, encoding);
}

Result<std::unique_ptr<ImageWriter>> ImageWriter::open(const std::string& path,
                                                       std::size_t bands,
                                                       std::size_t rows, std::size_t cols,
                                                       const WriteOptions& options) {
    const io::OpenWriter open_writer = io::writer_of(path);
    if (open_writer == nullptr)
        return io::unsupported(path,
                               "found no known extension, expected .png, .jpg, .jpeg, "
                               ".exr, .tif or .tiff");
    if ((bands != 1 && bands != 3) || rows == 0 || cols == 0)
        return Error{Errc::invalid_argument,
                     path + ": found an image of " + std::to_string(bands) + " bands, " +
                         io::size_text(cols, rows) +
                         " pixels, expected 1 or 3 bands and at least one pixel"};
    constexpr std::size_t kMaxRowBytes = std::size_t{1} << 30;
    if (cols > kMaxRowBytes / (bands * 4) || rows >= std::size_t{1} << 31)
        return io::unsupported(path, "cannot hold " + io::size_text(cols, rows) +
                                         " pixels, expected at most 2^31 - 1 rows and " +
                                         "rows of at most 2^30 bytes");
    SATEEN_TRY(AtomicFile file, AtomicFile::create(path));
    return open_writer(std::move(file), {bands, rows, cols}, options);
}

Result<void> write_image(const std::string& path, ImageView<const float> image,
                         const WriteOptions& options) {
    SATEEN_TRY(const std::unique_ptr<ImageWriter> writer,
               ImageWriter::open(path, image.bands, image.rows, image.cols, options));
    SATEEN_CHECK(writer->write_rows(image));
    return writer->finish();
}

}  // namespace sateen
