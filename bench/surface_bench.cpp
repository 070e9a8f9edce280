// SPDX-License-Identifier: Apache-2.0
// How near the estimated range map is to a known one, and how well a surface predicts
// photographs under lights that were held out. Prints one JSON object.
//
//     surface_bench truth MEASUREMENT TRUTH_FOLDER
//     surface_bench relight MEASUREMENT
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "sateen/analysis/integrate.hpp"
#include "sateen/analysis/photometric_stereo.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/open_measurement.hpp"
#include "sateen/synthesis/surface.hpp"
#include "support/relief.hpp"

namespace sateen {
namespace {

template <class T>
T valid(Result<T> result) {
    if (result) return *std::move(result);
    std::fprintf(stderr, "surface_bench: %s\n", result.error().message.c_str());
    std::exit(1);
}

StereoEstimate estimate(const Measurement& measurement, const StereoOptions& options) {
    Progress progress;
    return valid(photometric_stereo(measurement, options, *make_executor(0), progress));
}

double truth_number(const std::string& path, const std::string& key) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string name;
        double value = 0;
        if (words >> name >> value && name == key) return value;
    }
    std::fprintf(stderr, "surface_bench: %s: no %s\n", path.c_str(), key.c_str());
    std::exit(1);
}

Image true_normals(const std::string& folder) {
    Image out = valid(read_image(folder + "/normals.png", Encoding::linear));
    for (float& v : out.values()) v = 2 * v - 1;
    for (std::size_t i = 0; i < out.plane_size(); ++i) {
        double square = 0;
        for (std::size_t band = 0; band < 3; ++band)
            square += std::pow(static_cast<double>(out.plane(band).data[i]), 2);
        for (std::size_t band = 0; band < 3; ++band)
            out.plane(band).data[i] /= static_cast<float>(std::sqrt(square));
    }
    return out;
}

Image to_float(const BasicImage<double>& image) {
    Image out(image.bands(), image.rows(), image.cols());
    for (std::size_t i = 0; i < image.values().size(); ++i)
        out.values()[i] = static_cast<float>(image.values()[i]);
    return out;
}

int compare_with_truth(const std::string& path, const std::string& folder) {
    const auto measurement = valid(open_measurement({&path, 1}));
    const Image normals = true_normals(folder);
    Image height = valid(read_image(folder + "/height.png", Encoding::linear));
    const double low = truth_number(folder + "/truth.txt", "height_low");
    const double high = truth_number(folder + "/truth.txt", "height_high");
    double square = 0;
    for (float& z : height.values()) {
        z = static_cast<float>(low + (high - low) * static_cast<double>(z));
        square += static_cast<double>(z) * static_cast<double>(z);
    }
    std::printf("{\n  \"measurement\": \"%s\"", measurement->info().name.c_str());
    for (const bool robust : {false, true}) {
        const StereoEstimate found = estimate(*measurement, {.robust = robust});
        const char* name = robust ? "robust" : "least_squares";
        std::printf(",\n  \"%s\": {\"mean_angle_deg\": %.3f, \"used\": %.3f", name,
                    test::mean_angle(found.normals, normals), found.mean_used);
        for (const Difference d : {Difference::central, Difference::band_limited}) {
            const auto z =
                integrate(slopes_of_normals(found.normals), d, Periodicity::torus);
            const Image heights = to_float(z);
            double product = 0;
            for (std::size_t i = 0; i < heights.plane_size(); ++i)
                product += static_cast<double>(heights.values()[i]) *
                           static_cast<double>(height.values()[i]);
            std::printf(
                ",\n    \"%s\": {\"height_correlation\": %.4f, \"height_gain\": %.3f, "
                "\"derived_normal_angle_deg\": %.3f}",
                d == Difference::central ? "central" : "band_limited",
                test::correlation(heights, height), product / square,
                test::mean_angle(normals_of(heights.plane(0), Border::wraps), normals));
        }
        std::printf("}");
    }
    std::printf(
        ",\n  \"limits\": {\"mean_angle_deg\": 5, \"height_correlation\": 0.97}\n}\n");
    return 0;
}

// Six terms of a polynomial texture map [Malzbender et al. 2001].
using Terms = Eigen::Matrix<double, 6, 1>;
Terms terms_of(Direction light) {
    const auto l = to_vector(light);
    const auto x = static_cast<double>(l[0]);
    const auto y = static_cast<double>(l[1]);
    Terms out;
    out << x * x, y * y, x * y, x, y, 1;
    return out;
}

struct Errors {
    double square = 0;
    std::size_t count = 0;
    void add(double found, double expected) {
        const auto code = [](double v) {
            v = std::min(1.0, std::max(0.0, v));
            return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        };
        square += std::pow(code(found) - code(expected), 2);
        ++count;
    }
    [[nodiscard]] double psnr() const {
        return -10 * std::log10(square / static_cast<double>(count));
    }
};

int predict_held_out(const std::string& path) {
    const auto measurement = valid(open_measurement({&path, 1}));
    const MeasurementInfo& info = measurement->info();
    StereoOptions options{.upright = false};
    for (std::uint32_t light = 5; light < info.lights.size(); light += 6)
        options.without_lights.push_back(light);
    const auto held_out = [&](std::uint32_t light) { return light % 6 == 5; };
    const StereoEstimate robust = estimate(*measurement, options);
    options.robust = false;
    const StereoEstimate plain = estimate(*measurement, options);

    const std::size_t values = info.bands * info.rows * info.cols;
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, Eigen::Dynamic> b =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6,
                                                       static_cast<Eigen::Index>(values));
    for (std::size_t i = 0; i < info.observations.size(); ++i) {
        const std::uint32_t light = info.observations[i].light;
        if (held_out(light)) continue;
        const Image image = valid(measurement->read(i));
        const Terms t = terms_of(info.lights[light]);
        A += t * t.transpose();
        for (std::size_t k = 0; k < values; ++k)
            b.col(static_cast<Eigen::Index>(k)) +=
                t * static_cast<double>(image.values()[k]);
    }
    const auto coefficients = A.ldlt().solve(b).eval();

    Errors errors[3];
    for (std::size_t i = 0; i < info.observations.size(); ++i) {
        const std::uint32_t light = info.observations[i].light;
        if (!held_out(light)) continue;
        const Image image = valid(measurement->read(i));
        const Terms t = terms_of(info.lights[light]);
        const Image lit[2] = {
            test::picture(robust.normals, robust.albedo, info.lights[light]),
            test::picture(plain.normals, plain.albedo, info.lights[light])};
        for (std::size_t k = 0; k < values; ++k) {
            const auto truth = static_cast<double>(image.values()[k]);
            errors[0].add(static_cast<double>(lit[0].values()[k]), truth);
            errors[1].add(static_cast<double>(lit[1].values()[k]), truth);
            errors[2].add(coefficients.col(static_cast<Eigen::Index>(k)).dot(t), truth);
        }
    }
    std::printf(
        "{\n  \"measurement\": \"%s\",\n  \"lights_held_out\": %zu,\n  \"psnr_db\": "
        "{\"robust_stereo\": %.2f, \"least_squares_stereo\": %.2f, "
        "\"polynomial_texture_map\": %.2f}\n}\n",
        info.name.c_str(), options.without_lights.size(), errors[0].psnr(),
        errors[1].psnr(), errors[2].psnr());
    return 0;
}

}  // namespace
}  // namespace sateen

int main(int argc, char** argv) {
    const std::string mode = argc > 1 ? argv[1] : "";
    if (mode == "truth" && argc == 4) return sateen::compare_with_truth(argv[2], argv[3]);
    if (mode == "relight" && argc == 3) return sateen::predict_held_out(argv[2]);
    std::fprintf(stderr,
                 "usage: surface_bench truth MEASUREMENT TRUTH_FOLDER\n"
                 "       surface_bench relight MEASUREMENT\n");
    return 2;
}
