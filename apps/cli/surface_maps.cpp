// SPDX-License-Identifier: Apache-2.0
#include "surface_maps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "sateen/io/atomic_file.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/synthesis/surface.hpp"

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

Result<std::vector<std::string>> write_maps(const std::string& folder,
                                            const Image& height_px, const Image& normals,
                                            const Image& colour,
                                            const std::string& colour_name,
                                            std::optional<float> pixels_per_mm,
                                            Executor& executor) {
    SATEEN_CHECK(make_folder(folder));
    std::vector<std::string> written;
    const auto path_of = [&](const std::string& name) {
        return (std::filesystem::path(folder) / name).string();
    };
    const auto write = [&](const std::string& name, const Image& image, int bits,
                           Encoding encoding) -> Result<void> {
        WriteOptions options;
        options.bits = bits;
        options.encoding = encoding;
        options.executor = &executor;
        written.push_back(path_of(name));
        return write_image(written.back(), image.view(), options);
    };
    const auto [low, high] =
        std::minmax_element(height_px.values().begin(), height_px.values().end());
    const float range = *high - *low;
    Image height = height_px;
    for (float& z : height.values()) z = range > 0 ? (z - *low) / range : 0.5F;
    Image normal = normals;
    for (float& n : normal.values()) n = 0.5F * (n + 1);
    SATEEN_CHECK(write("height.png", height, 16, Encoding::linear));
    SATEEN_CHECK(write("normal.png", normal, 16, Encoding::linear));
    SATEEN_CHECK(write(colour_name, colour, 8, Encoding::srgb));

    nlohmann::ordered_json json;
    json["height"] = {{"file", "height.png"},
                      {"lowest_px", *low},
                      {"highest_px", *high},
                      {"encoding", "linear: 0 the lowest point, 65535 the highest"}};
    if (pixels_per_mm) {
        json["height"]["lowest_mm"] = *low / *pixels_per_mm;
        json["height"]["highest_mm"] = *high / *pixels_per_mm;
        json["pixels_per_mm"] = *pixels_per_mm;
    }
    json["normal"] = {{"file", "normal.png"},
                      {"encoding", "linear: (n + 1) / 2; x right, y up, z out"}};
    json["colour"] = {{"file", colour_name}, {"encoding", "sRGB"}};
    const std::string text = json.dump(2) + "\n";
    written.push_back(path_of("maps.json"));
    SATEEN_CHECK(
        write_file(written.back(), std::vector<std::uint8_t>(text.begin(), text.end())));
    return written;
}

Result<std::vector<std::string>> draw_maps(const std::string& folder,
                                           const Material& material,
                                           SynthesisOptions options, Executor& executor,
                                           Progress& progress) {
    options.tileable = true;
    SATEEN_TRY(const Image colour,
               synthesise(material, nearest_subspace(material, {}, {}), options, executor,
                          progress));
    Image height(1, options.rows, options.cols);
    if (material.surface) {
        SATEEN_TRY(ToroidalRange range,
                   draw_toroidal_range(*material.surface, options.rows, options.cols,
                                       options.seed));
        height = std::move(range.height_px);
    }
    const Image normals = normals_of(height.plane(0), Border::wraps);
    return write_maps(folder, height, normals, colour, "base_colour.png",
                      material.pixels_per_mm, executor);
}

}  // namespace sateen::cli
