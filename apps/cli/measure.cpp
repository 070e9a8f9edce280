// SPDX-License-Identifier: Apache-2.0
// sateen measure: a virtual measurement of a surface with known truth.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "console.hpp"
#include "sateen/goniometer/directions.hpp"
#include "sateen/goniometer/goniometer.hpp"
#include "sateen/goniometer/preset.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/measurement_writer.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Texels of a surface for each pixel of an image, along a side.
constexpr std::size_t kTexelsPerPixel = 2;
/// Relief of maps that come without --height-scale, as a share of the width.
constexpr float kDefaultRelief = 0.05F;

struct MeasureArguments {
    CommonArguments common;
    std::string preset;
    std::string height;
    std::string colour;
    std::string normal;
    std::string roughness;
    std::string output;
    std::string directions = "ubo2003";
    std::string size = "128";
    std::string format = "jpg";
    std::size_t samples = 2;
    std::size_t gather_rays = 64;
    int quality = 90;
    float exposure = 1;
    float f0 = 0.04F;
    float height_scale = 0;
    bool lambert = false;
    bool no_shadows = false;
    bool resume = false;

    [[nodiscard]] bool has_maps() const { return !height.empty(); }
};

// --- the surface ----------------------------------------------------------------------

Result<Image> read_map(const std::string& path, Encoding encoding, std::size_t bands,
                       Size texels) {
    SATEEN_TRY(const Image file, read_image(path, encoding));
    Image map(bands, file.rows(), file.cols());
    const std::size_t plane = file.plane_size();
    for (std::size_t band = 0; band < bands; ++band)
        std::copy_n(file.plane(std::min(band, file.bands() - 1)).data, plane,
                    map.plane(band).data);
    return resample(map, texels.rows, texels.cols);
}

/// A map of one number: the mean of the bands of the file, since grey is often kept as
/// RGB.
Result<Image> read_grey_map(const std::string& path, Size texels) {
    SATEEN_TRY(const Image colour, read_map(path, Encoding::linear, 3, texels));
    Image grey(1, texels.rows, texels.cols);
    for (std::size_t i = 0; i < grey.plane_size(); ++i)
        grey.values()[i] = (colour.plane(0).data[i] + colour.plane(1).data[i] +
                            colour.plane(2).data[i]) /
                           3;
    return grey;
}

Image constant(std::size_t bands, Size texels, float value) {
    Image image(bands, texels.rows, texels.cols);
    std::fill(image.values().begin(), image.values().end(), value);
    return image;
}

/// Stretches heights to `relief` pixels from the lowest to the highest.
void scale_relief(Image& height, float relief) {
    const auto [low, high] =
        std::minmax_element(height.values().begin(), height.values().end());
    const float range = *high - *low;
    const float lowest = *low;
    for (float& z : height.values()) z = range > 0 ? (z - lowest) / range * relief : 0;
}

Result<SurfaceMaps> read_maps(const MeasureArguments& arguments, Size size, Size texels) {
    SurfaceMaps surface;
    SATEEN_TRY(surface.height, read_grey_map(arguments.height, texels));
    const float relief = arguments.height_scale > 0
                             ? arguments.height_scale
                             : kDefaultRelief * static_cast<float>(size.cols);
    scale_relief(surface.height, relief);
    surface.colour = constant(3, texels, 0.5F);
    surface.roughness = constant(1, texels, 0.8F);
    if (!arguments.colour.empty()) {
        SATEEN_TRY(surface.colour,
                   read_map(arguments.colour, Encoding::automatic, 3, texels));
    }
    if (!arguments.roughness.empty()) {
        SATEEN_TRY(surface.roughness, read_grey_map(arguments.roughness, texels));
    }
    if (arguments.normal.empty()) return surface;
    SATEEN_TRY(surface.normal, read_map(arguments.normal, Encoding::linear, 3, texels));
    const std::size_t plane = surface.normal.plane_size();
    const std::span<float> n = surface.normal.values();
    for (std::size_t i = 0; i < plane; ++i) {
        const float x = 2 * n[i] - 1;
        const float y = 2 * n[plane + i] - 1;
        const float z = std::max(2 * n[2 * plane + i] - 1, 0.01F);
        const float length = std::sqrt(x * x + y * y + z * z);
        n[i] = x / length;
        n[plane + i] = y / length;
        n[2 * plane + i] = z / length;
    }
    return surface;
}

Result<SurfaceMaps> surface_of(const MeasureArguments& arguments, Size size) {
    const Size texels = {kTexelsPerPixel * size.cols, kTexelsPerPixel * size.rows};
    if (arguments.has_maps()) return read_maps(arguments, size, texels);
    if (size.rows != size.cols)
        return Error{Errc::invalid_argument,
                     fmt::format("--size: found {}x{}, expected a square: presets are",
                                 size.cols, size.rows)};
    SATEEN_TRY(SurfaceMaps surface,
               make_preset(arguments.preset, texels.cols, arguments.common.seed));
    for (float& z : surface.height.values()) z *= static_cast<float>(size.cols);
    if (arguments.height_scale > 0) scale_relief(surface.height, arguments.height_scale);
    return surface;
}

// --- what is written ------------------------------------------------------------------

Result<DirectionPlan> plan_of(const std::string& directions) {
    if (directions == "ubo2003")
        return DirectionPlan::product(ubo2003_directions(), ubo2003_directions());
    if (directions == "coarse")
        return DirectionPlan::product(coarse_directions(), coarse_directions());
    if (directions == "lights") return DirectionPlan::product({{}}, ubo2003_directions());
    return read_direction_plan(directions);
}

MeasurementFormat format_of(const MeasureArguments& arguments) {
    MeasurementFormat format;
    format.extension = arguments.format == "png16" ? "png" : arguments.format;
    format.options.jpeg_quality = arguments.quality;
    if (arguments.format == "png16") format.options.bits = 16;
    return format;
}

double mean_of(const Image& image, std::size_t band) {
    double sum = 0;
    for (std::size_t i = 0; i < image.plane_size(); ++i)
        sum += static_cast<double>(image.plane(band).data[i]);
    return sum / static_cast<double>(image.plane_size());
}

/// What measurement.json says. Everything that the images depend on is in it.
Json manifest_of(const MeasureArguments& arguments, const DirectionPlan& plan,
                 const SurfaceMaps& surface, const SurfaceMaps& truth) {
    const auto [low, high] =
        std::minmax_element(truth.height.values().begin(), truth.height.values().end());
    Json json;
    json["writer"] = "sateen " SATEEN_VERSION;
    Json& source = json["surface"];
    if (arguments.has_maps()) {
        source["height"] = arguments.height;
        if (!arguments.colour.empty()) source["colour"] = arguments.colour;
        if (!arguments.normal.empty()) source["normal"] = arguments.normal;
        if (!arguments.roughness.empty()) source["roughness"] = arguments.roughness;
        // Tells maps of one name apart.
        source["means"] = {mean_of(surface.height, 0), mean_of(surface.colour, 0),
                           mean_of(surface.colour, 1), mean_of(surface.colour, 2),
                           mean_of(surface.roughness, 0)};
    } else {
        source["preset"] = arguments.preset;
        source["seed"] = arguments.common.seed;
        for (const Preset& preset : presets())
            if (preset.name == arguments.preset)
                json["pixels_per_mm"] =
                    static_cast<float>(truth.height.cols()) / preset.width_mm;
    }
    json["size"] = {truth.height.cols(), truth.height.rows()};
    json["views"] = plan.views.size();
    json["lights"] = plan.lights.size();
    json["images"] = plan.pairs();
    json["radiometry"] = {
        {"value", "exposure * pi * radiance / irradiance of a plane facing the light"},
        {"exposure", arguments.exposure},
        {"cosine_included", true},
        {"encoding", arguments.format == "exr" ? "linear" : "srgb"}};
    json["format"] = {{"extension", arguments.format}};
    if (arguments.format == "jpg") json["format"]["quality"] = arguments.quality;
    json["geometry"] =
        "orthographic, rectified on the mean plane; x right, y up (row 0 on top), z out; "
        "theta from z, phi from x to y, both vectors away from the surface; toroidal";
    json["reflectance"] = {
        {"model", arguments.lambert ? "Lambert" : "Lambert under GGX, joined by Schlick"},
        {"f0", arguments.lambert ? 0 : arguments.f0},
        {"shadows", !arguments.no_shadows},
        {"interreflection_rays", arguments.gather_rays}};
    json["samples_per_pixel"] = arguments.samples * arguments.samples;
    json["truth"] = {
        {"height.png", "16 bit: low + (high - low) * value / 65535, in pixels"},
        {"low", *low},
        {"high", *high},
        {"normal.png", "16 bit: (x, y, z) = 2 * value / 65535 - 1"},
        {"colour.png", "diffuse albedo, 8 bit, srgb"},
        {"roughness.png", "8 bit: value / 255, the square root of alpha of GGX"}};
    return json;
}

/// True maps into a folder.
Result<void> write_truth(const fs::path& folder, SurfaceMaps truth,
                         const std::string& manifest) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (code)
        return Error{Errc::io, fmt::format("{}: cannot create the folder: {}",
                                           folder.string(), code.message())};
    scale_relief(truth.height, 1);
    for (float& v : truth.normal.values()) v = 0.5F * v + 0.5F;
    WriteOptions wide;
    wide.bits = 16;
    wide.encoding = Encoding::linear;
    WriteOptions narrow;
    narrow.encoding = Encoding::linear;
    const auto path = [&](const char* name) { return (folder / name).string(); };
    SATEEN_CHECK(write_image(path("height.png"), truth.height.view(), wide));
    SATEEN_CHECK(write_image(path("normal.png"), truth.normal.view(), wide));
    SATEEN_CHECK(write_image(path("colour.png"), truth.colour.view()));
    SATEEN_CHECK(write_image(path("roughness.png"), truth.roughness.view(), narrow));
    return write_file(
        path("measurement.json"),
        {reinterpret_cast<const std::uint8_t*>(manifest.data()), manifest.size()});
}

fs::path truth_folder(const std::string& output) {
    fs::path path = fs::path(output).lexically_normal();
    if (path.filename().empty()) path = path.parent_path();
    std::string name = path.filename().string();
    if (name.ends_with(".zip") || name.ends_with(".ZIP")) name.resize(name.size() - 4);
    return path.parent_path() / (name + "_truth");
}

// --- the work -------------------------------------------------------------------------

/// \return images that an earlier run had made
Result<std::size_t> measure_all(const Goniometer& goniometer, float exposure,
                                const MeasurementWriter& writer, Executor& executor,
                                Progress& progress) {
    const DirectionPlan& plan = writer.plan();
    const auto total = static_cast<double>(plan.pairs());
    std::atomic<std::size_t> done = 0;
    std::size_t found = 0;
    for (std::size_t view = 0; view < plan.views.size(); ++view) {
        std::vector<std::size_t> missing;
        for (const std::size_t light : plan.lights_of_view[view])
            if (!writer.has(view, light)) missing.push_back(light);
        const std::size_t had = plan.lights_of_view[view].size() - missing.size();
        found += had;
        done += had;
        if (missing.empty()) continue;
        const auto take = [&](std::size_t light, const Image& image) -> Result<void> {
            Image exposed = image;
            for (float& v : exposed.values()) v *= exposure;
            SATEEN_CHECK(writer.add(view, light, exposed));
            progress.report(static_cast<double>(++done), total);
            return {};
        };
        SATEEN_CHECK(
            goniometer.measure(plan.views[view], missing, take, executor, progress));
    }
    return found;
}

Error with_hint(Error error, const std::string& partial) {
    if (error.code == Errc::cancelled)
        error.message +=
            fmt::format("; what is finished is in {}: --resume goes on", partial);
    return error;
}

Result<void> run_measure(const MeasureArguments& arguments) {
    const auto start = std::chrono::steady_clock::now();
    const Size size = parse_size(arguments.size);
    const std::unique_ptr<Executor> executor = make_executor(arguments.common.threads);
    ConsoleProgress progress;
    progress.stage("preparing");
    SATEEN_TRY(DirectionPlan plan, plan_of(arguments.directions));
    SATEEN_TRY(const SurfaceMaps surface, surface_of(arguments, size));

    GoniometerOptions options;
    options.rows = size.rows;
    options.cols = size.cols;
    options.samples = arguments.samples;
    options.specular = !arguments.lambert;
    options.f0 = arguments.f0;
    options.gather_rays = arguments.gather_rays;
    options.shadows = !arguments.no_shadows;
    options.max_view_theta = 0;
    for (const Direction& view : plan.views)
        options.max_view_theta = std::max(options.max_view_theta, view.theta);
    SATEEN_TRY(const Goniometer goniometer,
               Goniometer::create(surface, plan.lights, options, *executor));
    const SurfaceMaps truth = goniometer.truth(*executor);
    const std::string manifest =
        manifest_of(arguments, plan, surface, truth).dump(2) + "\n";

    SATEEN_TRY(
        MeasurementWriter writer,
        MeasurementWriter::create(arguments.output, std::move(plan), format_of(arguments),
                                  manifest, arguments.resume));
    progress.stage("tracing");
    const auto found =
        measure_all(goniometer, arguments.exposure, writer, *executor, progress);
    if (!found) return with_hint(found.error(), writer.partial_path());
    const std::string truth_path = truth_folder(arguments.output).string();
    SATEEN_CHECK(write_truth(truth_path, truth, manifest));
    progress.stage("packing");
    const std::size_t images = writer.plan().pairs();
    if (auto finished = writer.finish(progress); !finished)
        return with_hint(finished.error(), writer.partial_path());

    progress.clear();
    const std::chrono::duration<double> elapsed =
        std::chrono::steady_clock::now() - start;
    if (arguments.common.json) {
        Json json;
        json["written"] = {arguments.output, truth_path};
        json["images"] = images;
        json["resumed"] = *found;
        json["size"] = {size.cols, size.rows};
        json["seconds"] = elapsed.count();
        print_json(json);
    } else {
        fmt::print(stderr, "{}: {} images of {}x{}, {:.1f} s; the truth is in {}\n",
                   one_line(arguments.output), images, size.cols, size.rows,
                   elapsed.count(), one_line(truth_path));
    }
    return {};
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : presets()) names.emplace_back(preset.name);
    return names;
}

std::string preset_list() {
    std::string text;
    for (const Preset& preset : presets())
        text += fmt::format("\n  {:<12} {}", preset.name, preset.about);
    return text;
}

}  // namespace

Verb add_measure(CLI::App& program) {
    auto arguments = std::make_shared<MeasureArguments>();
    CLI::App* verb = program.add_subcommand(
        "measure", "Ray trace a measurement of a surface whose truth is known");
    auto* preset =
        verb->add_option("SURFACE", arguments->preset, "A preset; or give --height")
            ->type_name("")
            ->check(CLI::IsMember(preset_names()));
    verb->add_option("-o,--output", arguments->output,
                     "NAME.zip, or a new folder; true maps go to NAME_truth")
        ->type_name("OUT")
        ->required();
    verb->add_option("--directions", arguments->directions,
                     "ubo2003: 81 views x 81 lights; coarse: 25 x 25; lights: 81\n"
                     "lights of the view from above; or a file with the columns\n"
                     "theta,phi or theta_i,phi_i,theta_v,phi_v in degrees")
        ->type_name("LIST")
        ->capture_default_str();
    verb->add_option("--size", arguments->size,
                     "Of the images: width x height, or one number for a square")
        ->type_name("WxH")
        ->capture_default_str()
        ->check([](const std::string& text) {
            const Size size = parse_size(text);
            return size.cols <= 4096 && size.rows <= 4096
                       ? std::string()
                       : fmt::format("\"{}\" is not 1 to 4096 pixels a side", text);
        });
    verb->add_option("--samples", arguments->samples,
                     "A pixel is the mean of N x N samples")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(1, 16));
    verb->add_option("--format", arguments->format, "Of the images")
        ->type_name("EXT")
        ->capture_default_str()
        ->check(CLI::IsMember({"jpg", "png", "png16", "exr"}));
    verb->add_option("--quality", arguments->quality, "Of JPEG")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    verb->add_option("--exposure", arguments->exposure,
                     "Factor on all values; 1 makes a white plane facing the light 1")
        ->type_name("X")
        ->capture_default_str()
        ->check(CLI::Range(1e-3F, 1e3F));
    auto* lambert =
        verb->add_flag("--lambert", arguments->lambert, "Without the specular layer");
    verb->add_option("--f0", arguments->f0,
                     "Reflectance of the specular layer at normal incidence")
        ->type_name("X")
        ->capture_default_str()
        ->check(CLI::Range(0.0F, 1.0F))
        ->excludes(lambert);
    verb->add_option("--interreflection", arguments->gather_rays,
                     "Rays a pixel that gather light from the rest of the surface;\n"
                     "0 for direct light only")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(0, 4096));
    verb->add_flag("--no-shadows", arguments->no_shadows, "Without cast shadows");
    verb->add_option("--height-scale", arguments->height_scale,
                     "Pixels from the lowest to the highest point; default: the\n"
                     "preset's own, or 5 % of the width for maps")
        ->type_name("PX")
        ->check(CLI::Range(1e-3F, 1e4F));
    auto* height = verb->add_option("--height", arguments->height,
                                    "Height map, white is high; maps must be tileable")
                       ->type_name("FILE")
                       ->excludes(preset);
    verb->add_option("--colour,--color", arguments->colour, "Albedo map, sRGB")
        ->type_name("FILE")
        ->needs(height);
    verb->add_option("--normal", arguments->normal,
                     "Normal map, y up (OpenGL), in place of the height's normals")
        ->type_name("FILE")
        ->needs(height);
    verb->add_option("--roughness", arguments->roughness, "Roughness map")
        ->type_name("FILE")
        ->needs(height);
    verb->add_flag("--resume", arguments->resume,
                   "Go on with the images that an interrupted run has left");
    arguments->common.add_to(*verb);
    verb->footer("Presets:" + preset_list() +
                 "\n\nExamples:\n"
                 "  sateen measure leather -o leather.zip\n"
                 "  sateen measure twill -o twill --directions coarse --size 256\n"
                 "  sateen measure --height h.png --colour c.png -o mine.zip\n");
    verb->callback([arguments] {
        if (arguments->preset.empty() && !arguments->has_maps())
            throw CLI::RequiredError("SURFACE or --height");
    });
    return {verb, [arguments] { return run_measure(*arguments); }};
}

}  // namespace sateen::cli
