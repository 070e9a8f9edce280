// SPDX-License-Identifier: Apache-2.0
// From paths to a measurement. See open_measurement.hpp.
#include "sateen/io/open_measurement.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "io/file_source.hpp"
#include "io/find_images.hpp"

namespace sateen {
namespace {

namespace fs = std::filesystem;
using io::bad_entry;
using io::DirectionKey;
using io::FileEntry;
using io::FileSource;
using io::FoundImage;
using io::FoundImages;
using io::Rejects;

bool begins_like_zip(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 4> bytes = {};
    file.read(bytes.data(), bytes.size());
    const std::string_view text(bytes.data(), bytes.size());
    // Of an entry, or of the directory of an empty archive.
    return text == std::string_view("PK\3\4", 4) || text == std::string_view("PK\5\6", 4);
}

bool ends_like_zip(const std::string& path) {
    const std::string extension = fs::path(path).extension().string();
    return extension == ".zip" || extension == ".ZIP";
}

Result<std::unique_ptr<FileSource>> open_source(std::span<const std::string> paths) {
    if (paths.empty())
        return Error{Errc::invalid_argument,
                     "no input: expected a zip, a folder or image files"};
    for (const std::string& path : paths) {
        std::error_code code;
        const fs::file_status status = fs::status(path, code);
        if (status.type() == fs::file_type::not_found)
            return Error{Errc::io, path + ": does not exist"};
        if (code) return Error{Errc::io, path + ": cannot be read: " + code.message()};
        const bool folder = fs::is_directory(status);
        if (!folder && paths.size() == 1 && io::ends_like_light_positions(path)) {
            const fs::path parent = fs::path(path).parent_path();
            return io::open_folder(parent.empty() ? "." : parent.string());
        }
        const bool zip = !folder && (ends_like_zip(path) || begins_like_zip(path));
        if (paths.size() > 1 && (folder || zip))
            return Error{Errc::invalid_argument,
                         path + ": found a " + (folder ? "folder" : "zip") +
                             " among several inputs, expected one zip, one folder, or "
                             "image files"};
        if (folder) return io::open_folder(path);
        if (zip) return io::open_zip(path);
    }
    return io::open_files(paths);
}

std::string material_name(const std::string& path) {
    std::error_code code;
    fs::path whole = fs::absolute(path, code).lexically_normal();
    // "dirs.lp" says nothing: the folder does.
    if (io::ends_like_light_positions(path)) whole = whole.parent_path();
    if (whole.filename().empty()) whole = whole.parent_path();
    return fs::is_directory(whole, code) ? whole.filename().string()
                                         : whole.stem().string();
}

/// FNV-1a of 64 bits.
class Fingerprint {
  public:
    void add(std::span<const std::uint8_t> bytes) {
        for (const std::uint8_t byte : bytes) add_byte(byte);
    }
    void add(const std::string& text) {
        for (const char c : text) add_byte(static_cast<std::uint8_t>(c));
        add_byte(0);
    }
    void add(std::uint64_t number) {
        for (int i = 0; i < 8; ++i)
            add_byte(static_cast<std::uint8_t>(number >> (8 * i)));
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    void add_byte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3U; }
    std::uint64_t value_ = 0xCBF29CE484222325U;
};

std::string encoding_name(Encoding encoding, bool floating_point) {
    if (encoding == Encoding::gamma22) return "gamma 2.2";
    if (encoding == Encoding::linear) return "linear";
    if (encoding == Encoding::srgb) return "srgb";
    return floating_point ? "linear" : "srgb";
}

/// Reads headers: of the first image of a measurement, of all photographs. Leaves out
/// images whose header is bad.
Result<void> read_headers(const FileSource& source, const OpenOptions& options,
                          FoundImages& found, MeasurementInfo& info, Rejects& rejects) {
    Fingerprint fingerprint;
    std::vector<FoundImage> kept;
    for (const FoundImage& image : found.images) {
        const FileEntry& entry = source.entries()[image.entry];
        if (!found.has_directions || kept.empty()) {
            const auto bytes = source.read(image.entry);
            auto header =
                !bytes ? Result<ImageHeader>(bytes.error())
                       : decode_image_header(*bytes, source.display_name(image.entry));
            if (!header) {
                SATEEN_CHECK(rejects.add(std::move(header).error()));
                continue;
            }
            if (kept.empty()) {
                info.rows = header->rows;
                info.cols = header->cols;
                info.radiometry.encoding =
                    encoding_name(options.encoding, header->floating_point);
            }
            info.bands = std::max(info.bands, header->bands);
            if (!found.has_directions) fingerprint.add(*bytes);
        }
        if (found.has_directions) {
            fingerprint.add(entry.name);
            fingerprint.add(entry.bytes);
            fingerprint.add(entry.crc);
        }
        kept.push_back(image);
    }
    found.images = std::move(kept);
    info.checksum = fingerprint.value();
    return {};
}

void number_directions(const FoundImages& found, MeasurementInfo& info) {
    std::set<DirectionKey> lights;
    std::set<DirectionKey> views;
    for (const FoundImage& image : found.images) {
        lights.insert(image.directions.light);
        views.insert(image.directions.view);
    }
    const auto index = [](const std::set<DirectionKey>& keys,
                          std::vector<Direction>& directions) {
        std::map<DirectionKey, std::uint32_t> indices;
        for (const DirectionKey& key : keys) {
            indices.emplace(key, static_cast<std::uint32_t>(directions.size()));
            directions.push_back(key.direction());
        }
        return indices;
    };
    const auto light_index = index(lights, info.lights);
    const auto view_index = index(views, info.views);
    for (std::size_t i = 0; i < found.images.size(); ++i) {
        info.observations[i].light = light_index.at(found.images[i].directions.light);
        info.observations[i].view = view_index.at(found.images[i].directions.view);
    }
}

class FileMeasurement final : public Measurement {
  public:
    FileMeasurement(std::unique_ptr<FileSource> source, std::vector<std::size_t> entries,
                    MeasurementInfo info, Encoding encoding)
        : source_(std::move(source)),
          entries_(std::move(entries)),
          info_(std::move(info)),
          encoding_(encoding) {}

    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }

    [[nodiscard]] Result<Image> read(std::size_t observation) const override {
        const std::size_t entry = entries_.at(observation);
        SATEEN_TRY(const std::vector<std::uint8_t> bytes, source_->read(entry));
        SATEEN_TRY(Image image,
                   decode_image(bytes, source_->display_name(entry), encoding_));
        if (info_.has_directions() &&
            (image.rows() != info_.rows || image.cols() != info_.cols))
            return bad_entry(
                *source_, entry,
                "has " + size_text(image.cols(), image.rows()) + " pixels, expected " +
                    size_text(info_.cols, info_.rows) + " as the first image has");
        if (image.bands() == info_.bands) return image;
        if (image.bands() == 1) return grey_to_colour(image);
        return bad_entry(*source_, entry,
                         "is in colour, expected grey as the first image is");
    }

  private:
    static std::string size_text(std::size_t cols, std::size_t rows) {
        return std::to_string(cols) + " x " + std::to_string(rows);
    }
    static Image grey_to_colour(const Image& grey) {
        Image colour(3, grey.rows(), grey.cols());
        for (std::size_t band = 0; band < 3; ++band)
            std::copy(grey.values().begin(), grey.values().end(),
                      colour.plane(band).data);
        return colour;
    }

    std::unique_ptr<FileSource> source_;
    std::vector<std::size_t> entries_;  ///< of each observation
    MeasurementInfo info_;
    Encoding encoding_;
};

}  // namespace

Result<std::unique_ptr<Measurement>> open_measurement(std::span<const std::string> paths,
                                                      const OpenOptions& options) {
    SATEEN_TRY(std::unique_ptr<FileSource> source, open_source(paths));
    std::error_code code;
    const std::string& path = paths.front();
    const bool is_list = source->entries().size() == paths.size() &&
                         source->entries().front().name == path;

    Rejects rejects(options.skip_bad);
    SATEEN_TRY(FoundImages found, io::find_images(*source, path, is_list, rejects));
    MeasurementInfo info;
    SATEEN_CHECK(read_headers(*source, options, found, info, rejects));
    if (found.images.empty())
        return Error{Errc::bad_format, path +
                                           ": found no usable image, the first left "
                                           "out because " +
                                           rejects.lines().front()};

    info.name = material_name(path);
    info.layout = found.layout;
    info.skipped = rejects.lines();
    info.skipped.insert(info.skipped.end(), found.notes.begin(), found.notes.end());
    std::vector<std::size_t> entries;
    for (const FoundImage& image : found.images) {
        entries.push_back(image.entry);
        info.observations.push_back({Observation::kUnknown, Observation::kUnknown,
                                     source->entries()[image.entry].name});
    }
    if (found.has_directions) number_directions(found, info);
    return std::unique_ptr<Measurement>(std::make_unique<FileMeasurement>(
        std::move(source), std::move(entries), std::move(info), options.encoding));
}

}  // namespace sateen
