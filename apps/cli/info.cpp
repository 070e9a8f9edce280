// SPDX-License-Identifier: Apache-2.0
// sateen info: what a measurement or a material holds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "console.hpp"
#include "field_names.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/io/open_measurement.hpp"
#include "sateen/material/file.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
    std::string file;
    bool json = false;
    bool skip_bad = false;
};

Json directions_json(const std::vector<Direction>& directions) {
    Json json = Json::array();
    for (const Direction& d : directions) {
        const auto degrees = [](float radians) {
            return std::round(static_cast<double>(radians / kRadiansPerDegree) * 1e4) /
                   1e4;
        };
        json.push_back({degrees(d.theta), degrees(d.phi)});
    }
    return json;
}

Json surface_json(const Surface& surface) {
    std::uint16_t highest = 0;
    for (const auto& tile : surface.tiles)
        for (const std::uint16_t code : tile) highest = std::max(highest, code);
    return {{"tile", fmt::format("{}x{}", surface.cols, surface.rows)},
            {"tiles", surface.tiles.size()},
            {"shear", surface.shear_px},
            {"lowest_px", surface.height_px(0)},
            {"highest_px", surface.height_px(highest)},
            {"delit", surface.delit},
            {"ambient", surface.ambient}};
}

/// Subspaces by light (rows) and view; null where nothing was measured.
Json index_json(const Material& material) {
    Json json(material.lights.size(), Json(material.views.size(), nullptr));
    for (const IndexEntry& entry : material.index)
        json[entry.light][entry.view] = entry.subspace;
    return json;
}

Result<Json> describe_material(const std::string& path) {
    SATEEN_TRY(const auto bytes, read_file(path, kMaxPayloadBytes));
    SATEEN_TRY(const Material material, load_material(path));
    SATEEN_TRY(const auto parts, material_part_bytes(material));
    Json json;
    json["kind"] = "material";
    json["name"] = material.provenance.name;
    json["bytes"] = bytes.size();
    json["source"] = {
        {"layout", material.provenance.source},
        {"checksum", fmt::format("{:016x}", material.provenance.source_checksum)},
        {"options", material.provenance.options},
        {"writer", material.provenance.writer}};
    json["sample_size"] = {material.sample_cols, material.sample_rows};
    json["bands"] = material.bands;
    json["cosine_included"] = material.cosine_included;
    json["pixels_per_mm"] =
        material.pixels_per_mm ? Json(*material.pixels_per_mm) : Json(nullptr);
    json["drawing"] = material.drawing == Drawing::recursive ? "recursive" : "spectral";
    json["views"] = directions_json(material.views);
    json["lights"] = directions_json(material.lights);
    json["measured_pairs"] = material.index.size();
    if (material.lights.size() * material.views.size() <= kMaxPairs)
        json["index"] = index_json(material);
    json["subspaces"] = Json::array();
    for (const Subspace& subspace : material.subspaces) {
        std::size_t coefficients = 0;
        for (const Level& level : subspace.levels)
            for (const FieldModel& field : level.fields)
                coefficients += coefficients_of(field);
        json["subspaces"].push_back({{"field", field_names({&subspace, 1})},
                                     {"members", subspace.members},
                                     {"levels", subspace.levels.size()},
                                     {"coefficients", coefficients}});
    }
    if (material.surface) json["surface"] = surface_json(*material.surface);
    for (const PartBytes& part : parts) json["payload_bytes"][part.part] = part.bytes;
    return json;
}

Result<Json> describe_measurement(const InfoArguments& arguments) {
    const std::vector<std::string> paths = {arguments.file};
    SATEEN_TRY(const std::unique_ptr<Measurement> measurement,
               open_measurement(paths, {.skip_bad = arguments.skip_bad}));
    const MeasurementInfo& info = measurement->info();
    Json json;
    json["kind"] = "measurement";
    json["name"] = info.name;
    json["layout"] = info.layout;
    json["images"] = info.observations.size();
    json["size"] = {info.cols, info.rows};
    json["bands"] = info.bands;
    json["encoding"] = info.radiometry.encoding;
    json["cosine_included"] = info.radiometry.cosine_included;
    json["checksum"] = fmt::format("{:016x}", info.checksum);
    json["views"] = directions_json(info.views);
    json["lights"] = directions_json(info.lights);
    json["missing_pairs"] =
        info.has_directions()
            ? info.views.size() * info.lights.size() - info.observations.size()
            : 0;
    json["skipped"] = info.skipped;
    return json;
}

/// A value on one line: sizes as 256x256, no quotes.
std::string text_of(const std::string& key, const Json& value) {
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (key == "views" || key == "lights") return std::to_string(value.size());
    if (key == "size" || key == "sample_size")
        return fmt::format("{}x{}", value[0].dump(), value[1].dump());
    return value.is_string() ? one_line(value.get<std::string>()) : value.dump();
}

bool says_nothing(const Json& value) {
    return value.is_null() || (value.is_array() && value.empty()) || value == "";
}

void print_entry(const std::string& key, const Json& value) {
    fmt::print("{:<22}{}\n", key, text_of(key, value));
}

void print_text(const Json& json) {
    for (const auto& [key, value] : json.items()) {
        if (says_nothing(value) || key == "index") continue;
        if (key == "subspaces") {
            print_entry(key, value.size());
            for (std::size_t k = 0; k < value.size(); ++k)
                fmt::print("  {:<20}{}, {} images, {} levels, {} coefficients\n", k,
                           value[k]["field"].get<std::string>(),
                           value[k]["members"].dump(), value[k]["levels"].dump(),
                           value[k]["coefficients"].dump());
        } else if (key == "skipped") {
            print_entry(key, value.size());
            for (const Json& line : value) print_entry("", line);
        } else if (value.is_object()) {
            fmt::print("{}\n", key);
            for (const auto& [name, part] : value.items())
                if (!says_nothing(part)) print_entry("  " + name, part);
        } else {
            print_entry(key, value);
        }
    }
}

Result<void> run_info(const InfoArguments& arguments) {
    SATEEN_TRY(const Json json, looks_like_material(arguments.file)
                                    ? describe_material(arguments.file)
                                    : describe_measurement(arguments));
    if (arguments.json)
        print_json(json);
    else
        print_text(json);
    return {};
}

}  // namespace

Verb add_info(CLI::App& program) {
    auto arguments = std::make_shared<InfoArguments>();
    CLI::App* verb =
        program.add_subcommand("info", "Say what a measurement or a material holds");
    verb->add_option("FILE", arguments->file, "A material, or what sateen model takes")
        ->type_name("")
        ->required();
    verb->set_help_flag("-h,--help", "Print this help");
    verb->add_flag("--json", arguments->json, "Print as JSON");
    verb->add_flag("--skip-bad", arguments->skip_bad,
                   "Leave out unreadable images of a measurement and list them");
    return {verb, [arguments] { return run_info(*arguments); }};
}

}  // namespace sateen::cli
