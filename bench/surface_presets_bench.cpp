// SPDX-License-Identifier: Apache-2.0
// Surfaces of the presets of the goniometer, with shadow, gloss, interreflection and JPEG:
// how near normals and height come to the truth, how the Roller joins what is cut out of
// them, and what is stored. Prints one JSON object.
//
//     surface_presets_bench [SIDE [PICTURE_FOLDER [PRESET]]]
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>

#include "analysis/fourier.hpp"
#include "figures.hpp"
#include "sateen/analysis/integrate.hpp"
#include "sateen/analysis/photometric_stereo.hpp"
#include "sateen/analysis/roller.hpp"
#include "sateen/goniometer/directions.hpp"
#include "sateen/goniometer/goniometer.hpp"
#include "sateen/goniometer/preset.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/material/surface.hpp"
#include "sateen/synthesis/surface.hpp"
#include "support/relief.hpp"

namespace sateen {
namespace {

using bench::Figure;
using Plane = BasicImage<double>;

template <class T>
T valid(Result<T> result) {
    if (result) return *std::move(result);
    std::fprintf(stderr, "surface_presets_bench: %s\n", result.error().message.c_str());
    std::exit(1);
}
void valid(const Result<void>& result) {
    if (result) return;
    std::fprintf(stderr, "surface_presets_bench: %s\n", result.error().message.c_str());
    std::exit(1);
}

/// A picture as a file of JPEG holds it.
Image through_jpeg(const Image& image, const std::string& path) {
    WriteOptions options;
    options.jpeg_quality = 90;
    valid(write_image(path, image.view(), options));
    return valid(read_image(path, Encoding::automatic));
}

struct Sample {
    test::SyntheticMeasurement measurement;
    SurfaceMaps truth;
};

Sample measure(std::string_view preset, std::size_t side, Executor& executor) {
    SurfaceMaps maps = valid(make_preset(preset, 2 * side, 0));
    for (float& z : maps.height.values()) z *= static_cast<float>(side);
    GoniometerOptions options;
    options.rows = side;
    options.cols = side;
    const std::vector<Direction> lights = ubo2003_directions();
    const Goniometer goniometer =
        valid(Goniometer::create(maps, lights, options, executor));
    const std::string file = (std::filesystem::temp_directory_path() /
                              ("surface_presets_" + std::to_string(getpid()) + ".jpg"))
                                 .string();
    std::vector<Image> images(lights.size());
    std::vector<std::size_t> all(lights.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    valid(goniometer.measure(
        Direction{}, all,
        [&](std::size_t light, const Image& image) -> Result<void> {
            images[light] = image;
            return {};
        },
        executor, Progress()));
    for (Image& image : images) image = through_jpeg(image, file);
    std::filesystem::remove(file);
    return {{{Direction{}}, lights, std::move(images)}, goniometer.truth(executor)};
}

Plane window(const Plane& from, std::size_t rows, std::size_t cols) {
    Plane out(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) out(0, r, c) = from(0, r, c);
    return out;
}

// Cycles a side below which an error of a degree in the normals adds up over more than a
// quarter of the sample, and cycles a pixel above which central differences see little.
constexpr double kLowest = 4;
constexpr double kHighest = 0.25;

/// Between those frequencies.
template <class T>
Plane band_limited(const BasicImage<T>& image) {
    Spectrum spectrum = spectrum_of<T>(image.plane(0));
    const auto cycles = [](std::size_t k, std::size_t n) {
        return frequency(k, n) / (2 * std::numbers::pi);
    };
    for (std::size_t m = 0; m < spectrum.rows; ++m)
        for (std::size_t n = 0; n < spectrum.cols; ++n) {
            const double f =
                std::hypot(cycles(m, spectrum.rows), cycles(n, spectrum.cols));
            if (f * static_cast<double>(spectrum.cols) < kLowest || f > kHighest)
                spectrum(m, n) = 0;
        }
    inverse(spectrum);
    Plane out(1, spectrum.rows, spectrum.cols);
    for (std::size_t i = 0; i < out.plane_size(); ++i)
        out.values()[i] = spectrum.values[i].real();
    return out;
}

double range_of(std::span<const float> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return static_cast<double>(*high - *low);
}

Surface quantised(const RolledSurface& rolled, float share) {
    double range = 0;
    for (const Image& tile : rolled.tiles)
        range = std::max(range, range_of(tile.values()));
    return valid(quantise_surface(rolled.tiles, share * static_cast<float>(range),
                                  rolled.shear_px));
}

/// Largest error of the stored heights, as a share of their range.
double storage_error(const RolledSurface& rolled, const Surface& surface) {
    double error = 0;
    double low = 1e30;
    double high = -1e30;
    for (std::size_t t = 0; t < rolled.tiles.size(); ++t)
        for (std::size_t i = 0; i < surface.tiles[t].size(); ++i) {
            const auto z = static_cast<double>(rolled.tiles[t].values()[i]);
            const auto stored =
                static_cast<double>(surface.height_px(surface.tiles[t][i]));
            error = std::max(error, std::abs(z - stored));
            low = std::min(low, z);
            high = std::max(high, z);
        }
    return error / (high - low);
}

/// 4 x 4 tiles, lit obliquely.
void draw_field(const Surface& surface, const std::string& path) {
    const PlaneWindow field = {0, 0, 4 * surface.rows, 4 * surface.cols};
    const Image height = valid(draw_range(surface, field, 0));
    const Image normals = normals_of(height.plane(0), Border::repeats_last);
    Image white(1, height.rows(), height.cols());
    for (float& v : white.values()) v = 0.9F;
    valid(write_image(
        path, test::picture(normals, white, direction_from_degrees(55, 135)).view(), {}));
}

void judge(std::string_view preset, std::size_t side, const std::string& pictures,
           std::vector<Figure>& figures) {
    const auto executor = make_executor(0);
    Progress progress;
    const Sample sample = measure(preset, side, *executor);
    const std::string name(preset);
    double angles[2] = {};
    Plane height;
    for (const bool robust : {false, true}) {
        const StereoEstimate found = valid(photometric_stereo(
            sample.measurement, {.robust = robust}, *executor, progress));
        angles[robust ? 1 : 0] = test::mean_angle(found.normals, sample.truth.normal);
        if (robust)
            height = integrate(slopes_of_normals(found.normals), Difference::central,
                               Periodicity::torus);
    }
    figures.push_back({name + ": mean angle of normals",
                       angles[1],
                       "degrees",
                       5,
                       Figure::Bound::at_most,
                       {{"least_squares", angles[0]}}});
    figures.push_back({name + ": robust to least squares",
                       angles[1] / angles[0],
                       "x",
                       1,
                       Figure::Bound::at_most,
                       {}});
    figures.push_back(
        {name + ": correlation of height, 4 cycles a side to 1/4 a pixel",
         test::correlation(band_limited(height), band_limited(sample.truth.height)),
         "",
         0.97,
         Figure::Bound::at_least,
         {{"all_frequencies", test::correlation(height, sample.truth.height)}}});

    const RolledSurface torus = valid(roll(height, {}));
    figures.push_back({name + ": the torus stays whole",
                       torus.was_toroidal ? 1.0 : 0.0,
                       "",
                       1,
                       Figure::Bound::at_least,
                       {}});
    const Plane piece = window(height, side * 7 / 8, side * 13 / 16);
    const RolledSurface cut = valid(roll(piece, {}));
    for (const RolledSurface* rolled : {&torus, &cut}) {
        const std::string of = name + (rolled == &torus ? ", torus: " : ", piece: ");
        const std::vector<std::pair<std::string, double>> size = {
            {"rows", static_cast<double>(rolled->tiles[0].rows())},
            {"cols", static_cast<double>(rolled->tiles[0].cols())},
            {"shear", static_cast<double>(rolled->shear_px)}};
        figures.push_back({of + "seams of height", rolled->seam_ratio, "x", 1.05,
                           Figure::Bound::at_most, size});
        figures.push_back({of + "seams of normals",
                           rolled->normal_seam_ratio,
                           "x",
                           1.05,
                           Figure::Bound::at_most,
                           {}});
        const auto [low, high] =
            std::minmax_element(height.values().begin(), height.values().end());
        double range = 0;
        for (const Image& tile : rolled->tiles)
            range = std::max(range, range_of(tile.values()));
        figures.push_back({of + "range to that of the sample",
                           range / (*high - *low),
                           "x",
                           1.05,
                           Figure::Bound::at_most,
                           {}});
        const Surface surface = quantised(*rolled, 0.01F);
        figures.push_back({of + "error of storage",
                           storage_error(*rolled, surface),
                           "of the range",
                           0.005,
                           Figure::Bound::at_most,
                           {}});
        if (!pictures.empty())
            draw_field(surface, pictures + "/" + name +
                                    (rolled == &torus ? "_torus.png" : "_piece.png"));
    }
}

}  // namespace
}  // namespace sateen

int main(int argc, char** argv) {
    const std::size_t side = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 96;
    const std::string pictures = argc > 2 ? argv[2] : "";
    if (side < 48 || side > 1024) {
        std::fprintf(stderr,
                     "usage: surface_presets_bench [SIDE [PICTURE_FOLDER [PRESET]]]\n");
        return 2;
    }
    std::vector<sateen::bench::Figure> figures;
    for (const sateen::Preset& preset : sateen::presets())
        if (argc < 4 || preset.name == argv[3])
            sateen::judge(preset.name, side, pictures, figures);
    sateen::bench::print("surface_presets", figures);
    return 0;
}
