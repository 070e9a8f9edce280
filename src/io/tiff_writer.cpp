// SPDX-License-Identifier: Apache-2.0
// Writes TIFF by libtiff: interleaved strips, deflate with a predictor, BigTIFF where 4
// GiB might not do.
#include <tiffio.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "io/codecs.hpp"
#include "io/tiff_handle.hpp"
#include "io/transfer.hpp"

namespace sateen::io {
namespace {

constexpr std::size_t kStripBytes = std::size_t{1} << 18;
// Deflate may grow what it cannot shrink; below this the classic format is safe.
constexpr std::uint64_t kClassicBytes = std::uint64_t{7} << 29;

/// The file as libtiff sees it; keeps the first error, which libtiff would reduce to a
/// count.
struct Target {
    explicit Target(AtomicFile file_) : file(std::move(file_)) {}
    bool keep(Result<void> result) {
        if (!result && !error) error = std::move(result).error();
        return !error;
    }
    AtomicFile file;
    std::uint64_t size = 0;
    std::optional<Error> error;
};

tmsize_t read_target(thandle_t handle, void* to, tmsize_t count) {
    auto& target = *static_cast<Target*>(handle);
    const auto got = target.file.read(
        {static_cast<std::uint8_t*>(to), static_cast<std::size_t>(count)});
    return got ? static_cast<tmsize_t>(*got) : 0;
}
tmsize_t write_target(thandle_t handle, void* from, tmsize_t count) {
    auto& target = *static_cast<Target*>(handle);
    const Bytes bytes(static_cast<const std::uint8_t*>(from),
                      static_cast<std::size_t>(count));
    if (!target.keep(target.file.write(bytes))) return 0;
    target.size = std::max(target.size, target.file.position());
    return count;
}
toff_t seek_target(thandle_t handle, toff_t offset, int whence) {
    auto& target = *static_cast<Target*>(handle);
    if (whence == SEEK_CUR)
        offset += target.file.position();
    else if (whence == SEEK_END)
        offset += target.size;
    target.keep(target.file.seek(offset));
    return target.file.position();
}
int close_nothing(thandle_t) {
    return 0;
}
toff_t size_of_target(thandle_t handle) {
    return static_cast<Target*>(handle)->size;
}

class TiffWriter final : public ImageWriter {
  public:
    TiffWriter(AtomicFile file, const Shape& shape, const WriteOptions& options)
        : target_(std::move(file)),
          shape_(shape),
          bits_(options.bits),
          encoding_(options.encoding),
          row_bytes_(shape.cols * shape.bands * static_cast<std::size_t>(bits_) / 8),
          strip_rows_(std::clamp<std::size_t>(kStripBytes / row_bytes_, 1, shape.rows)),
          strip_(strip_rows_ * row_bytes_) {}

    Result<void> begin() {
        const bool big = std::uint64_t{shape_.rows} * row_bytes_ > kClassicBytes;
        tiff_ = open_tiff(
            big ? "w8" : "w", &target_,
            {read_target, write_target, seek_target, close_nothing, size_of_target},
            messages_);
        if (!tiff_) return failure();
        set(TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(shape_.cols));
        set(TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(shape_.rows));
        set(TIFFTAG_SAMPLESPERPIXEL, static_cast<int>(shape_.bands));
        set(TIFFTAG_BITSPERSAMPLE, bits_);
        set(TIFFTAG_SAMPLEFORMAT, bits_ == 32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
        set(TIFFTAG_PHOTOMETRIC,
            shape_.bands == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
        set(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        set(TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        set(TIFFTAG_PREDICTOR,
            bits_ == 32 ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
        set(TIFFTAG_ZIPQUALITY, 1);
        set(TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(strip_rows_));
        return good_ ? Result<void>() : failure();
    }

    Result<void> write_rows(ImageView<const float> strip) override {
        SATEEN_CHECK(check_strip(target_.file.path(), shape_, rows_taken_, strip));
        for (std::size_t r = 0; r < strip.rows; ++r) {
            encode(strip, r, strip_.data() + pending_ * row_bytes_);
            ++pending_;
            ++rows_taken_;
            if (pending_ == strip_rows_ || rows_taken_ == shape_.rows)
                SATEEN_CHECK(write_strip());
        }
        return {};
    }

    Result<void> finish() override {
        if (rows_taken_ != shape_.rows)
            return missing_rows(target_.file.path(), shape_, rows_taken_);
        const bool flushed = TIFFFlush(tiff_.get()) == 1;
        tiff_.reset();
        if (!flushed || target_.error) return failure();
        return target_.file.commit();
    }

  private:
    template <class T>
    void set(std::uint32_t tag, T value) {
        good_ = TIFFSetField(tiff_.get(), tag, value) == 1 && good_;
    }

    void encode(ImageView<const float> strip, std::size_t row, std::uint8_t* out) {
        for (std::size_t band = 0; band < shape_.bands; ++band) {
            const float* const values = strip.plane(band).row(row);
            if (bits_ == 8) {
                encode_row(values, shape_.cols, shape_.bands, encoding_, out + band);
            } else if (bits_ == 16) {
                encode_row(values, shape_.cols, shape_.bands, encoding_,
                           reinterpret_cast<std::uint16_t*>(out) + band);
            } else {
                float* const to = reinterpret_cast<float*>(out) + band;
                for (std::size_t c = 0; c < shape_.cols; ++c)
                    to[c * shape_.bands] = values[c];
            }
        }
        if (bits_ == 32)
            delinearise({reinterpret_cast<float*>(out), shape_.cols * shape_.bands},
                        encoding_);
    }

    Result<void> write_strip() {
        const auto index =
            static_cast<std::uint32_t>((rows_taken_ - pending_) / strip_rows_);
        const auto size = static_cast<tmsize_t>(pending_ * row_bytes_);
        if (TIFFWriteEncodedStrip(tiff_.get(), index, strip_.data(), size) != size ||
            target_.error)
            return failure();
        pending_ = 0;
        return {};
    }

    [[nodiscard]] Error failure() const {
        if (target_.error) return *target_.error;
        return {Errc::io,
                target_.file.path() + ": cannot be written: " + messages_.first()};
    }

    Target target_;
    Shape shape_;
    int bits_;
    Encoding encoding_;
    std::size_t row_bytes_;
    std::size_t strip_rows_;
    std::vector<std::uint8_t> strip_;
    TiffMessages messages_;
    TiffHandle tiff_;  // after what its closing still uses
    bool good_ = true;
    std::size_t pending_ = 0;
    std::size_t rows_taken_ = 0;
};

}  // namespace

Writer open_tiff_writer(AtomicFile file, const Shape& shape,
                        const WriteOptions& options) {
    if (options.bits != 8 && options.bits != 16 && options.bits != 32)
        return unsupported(file.path(),
                           "TIFF holds 8, 16 or 32 (float) bits a sample, asked "
                           "for " +
                               std::to_string(options.bits));
    auto writer = std::make_unique<TiffWriter>(std::move(file), shape, options);
    SATEEN_CHECK(writer->begin());
    return std::unique_ptr<ImageWriter>(std::move(writer));
}

}  // namespace sateen::io
