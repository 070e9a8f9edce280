// SPDX-License-Identifier: Apache-2.0
// See find_images.hpp.
#include "io/find_images.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <tuple>

#include "io/light_positions.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::io {
namespace {

/// The directions.csv nearest to the root, if any.
const FileEntry* find_csv(const FileSource& source) {
    const FileEntry* best = nullptr;
    const auto depth = [](const FileEntry& entry) {
        return std::count(entry.name.begin(), entry.name.end(), '/');
    };
    for (const FileEntry& entry : source.entries())
        if (base_name(entry.name) == "directions.csv" &&
            (best == nullptr || depth(entry) < depth(*best)))
            best = &entry;
    return best;
}

/// The light position file that was given, or the only one beside the images.
const FileEntry* find_light_positions(const FileSource& source, const std::string& path) {
    const bool given = ends_like_light_positions(path);
    const std::string name = std::filesystem::path(path).filename().string();
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

Result<FoundImages> find_by_light_positions(const FileSource& source,
                                            const FileEntry& list, Rejects& rejects) {
    const auto& entries = source.entries();
    const auto list_entry = static_cast<std::size_t>(&list - entries.data());
    const std::string name = source.display_name(list_entry);
    SATEEN_TRY(const std::string text, read_list(source, list_entry));
    SATEEN_TRY(LightPositions positions, parse_light_positions(text, name));

    std::map<std::string, std::size_t> by_name;
    std::vector<std::size_t> images;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!has_image_extension(entries[i].name)) continue;
        by_name.emplace(lower_case(base_name(entries[i].name)), i);
        images.push_back(i);
    }
    FoundImages found{"lp", true, {}, {}};
    const auto exists = [&](const LightPosition& light) {
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
        const LightPosition& light = positions.lights[i];
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

Result<FoundImages> find_by_csv(const FileSource& source, const FileEntry& csv,
                                Rejects& rejects) {
    const auto& entries = source.entries();
    const auto csv_entry = static_cast<std::size_t>(&csv - entries.data());
    const std::string csv_name = source.display_name(csv_entry);
    SATEEN_TRY(const std::string text, read_list(source, csv_entry));
    SATEEN_TRY(const std::vector<CsvRow> rows, parse_directions_csv(text, csv_name));

    const std::string folder = csv.name.substr(0, csv.name.find_last_of('/') + 1);
    std::map<std::string, std::size_t> by_name;
    for (std::size_t i = 0; i < entries.size(); ++i) by_name[entries[i].name] = i;
    FoundImages found{"directions.csv", true, {}, {}};
    for (const CsvRow& row : rows) {
        const std::string where = csv_name + ", line " + std::to_string(row.line) + ": ";
        if (!row.problem.empty()) {
            SATEEN_CHECK(rejects.add({Errc::bad_format, where + row.problem}));
            continue;
        }
        std::string file = row.file;
        std::replace(file.begin(), file.end(), '\\', '/');
        file = std::filesystem::path(folder + file).lexically_normal().generic_string();
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

Result<FoundImages> find_by_name(const FileSource& source, const std::string& path,
                                 bool given_one_by_one, Rejects& rejects) {
    std::vector<std::size_t> images;
    std::vector<NamedDirections> names;
    std::array<std::size_t, 3> kinds = {};
    const auto& entries = source.entries();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!given_one_by_one && !has_image_extension(entries[i].name)) continue;
        images.push_back(i);
        names.push_back(parse_directions(entries[i].name));
        ++kinds[static_cast<std::size_t>(names.back().kind)];
    }
    if (images.empty())
        return Error{Errc::io, path + ": found no image among " +
                                   std::to_string(entries.size()) +
                                   " files, expected .jpg, .png, .exr, .tif or .hdr"};

    // Files given one by one are a measurement only if every name says so.
    const std::size_t full = kinds[static_cast<std::size_t>(NameKind::full)];
    const std::size_t none = kinds[static_cast<std::size_t>(NameKind::none)];
    const bool directions = given_one_by_one ? images.size() > 1 && full == images.size()
                                             : none != images.size();
    FoundImages found{directions           ? "ubo2003"
                      : images.size() == 1 ? "photograph"
                                           : "photographs",
                      directions,
                      {},
                      {}};
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (directions && names[i].kind != NameKind::full) {
            const std::string problem =
                names[i].kind == NameKind::partial
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

auto sort_key(const FoundImage& c) {
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

Result<void> sort_and_check_duplicates(const FileSource& source, FoundImages& found,
                                       Rejects& rejects) {
    if (!found.has_directions) return {};
    std::sort(found.images.begin(), found.images.end(),
              [](const FoundImage& a, const FoundImage& b) {
                  return sort_key(a) < sort_key(b);
              });
    std::vector<FoundImage> kept;
    for (const FoundImage& image : found.images) {
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

}  // namespace

Error bad_entry(const FileSource& source, std::size_t entry, const std::string& what) {
    return {Errc::bad_format, source.display_name(entry) + ": " + what};
}

bool ends_like_light_positions(const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    return extension == ".lp" || extension == ".LP";
}

Result<FoundImages> find_images(const FileSource& source, const std::string& path,
                                bool given_one_by_one, Rejects& rejects) {
    const FileEntry* csv = given_one_by_one ? nullptr : find_csv(source);
    const FileEntry* lights =
        given_one_by_one || csv != nullptr ? nullptr : find_light_positions(source, path);
    SATEEN_TRY(FoundImages found,
               csv != nullptr ? find_by_csv(source, *csv, rejects)
               : lights != nullptr
                   ? find_by_light_positions(source, *lights, rejects)
                   : find_by_name(source, path, given_one_by_one, rejects));
    SATEEN_CHECK(sort_and_check_duplicates(source, found, rejects));
    return found;
}

}  // namespace sateen::io
