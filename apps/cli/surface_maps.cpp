// SPDX-License-Identifier: Apache-2.0
#include "surface_maps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "base_colour.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/atomic_folder.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/synthesis/surface.hpp"
#include "sateen/synthesis/synthesise_direction.hpp"

namespace sateen::cli {

Result<void> make_folder(const std::string& path) {
    std::error_code failure;
    if (std::filesystem::exists(path, failure) &&
        !std::filesystem::is_directory(path, failure))
        return Error{Errc::io, path + ": is a file, expected a folder"};
    std::filesystem::create_directories(path, failure);
    if (failure)
        return Error{Errc::io, fmt::format("{}: cannot create the folder: {}", path,
                                           failure.message())};
    return {};
}

namespace {

/// Images and what they mean, into a folder that appears as a whole.
class MapFolder {
  public:
    static Result<MapFolder> create(const std::string& path, Executor& executor) {
        SATEEN_TRY(AtomicFolder folder, AtomicFolder::create(path));
        return MapFolder(std::move(folder), executor);
    }

    Result<void> write(const std::string& name, const Image& image, int bits,
                       Encoding encoding) {
        WriteOptions options;
        options.bits = bits;
        options.encoding = encoding;
        options.executor = executor_;
        return write_image(take(name), image.view(), options);
    }

    Result<void> write_height(const Image& height_px, std::optional<float> pixels_per_mm,
                              nlohmann::ordered_json& json) {
        const auto [low, high] =
            std::minmax_element(height_px.values().begin(), height_px.values().end());
        const float range = *high - *low;
        Image height = height_px;
        for (float& z : height.values()) z = range > 0 ? (z - *low) / range : 0.5F;
        json["height"] = {{"file", "height.png"},
                          {"unit", "pixels of these maps"},
                          {"lowest_px", *low},
                          {"highest_px", *high},
                          {"encoding", "linear: 0 the lowest point, 65535 the highest"}};
        if (pixels_per_mm) {
            json["height"]["lowest_mm"] = *low / *pixels_per_mm;
            json["height"]["highest_mm"] = *high / *pixels_per_mm;
            json["pixels_per_mm"] = *pixels_per_mm;
        }
        return write("height.png", height, 16, Encoding::linear);
    }

    Result<void> write_normals(Image normals, nlohmann::ordered_json& json) {
        for (float& n : normals.values()) n = 0.5F * (n + 1);
        json["normal"] = {{"file", "normal.png"},
                          {"encoding", "linear: (n + 1) / 2; x right, y up, z out"}};
        return write("normal.png", normals, 16, Encoding::linear);
    }

    Result<std::vector<std::string>> commit(const nlohmann::ordered_json& json) {
        const std::string text = json.dump(2) + "\n";
        SATEEN_CHECK(write_file(take("maps.json"),
                                std::vector<std::uint8_t>(text.begin(), text.end())));
        SATEEN_CHECK(folder_.commit());
        return std::move(written_);
    }

  private:
    MapFolder(AtomicFolder folder, Executor& executor)
        : folder_(std::move(folder)), executor_(&executor) {}
    /// The path to write to.
    std::string take(const std::string& name) {
        written_.push_back((std::filesystem::path(folder_.path()) / name).string());
        return (std::filesystem::path(folder_.temporary_path()) / name).string();
    }

    AtomicFolder folder_;
    Executor* executor_;
    std::vector<std::string> written_;
};

/// What a view from above sees under a light, on the torus of the maps.
Result<Image> draw_relit(const Material& material, Direction light,
                         const SynthesisOptions& options, Executor& executor,
                         Progress& progress) {
    SATEEN_TRY(const LitBlend lit, lit_blend(material, {}, light, {}, executor));
    return synthesise(material, lit, options, executor, progress);
}

}  // namespace

Result<std::vector<std::string>> write_maps(const std::string& folder,
                                            const RangeMap& range,
                                            std::optional<float> pixels_per_mm,
                                            Executor& executor) {
    SATEEN_TRY(MapFolder maps, MapFolder::create(folder, executor));
    nlohmann::ordered_json json;
    SATEEN_CHECK(maps.write_height(range.height_px, pixels_per_mm, json));
    SATEEN_CHECK(maps.write_normals(range.normals, json));
    SATEEN_CHECK(maps.write("albedo.png", range.albedo, 8, Encoding::srgb));
    json["colour"] = {{"file", "albedo.png"}, {"encoding", "sRGB"}};
    if (range.method == SurfaceMethod::shading)
        json["light"] = {{"theta", range.light.theta / kRadiansPerDegree},
                         {"phi", range.light.phi / kRadiansPerDegree},
                         {"estimated", range.light_estimated}};
    return maps.commit(json);
}

Result<std::vector<std::string>> draw_maps(const std::string& folder,
                                           const Material& material,
                                           SynthesisOptions options,
                                           std::optional<Direction> light,
                                           Executor& executor, Progress& progress) {
    options.tileable = true;
    SATEEN_TRY(MapFolder maps, MapFolder::create(folder, executor));
    nlohmann::ordered_json json;
    SATEEN_TRY(const Image colour,
               draw_base_colour(material, options, executor, progress));
    SATEEN_CHECK(maps.write("base_colour.png", colour, 8, Encoding::srgb));
    const bool delit = material.surface && material.surface->delit;
    json["colour"] = {
        {"file", "base_colour.png"}, {"encoding", "sRGB"}, {"delit", delit}};
    Image height(1, options.rows, options.cols);
    if (material.surface) {
        SATEEN_TRY(ToroidalRange range,
                   draw_toroidal_range(*material.surface, options.rows, options.cols,
                                       options.seed));
        height = std::move(range.height_px);
    }
    SATEEN_CHECK(maps.write_height(height, material.pixels_per_mm, json));
    SATEEN_CHECK(maps.write_normals(normals_of(height.plane(0), Border::wraps), json));
    if (light) {
        SATEEN_TRY(const Image relit,
                   draw_relit(material, *light, options, executor, progress));
        SATEEN_CHECK(maps.write("relit.png", relit, 8, Encoding::srgb));
        json["relit"] = {
            {"file", "relit.png"},
            {"encoding", "sRGB"},
            {"light",
             {light->theta / kRadiansPerDegree, light->phi / kRadiansPerDegree}}};
    }
    return maps.commit(json);
}

}  // namespace sateen::cli
