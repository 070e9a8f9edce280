// SPDX-License-Identifier: Apache-2.0
// Measurements to zips and folders. See measurement_writer.hpp.
#include "sateen/io/measurement_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/direction_names.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/zip_writer.hpp"

namespace sateen {
namespace {

namespace fs = std::filesystem;
constexpr const char* kManifest = "measurement.json";
constexpr const char* kDirections = "directions.csv";

template <class... Numbers>
std::string formatted(const char* format, Numbers... numbers) {
    char text[128] = {};
    std::snprintf(text, sizeof text, format, numbers...);
    return text;
}

/// Angles as files state them, to 1e-4 degree.
double degrees(float radians) {
    return std::round(static_cast<double>(radians / kRadiansPerDegree) * 1e4) / 1e4;
}

bool whole(float radians) {
    return degrees(radians) == std::round(degrees(radians));
}

bool all_whole(const std::vector<Direction>& directions) {
    return std::all_of(directions.begin(), directions.end(),
                       [](const Direction& d) { return whole(d.theta) && whole(d.phi); });
}

int whole_degrees(float radians) {
    return static_cast<int>(std::lround(degrees(radians)));
}

bool is_zip(const std::string& path) {
    const std::string extension = fs::path(path).extension().string();
    return extension == ".zip" || extension == ".ZIP";
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Error io_failure(const std::string& path, const std::error_code& code) {
    return {Errc::io, path + ": cannot be written: " + code.message()};
}

Result<void> make_folders(const fs::path& path) {
    std::error_code code;
    fs::create_directories(path, code);
    if (code) return io_failure(path.string(), code);
    return {};
}

/// Files being written when an earlier writer was killed.
void remove_unfinished(const std::string& folder) {
    std::vector<fs::path> unfinished;
    std::error_code code;
    for (const auto& entry : fs::recursive_directory_iterator(folder, code))
        if (entry.path().filename().string().starts_with('.'))
            unfinished.push_back(entry.path());
    for (const fs::path& path : unfinished) fs::remove(path, code);
}

Result<void> check_same_manifest(const std::string& path, const std::string& manifest) {
    constexpr std::size_t kMaxManifestBytes = std::size_t{1} << 24;
    SATEEN_TRY(const auto earlier, read_file(path, kMaxManifestBytes));
    if (std::string_view(reinterpret_cast<const char*>(earlier.data()), earlier.size()) ==
        manifest)
        return {};
    return Error{Errc::invalid_argument,
                 path +
                     ": was made with other options, expected the same to go on; "
                     "remove its folder to begin anew"};
}

}  // namespace

DirectionPlan DirectionPlan::product(std::vector<Direction> from,
                                     std::vector<Direction> under) {
    DirectionPlan plan{std::move(from), std::move(under), {}};
    std::vector<std::size_t> all(plan.lights.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    plan.lights_of_view.assign(plan.views.size(), all);
    return plan;
}

std::size_t DirectionPlan::pairs() const {
    std::size_t count = 0;
    for (const auto& of_view : lights_of_view) count += of_view.size();
    return count;
}

Result<DirectionPlan> read_direction_plan(const std::string& path) {
    constexpr std::size_t kMaxBytes = std::size_t{1} << 26;
    SATEEN_TRY(const auto bytes, read_file(path, kMaxBytes));
    const std::string text(bytes.begin(), bytes.end());
    const auto problem_of = [&](std::size_t line, const std::string& problem) {
        return Error{Errc::bad_format,
                     path + ", line " + std::to_string(line) + ": " + problem};
    };
    std::set<io::DirectionKey> views;
    std::set<io::DirectionKey> lights;
    std::set<std::pair<io::DirectionKey, io::DirectionKey>> pairs;
    SATEEN_TRY(const auto rows, io::parse_direction_pairs(text, path));
    for (const io::CsvRow& row : rows) {
        if (!row.problem.empty()) return problem_of(row.line, row.problem);
        views.insert(row.directions.view);
        lights.insert(row.directions.light);
        if (!pairs.emplace(row.directions.view, row.directions.light).second)
            return problem_of(row.line, "found a pair of directions for the second time");
    }
    if (rows.empty()) return Error{Errc::bad_format, path + ": lists no direction"};
    DirectionPlan plan;
    std::map<io::DirectionKey, std::size_t> light_index;
    for (const io::DirectionKey& key : lights) {
        light_index.emplace(key, plan.lights.size());
        plan.lights.push_back(key.direction());
    }
    for (const io::DirectionKey& key : views) {
        plan.views.push_back(key.direction());
        plan.lights_of_view.emplace_back();
        for (auto pair = pairs.lower_bound({key, {}});
             pair != pairs.end() && pair->first == key; ++pair)
            plan.lights_of_view.back().push_back(light_index.at(pair->second));
    }
    return plan;
}

Result<MeasurementWriter> MeasurementWriter::create(const std::string& path,
                                                    DirectionPlan plan,
                                                    MeasurementFormat format,
                                                    const std::string& manifest,
                                                    bool resume) {
    MeasurementWriter writer;
    writer.path_ = path;
    while (writer.path_.size() > 1 && writer.path_.back() == '/') writer.path_.pop_back();
    writer.work_ = writer.path_ + ".partial";
    writer.plan_ = std::move(plan);
    writer.format_ = std::move(format);
    writer.named_ = all_whole(writer.plan_.views) && all_whole(writer.plan_.lights);

    std::error_code code;
    const bool folder = fs::is_directory(writer.path_, code);
    if (is_zip(writer.path_) && folder)
        return Error{Errc::io, writer.path_ + ": is a folder, expected a zip to write"};
    if (!is_zip(writer.path_) && fs::exists(writer.path_, code) &&
        !(folder && fs::is_empty(writer.path_, code)))
        return Error{Errc::io, writer.path_ +
                                   ": is there already, expected a new or an empty "
                                   "folder, or a name ending in .zip"};
    const std::string stated = (fs::path(writer.work_) / kManifest).string();
    if (resume && fs::exists(stated, code)) {
        SATEEN_CHECK(check_same_manifest(stated, manifest));
        remove_unfinished(writer.work_);
        return writer;
    }
    fs::remove_all(writer.work_, code);
    if (code) return io_failure(writer.work_, code);
    SATEEN_CHECK(make_folders(writer.work_));
    for (std::size_t view = 0; view < writer.plan_.views.size(); ++view)
        SATEEN_CHECK(make_folders(
            (fs::path(writer.work_) / writer.name_of(view, 0)).parent_path()));
    SATEEN_CHECK(write_file(stated, bytes_of(manifest)));
    return writer;
}

std::string MeasurementWriter::name_of(std::size_t view, std::size_t light) const {
    const std::size_t number = light * plan_.views.size() + view;
    if (!named_) return formatted("images/%06zu.", number) + format_.extension;
    const Direction& v = plan_.views[view];
    const Direction& l = plan_.lights[light];
    const int tv = whole_degrees(v.theta);
    const int pv = whole_degrees(v.phi);
    return formatted("tv%03d_pv%03d/%05zu tl%03d pl%03d tv%03d pv%03d.", tv, pv, number,
                     whole_degrees(l.theta), whole_degrees(l.phi), tv, pv) +
           format_.extension;
}

bool MeasurementWriter::has(std::size_t view, std::size_t light) const {
    std::error_code code;
    return fs::exists(fs::path(work_) / name_of(view, light), code);
}

Result<void> MeasurementWriter::add(std::size_t view, std::size_t light,
                                    const Image& image) const {
    return write_image((fs::path(work_) / name_of(view, light)).string(), image.view(),
                       format_.options);
}

Result<void> MeasurementWriter::write_directions() const {
    std::string text = "file,theta_i,phi_i,theta_v,phi_v\n";
    for (std::size_t view = 0; view < plan_.views.size(); ++view)
        for (const std::size_t light : plan_.lights_of_view[view])
            text += name_of(view, light) + formatted(",%.10g,%.10g,%.10g,%.10g\n",
                                                     degrees(plan_.lights[light].theta),
                                                     degrees(plan_.lights[light].phi),
                                                     degrees(plan_.views[view].theta),
                                                     degrees(plan_.views[view].phi));
    return write_file((fs::path(work_) / kDirections).string(), bytes_of(text));
}

Result<void> MeasurementWriter::finish(Progress& progress) {
    if (!named_) SATEEN_CHECK(write_directions());
    std::error_code code;
    if (!is_zip(path_)) {
        // An empty folder gives way.
        fs::remove(path_, code);
        fs::rename(work_, path_, code);
        if (code) return io_failure(path_, code);
        return {};
    }
    std::vector<std::string> names = {kManifest};
    if (!named_) names.emplace_back(kDirections);
    for (std::size_t view = 0; view < plan_.views.size(); ++view)
        for (const std::size_t light : plan_.lights_of_view[view])
            names.push_back(name_of(view, light));
    const std::string root = fs::path(path_).stem().string() + "/";
    std::vector<ZipMember> members;
    for (const std::string& name : names)
        members.push_back({root + name, (fs::path(work_) / name).string()});
    SATEEN_CHECK(write_zip(path_, members, progress));
    fs::remove_all(work_, code);
    return {};
}

}  // namespace sateen
