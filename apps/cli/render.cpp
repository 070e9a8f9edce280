// SPDX-License-Identifier: Apache-2.0
// sateen render: pictures of an object of a material.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "console.hpp"
#include "sateen/io/animated_png.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/render/displacement.hpp"
#include "sateen/render/renderer.hpp"
#include "sateen/synthesis/evaluate.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

struct RenderArguments {
    CommonArguments common;
    std::string material;
    std::string output;
    std::string mesh = "sphere";
    std::string view;
    std::vector<std::string> lights;
    std::string environment;
    std::string size = "512x512";
    float repeats = 3;
    float exposure = 0;  ///< 0: from the first picture
    std::size_t texture_side = 512;
    std::size_t environment_samples = 4;
    std::size_t turntable = 0;
    std::size_t sweep = 0;
    std::string relief = "shading";
    std::size_t triangles = 2'000'000;
    bool displacement = false;
    bool animate = false;

    [[nodiscard]] std::size_t frames() const {
        return std::max<std::size_t>({turntable, sweep, 1});
    }
};

Result<Mesh> mesh_of(const RenderArguments& arguments) {
    if (arguments.mesh == "sphere") return sphere_mesh(arguments.repeats);
    if (arguments.mesh == "plane") return plane_mesh(arguments.repeats);
    if (arguments.mesh == "cloth") return cloth_mesh(arguments.repeats);
    constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
    SATEEN_TRY(const auto bytes, read_file(arguments.mesh, kMaxBytes));
    return parse_obj({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                     arguments.mesh, arguments.repeats);
}

Result<std::optional<Environment>> environment_of(const std::string& path) {
    if (path.empty()) return std::optional<Environment>();
    SATEEN_TRY(Image map, read_image(path));
    auto made = Environment::create(std::move(map));
    if (!made) return Error{made.error().code, path + ": " + made.error().message};
    return std::optional<Environment>(std::move(*made));
}

Direction default_view(const std::string& mesh) {
    return direction_from_degrees(mesh == "plane" ? 45.0F : 62.0F, 270);
}

ShadePoints shading_by(const Evaluator& evaluator) {
    return [&evaluator](std::span<const LitPoint> points, std::span<Vector3> values) {
        std::vector<ShadingPoint> own(points.size());
        for (std::size_t k = 0; k < points.size(); ++k)
            own[k] = {points[k].u, points[k].v, points[k].view, points[k].light};
        evaluator.evaluate(own, values);
    };
}

/// The factor that brings the 98th percentile of what is not black to 0.5.
float exposure_for(const Image& picture) {
    std::vector<float> values;
    for (std::size_t i = 0; i < picture.plane_size(); ++i) {
        const float v = std::max({picture.plane(0).data[i], picture.plane(1).data[i],
                                  picture.plane(2).data[i]});
        if (v > 0) values.push_back(v);
    }
    if (values.empty()) return 1;
    const auto at = static_cast<std::ptrdiff_t>(values.size() * 98 / 100);
    std::nth_element(values.begin(), values.begin() + at, values.end());
    constexpr float kBright = 0.5F;
    return kBright / values[static_cast<std::size_t>(at)];
}

const std::map<std::string, Relief> kReliefs = {{"none", Relief::none},
                                                {"shading", Relief::shading},
                                                {"parallax", Relief::parallax},
                                                {"marched", Relief::marched}};

/// Heights of the evaluator's torus, means weighted by a tent as wide as the square; of a
/// texel, where squares are smaller, which is bilinear.
HeightAt heights_of(const Evaluator& evaluator) {
    return [&evaluator](float u, float v, float width) {
        constexpr float kFurthest = 8;
        const std::span<const float> relief = evaluator.relief();
        const auto side = static_cast<std::int64_t>(evaluator.side());
        const auto texels = static_cast<float>(side);
        const float reach = std::clamp(width * texels, 1.0F, kFurthest);
        const float col = u * texels - 0.5F;
        const float row = -v * texels - 0.5F;
        const auto first = [reach](float at) {
            return static_cast<std::int64_t>(std::ceil(at - reach));
        };
        const auto share = [reach](std::int64_t i, float at) {
            return std::max(0.0F, reach - std::abs(static_cast<float>(i) - at));
        };
        const auto wrapped = [side](std::int64_t i) { return (i % side + side) % side; };
        float sum = 0;
        float weights = 0;
        for (std::int64_t r = first(row); static_cast<float>(r) < row + reach; ++r)
            for (std::int64_t c = first(col); static_cast<float>(c) < col + reach; ++c) {
                const float weight = share(r, row) * share(c, col);
                const auto at = static_cast<std::size_t>(wrapped(r) * side + wrapped(c));
                sum += weight * relief[4 * at + 3];
                weights += weight;
            }
        return weights > 0 ? sum / weights : 0.0F;
    };
}

/// The displaced mesh in the scene. Smooth textures that hold the shadows of the relief are
/// not shaded by it again: then shadow rays begin above it.
Result<DisplacedMesh> displaced_by(const RenderArguments& arguments, const Mesh& mesh,
                                   const Evaluator& evaluator, bool delit, Scene& scene,
                                   Progress& progress) {
    progress.stage("displacing");
    DisplacementOptions options;
    options.max_triangles = arguments.triangles;
    options.detail = 1 / static_cast<float>(evaluator.side());
    SATEEN_TRY(DisplacedMesh displaced,
               displace(mesh, heights_of(evaluator), options, progress));
    constexpr float kClearance = 3e-4F;
    scene.shadow_lift =
        delit ? kClearance : kClearance + displaced.highest - displaced.lowest;
    return displaced;
}

std::string frame_name(const std::string& output, std::size_t frame) {
    const std::filesystem::path path(output);
    return (path.parent_path() / fmt::format("{}_{:03}{}", path.stem().string(), frame,
                                             path.extension().string()))
        .string();
}

/// The scene and camera of a frame: the object turns under camera and lights, or the
/// lights go around.
void turn(const RenderArguments& arguments, std::size_t frame, Scene& scene,
          RenderOptions& options) {
    const float angle = 360 * kRadiansPerDegree * static_cast<float>(frame) /
                        static_cast<float>(arguments.frames());
    if (arguments.turntable > 0) options.view.phi += angle;
    for (DistantLight& light : scene.lights) light.direction.phi += angle;
}

Result<std::vector<std::string>> render_all(const RenderArguments& arguments, Scene scene,
                                            const ShadePoints& shade,
                                            const RenderOptions& options,
                                            Executor& executor, Progress& progress) {
    float exposure = arguments.exposure;
    if (exposure == 0) {
        RenderOptions small = options;
        small.rows = small.cols = 64;
        Scene dark = scene;
        dark.background_top = dark.background_bottom = {};
        Progress quiet;
        SATEEN_TRY(const Image preview, render(dark, shade, small, executor, quiet));
        exposure = exposure_for(preview);
    }
    // The backdrop is not lit.
    for (float& v : scene.background_top) v /= exposure;
    for (float& v : scene.background_bottom) v /= exposure;
    WriteOptions writing;
    writing.executor = &executor;
    std::vector<std::string> written;
    for (std::size_t frame = 0; frame < arguments.frames(); ++frame) {
        progress.stage(fmt::format("frame {} of {}", frame + 1, arguments.frames()));
        Scene turned = scene;
        RenderOptions from = options;
        turn(arguments, frame, turned, from);
        SATEEN_TRY(Image image, render(turned, shade, from, executor, progress));
        for (float& v : image.values()) v *= exposure;
        const std::string path = arguments.frames() > 1
                                     ? frame_name(arguments.output, frame)
                                     : arguments.output;
        SATEEN_CHECK(write_image(path, image.view(), writing));
        written.push_back(path);
    }
    if (arguments.animate) {
        constexpr std::uint16_t kTurn = 4000;  // milliseconds
        SATEEN_CHECK(join_png_frames(arguments.output, written,
                                     static_cast<std::uint16_t>(std::max<std::size_t>(
                                         20, kTurn / arguments.frames()))));
        written.push_back(arguments.output);
    }
    return written;
}

Result<void> run_render(const RenderArguments& arguments) {
    if (arguments.animate &&
        (arguments.frames() < 2 ||
         std::filesystem::path(arguments.output).extension() != ".png"))
        return Error{Errc::invalid_argument,
                     "--animate: found " + one_line(arguments.output) +
                         ", expected a .png, and --turntable or --sweep of 2 and more"};
    const auto start = std::chrono::steady_clock::now();
    const Size size = parse_size(arguments.size);
    const std::unique_ptr<Executor> executor = make_executor(arguments.common.threads);
    ConsoleProgress progress;
    SATEEN_TRY(const Material material, load_material(arguments.material));
    SATEEN_TRY(const Mesh mesh, mesh_of(arguments));
    SATEEN_TRY(const std::optional<Environment> environment,
               environment_of(arguments.environment));

    progress.stage("drawing");
    EvaluatorOptions drawing;
    drawing.side = arguments.texture_side;
    drawing.seed = arguments.common.seed;
    drawing.relief = kReliefs.at(arguments.relief);
    drawing.self_shadow = drawing.relief == Relief::marched;
    SATEEN_TRY(const Evaluator evaluator,
               Evaluator::create(material, drawing, *executor, progress));

    Scene scene;
    scene.mesh = &mesh;
    DisplacedMesh displaced;
    if (arguments.displacement) {
        if (!material.surface)
            return Error{Errc::invalid_argument,
                         one_line(arguments.material) +
                             ": holds no range map to displace by, expected a material "
                             "modelled with --surface"};
        SATEEN_TRY(displaced, displaced_by(arguments, mesh, evaluator,
                                           material.surface->delit, scene, progress));
        scene.mesh = &displaced.mesh;
    }
    if (environment) scene.environment = &*environment;
    for (const std::string& light : arguments.lights)
        scene.lights.push_back({parse_direction(light), 1});
    if (scene.lights.empty() && !environment)
        scene.lights = {{direction_from_degrees(42, 225), 1},
                        {direction_from_degrees(65, 320), 0.2F}};
    RenderOptions options;
    options.rows = size.rows;
    options.cols = size.cols;
    options.seed = arguments.common.seed;
    options.environment_samples = arguments.environment_samples;
    options.view = arguments.view.empty() ? default_view(arguments.mesh)
                                          : parse_direction(arguments.view);
    SATEEN_TRY(const std::vector<std::string> written,
               render_all(arguments, scene, shading_by(evaluator), options, *executor,
                          progress));

    progress.clear();
    const std::chrono::duration<double> elapsed =
        std::chrono::steady_clock::now() - start;
    if (arguments.common.json) {
        nlohmann::ordered_json json;
        json["written"] = written;
        json["size"] = {size.cols, size.rows};
        json["triangles"] = scene.mesh->triangles.size();
        json["seconds"] = elapsed.count();
        print_json(json);
    } else {
        print_drawn(arguments.output, written.size(), "picture", size.rows, size.cols,
                    elapsed.count());
    }
    return {};
}

}  // namespace

Verb add_render(CLI::App& program) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* verb =
        program.add_subcommand("render", "Render an object of a material, lit");
    add_material(*verb, arguments->material);
    verb->add_option("-o,--output", arguments->output,
                     "Image file: .png, .jpg, .exr or .tif; frames get numbers")
        ->type_name("OUT")
        ->required();
    verb->add_option("--mesh", arguments->mesh, "sphere, plane, cloth, or FILE.obj")
        ->type_name("MESH")
        ->capture_default_str();
    add_direction(*verb, "--view", arguments->view,
                  "Where the camera stands, in degrees in the object's frame: theta\n"
                  "from its z axis, phi from x to y; default 62,270 (plane: 45,270)");
    add_direction(*verb, "--light", arguments->lights,
                  "A distant light in the same frame, repeatable; default 42,225\n"
                  "and a weak one, unless there is an environment")
        ->take_all();
    verb->add_option("--env", arguments->environment,
                     "Light from an equirectangular map, .exr or .hdr; +z is up")
        ->type_name("FILE");
    verb->add_option("--env-samples", arguments->environment_samples,
                     "Directions of it for each of the 16 samples of a pixel")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(1, 1024));
    verb->add_option("--size", arguments->size,
                     "Width x height in pixels, or one number for a square")
        ->type_name("WxH")
        ->capture_default_str()
        ->check(checked(parse_size));
    verb->add_option("--scale", arguments->repeats,
                     "Periods of the texture across the object")
        ->type_name("S")
        ->capture_default_str()
        ->check(CLI::Range(1e-3F, 1e3F));
    verb->add_option("--texture", arguments->texture_side,
                     "Pixels of a period of the texture, a side")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(16, 2048));
    auto* displacement =
        verb->add_flag("--displacement", arguments->displacement,
                       "Move the surface by the range map: a mesh of small triangles,\n"
                       "with silhouettes and shadows of its own");
    verb->add_option("--triangles", arguments->triangles,
                     "At most, of --displacement; 1 GB holds about 4 million")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(1000, 20000000))
        ->needs(displacement);
    verb->add_option("--relief", arguments->relief,
                     "What the range map does within the surface: none, shading,\n"
                     "parallax, or marched: rays through it, with its own shadows")
        ->type_name("KIND")
        ->capture_default_str()
        ->check(CLI::IsMember({"none", "shading", "parallax", "marched"}));
    verb->add_option("--exposure", arguments->exposure,
                     "Factor on all values; default: the first picture decides")
        ->type_name("X")
        ->check(CLI::Range(1e-4F, 1e4F));
    auto* turntable = verb->add_option("--turntable", arguments->turntable,
                                       "N pictures of the object turning once")
                          ->type_name("N")
                          ->check(CLI::Range(1, 10000));
    verb->add_option("--sweep", arguments->sweep,
                     "N pictures of the lights going around once")
        ->type_name("N")
        ->check(CLI::Range(1, 10000))
        ->excludes(turntable);
    verb->add_flag("--animate", arguments->animate,
                   "The frames as an animated PNG as well, OUT itself");
    arguments->common.add_to(*verb);
    verb->footer(
        "Examples:\n"
        "  sateen render wool.sateen -o ball.png --light 45,225 --light 70,0\n"
        "  sateen render wool.sateen -o scarf.png --mesh cloth --env studio.hdr\n"
        "  sateen render wool.sateen -o turn.png --turntable 36 --animate");
    return {verb, [arguments] { return run_render(*arguments); }};
}

}  // namespace sateen::cli
