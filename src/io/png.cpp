// SPDX-License-Identifier: Apache-2.0
// Reads PNG by libpng. Writing is in png_writer.cpp.
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <vector>

#include "io/codecs.hpp"
#include "io/transfer.hpp"

namespace sateen::io {
namespace {

// What a byte of deflate can stand for at most, times the 8 pixels of a 1-bit byte.
constexpr std::uint64_t kMaxRatio = 1032U * 8U;
constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P',  'N',  'G',
                                                    0x0D, 0x0A, 0x1A, 0x0A};

bool matches(Bytes bytes) {
    return bytes.size() >= kSignature.size() &&
           std::equal(kSignature.begin(), kSignature.end(), bytes.begin());
}

/// A decompressor. As with libjpeg, each function that calls libpng sets its own jump
/// target and holds nothing with a destructor below it.
class Decoder {
  public:
    explicit Decoder(Bytes bytes) : rest_(bytes) {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
        if (png_ != nullptr) info_ = png_create_info_struct(png_);
    }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;
    ~Decoder() { png_destroy_read_struct(&png_, &info_, nullptr); }

    [[nodiscard]] bool read_header() {
        if (png_ == nullptr || info_ == nullptr) return false;
        if (setjmp(jump_) != 0) return false;
        // Sizes are checked by check_size, whose message says more.
        png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        png_set_read_fn(png_, this, on_read);
        png_read_info(png_, info_);
        return true;
    }

    /// Decodes rows to `buffer`: one row each time, or all rows if interlaced.
    [[nodiscard]] bool decode(std::uint8_t* buffer, std::span<const float> table,
                              ImageView<float> out) {
        if (setjmp(jump_) != 0) return false;
        png_set_palette_to_rgb(png_);
        png_set_expand_gray_1_2_4_to_8(png_);
        png_set_strip_alpha(png_);
        if (bits() == 16 && std::endian::native == std::endian::little)
            png_set_swap(png_);
        const int passes = png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        const std::size_t row_bytes = png_get_rowbytes(png_, info_);
        const std::size_t step = passes > 1 ? row_bytes : 0;
        for (int pass = 0; pass < passes; ++pass) {
            for (std::size_t row = 0; row < out.rows; ++row) {
                std::uint8_t* const codes = buffer + row * step;
                png_read_row(png_, codes, nullptr);
                if (pass == passes - 1) take_row(codes, table, row, out);
            }
        }
        png_read_end(png_, nullptr);
        return true;
    }

    [[nodiscard]] std::size_t rows() const { return png_get_image_height(png_, info_); }
    [[nodiscard]] std::size_t cols() const { return png_get_image_width(png_, info_); }
    [[nodiscard]] int bits() const { return png_get_bit_depth(png_, info_); }
    [[nodiscard]] bool grey() const {
        return (png_get_color_type(png_, info_) & PNG_COLOR_MASK_COLOR) == 0;
    }
    [[nodiscard]] bool interlaced() const {
        return png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE;
    }
    [[nodiscard]] std::string message() const { return message_.data(); }

  private:
    void take_row(const std::uint8_t* codes, std::span<const float> table,
                  std::size_t row, ImageView<float> out) {
        if (bits() == 16)
            decode_row(reinterpret_cast<const std::uint16_t*>(codes), out.bands, table,
                       row, out);
        else
            decode_row(codes, out.bands, table, row, out);
    }
    [[noreturn]] static void on_error(png_structp png, png_const_charp text) {
        auto* const self = static_cast<Decoder*>(png_get_error_ptr(png));
        std::strncpy(self->message_.data(), text, self->message_.size() - 1);
        std::longjmp(self->jump_, 1);
    }
    static void on_warning(png_structp, png_const_charp) {}
    static void on_read(png_structp png, png_bytep to, std::size_t count) {
        auto* const self = static_cast<Decoder*>(png_get_io_ptr(png));
        if (count > self->rest_.size()) png_error(png, "premature end of file");
        std::copy_n(self->rest_.begin(), count, to);
        self->rest_ = self->rest_.subspan(count);
    }

    Bytes rest_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    std::jmp_buf jump_ = {};
    std::array<char, 128> message_ = {};
};

Result<ImageHeader> header_of(Decoder& decoder, Bytes bytes, std::string_view name) {
    if (!decoder.read_header())
        return bad_format(name, "damaged or truncated PNG header: " + decoder.message());
    SATEEN_CHECK(
        check_size(name, decoder.rows(), decoder.cols(), bytes.size(), kMaxRatio));
    ImageHeader header;
    header.rows = decoder.rows();
    header.cols = decoder.cols();
    header.bands = decoder.grey() ? 1 : 3;
    header.bits = std::max(8, decoder.bits());
    header.format = "PNG";
    return header;
}

Result<ImageHeader> read_png_header(Bytes bytes, std::string_view name) {
    Decoder decoder(bytes);
    return header_of(decoder, bytes, name);
}

Result<Image> decode_png(Bytes bytes, std::string_view name, Encoding encoding) {
    Decoder decoder(bytes);
    SATEEN_TRY(const ImageHeader header, header_of(decoder, bytes, name));
    Image image(header.bands, header.rows, header.cols);
    const bool wide = header.bits == 16;
    // Four channels: alpha is stripped in place.
    std::vector<std::uint16_t> buffer(
        (decoder.interlaced() ? header.rows : 1) * header.cols * 4 / (wide ? 1 : 2) + 8);
    if (!decoder.decode(reinterpret_cast<std::uint8_t*>(buffer.data()),
                        wide ? decode_table16(encoding) : decode_table8(encoding),
                        image.view()))
        return bad_format(name, "damaged or truncated PNG: " + decoder.message());
    return image;
}

}  // namespace

const Format kPngFormat = {"PNG", matches, read_png_header, decode_png};

}  // namespace sateen::io
