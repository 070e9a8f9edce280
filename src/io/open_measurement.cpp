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
#include <tuple>
#include <utility>

#include "io/direction_names.hpp"
#include "io/file_source.hpp"
#include "io/light_positions.hpp"

namespace sateen {
namespace {

namespace fs = std::filesystem;
using io::DirectionKey;
using io::DirectionPair;
using io::FileEntry;
using io::FileSource;

/// Errors that end the opening or, with skip_bad, are listed.
class Rejects {
  public:
    explicit Rejects(bool skip_bad) : skip_bad_(skip_bad) {}
    [[nodiscard]] Result<void> add(Error error) {
        if (!skip_bad_) return error;
        lines_.push_back(std::move(error.message));
        return {};
    }
    [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

  private:
    bool skip_bad_;
    std::vector<std::string> lines_;
};

/// An image found, before anything of it is read.
struct Candidate {
    std::size_t entry = 0;
    DirectionPair directions;
};

struct Found {
    std::string layout;
    bool has_directions = false;
    std::vector<Candidate> images;
    std::vector<std::string> notes;
};

Error bad_entry(const FileSource& source, std::size_t entry, const std::string& what) {
    return {Errc::bad_format, source.display_name(entry) + ": " + what};
}

// --- which source ---------------------------------------------------------------------

bool begins_like_zip(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 4> bytes = {};
    file.read(bytes.data(), bytes.size());
    const std::string_view text(bytes.data(), bytes.size());
    // Of an entry, or of the directory of an empty archive.
    return text == std::string_view("PK\3\4", 4) || text == std::string_view("PK\5\6", 4);
}

bool ends_like_light_positions(const std::string& path) {
    const std::string extension = fs::path(path).extension().string();
    return extension == ".lp" || extension == ".LP";
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
        if (!folder && paths.size() == 1 && ends_like_light_positions(path)) {
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
    if (ends_like_light_positions(path)) whole = whole.parent_path();
    if (whole.filename().empty()) whole = whole.parent_path();
    return fs::is_directory(whole, code) ? whole.filename().string()
                                         : whole.stem().string();
}

// --- which images, and their directions -----------------------------------------------

/// The directions.csv nearest to the root, if any.
const FileEntry* find_csv(const FileSource& source) {
    const FileEntry* best = nullptr;
    const auto depth = [](const FileEntry& entry) {
        return std::count(entry.name.begin(), entry.name.end(), '/');
    };
    for (const FileEntry& entry : source.entries())
        if (io::base_name(entry.name) == "directions.csv" &&
            (best == nullptr || depth(entry) < depth(*best)))
            best = &entry;
    return best;
}

/// The light position file that was given, or the only one beside the images.
const FileEntry* find_light_positions(const FileSource& source, const std::string& path) {
    const bool given = ends_like_light_positions(path);
    const std::string name = fs::path(path).filename().string();
    const FileEntry* found = nullptr;
    for (const FileEntry& entry : source.entries()) {
        if (given ? entry.name != name
                  : entry.name.find('/') != std::string::npos ||
                        !ends_like_light_positions(entry.name))
            continue;
        if (found != nullptr) return nullptr;
        found = &entry;
    }
    return found;
}

Result<std::string> read_list(const FileSource& source, std::size_t entry) {
    constexpr std::uint64_t kMaxListBytes = std::uint64_t{1} << 26;
    const std::uint64_t size = source.entries()[entry].bytes;
    if (size > kMaxListBytes)
        return Error{Errc::limit_exceeded,
                     source.display_name(entry) + ": has " + std::to_string(size) +
                         " bytes, expected at most " + std::to_string(kMaxListBytes)};
    SATEEN_TRY(const std::vector<std::uint8_t> bytes, source.read(entry));
    return std::string(bytes.begin(), bytes.end());
}

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

Result<Found> find_by_light_positions(const FileSource& source, const FileEntry& list,
                                      Rejects& rejects) {
    const auto& entries = source.entries();
    const auto list_entry = static_cast<std::size_t>(&list - entries.data());
    const std::string name = source.display_name(list_entry);
    SATEEN_TRY(const std::string text, read_list(source, list_entry));
    SATEEN_TRY(io::LightPositions positions, io::parse_light_positions(text, name));

    std::map<std::string, std::size_t> by_name;
    std::vector<std::size_t> images;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!io::has_image_extension(entries[i].name)) continue;
        by_name.emplace(lower_case(io::base_name(entries[i].name)), i);
        images.push_back(i);
    }
    Found found{"lp", true, {}, {}};
    const auto exists = [&](const io::LightPosition& light) {
        return by_name.contains(lower_case(light.file));
    };
    // Renamed or converted since: as many files as lines, in the same order.
    const bool by_order =
        images.size() == positions.lights.size() &&
        std::none_of(positions.lights.begin(), positions.lights.end(), exists);
    if (by_order)
        found.notes.push_back(name + ": none of its files exists; took the " +
                              std::to_string(images.size()) + " images in order of name");
    for (std::size_t i = 0; i < positions.lights.size(); ++i) {
        const io::LightPosition& light = positions.lights[i];
        const std::string where = name + ", line " + std::to_string(light.line) + ": ";
        if (!light.problem.empty()) {
            SATEEN_CHECK(rejects.add({Errc::bad_format, where + light.problem}));
            continue;
        }
        if (!by_order && !exists(light)) {
            SATEEN_CHECK(rejects.add(
                {Errc::io, where + "lists '" + light.file + "', which does not exist"}));
            continue;
        }
        const std::size_t entry =
            by_order ? images[i] : by_name.at(lower_case(light.file));
        found.images.push_back({entry, {light.direction, DirectionKey{}}});
    }
    if (!positions.note.empty()) found.notes.push_back(std::move(positions.note));
    return found;
}

Result<Found> find_by_csv(const FileSource& source, const FileEntry& csv,
                          Rejects& rejects) {
    const auto& entries = source.entries();
    const auto csv_entry = static_cast<std::size_t>(&csv - entries.data());
    const std::string csv_name = source.display_name(csv_entry);
    SATEEN_TRY(const std::string text, read_list(source, csv_entry));
    SATEEN_TRY(const std::vector<io::CsvRow> rows,
               io::parse_directions_csv(text, csv_name));

    const std::string folder = csv.name.substr(0, csv.name.find_last_of('/') + 1);
    std::map<std::string, std::size_t> by_name;
    for (std::size_t i = 0; i < entries.size(); ++i) by_name[entries[i].name] = i;
    Found found{"directions.csv", true, {}, {}};
    for (const io::CsvRow& row : rows) {
        const std::string where = csv_name + ", line " + std::to_string(row.line) + ": ";
        if (!row.problem.empty()) {
            SATEEN_CHECK(rejects.add({Errc::bad_format, where + row.problem}));
            continue;
        }
        std::string file = row.file;
        std::replace(file.begin(), file.end(), '\\', '/');
        file = fs::path(folder + file).lexically_normal().generic_string();
        const auto entry = by_name.find(file);
        if (entry == by_name.end()) {
            SATEEN_CHECK(rejects.add(
                {Errc::io, where + "lists '" + row.file + "', which does not exist"}));
            continue;
        }
        found.images.push_back({entry->second, row.directions});
    }
    if (found.images.empty() && rejects.lines().empty())
        return Error{Errc::bad_format, csv_name + ": lists no image"};
    return found;
}

Result<Found> find_by_name(const FileSource& source, const std::string& path,
                           bool given_one_by_one, Rejects& rejects) {
    std::vector<std::size_t> images;
    std::vector<io::NamedDirections> names;
    std::array<std::size_t, 3> kinds = {};
    const auto& entries = source.entries();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!given_one_by_one && !io::has_image_extension(entries[i].name)) continue;
        images.push_back(i);
        names.push_back(io::parse_directions(entries[i].name));
        ++kinds[static_cast<std::size_t>(names.back().kind)];
    }
    if (images.empty())
        return Error{Errc::io, path + ": found no image among " +
                                   std::to_string(entries.size()) +
                                   " files, expected .jpg, .png, .exr, .tif or .hdr"};

    // Files given one by one are a measurement only if every name says so.
    const std::size_t full = kinds[static_cast<std::size_t>(io::NameKind::full)];
    const std::size_t none = kinds[static_cast<std::size_t>(io::NameKind::none)];
    const bool directions = given_one_by_one ? images.size() > 1 && full == images.size()
                                             : none != images.size();
    Found found{directions           ? "ubo2003"
                : images.size() == 1 ? "photograph"
                                     : "photographs",
                directions,
                {},
                {}};
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (directions && names[i].kind != io::NameKind::full) {
            const std::string problem =
                names[i].kind == io::NameKind::partial
                    ? names[i].problem
                    : "found no directions in the name, expected a name like "
                      "'tl015 pl060 tv030 pv000'";
            SATEEN_CHECK(rejects.add(bad_entry(source, images[i], problem)));
            continue;
        }
        found.images.push_back({images[i], names[i].directions});
    }
    return found;
}

// --- in order, without duplicates -----------------------------------------------------

auto sort_key(const Candidate& c) {
    return std::tie(c.directions.light, c.directions.view, c.entry);
}

std::string in_degrees(DirectionKey key) {
    const auto text = [](std::int32_t units) {
        std::string digits = std::to_string(units / 10000);
        if (units % 10000 == 0) return digits;
        std::string decimals = std::to_string(10000 + units % 10000).substr(1);
        decimals.erase(decimals.find_last_not_of('0') + 1);
        return digits + "." + decimals;
    };
    return text(key.theta) + "," + text(key.phi);
}

Result<void> sort_and_check_duplicates(const FileSource& source, Found& found,
                                       Rejects& rejects) {
    if (!found.has_directions) return {};
    std::sort(
        found.images.begin(), found.images.end(),
        [](const Candidate& a, const Candidate& b) { return sort_key(a) < sort_key(b); });
    std::vector<Candidate> kept;
    for (const Candidate& image : found.images) {
        const DirectionPair& d = image.directions;
        if (!kept.empty() && kept.back().directions.light == d.light &&
            kept.back().directions.view == d.view) {
            SATEEN_CHECK(rejects.add(bad_entry(
                source, image.entry,
                "has light " + in_degrees(d.light) + " and view " + in_degrees(d.view) +
                    " as " + source.entries()[kept.back().entry].name +
                    " has already, expected each pair once")));
            continue;
        }
        kept.push_back(image);
    }
    found.images = std::move(kept);
    return {};
}

// --- headers --------------------------------------------------------------------------

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
                          Found& found, MeasurementInfo& info, Rejects& rejects) {
    Fingerprint fingerprint;
    std::vector<Candidate> kept;
    for (const Candidate& image : found.images) {
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

// --- the measurement ------------------------------------------------------------------

void number_directions(const Found& found, MeasurementInfo& info) {
    std::set<DirectionKey> lights;
    std::set<DirectionKey> views;
    for (const Candidate& image : found.images) {
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
    const FileEntry* csv = is_list ? nullptr : find_csv(*source);
    const FileEntry* lights =
        is_list || csv != nullptr ? nullptr : find_light_positions(*source, path);
    SATEEN_TRY(Found found, csv != nullptr ? find_by_csv(*source, *csv, rejects)
                            : lights != nullptr
                                ? find_by_light_positions(*source, *lights, rejects)
                                : find_by_name(*source, path, is_list, rejects));
    SATEEN_CHECK(sort_and_check_duplicates(*source, found, rejects));
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
    for (const Candidate& image : found.images) {
        entries.push_back(image.entry);
        info.observations.push_back({Observation::kUnknown, Observation::kUnknown,
                                     source->entries()[image.entry].name});
    }
    if (found.has_directions) number_directions(found, info);
    return std::unique_ptr<Measurement>(std::make_unique<FileMeasurement>(
        std::move(source), std::move(entries), std::move(info), options.encoding));
}

}  // namespace sateen
