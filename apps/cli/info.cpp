// SPDX-License-Identifier: Apache-2.0
// sateen info: what a measurement or a material holds.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.hpp"
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

/// Materials are gzip files, which no measurement is.
bool looks_like_material(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return file.get() == 0x1F && file.get() == 0x8B;
}

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
    json["subspaces"] = Json::array();
    for (const Subspace& subspace : material.subspaces) {
        std::size_t coefficients = 0;
        for (const Level& level : subspace.levels)
            for (const FieldModel& field : level.fields)
                coefficients += std::get<Car2d>(field).a.size();
        json["subspaces"].push_back({{"field", "car2d"},
                                     {"members", subspace.members},
                                     {"levels", subspace.levels.size()},
                                     {"coefficients", coefficients}});
    }
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
    json["complete"] =
        info.observations.size() == info.views.size() * info.lights.size() ||
        !info.has_directions();
    json["skipped"] = info.skipped;
    return json;
}

void print_text(const Json& json) {
    for (const auto& [key, value] : json.items()) {
        const bool directions = key == "views" || key == "lights";
        if (directions)
            fmt::print("{:<16} {} directions\n", key, value.size());
        else if (key == "subspaces") {
            fmt::print("{:<16} {}\n", key, value.size());
            for (std::size_t k = 0; k < value.size(); ++k)
                fmt::print("{:>16} {} images, {} levels, {} coefficients\n", k,
                           value[k]["members"].dump(), value[k]["levels"].dump(),
                           value[k]["coefficients"].dump());
        } else if (value.is_object()) {
            fmt::print("{}\n", key);
            for (const auto& [name, part] : value.items())
                fmt::print("{:>16} {}\n", name,
                           part.is_string() ? part.get<std::string>() : part.dump());
        } else {
            fmt::print("{:<16} {}\n", key,
                       value.is_string() ? value.get<std::string>() : value.dump());
        }
    }
}

Result<void> run_info(const InfoArguments& arguments) {
    SATEEN_TRY(const Json json, looks_like_material(arguments.file)
                                    ? describe_material(arguments.file)
                                    : describe_measurement(arguments));
    if (arguments.json)
        fmt::print("{}\n", json.dump(2));
    else
        print_text(json);
    return {};
}

}  // namespace

Verb add_info(CLI::App& program) {
    auto arguments = std::make_shared<InfoArguments>();
    CLI::App* verb =
        program.add_subcommand("info", "Say what a measurement or a material holds");
    verb->add_option("file", arguments->file, "A measurement or a material")->required();
    verb->add_flag("--json", arguments->json, "Print as JSON");
    verb->add_flag("--skip-bad", arguments->skip_bad,
                   "Leave out unreadable images of a measurement and list them");
    return {verb, [arguments] { return run_info(*arguments); }};
}

}  // namespace sateen::cli
