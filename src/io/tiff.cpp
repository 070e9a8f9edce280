// SPDX-License-Identifier: Apache-2.0
// Reads TIFF by libtiff, block by block: strips or tiles, interleaved or planar, 8 and 16
// bit integers and 32-bit floats. libtiff's own RGBA reader would reduce all to 8 bits.
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "io/codecs.hpp"
#include "io/tiff_handle.hpp"
#include "io/transfer.hpp"

namespace sateen::io {
namespace {

// Deflate shrinks by at most 1032, LZW with its 12-bit codes by 4096 * 8 / 12.
constexpr std::uint64_t kMaxRatio = 1U << 12;
constexpr unsigned kMaxSamples = 16;

bool matches(Bytes bytes) {
    if (bytes.size() < 4) return false;
    // 42 is TIFF, 43 BigTIFF; in the byte order that the first two letters state.
    const bool little = bytes[0] == 'I' && bytes[1] == 'I' && bytes[3] == 0;
    const bool big = bytes[0] == 'M' && bytes[1] == 'M' && bytes[2] == 0;
    const std::uint8_t version = little ? bytes[2] : bytes[3];
    return (little || big) && (version == 42 || version == 43);
}

struct MemoryFile {
    Bytes bytes;
    std::uint64_t at = 0;
    /// Something was to be read beyond the end: libtiff goes on where it is a tag or a
    /// link that it can do without.
    bool truncated = false;
};

tmsize_t read_memory(thandle_t handle, void* to, tmsize_t count) {
    auto* const file = static_cast<MemoryFile*>(handle);
    if (count <= 0) return 0;
    const std::uint64_t left =
        file->bytes.size() - std::min<std::uint64_t>(file->at, file->bytes.size());
    file->truncated = file->truncated || left < static_cast<std::uint64_t>(count);
    const auto size = static_cast<std::size_t>(
        std::min<std::uint64_t>(static_cast<std::uint64_t>(count), left));
    if (size > 0) std::memcpy(to, file->bytes.data() + file->at, size);
    file->at += size;
    return static_cast<tmsize_t>(size);
}
tmsize_t refuse_write(thandle_t, void*, tmsize_t) {
    return 0;
}
toff_t seek_memory(thandle_t handle, toff_t offset, int whence) {
    auto* const file = static_cast<MemoryFile*>(handle);
    if (whence == SEEK_CUR)
        offset += file->at;
    else if (whence == SEEK_END)
        offset += file->bytes.size();
    return file->at = offset;
}
int close_nothing(thandle_t) {
    return 0;
}
toff_t size_of_memory(thandle_t handle) {
    return static_cast<MemoryFile*>(handle)->bytes.size();
}

struct Layout {
    std::uint32_t rows = 0;
    std::uint32_t cols = 0;
    std::uint16_t samples = 1;
    std::uint16_t bits = 1;
    std::uint16_t sample_format = SAMPLEFORMAT_UINT;
    std::uint16_t photometric = 0;
    bool planar = false;
    std::uint32_t block_rows = 0;
    std::uint32_t block_cols = 0;
    bool tiled = false;
};

/// An open file: states its layout, decodes its blocks.
class Reader {
  public:
    Reader(Bytes bytes, std::string_view name) : file_{bytes, 0, false}, name_(name) {}

    [[nodiscard]] Result<ImageHeader> open() {
        tiff_ = open_tiff(
            "r", &file_,
            {read_memory, refuse_write, seek_memory, close_nothing, size_of_memory},
            messages_);
        if (!tiff_ || file_.truncated) return damaged();
        read_layout();
        SATEEN_CHECK(check_layout());
        ImageHeader header;
        header.rows = layout_.rows;
        header.cols = layout_.cols;
        header.bands = grey() ? 1 : 3;
        header.bits = layout_.bits;
        header.floating_point = layout_.sample_format == SAMPLEFORMAT_IEEEFP;
        header.format = "TIFF";
        return header;
    }

    [[nodiscard]] Result<Image> decode(const ImageHeader& header, Encoding encoding) {
        Image image(header.bands, header.rows, header.cols);
        SATEEN_CHECK(prepare(header, encoding));
        const std::size_t planes = layout_.planar ? header.bands : 1;
        for (std::size_t plane = 0; plane < planes; ++plane)
            for (std::uint32_t row = 0; row < layout_.rows; row += layout_.block_rows)
                for (std::uint32_t col = 0; col < layout_.cols; col += layout_.block_cols)
                    SATEEN_CHECK(take_block(plane, row, col, image.view()));
        if (header.floating_point) linearise(image.values(), encoding);
        return image;
    }

  private:
    [[nodiscard]] Error damaged() const {
        return bad_format(name_, file_.truncated ? "truncated TIFF: premature end of file"
                                                 : "damaged TIFF: " + messages_.first());
    }
    [[nodiscard]] bool grey() const {
        return layout_.photometric == PHOTOMETRIC_MINISBLACK ||
               layout_.photometric == PHOTOMETRIC_MINISWHITE;
    }

    template <class T>
    void field(std::uint32_t tag, T& value) {
        TIFFGetFieldDefaulted(tiff_.get(), tag, &value);
    }

    void read_layout() {
        field(TIFFTAG_IMAGELENGTH, layout_.rows);
        field(TIFFTAG_IMAGEWIDTH, layout_.cols);
        field(TIFFTAG_SAMPLESPERPIXEL, layout_.samples);
        field(TIFFTAG_BITSPERSAMPLE, layout_.bits);
        field(TIFFTAG_SAMPLEFORMAT, layout_.sample_format);
        field(TIFFTAG_PHOTOMETRIC, layout_.photometric);
        std::uint16_t planar = PLANARCONFIG_CONTIG;
        field(TIFFTAG_PLANARCONFIG, planar);
        layout_.planar = planar == PLANARCONFIG_SEPARATE && layout_.samples > 1;
        std::uint16_t compression = COMPRESSION_NONE;
        field(TIFFTAG_COMPRESSION, compression);
        if (layout_.photometric == PHOTOMETRIC_YCBCR && compression == COMPRESSION_JPEG &&
            !layout_.planar) {
            TIFFSetField(tiff_.get(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
            layout_.photometric = PHOTOMETRIC_RGB;
        }
        layout_.tiled = TIFFIsTiled(tiff_.get()) != 0;
        if (layout_.tiled) {
            field(TIFFTAG_TILELENGTH, layout_.block_rows);
            field(TIFFTAG_TILEWIDTH, layout_.block_cols);
        } else {
            field(TIFFTAG_ROWSPERSTRIP, layout_.block_rows);
            layout_.block_rows = std::min(layout_.block_rows, layout_.rows);
            layout_.block_cols = layout_.cols;
        }
    }

    [[nodiscard]] Result<void> check_layout() const {
        SATEEN_CHECK(
            check_size(name_, layout_.rows, layout_.cols, file_.bytes.size(), kMaxRatio));
        const bool integer = layout_.sample_format == SAMPLEFORMAT_UINT ||
                             layout_.sample_format == SAMPLEFORMAT_VOID;
        const bool floating =
            layout_.sample_format == SAMPLEFORMAT_IEEEFP && layout_.bits == 32;
        if (!floating && !(integer && (layout_.bits == 8 || layout_.bits == 16)))
            return unsupported(
                name_, "found TIFF samples of " + std::to_string(layout_.bits) +
                           " bits, format " + std::to_string(layout_.sample_format) +
                           ", expected 8 or 16 bit unsigned or 32 bit float");
        const bool palette = layout_.photometric == PHOTOMETRIC_PALETTE &&
                             layout_.bits == 8 && integer && layout_.samples == 1;
        const bool colour =
            layout_.photometric == PHOTOMETRIC_RGB && layout_.samples >= 3;
        if ((!grey() && !palette && !colour) || layout_.samples == 0 ||
            layout_.samples > kMaxSamples)
            return unsupported(name_,
                               "found a TIFF with " + std::to_string(layout_.samples) +
                                   " samples a pixel, photometric interpretation " +
                                   std::to_string(layout_.photometric) +
                                   ", expected grey, RGB or an 8-bit palette");
        if (layout_.block_rows == 0 || layout_.block_cols == 0 ||
            layout_.block_rows > kMaxSide || layout_.block_cols > kMaxSide)
            return bad_format(name_, "has TIFF strips or tiles of an impossible size");
        return {};
    }

    [[nodiscard]] Result<void> prepare(const ImageHeader& header, Encoding encoding) {
        const bool palette = layout_.photometric == PHOTOMETRIC_PALETTE;
        channels_ = layout_.planar ? 1 : layout_.samples;
        const std::size_t expected = std::size_t{layout_.block_rows} *
                                     layout_.block_cols * channels_ * layout_.bits / 8;
        const tmsize_t stated =
            layout_.tiled ? TIFFTileSize(tiff_.get()) : TIFFStripSize(tiff_.get());
        if (stated <= 0 || static_cast<std::size_t>(stated) != expected)
            return bad_format(name_, "has TIFF strips or tiles of " +
                                         std::to_string(stated) + " bytes, expected " +
                                         std::to_string(expected));
        block_.resize(expected);
        if (header.floating_point) return {};
        const std::span<const float> table =
            layout_.bits == 16 ? decode_table16(encoding) : decode_table8(encoding);
        table_.assign(table.begin(), table.end());
        if (layout_.photometric == PHOTOMETRIC_MINISWHITE)
            std::reverse(table_.begin(), table_.end());
        if (palette) return prepare_palette(encoding);
        return {};
    }

    [[nodiscard]] Result<void> prepare_palette(Encoding encoding) {
        std::array<std::uint16_t*, 3> map = {};
        if (TIFFGetField(tiff_.get(), TIFFTAG_COLORMAP, &map[0], &map[1], &map[2]) == 0)
            return bad_format(name_, "is a palette TIFF without a colour map");
        const std::span<const float> table = decode_table16(encoding);
        palette_.resize(3 * 256);
        for (std::size_t band = 0; band < 3; ++band)
            for (std::size_t code = 0; code < 256; ++code)
                palette_[band * 256 + code] = table[map[band][code]];
        return {};
    }

    [[nodiscard]] Result<void> take_block(std::size_t plane, std::uint32_t row,
                                          std::uint32_t col, ImageView<float> out) {
        const auto sample = static_cast<std::uint16_t>(plane);
        const std::uint32_t rows = std::min(layout_.block_rows, layout_.rows - row);
        const std::uint32_t cols = std::min(layout_.block_cols, layout_.cols - col);
        const std::size_t row_bytes =
            std::size_t{layout_.block_cols} * channels_ * layout_.bits / 8;
        const auto size = static_cast<tmsize_t>(
            row_bytes * (layout_.tiled ? layout_.block_rows : rows));
        const tmsize_t got =
            layout_.tiled
                ? TIFFReadEncodedTile(tiff_.get(),
                                      TIFFComputeTile(tiff_.get(), col, row, 0, sample),
                                      block_.data(), size)
                : TIFFReadEncodedStrip(tiff_.get(),
                                       TIFFComputeStrip(tiff_.get(), row, sample),
                                       block_.data(), size);
        if (got != size || file_.truncated) return damaged();
        for (std::uint32_t r = 0; r < rows; ++r)
            take_row(block_.data() + r * row_bytes, plane, row + r, col, cols, out);
        return {};
    }

    void take_row(const std::uint8_t* codes, std::size_t plane, std::size_t row,
                  std::size_t col, std::size_t cols, ImageView<float> out) const {
        const std::size_t first = layout_.planar ? plane : 0;
        const std::size_t last = layout_.planar ? plane + 1 : out.bands;
        for (std::size_t band = first; band < last; ++band) {
            float* const to = out.plane(band).row(row) + col;
            const std::size_t channel = band - first;
            if (!palette_.empty()) {
                for (std::size_t c = 0; c < cols; ++c)
                    to[c] = palette_[band * 256 + codes[c * channels_]];
            } else if (layout_.bits == 8) {
                for (std::size_t c = 0; c < cols; ++c)
                    to[c] = table_[codes[c * channels_ + channel]];
            } else if (layout_.bits == 16) {
                for (std::size_t c = 0; c < cols; ++c)
                    to[c] =
                        table_[sample_at<std::uint16_t>(codes, c * channels_ + channel)];
            } else {
                for (std::size_t c = 0; c < cols; ++c)
                    to[c] = sample_at<float>(codes, c * channels_ + channel);
            }
        }
    }

    template <class T>
    static T sample_at(const std::uint8_t* bytes, std::size_t index) {
        T value;
        std::memcpy(&value, bytes + index * sizeof(T), sizeof(T));
        return value;
    }

    MemoryFile file_;
    std::string name_;
    TiffMessages messages_;
    TiffHandle tiff_;
    Layout layout_;
    std::size_t channels_ = 1;  ///< samples of a pixel that lie together
    std::vector<std::uint8_t> block_;
    std::vector<float> table_;
    std::vector<float> palette_;
};

Result<ImageHeader> read_tiff_header(Bytes bytes, std::string_view name) {
    Reader reader(bytes, name);
    return reader.open();
}

Result<Image> decode_tiff(Bytes bytes, std::string_view name, Encoding encoding) {
    Reader reader(bytes, name);
    SATEEN_TRY(const ImageHeader header, reader.open());
    return reader.decode(header, encoding);
}

}  // namespace

const Format kTiffFormat = {"TIFF", matches, read_tiff_header, decode_tiff};

}  // namespace sateen::io
