// SPDX-License-Identifier: Apache-2.0
// gzip around the payload of material/file.hpp. See material_file.hpp.
#include "sateen/io/material_file.hpp"

#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>

#include "sateen/io/atomic_file.hpp"
#include "sateen/material/file.hpp"

namespace sateen {
namespace {

constexpr int kWindowBits = 15;
constexpr int kGzipOnly = 16;    // added to the window bits: neither zlib nor raw deflate
constexpr int kMemoryLevel = 8;  // 9 compresses the mixed parts of a material less
constexpr int kUnknownSystem = 255;
constexpr std::size_t kFirstBytes = 4096;
// What does not compress grows by 5 bytes every 16 KB.
constexpr std::size_t kMaxFileBytes = kMaxPayloadBytes + kMaxPayloadBytes / 1024;

Error bad_gzip(const std::string& message) {
    return {Errc::bad_format, "not a material: " + message};
}

Result<std::vector<std::uint8_t>> gzip(std::span<const std::uint8_t> bytes) {
    z_stream stream{};
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kWindowBits + kGzipOnly,
                     kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK)
        return Error{Errc::limit_exceeded, "gzip: out of memory"};
    gz_header header{};  // time 0, no name
    header.os = kUnknownSystem;
    deflateSetHeader(&stream, &header);
    std::vector<std::uint8_t> out(deflateBound(&stream, bytes.size()));
    stream.next_in = bytes.data();
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (status != Z_STREAM_END) return Error{Errc::limit_exceeded, "gzip: out of memory"};
    return out;
}

// Inflates into a buffer that grows with what has really been unpacked, up to one byte
// more than the limit.
Result<std::vector<std::uint8_t>> gunzip(std::span<const std::uint8_t> file) {
    z_stream stream{};
    if (inflateInit2(&stream, kWindowBits + kGzipOnly) != Z_OK)
        return Error{Errc::limit_exceeded, "gzip: out of memory"};
    stream.next_in = file.data();
    stream.avail_in = static_cast<uInt>(file.size());
    std::vector<std::uint8_t> out;
    int status = Z_OK;
    while (status == Z_OK && out.size() <= kMaxPayloadBytes) {
        const std::size_t done = out.size();
        out.resize(std::min(kMaxPayloadBytes + 1,
                            std::max({kFirstBytes, 4 * file.size(), 2 * done})));
        stream.next_out = out.data() + done;
        stream.avail_out = static_cast<uInt>(out.size() - done);
        status = inflate(&stream, Z_SYNC_FLUSH);
        out.resize(stream.total_out);
        if (stream.avail_in == 0 && stream.avail_out != 0) break;
    }
    const std::size_t extra = stream.avail_in;
    inflateEnd(&stream);
    if (out.size() > kMaxPayloadBytes)
        return Error{
            Errc::limit_exceeded,
            "unpacks to more than " + std::to_string(kMaxPayloadBytes) + " bytes"};
    if (status == Z_OK || status == Z_BUF_ERROR) return bad_gzip("gzip ends too early");
    if (status == Z_MEM_ERROR) return Error{Errc::limit_exceeded, "gzip: out of memory"};
    if (status != Z_STREAM_END) return bad_gzip("no gzip or damaged");
    if (extra != 0)
        return bad_gzip(std::to_string(extra) + " bytes after the gzip member");
    return out;
}

Error name_file(const std::string& path, Error error) {
    if (!error.message.starts_with(path)) error.message.insert(0, path + ": ");
    return error;
}

}  // namespace

Result<std::vector<std::uint8_t>> pack_material(const Material& material) {
    SATEEN_TRY(const auto payload, write_material(material));
    return gzip(payload);
}

Result<Material> unpack_material(std::span<const std::uint8_t> file) {
    if (file.size() > kMaxFileBytes)
        return Error{Errc::limit_exceeded, std::to_string(file.size()) +
                                               " bytes, expected at most " +
                                               std::to_string(kMaxFileBytes)};
    SATEEN_TRY(const auto payload, gunzip(file));
    return read_material(payload);
}

Result<std::size_t> save_material(const std::string& path, const Material& material) {
    const auto file = pack_material(material);
    if (!file) return name_file(path, file.error());
    if (auto written = write_file(path, *file); !written)
        return name_file(path, std::move(written).error());
    return file->size();
}

Result<Material> load_material(const std::string& path) {
    const auto file = read_file(path, kMaxFileBytes);
    if (!file) return name_file(path, file.error());
    auto material = unpack_material(*file);
    if (!material) return name_file(path, std::move(material).error());
    return material;
}

}  // namespace sateen
