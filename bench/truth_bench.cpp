// SPDX-License-Identifier: Apache-2.0
// Pictures of a material beside pictures ray traced from the maps that were measured, under
// the same camera and lights:
//
//     truth_bench MAPS LOW HIGH EXPOSURE MATERIAL PERIOD OUT [plane|sphere THETA,PHI]...
//
// MAPS is the folder of the true height, normals, colour and, if known, roughness of a
// virtual BTF, LOW and HIGH the heights of black and white, EXPOSURE the measurement's.
// PERIOD is the side of the textures in pixels. Writes OUT/N_traced.png and
// OUT/N_material.png for every object and light, and prints how far they are apart.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "figures.hpp"
#include "goniometer/tracer.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/render/renderer.hpp"
#include "sateen/synthesis/evaluate.hpp"

namespace sateen::bench {
namespace {

constexpr std::size_t kSide = 320;
constexpr float kRepeats = 1;
// The tracer follows no flatter rays.
constexpr float kLowest = 0.05F;
// Of maps without one: cloth and soil are matt.
constexpr float kRoughness = 0.8F;
constexpr float kF0 = 0.04F;

struct Truth {
    SurfaceMaps maps;
    float range = 0;
    float exposure = 1;
};

/// \param maps, low, high, exposure  as the command line has them
Result<Truth> read_truth(std::span<const std::string> arguments) {
    const std::string& folder = arguments[0];
    const float low = std::stof(arguments[1]);
    Truth truth;
    truth.range = std::stof(arguments[2]) - low;
    truth.exposure = std::stof(arguments[3]);
    const auto has = [&](const char* name) {
        return std::filesystem::exists(folder + "/" + name);
    };
    const std::string normals = has("normals.png") ? "/normals.png" : "/normal.png";
    SATEEN_TRY(truth.maps.height, read_image(folder + "/height.png", Encoding::linear));
    SATEEN_TRY(truth.maps.normal, read_image(folder + normals, Encoding::linear));
    SATEEN_TRY(truth.maps.colour, read_image(folder + "/colour.png"));
    for (float& v : truth.maps.height.values()) v = low + truth.range * v;
    for (float& v : truth.maps.normal.values()) v = 2 * v - 1;
    truth.maps.roughness = Image(1, truth.maps.height.rows(), truth.maps.height.cols());
    std::fill(truth.maps.roughness.values().begin(), truth.maps.roughness.values().end(),
              kRoughness);
    if (has("roughness.png")) {
        SATEEN_TRY(truth.maps.roughness,
                   read_image(folder + "/roughness.png", Encoding::linear));
        if (truth.maps.roughness.bands() != 1)
            return Error{Errc::bad_format, folder + "/roughness.png: is not grey"};
    }
    return truth;
}

/// Direct light on the maps at the points of a picture, as the goniometer would measure it.
ShadePoints traced_by(const goniometer::Tracer& tracer, const Truth& truth,
                      std::size_t period) {
    return [&tracer, &truth, period](std::span<const LitPoint> points,
                                     std::span<Vector3> values) {
        SerialExecutor executor;
        const auto raised = [](const Vector3& d) {
            const float z = std::max(d[2], kLowest);
            const float flat = std::sqrt(d[0] * d[0] + d[1] * d[1]);
            const float scale = flat > 0 ? std::sqrt(1 - z * z) / flat : 0;
            return Vector3{scale * d[0], scale * d[1], z};
        };
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Vector3 view = raised(points[k].view);
            const Vector3 light = raised(points[k].light);
            const Direction from = {std::acos(std::min(1.0F, view[2])),
                                    std::atan2(view[1], view[0])};
            const std::array<float, 1> x = {
                tracer.wrap_x(points[k].u * static_cast<float>(period))};
            const std::array<float, 1> y = {
                tracer.wrap_y(points[k].v * static_cast<float>(period))};
            const goniometer::Hits hits = tracer.trace(x, y, from, executor);
            const goniometer::Hits::Block& block = hits.blocks.front();
            const goniometer::Reflected value = goniometer::reflect(
                block, {true, kF0}, view, light, tracer.lit(block, light, true));
            for (std::size_t band = 0; band < 3; ++band)
                values[k][band] = truth.exposure * value[band][0];
        }
    };
}

ShadePoints shaded_by(const Evaluator& evaluator) {
    return [&evaluator](std::span<const LitPoint> points, std::span<Vector3> values) {
        std::vector<ShadingPoint> own(points.size());
        for (std::size_t k = 0; k < points.size(); ++k)
            own[k] = {points[k].u, points[k].v, points[k].view, points[k].light};
        evaluator.evaluate(own, values);
    };
}

/// Mean difference of the colours of blocks of 32 pixels where both show the object: the
/// textures are not the same, their means are.
double block_difference(const Image& a, const Image& b) {
    constexpr std::size_t kBlock = 32;
    double sum = 0;
    double count = 0;
    for (std::size_t r = 0; r + kBlock <= a.rows(); r += kBlock)
        for (std::size_t c = 0; c + kBlock <= a.cols(); c += kBlock) {
            std::array<std::array<double, 3>, 2> mean{};
            std::size_t background = 0;
            for (std::size_t i = r; i < r + kBlock; ++i)
                for (std::size_t j = c; j < c + kBlock; ++j) {
                    background += a(0, i, j) == 0 && b(0, i, j) == 0 ? 1U : 0U;
                    for (std::size_t band = 0; band < 3; ++band) {
                        mean[0][band] += static_cast<double>(a(band, i, j));
                        mean[1][band] += static_cast<double>(b(band, i, j));
                    }
                }
            if (background > kBlock * kBlock / 4) continue;
            const auto lab = [&](const std::array<double, 3>& m) {
                constexpr double n = kBlock * kBlock;
                return lab_from_linear_srgb(m[0] / n, m[1] / n, m[2] / n);
            };
            sum += delta_e_2000(lab(mean[0]), lab(mean[1]));
            ++count;
        }
    return count > 0 ? sum / count : 0;
}

Result<void> run(const std::vector<std::string>& arguments) {
    SATEEN_TRY(const Truth truth, read_truth(arguments));
    SATEEN_TRY(const Material material, load_material(arguments[4]));
    const auto period = static_cast<std::size_t>(std::stoul(arguments[5]));
    constexpr std::size_t kFirst = 7;
    const auto executor = make_executor(0);
    Progress progress;
    EvaluatorOptions options;
    options.side = period;
    SATEEN_TRY(const Evaluator evaluator,
               Evaluator::create(material, options, *executor, progress));
    const auto cols = static_cast<float>(truth.maps.height.cols());
    const auto rows = static_cast<float>(truth.maps.height.rows());
    SATEEN_TRY(
        const goniometer::Tracer tracer,
        goniometer::Tracer::create(truth.maps, cols, rows, (truth.range + 1) / kLowest));
    std::vector<Figure> figures;
    for (std::size_t k = kFirst; k + 1 < arguments.size(); k += 2) {
        const bool is_plane = arguments[k] == "plane";
        const Mesh mesh = is_plane ? plane_mesh(kRepeats) : sphere_mesh(kRepeats);
        float theta = 0;
        float phi = 0;
        if (std::sscanf(arguments[k + 1].c_str(), "%f,%f", &theta, &phi) != 2)
            return Error{Errc::invalid_argument,
                         arguments[k + 1] + ": expected THETA,PHI"};
        Scene scene;
        scene.mesh = &mesh;
        scene.lights = {{direction_from_degrees(theta, phi), 1}};
        scene.background_top = scene.background_bottom = {};
        RenderOptions camera;
        camera.rows = camera.cols = kSide;
        camera.view = direction_from_degrees(is_plane ? 35.0F : 62.0F, 270);
        SATEEN_TRY(const Image of_maps, render(scene, traced_by(tracer, truth, period),
                                               camera, *executor, progress));
        SATEEN_TRY(const Image of_material,
                   render(scene, shaded_by(evaluator), camera, *executor, progress));
        const std::string stem = arguments[6] + "/" + std::to_string((k - kFirst) / 2);
        SATEEN_CHECK(write_image(stem + "_traced.png", of_maps.view()));
        SATEEN_CHECK(write_image(stem + "_material.png", of_material.view()));
        figures.push_back({arguments[k] + " " + arguments[k + 1],
                           block_difference(of_maps, of_material),
                           "mean Delta E of blocks",
                           5,
                           Figure::Bound::at_most,
                           {}});
    }
    print("truth", figures);
    return {};
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments.size() < 9) {
        std::fprintf(stderr,
                     "truth_bench MAPS LOW HIGH EXPOSURE MATERIAL PERIOD OUT "
                     "[plane|sphere THETA,PHI]...\n");
        return 2;
    }
    const auto done = sateen::bench::run(arguments);
    if (done) return 0;
    std::fprintf(stderr, "truth_bench: error: %s\n", done.error().message.c_str());
    return 1;
}
