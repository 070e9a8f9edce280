// SPDX-License-Identifier: Apache-2.0
// Chunks of PNG files, put together. See animated_png.hpp.
#include "sateen/io/animated_png.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "sateen/io/atomic_file.hpp"

namespace sateen {
namespace {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P',  'N',  'G',
                                                    '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kMaxFrame = std::size_t{1} << 31;
constexpr std::size_t kAround = 12;  // length, type and checksum of a chunk

std::uint32_t big_endian(View bytes) {
    return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U |
           std::uint32_t{bytes[2]} << 8U | std::uint32_t{bytes[3]};
}

void append(Bytes& out, std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U})
        out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void append(Bytes& out, View bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
}

Bytes chunk(std::string_view type, View data) {
    Bytes out;
    append(out, static_cast<std::uint32_t>(data.size()));
    out.insert(out.end(), type.begin(), type.end());
    append(out, data);
    const auto sum = crc32_z(0, out.data() + 4, out.size() - 4);
    append(out, static_cast<std::uint32_t>(sum));
    return out;
}

/// A PNG file taken apart.
struct Frame {
    Bytes header;               // of IHDR
    Bytes before;               // chunks between IHDR and the first IDAT, whole
    std::vector<Bytes> pieces;  // of IDAT
};

Result<Frame> read_frame(const std::string& path) {
    SATEEN_TRY(const Bytes file, read_file(path, kMaxFrame));
    const Error damaged{Errc::bad_format, path + ": is no PNG file"};
    if (file.size() < kSignature.size() ||
        !std::equal(kSignature.begin(), kSignature.end(), file.begin()))
        return damaged;
    Frame frame;
    for (std::size_t at = kSignature.size(); at + kAround <= file.size();) {
        const std::size_t length = big_endian(View(file).subspan(at));
        if (length > file.size() - at - kAround) return damaged;
        const View whole = View(file).subspan(at, kAround + length);
        const View data = whole.subspan(8, length);
        const std::string_view type(reinterpret_cast<const char*>(whole.data()) + 4, 4);
        if (type == "IHDR")
            frame.header.assign(data.begin(), data.end());
        else if (type == "IDAT")
            frame.pieces.emplace_back(data.begin(), data.end());
        else if (type != "IEND" && frame.pieces.empty())
            append(frame.before, whole);
        at += kAround + length;
    }
    if (frame.header.size() != 13 || frame.pieces.empty()) return damaged;
    return frame;
}

/// fcTL: the whole picture replaces the one before.
Bytes frame_control(std::uint32_t sequence, const Bytes& header,
                    std::uint16_t milliseconds) {
    Bytes data;
    append(data, sequence);
    append(data, View(header).first(8));
    append(data, 0U);
    append(data, 0U);
    for (const std::uint16_t value : {milliseconds, std::uint16_t{1000}}) {
        data.push_back(static_cast<std::uint8_t>(value >> 8U));
        data.push_back(static_cast<std::uint8_t>(value & 0xFFU));
    }
    data.push_back(0);
    data.push_back(0);
    return chunk("fcTL", data);
}

}  // namespace

Result<void> join_png_frames(const std::string& path, std::span<const std::string> frames,
                             std::uint16_t milliseconds) {
    if (frames.empty())
        return Error{Errc::invalid_argument, path + ": an animation without frames"};
    SATEEN_TRY(AtomicFile file, AtomicFile::create(path));
    Bytes header;
    std::uint32_t sequence = 0;
    for (const std::string& name : frames) {
        SATEEN_TRY(const Frame frame, read_frame(name));
        const bool is_first = header.empty();
        if (is_first) {
            header = frame.header;
            Bytes control;
            append(control, static_cast<std::uint32_t>(frames.size()));
            append(control, 0U);
            SATEEN_CHECK(file.write(kSignature));
            SATEEN_CHECK(file.write(chunk("IHDR", header)));
            SATEEN_CHECK(file.write(frame.before));
            SATEEN_CHECK(file.write(chunk("acTL", control)));
        } else if (frame.header != header) {
            return Error{Errc::bad_format,
                         name + ": differs in size or type from " + frames.front()};
        }
        SATEEN_CHECK(file.write(frame_control(sequence++, header, milliseconds)));
        for (const Bytes& piece : frame.pieces) {
            Bytes data;
            if (!is_first) append(data, sequence++);
            append(data, piece);
            SATEEN_CHECK(file.write(chunk(is_first ? "IDAT" : "fdAT", data)));
        }
    }
    SATEEN_CHECK(file.write(chunk("IEND", {})));
    return file.commit();
}

}  // namespace sateen
