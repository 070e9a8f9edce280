// SPDX-License-Identifier: Apache-2.0
// A tileable patch as maps. See baked_maps.hpp.
#include "baked_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base_colour.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/synthesis/surface.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen::cli {
namespace {

using Vector = std::array<float, 3>;

float dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Mean luminance of what a subspace shows, from the mean of its transform.
float mean_luminance(const Subspace& subspace) {
    std::array<float, 3> rgb{};
    for (std::size_t b = 0; b < 3; ++b) {
        const float code =
            subspace.spectral.mean[std::min(b, subspace.spectral.mean.size() - 1)];
        rgb[b] = subspace.spectral.tone == Tone::srgb ? srgb_decode(code) : code;
    }
    return 0.2126F * rgb[0] + 0.7152F * rgb[1] + 0.0722F * rgb[2];
}

/// And of a pair of directions.
float mean_luminance(const EncodedAppearance& e, std::size_t bands) {
    std::array<float, 3> rgb{};
    for (std::size_t b = 0; b < 3; ++b)
        rgb[b] = std::pow(std::max(0.0F, e[std::min(b, bands - 1)]), 3.0F);
    return 0.2126F * rgb[0] + 0.7152F * rgb[1] + 0.0722F * rgb[2];
}

/// The GGX lobe with Smith's height-correlated shadowing, times cos θ of the light and π, so that
/// a white matt surface has cos θ [Walter et al. 2007; Heitz 2014].
float ggx_lobe(Direction view, Direction light, float alpha) {
    const Vector v = to_vector(view);
    const Vector l = to_vector(light);
    Vector h = {v[0] + l[0], v[1] + l[1], v[2] + l[2]};
    const float length = std::sqrt(dot(h, h));
    for (float& x : h) x /= length;
    const float a2 = alpha * alpha;
    const float t = h[2] * h[2] * (a2 - 1) + 1;
    const float D = a2 / (t * t);  // times π, which the scale takes
    const auto lambda = [&](float z) { return std::sqrt(a2 + (1 - a2) * z * z); };
    const float G = 2 * l[2] * v[2] / (v[2] * lambda(l[2]) + l[2] * lambda(v[2]));
    const float F = 0.04F + 0.96F * std::pow(1 - dot(v, h), 5.0F);
    return D * G * F / (4 * std::max(v[2], 0.05F));
}

/// The surface of a torus of this size, as heights and normals.
Result<void> bake_surface(const Material& material, const BakeOptions& options,
                          BakedMaps& maps) {
    if (!material.surface) {
        maps.normal = Image(3, options.rows, options.cols);
        std::fill_n(maps.normal.plane(0).data, 2 * maps.normal.plane(0).size(), 0.5F);
        std::fill_n(maps.normal.plane(2).data, maps.normal.plane(2).size(), 1.0F);
        return {};
    }
    SATEEN_TRY(ToroidalRange range, draw_toroidal_range(*material.surface, options.rows,
                                                        options.cols, options.seed));
    maps.normal = normals_of(range.height_px.plane(0), Border::wraps);
    for (float& n : maps.normal.values()) n = 0.5F + 0.5F * n;
    maps.height_px = std::move(range.height_px);
    return {};
}

/// Mean over the 5 x 5 torus neighbourhood of every site.
void average(PlaneView<float> plane) {
    constexpr std::size_t kReach = 2;
    const std::size_t rows = plane.rows;
    const std::size_t cols = plane.cols;
    std::vector<float> across(rows * cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c)
            for (std::size_t k = 0; k <= 2 * kReach; ++k)
                across[r * cols + c] +=
                    plane.row(r)[(c + k + kReach * (cols - 1)) % cols];
    constexpr float kShare = 1.0F / ((2 * kReach + 1) * (2 * kReach + 1));
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            float sum = 0;
            for (std::size_t k = 0; k <= 2 * kReach; ++k)
                sum += across[((r + k + kReach * (rows - 1)) % rows) * cols + c];
            plane.row(r)[c] = kShare * sum;
        }
}

/// Roughness of every texel. A lobe of α over slopes of variance σ² along each axis looks like one
/// of α² + 2σ² [Olano & Baker 2010, LEAN mapping]. The fitted lobe is that of the whole surface:
/// its own slopes are taken off, and those around each texel come back.
Image roughness_map(float fitted, const Image& normal) {
    constexpr float kLeastAlpha = 0.04F;
    const std::size_t pixels = normal.plane_size();
    Image parts(3, normal.rows(), normal.cols());  // p, q, p² + q²
    std::array<double, 3> sums{};
    for (std::size_t i = 0; i < pixels; ++i) {
        const float z = std::max(0.05F, 2 * normal.plane(2).data[i] - 1);
        const float p = (1 - 2 * normal.plane(0).data[i]) / z;
        const float q = (1 - 2 * normal.plane(1).data[i]) / z;
        const std::array<float, 3> values = {p, q, p * p + q * q};
        for (std::size_t b = 0; b < 3; ++b) {
            parts.plane(b).data[i] = values[b];
            sums[b] += static_cast<double>(values[b]) / static_cast<double>(pixels);
        }
    }
    // 2σ², the mean of both axes being half of it.
    const auto all = static_cast<float>(sums[2] - sums[0] * sums[0] - sums[1] * sums[1]);
    const float alpha = fitted * fitted;
    const float own = std::max(kLeastAlpha * kLeastAlpha, alpha * alpha - all);
    for (std::size_t b = 0; b < 3; ++b) average(parts.plane(b));
    Image out(1, normal.rows(), normal.cols());
    for (std::size_t i = 0; i < pixels; ++i) {
        const float p = parts.plane(0).data[i];
        const float q = parts.plane(1).data[i];
        const float around = std::max(0.0F, parts.plane(2).data[i] - p * p - q * q);
        out.plane(0).data[i] = std::sqrt(std::sqrt(std::min(1.0F, own + around)));
    }
    return out;
}

Image in_three_bands(Image image) {
    if (image.bands() == 3) return image;
    Image out(3, image.rows(), image.cols());
    for (std::size_t b = 0; b < 3; ++b)
        std::copy_n(image.plane(0).data, image.plane(0).size(), out.plane(b).data);
    return out;
}

}  // namespace

float fitted_roughness(const Material& material) {
    struct Sample {
        Direction view, light;
        float luminance;
    };
    std::vector<Sample> samples;
    if (material.views.empty()) return 1;
    const auto add = [&](std::size_t view, std::size_t light, float luminance) {
        // Lights at the horizon tell little and weigh much.
        if (material.lights[light].theta < 1.45F)
            samples.push_back({material.views[view], material.lights[light], luminance});
    };
    if (material.reflectance) {
        constexpr std::size_t kSamples = 512;
        const std::size_t pairs = material.views.size() * material.lights.size();
        const std::size_t step = 1 + pairs / kSamples;
        for (std::size_t i = 0; i < pairs; i += step) {
            const std::size_t view = i % material.views.size();
            const std::size_t light = i / material.views.size();
            add(view, light,
                mean_luminance(encoded_appearance(*material.reflectance, view, light),
                               material.bands));
        }
    } else {
        for (const Subspace& subspace : material.subspaces)
            add(subspace.view, subspace.light, mean_luminance(subspace));
    }
    if (samples.size() < 4) return 1;
    float best = 1;
    double least = std::numeric_limits<double>::infinity();
    for (int step = 20; step >= 4; --step) {
        const float roughness = 0.05F * static_cast<float>(step);
        // Least squares for the albedo beside the lobe.
        double products = 0;
        double squares = 0;
        std::vector<double> rest;
        for (const Sample& s : samples) {
            const auto cosine = static_cast<double>(std::cos(s.light.theta));
            const double lobe =
                static_cast<double>(ggx_lobe(s.view, s.light, roughness * roughness));
            const double value = static_cast<double>(s.luminance) *
                                 (material.cosine_included ? 1.0 : cosine);
            rest.push_back(value - lobe);
            products += (value - lobe) * cosine;
            squares += cosine * cosine;
        }
        const double albedo = std::max(0.0, products / squares);
        double error = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double miss =
                rest[i] - albedo * static_cast<double>(std::cos(samples[i].light.theta));
            error += miss * miss;
        }
        if (error < least) {
            least = error;
            best = roughness;
        }
    }
    return best;
}

Result<BakedMaps> bake_maps(const Material& material, const BakeOptions& options,
                            Executor& executor, Progress& progress) {
    BakedMaps maps;
    SynthesisOptions synthesis;
    synthesis.rows = options.rows;
    synthesis.cols = options.cols;
    synthesis.seed = options.seed;
    synthesis.tileable = true;
    SATEEN_TRY(Image colour, draw_base_colour(material, synthesis, executor, progress));
    maps.base_colour = in_three_bands(std::move(colour));
    SATEEN_CHECK(bake_surface(material, options, maps));
    maps.roughness = roughness_map(fitted_roughness(material), maps.normal);
    if (material.pixels_per_mm) {
        const float metres = 1e-3F / *material.pixels_per_mm;
        maps.width_m = static_cast<float>(options.cols) * metres;
        maps.height_m = static_cast<float>(options.rows) * metres;
    }
    return maps;
}

}  // namespace sateen::cli
