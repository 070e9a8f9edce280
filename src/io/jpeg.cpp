// SPDX-License-Identifier: Apache-2.0
// JPEG by libjpeg-turbo, row by row. Its TurboJPEG interface neither streams rows nor
// tells which warnings occurred, and a truncated file is only a warning.
#include <csetjmp>
#include <cstdio>
// jpeglib.h needs size_t and FILE.
#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "io/codecs.hpp"
#include "io/transfer.hpp"

namespace sateen::io {
namespace {

// A blank area takes at least one bit per 8 x 8 block unless coded arithmetically, where
// it can take less; no real photograph comes near.
constexpr std::uint64_t kMaxRatio = 1U << 14;
// A hostile progressive file repeats scans without end; encoders write about ten.
constexpr int kMaxScans = 500;

/// Where libjpeg reports errors; `manager` comes first so that a pointer to it is one to
/// this.
struct ErrorState {
    jpeg_error_mgr manager;
    std::jmp_buf jump;
    std::array<char, JMSG_LENGTH_MAX> message;
};

[[noreturn]] void give_up(j_common_ptr info) {
    auto* const state = reinterpret_cast<ErrorState*>(info->err);
    info->err->format_message(info, state->message.data());
    std::longjmp(state->jump, 1);
}

// Warnings that leave every pixel as the encoder meant it.
bool harmless(int code) {
    return code == JWRN_EXTRANEOUS_DATA || code == JWRN_ADOBE_XFORM ||
           code == JWRN_JFIF_MAJOR || code == JWRN_NOT_SEQUENTIAL ||
           code == JWRN_BOGUS_PROGRESSION || code == JWRN_BOGUS_ICC;
}

void on_message(j_common_ptr info, int level) {
    if (level < 0 && !harmless(info->err->msg_code)) give_up(info);
}

void stay_silent(j_common_ptr) {}

void install(ErrorState& state) {
    jpeg_std_error(&state.manager);
    state.manager.error_exit = give_up;
    state.manager.emit_message = on_message;
    state.manager.output_message = stay_silent;
}

void limit_scans(j_common_ptr info) {
    const auto* const decoder = reinterpret_cast<j_decompress_ptr>(info);
    if (decoder->input_scan_number > kMaxScans) {
        info->err->msg_code = JWRN_BOGUS_PROGRESSION;
        give_up(info);
    }
}

/// A decompressor. Every function that calls libjpeg sets its own jump target and holds
/// nothing with a destructor below it.
class Decoder {
  public:
    Decoder() {
        install(errors_);
        info_.err = &errors_.manager;
        monitor_.progress_monitor = limit_scans;
    }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;
    ~Decoder() { jpeg_destroy_decompress(&info_); }

    [[nodiscard]] bool read_header(Bytes bytes) {
        if (setjmp(errors_.jump) != 0) return false;
        jpeg_create_decompress(&info_);
        info_.progress = &monitor_;
        jpeg_mem_src(&info_, bytes.data(), bytes.size());
        jpeg_read_header(&info_, TRUE);
        return true;
    }

    [[nodiscard]] bool decode(std::uint8_t* scratch, std::size_t scratch_rows,
                              std::span<const float> table, ImageView<float> out) {
        if (setjmp(errors_.jump) != 0) return false;
        info_.out_color_space = out.bands == 1 ? JCS_GRAYSCALE : JCS_RGB;
        jpeg_start_decompress(&info_);
        const std::size_t stride = out.cols * out.bands;
        std::array<JSAMPROW, kMaxScratchRows> pointers = {};
        for (std::size_t i = 0; i < scratch_rows; ++i) pointers[i] = scratch + i * stride;
        while (info_.output_scanline < info_.output_height) {
            const std::size_t first = info_.output_scanline;
            const std::size_t got = jpeg_read_scanlines(
                &info_, pointers.data(), static_cast<JDIMENSION>(scratch_rows));
            for (std::size_t i = 0; i < got; ++i)
                decode_row(pointers[i], out.bands, table, first + i, out);
        }
        // Also looks for the end marker, without which the file is truncated.
        jpeg_finish_decompress(&info_);
        return true;
    }

    [[nodiscard]] const jpeg_decompress_struct& info() const { return info_; }
    [[nodiscard]] std::string message() const { return errors_.message.data(); }

    static constexpr std::size_t kMaxScratchRows = 16;

  private:
    jpeg_decompress_struct info_ = {};
    jpeg_progress_mgr monitor_ = {};
    ErrorState errors_ = {};
};

bool matches(Bytes bytes) {
    return bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

Result<ImageHeader> header_of(Decoder& decoder, Bytes bytes, std::string_view name) {
    if (!decoder.read_header(bytes))
        return bad_format(name, "damaged or truncated JPEG header: " + decoder.message());
    const jpeg_decompress_struct& info = decoder.info();
    const J_COLOR_SPACE space = info.jpeg_color_space;
    if (space == JCS_CMYK || space == JCS_YCCK)
        return unsupported(name, "found a CMYK JPEG, expected RGB or grey");
    if (space != JCS_GRAYSCALE && space != JCS_YCbCr && space != JCS_RGB)
        return unsupported(name, "found a JPEG with " +
                                     std::to_string(info.num_components) +
                                     " unknown components, expected RGB or grey");
    SATEEN_CHECK(
        check_size(name, info.image_height, info.image_width, bytes.size(), kMaxRatio));
    ImageHeader header;
    header.rows = info.image_height;
    header.cols = info.image_width;
    header.bands = space == JCS_GRAYSCALE ? 1 : 3;
    header.bits = 8;
    header.format = "JPEG";
    return header;
}

Result<ImageHeader> read_jpeg_header(Bytes bytes, std::string_view name) {
    Decoder decoder;
    return header_of(decoder, bytes, name);
}

Result<Image> decode_jpeg(Bytes bytes, std::string_view name, Encoding encoding) {
    Decoder decoder;
    SATEEN_TRY(const ImageHeader header, header_of(decoder, bytes, name));
    Image image(header.bands, header.rows, header.cols);
    std::vector<std::uint8_t> scratch(Decoder::kMaxScratchRows * header.cols *
                                      header.bands);
    if (!decoder.decode(scratch.data(), Decoder::kMaxScratchRows, decode_table8(encoding),
                        image.view()))
        return bad_format(name, "damaged or truncated JPEG: " + decoder.message());
    return image;
}

/// Takes compressed bytes to the file; `manager` comes first, as in ErrorState.
struct Destination {
    jpeg_destination_mgr manager = {};
    AtomicFile* file = nullptr;
    std::optional<Error> error;
    std::array<std::uint8_t, 1 << 16> buffer = {};

    void rewind() {
        manager.next_output_byte = buffer.data();
        manager.free_in_buffer = buffer.size();
    }
    bool flush(std::size_t count) {
        auto written = file->write(Bytes(buffer.data(), count));
        if (!written) error = std::move(written).error();
        rewind();
        return !error;
    }
};

Destination& destination_of(j_compress_ptr info) {
    return *reinterpret_cast<Destination*>(info->dest);
}

void begin_output(j_compress_ptr info) {
    destination_of(info).rewind();
}

boolean flush_full(j_compress_ptr info) {
    Destination& destination = destination_of(info);
    if (!destination.flush(destination.buffer.size()))
        give_up(reinterpret_cast<j_common_ptr>(info));
    return TRUE;
}

void end_output(j_compress_ptr info) {
    Destination& destination = destination_of(info);
    if (!destination.flush(destination.buffer.size() -
                           destination.manager.free_in_buffer))
        give_up(reinterpret_cast<j_common_ptr>(info));
}

class JpegWriter final : public ImageWriter {
  public:
    JpegWriter(AtomicFile file, const Shape& shape, const WriteOptions& options)
        : file_(std::move(file)),
          shape_(shape),
          encoding_(options.encoding),
          row_(shape.cols * shape.bands) {
        install(errors_);
        info_.err = &errors_.manager;
        destination_.manager.init_destination = begin_output;
        destination_.manager.empty_output_buffer = flush_full;
        destination_.manager.term_destination = end_output;
    }
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;
    ~JpegWriter() override { jpeg_destroy_compress(&info_); }

    Result<void> begin(int quality) {
        destination_.file = &file_;
        if (!start(quality)) return failure();
        return {};
    }

    Result<void> write_rows(ImageView<const float> strip) override {
        SATEEN_CHECK(check_strip(file_.path(), shape_, info_.next_scanline, strip));
        for (std::size_t r = 0; r < strip.rows; ++r) {
            for (std::size_t band = 0; band < shape_.bands; ++band)
                encode_row(strip.plane(band).row(r), shape_.cols, shape_.bands, encoding_,
                           row_.data() + band);
            if (!put_row()) return failure();
        }
        return {};
    }

    Result<void> finish() override {
        if (info_.next_scanline != shape_.rows)
            return missing_rows(file_.path(), shape_, info_.next_scanline);
        if (!end()) return failure();
        return file_.commit();
    }

  private:
    bool start(int quality) {
        if (setjmp(errors_.jump) != 0) return false;
        jpeg_create_compress(&info_);
        info_.dest = &destination_.manager;
        info_.image_width = static_cast<JDIMENSION>(shape_.cols);
        info_.image_height = static_cast<JDIMENSION>(shape_.rows);
        info_.input_components = static_cast<int>(shape_.bands);
        info_.in_color_space = shape_.bands == 1 ? JCS_GRAYSCALE : JCS_RGB;
        jpeg_set_defaults(&info_);
        jpeg_set_quality(&info_, quality, TRUE);
        // Whoever asks for high quality wants the colour of single threads kept.
        if (quality >= 90 && shape_.bands == 3) {
            info_.comp_info[0].h_samp_factor = 1;
            info_.comp_info[0].v_samp_factor = 1;
        }
        jpeg_start_compress(&info_, TRUE);
        return true;
    }
    bool put_row() {
        if (setjmp(errors_.jump) != 0) return false;
        JSAMPROW row = row_.data();
        jpeg_write_scanlines(&info_, &row, 1);
        return true;
    }
    bool end() {
        if (setjmp(errors_.jump) != 0) return false;
        jpeg_finish_compress(&info_);
        return true;
    }
    [[nodiscard]] Error failure() const {
        if (destination_.error) return *destination_.error;
        return {Errc::io, file_.path() + ": " + errors_.message.data()};
    }

    AtomicFile file_;
    Shape shape_;
    Encoding encoding_;
    std::vector<std::uint8_t> row_;
    jpeg_compress_struct info_ = {};
    Destination destination_;
    ErrorState errors_ = {};
};

}  // namespace

const Format kJpegFormat = {"JPEG", matches, read_jpeg_header, decode_jpeg};

Writer open_jpeg_writer(AtomicFile file, const Shape& shape,
                        const WriteOptions& options) {
    constexpr std::size_t kMaxJpegSide = 65500;
    if (options.bits != 8)
        return unsupported(file.path(), "JPEG holds 8 bits a sample, asked for " +
                                            std::to_string(options.bits));
    if (shape.rows > kMaxJpegSide || shape.cols > kMaxJpegSide)
        return unsupported(file.path(),
                           "JPEG holds at most 65500 pixels a side, asked for " +
                               std::to_string(shape.cols) + " x " +
                               std::to_string(shape.rows));
    if (options.jpeg_quality < 1 || options.jpeg_quality > 100)
        return Error{Errc::invalid_argument, "JPEG quality: found " +
                                                 std::to_string(options.jpeg_quality) +
                                                 ", expected 1 to 100"};
    auto writer = std::make_unique<JpegWriter>(std::move(file), shape, options);
    SATEEN_CHECK(writer->begin(options.jpeg_quality));
    return std::unique_ptr<ImageWriter>(std::move(writer));
}

}  // namespace sateen::io
