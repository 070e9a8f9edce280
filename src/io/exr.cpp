// SPDX-License-Identifier: Apache-2.0
// OpenEXR: scan lines and tiles, half and float. Its exceptions end in this file.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <exception>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "io/codecs.hpp"
#include "io/transfer.hpp"

namespace sateen::io {
namespace {

// Constant areas shrink by more than deflate's 1032 where a method predicts lines.
constexpr std::uint64_t kMaxRatio = 1U << 14;
// OpenEXR allocates whole tiles; 4096 a side is far beyond what writers use.
constexpr unsigned kMaxTileSide = 4096;

constexpr std::array<const char*, 3> kColour = {"R", "G", "B"};

class MemoryStream final : public Imf::IStream {
  public:
    explicit MemoryStream(Bytes bytes) : Imf::IStream("image"), bytes_(bytes) {}
    bool read(char* to, int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (count < 0 || at_ > bytes_.size() || size > bytes_.size() - at_)
            throw std::runtime_error("premature end of file");
        std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t position) override { at_ = position; }

  private:
    Bytes bytes_;
    std::uint64_t at_ = 0;
};

bool matches(Bytes bytes) {
    return bytes.size() >= 4 && bytes[0] == 0x76 && bytes[1] == 0x2F &&
           bytes[2] == 0x31 && bytes[3] == 0x01;
}

/// Header of the first part, before OpenEXR allocates anything for it.
Imf::Header first_header(Bytes bytes) {
    MemoryStream stream(bytes);
    std::array<char, 8> start;
    stream.read(start.data(), static_cast<int>(start.size()));
    int version = 0;
    for (std::size_t i = 0; i < 4; ++i)
        version |= static_cast<int>(static_cast<unsigned char>(start[4 + i])) << (8 * i);
    if (Imf::getVersion(version) != Imf::EXR_VERSION)
        throw std::runtime_error("found version " +
                                 std::to_string(Imf::getVersion(version)) +
                                 ", expected " + std::to_string(Imf::EXR_VERSION));
    Imf::Header header;
    header.readFrom(stream, version);
    header.sanityCheck(Imf::isTiled(version));
    return header;
}

std::string channel_names(const Imf::ChannelList& channels) {
    std::string names;
    for (auto it = channels.begin(); it != channels.end(); ++it)
        names += (names.empty() ? "" : ", ") + std::string(it.name());
    return names.empty() ? "none" : names;
}

/// 3 for R, G and B, 1 for Y alone, 0 for anything else.
std::size_t bands_of(const Imf::ChannelList& channels) {
    const auto has = [&](const char* name) {
        const Imf::Channel* channel = channels.findChannel(name);
        return channel != nullptr && channel->xSampling == 1 && channel->ySampling == 1;
    };
    if (std::all_of(kColour.begin(), kColour.end(), has)) return 3;
    const auto other_colour = [&](const char* name) {
        return channels.findChannel(name) != nullptr;
    };
    return has("Y") && !other_colour("RY") && !other_colour("X") ? 1 : 0;
}

Result<ImageHeader> describe(const Imf::Header& exr, Bytes bytes, std::string_view name) {
    const Imath::Box2i& window = exr.dataWindow();
    const auto extent = [](int low, int high) {
        return static_cast<std::uint64_t>(std::int64_t{high} - low + 1);
    };
    ImageHeader header;
    header.rows = extent(window.min.y, window.max.y);
    header.cols = extent(window.min.x, window.max.x);
    SATEEN_CHECK(check_size(name, header.rows, header.cols, bytes.size(), kMaxRatio));
    if (exr.hasTileDescription() && (exr.tileDescription().xSize > kMaxTileSide ||
                                     exr.tileDescription().ySize > kMaxTileSide))
        return Error{Errc::limit_exceeded,
                     std::string(name) + ": has tiles of " +
                         std::to_string(exr.tileDescription().xSize) + " x " +
                         std::to_string(exr.tileDescription().ySize) +
                         " pixels, expected at most 4096 a side"};
    header.bands = bands_of(exr.channels());
    if (header.bands == 0)
        return unsupported(name, "found channels " + channel_names(exr.channels()) +
                                     ", expected R, G, B or Y alone, of full size");
    const Imf::PixelType type = exr.channels()[header.bands == 3 ? kColour[0] : "Y"].type;
    if (type == Imf::UINT)
        return unsupported(name, "found integer channels, expected half or float");
    header.bits = type == Imf::HALF ? 16 : 32;
    header.floating_point = true;
    header.format = "OpenEXR";
    return header;
}

Error damaged(std::string_view name, const std::exception& exception) {
    return bad_format(name,
                      std::string("damaged or truncated OpenEXR: ") + exception.what());
}

Result<ImageHeader> read_exr_header(Bytes bytes, std::string_view name) try {
    return describe(first_header(bytes), bytes, name);
} catch (const std::exception& exception) {
    return damaged(name, exception);
}

Imf::Slice slice_of(PlaneView<float> plane, const Imath::V2i& origin) {
    return Imf::Slice::Make(Imf::FLOAT, plane.data, origin,
                            static_cast<std::int64_t>(plane.cols),
                            static_cast<std::int64_t>(plane.rows), sizeof(float),
                            plane.stride * sizeof(float));
}

Result<Image> decode_exr(Bytes bytes, std::string_view name, Encoding encoding) try {
    SATEEN_TRY(const ImageHeader header, read_exr_header(bytes, name));
    MemoryStream stream(bytes);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    Image image(header.bands, header.rows, header.cols);
    Imf::FrameBuffer buffer;
    for (std::size_t band = 0; band < header.bands; ++band)
        buffer.insert(header.bands == 3 ? kColour[band] : "Y",
                      slice_of(image.plane(band), window.min));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    linearise(image.values(), encoding);
    return image;
} catch (const std::exception& exception) {
    return damaged(name, exception);
}

/// Carries an Error of the file through OpenEXR.
struct WriteFailure final : std::exception {
    explicit WriteFailure(Error error_) : error(std::move(error_)) {}
    [[nodiscard]] const char* what() const noexcept override {
        return error.message.c_str();
    }
    Error error;
};

class FileStream final : public Imf::OStream {
  public:
    explicit FileStream(AtomicFile& file) : Imf::OStream("image"), file_(file) {}
    void write(const char* from, int count) override {
        check(file_.write({reinterpret_cast<const std::uint8_t*>(from),
                           static_cast<std::size_t>(count)}));
    }
    std::uint64_t tellp() override { return file_.position(); }
    void seekp(std::uint64_t position) override { check(file_.seek(position)); }
    /// What made a write fail, also where OpenEXR kept silent about it.
    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  private:
    void check(Result<void> result) {
        if (result) return;
        error_ = std::move(result).error();
        throw WriteFailure(*error_);
    }
    AtomicFile& file_;
    std::optional<Error> error_;
};

class ExrWriter final : public ImageWriter {
  public:
    ExrWriter(AtomicFile file, const Shape& shape, const WriteOptions& options)
        : file_(std::move(file)),
          stream_(file_),
          shape_(shape),
          type_(options.bits == 16 ? Imf::HALF : Imf::FLOAT),
          encoding_(options.encoding) {}

    Result<void> begin() {
        return guarded([&] {
            Imf::Header header(static_cast<int>(shape_.cols),
                               static_cast<int>(shape_.rows));
            header.compression() = Imf::ZIP_COMPRESSION;
            for (std::size_t band = 0; band < shape_.bands; ++band)
                header.channels().insert(channel(band), Imf::Channel(type_));
            output_.emplace(stream_, header, 0);
        });
    }

    Result<void> write_rows(ImageView<const float> strip) override {
        SATEEN_CHECK(check_strip(file_.path(), shape_, rows_written_, strip));
        if (type_ == Imf::FLOAT && linear()) {
            SATEEN_CHECK(guarded([&] { put(strip); }));
        } else {
            SATEEN_CHECK(convert_and_put(strip));
        }
        rows_written_ += strip.rows;
        return {};
    }

    Result<void> finish() override {
        if (rows_written_ != shape_.rows)
            return missing_rows(file_.path(), shape_, rows_written_);
        // The destructor writes the table of lines and swallows what goes wrong.
        SATEEN_CHECK(guarded([&] { output_.reset(); }));
        if (stream_.error()) return *stream_.error();
        return file_.commit();
    }

  private:
    [[nodiscard]] const char* channel(std::size_t band) const {
        return shape_.bands == 3 ? kColour[band] : "Y";
    }
    [[nodiscard]] bool linear() const {
        return encoding_ == Encoding::automatic || encoding_ == Encoding::linear;
    }

    template <class F>
    Result<void> guarded(F&& work) try {
        work();
        return {};
    } catch (const WriteFailure& failure) {
        return failure.error;
    } catch (const std::exception& exception) {
        if (stream_.error()) return *stream_.error();
        return Error{Errc::io, file_.path() + ": cannot be written: " + exception.what()};
    }

    /// A few rows at a time, display encoded or as halfs, so that memory stays constant.
    Result<void> convert_and_put(ImageView<const float> strip) {
        constexpr std::size_t kRowsTogether = 16;
        for (std::size_t first = 0; first < strip.rows; first += kRowsTogether) {
            const std::size_t rows = std::min(kRowsTogether, strip.rows - first);
            Image part(shape_.bands, rows, shape_.cols);
            for (std::size_t band = 0; band < shape_.bands; ++band)
                std::copy_n(strip.plane(band).row(first), rows * shape_.cols,
                            part.plane(band).data);
            delinearise(part.values(), encoding_);
            SATEEN_CHECK(guarded([&] { put(std::as_const(part).view(), first); }));
        }
        return {};
    }

    void put(ImageView<const float> strip, std::size_t first = 0) {
        std::vector<half> halfs;
        Imf::FrameBuffer buffer;
        const Imath::V2i origin(0, static_cast<int>(rows_written_ + first));
        const auto cols = static_cast<std::int64_t>(strip.cols);
        const auto rows = static_cast<std::int64_t>(strip.rows);
        const std::size_t sample = type_ == Imf::HALF ? sizeof(half) : sizeof(float);
        if (type_ == Imf::HALF) {
            halfs.assign(strip.data, strip.data + strip.size());
            for (half& value : halfs)
                if (value.isInfinity()) value = value.isNegative() ? -kHalfMax : kHalfMax;
        }
        for (std::size_t band = 0; band < strip.bands; ++band) {
            const void* const data =
                type_ == Imf::HALF
                    ? static_cast<const void*>(halfs.data() + band * strip.plane_size())
                    : static_cast<const void*>(strip.plane(band).data);
            buffer.insert(channel(band), Imf::Slice::Make(type_, data, origin, cols, rows,
                                                          sample, strip.cols * sample));
        }
        output_->setFrameBuffer(buffer);
        output_->writePixels(static_cast<int>(strip.rows));
    }

    static constexpr float kHalfMax = 65504.0F;

    AtomicFile file_;
    FileStream stream_;
    Shape shape_;
    Imf::PixelType type_;
    Encoding encoding_;
    std::optional<Imf::OutputFile> output_;
    std::size_t rows_written_ = 0;
};

}  // namespace

const Format kExrFormat = {"OpenEXR", matches, read_exr_header, decode_exr};

Writer open_exr_writer(AtomicFile file, const Shape& shape, const WriteOptions& options) {
    // 8 is the default of integer formats: the nearest that OpenEXR has is half.
    WriteOptions checked = options;
    if (checked.bits == 8) checked.bits = 16;
    if (checked.bits != 16 && checked.bits != 32)
        return unsupported(file.path(),
                           "OpenEXR holds 16 (half) or 32 bits a sample, asked for " +
                               std::to_string(options.bits));
    auto writer = std::make_unique<ExrWriter>(std::move(file), shape, checked);
    SATEEN_CHECK(writer->begin());
    return std::unique_ptr<ImageWriter>(std::move(writer));
}

}  // namespace sateen::io
