// SPDX-License-Identifier: Apache-2.0
// Interpolation over views and lights. See interpolate.hpp.
#include "sateen/synthesis/interpolate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sateen/core/colour.hpp"

namespace sateen {
namespace {

constexpr std::array<float, 3> kLuminance = {
    static_cast<float>(kRelativeXyzOfLinearSrgb[1][0]),
    static_cast<float>(kRelativeXyzOfLinearSrgb[1][1]),
    static_cast<float>(kRelativeXyzOfLinearSrgb[1][2])};

float luminance(const std::array<float, 3>& colour, std::size_t bands) {
    if (bands == 1) return colour[0];
    return kLuminance[0] * colour[0] + kLuminance[1] * colour[1] +
           kLuminance[2] * colour[2];
}

float dot(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// A light far below the lowest measured one is weaker by the ratio of the cosines; one far
// above the only measured one is at most so much stronger.
constexpr float kMaxCosineRatio = 4;

}  // namespace

TextureMoments texture_moments(std::span<const Image> textures) {
    TextureMoments moments;
    const std::size_t n = textures.size();
    moments.mean.resize(n);
    moments.covariance.resize(n * n);
    if (n == 0) return moments;
    const std::size_t pixels = textures[0].plane_size();
    const std::size_t bands = textures[0].bands();
    std::vector<std::vector<float>> deviations(n);
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t b = 0; b < bands; ++b) {
            const auto plane = textures[k].plane(b);
            const double sum = std::accumulate(plane.data, plane.data + pixels, 0.0);
            moments.mean[k][b] = static_cast<float>(sum / static_cast<double>(pixels));
        }
        const float mean = luminance(moments.mean[k], bands);
        deviations[k].resize(pixels);
        for (std::size_t i = 0; i < pixels; ++i) {
            std::array<float, 3> colour{};
            for (std::size_t b = 0; b < bands; ++b)
                colour[b] = textures[k].plane(b).data[i];
            deviations[k][i] = luminance(colour, bands) - mean;
        }
    }
    for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k <= j; ++k) {
            const double sum = std::inner_product(
                deviations[j].begin(), deviations[j].end(), deviations[k].begin(), 0.0);
            moments.covariance[j * n + k] = moments.covariance[k * n + j] =
                static_cast<float>(sum / static_cast<double>(pixels));
        }
    return moments;
}

Result<DirectionalInterpolation> DirectionalInterpolation::create(
    const Material& material, TextureMoments moments,
    const InterpolationOptions& options) {
    DirectionalInterpolation out;
    out.moments_ = std::move(moments);
    out.options_ = options;
    out.bands_ = material.bands;
    out.cosine_included_ = material.cosine_included;
    if (material.index.empty()) return out;
    SATEEN_TRY(out.views_, DirectionMesh::create(material.views));
    SATEEN_TRY(out.lights_, DirectionMesh::create(material.lights));
    out.view_count_ = material.views.size();
    if (material.lights.size() * material.views.size() > kMaxPairs)
        return Error{Errc::limit_exceeded, std::to_string(material.lights.size()) +
                                               " lights and " +
                                               std::to_string(material.views.size()) +
                                               " views: more pairs to interpolate than " +
                                               std::to_string(kMaxPairs)};
    for (const Direction light : material.lights) {
        out.light_heights_.push_back(to_vector(light)[2]);
        out.light_roots_.push_back(std::cbrt(out.light_heights_.back()));
    }
    out.fill_index(material);
    if (options.reflectance && material.reflectance)
        out.take_reflectance(*material.reflectance);
    return out;
}

void DirectionalInterpolation::fill_index(const Material& material) {
    constexpr std::uint8_t kUnmeasured = 255;
    const std::size_t L = material.lights.size();
    const std::size_t V = view_count_;
    std::vector<std::uint8_t> measured(L * V, kUnmeasured);
    std::vector<std::vector<std::uint16_t>> views_of(L);
    for (const IndexEntry& entry : material.index) {
        measured[entry.light * V + entry.view] = entry.subspace;
        views_of[entry.light].push_back(entry.view);
    }
    index_ = measured;
    if (material.index.size() == L * V) return;
    std::vector<std::array<float, 3>> views;
    std::vector<std::array<float, 3>> lights;
    for (const Direction d : material.views) views.push_back(to_vector(d));
    for (const Direction d : material.lights) lights.push_back(to_vector(d));
    std::vector<std::size_t> nearest(L);
    for (std::size_t l = 0; l < L; ++l) {
        // Lights by their distance: no view makes up for one that is too far.
        std::iota(nearest.begin(), nearest.end(), std::size_t{0});
        std::stable_sort(nearest.begin(), nearest.end(), [&](auto a, auto b) {
            return dot(lights[a], lights[l]) > dot(lights[b], lights[l]);
        });
        for (std::size_t v = 0; v < V; ++v) {
            if (measured[l * V + v] != kUnmeasured) continue;
            float best = -3;
            for (const std::size_t other : nearest) {
                const float closeness = dot(lights[other], lights[l]);
                if (closeness + 1 <= best) break;
                for (const std::uint16_t view : views_of[other]) {
                    const float sum = closeness + dot(views[view], views[v]);
                    if (sum <= best) continue;
                    best = sum;
                    index_[l * V + v] = measured[other * V + view];
                }
            }
        }
    }
}

void DirectionalInterpolation::take_reflectance(const Reflectance& reflectance) {
    for (std::size_t l = 0; l < light_heights_.size(); ++l)
        for (std::size_t v = 0; v < view_count_; ++v)
            encoded_.push_back(encoded_appearance(reflectance, v, l));
}

Blend DirectionalInterpolation::at(const std::array<float, 3>& view,
                                   const std::array<float, 3>& light,
                                   float shading_contrast) const {
    Blend blend;
    blend.count = 1;
    blend.weight[0] = 1;
    if (light[2] <= 0 || view[2] <= 0) return blend;
    if (!views_) {
        // Of photographs the light is unknown: their values are taken for reflectance.
        blend.gain = {light[2], light[2], light[2]};
        return blend;
    }
    const auto weights_of = [&](const DirectionMesh& mesh,
                                const std::array<float, 3>& d) {
        return options_.three_nearest ? mesh.nearest_three(d) : mesh.interpolate(d);
    };
    const DirectionWeights v = weights_of(*views_, view);
    const DirectionWeights l = weights_of(*lights_, light);

    // 1. The 3 x 3 products, those of equal subspaces merged.
    blend.count = 0;
    EncodedAppearance e{};
    float height = 0;  // of the lights, interpolated as the textures are
    float root = 0;    // and as the reflectance is
    for (std::size_t i = 0; i < 3; ++i) {
        height += l.weight[i] * light_heights_[l.index[i]];
        root += l.weight[i] * light_roots_[l.index[i]];
        for (std::size_t j = 0; j < 3; ++j) {
            const float weight = l.weight[i] * v.weight[j];
            if (weight == 0) continue;
            const std::size_t pair = l.index[i] * view_count_ + v.index[j];
            if (!encoded_.empty())
                for (std::size_t c = 0; c < 4; ++c) e[c] += weight * encoded_[pair][c];
            const std::uint8_t k = index_[pair];
            std::size_t at = 0;
            while (at < blend.count && blend.subspace[at] != k) ++at;
            if (at == blend.count) {
                blend.subspace[at] = k;
                blend.weight[at] = 0;
                ++blend.count;
            }
            blend.weight[at] += weight;
        }
    }

    // 2. The cosine of the light for that of the interpolated lights: between them it makes
    // good for the chord, past them it lets the light set.
    const auto cosine_for = [&](float interpolated) {
        if (!cosine_included_) return light[2];
        return std::min(kMaxCosineRatio, light[2] / std::max(interpolated, 1e-3F));
    };
    float fade = cosine_for(height);
    blend.gain = {fade, fade, fade};
    if (encoded_.empty()) return blend;

    // 3. Mean colour and contrast of these directions in place of the blend's own.
    const std::size_t n = moments_.mean.size();
    std::array<float, 3> mean{};
    float variance = 0;
    for (std::size_t i = 0; i < blend.count; ++i) {
        const std::size_t k = blend.subspace[i];
        for (std::size_t b = 0; b < 3; ++b)
            mean[b] += blend.weight[i] * moments_.mean[k][b];
        const float* covariance = moments_.covariance.data() + k * n;
        float half = 0.5F * blend.weight[i] * covariance[k];
        for (std::size_t j = 0; j < i; ++j)
            half += blend.weight[j] * covariance[blend.subspace[j]];
        variance += 2 * blend.weight[i] * half;
    }
    fade = cosine_for(root * root * root);
    const float own = luminance(mean, bands_);
    const float contrast = own > 0 ? std::sqrt(std::max(0.0F, variance)) / own : 0.0F;
    const float s = shading_contrast * shading_contrast;
    const float total = std::sqrt((1 + contrast * contrast) * (1 + s) - 1);
    const float wanted = std::max(0.0F, e[bands_]);
    const float amplify =
        total > 1e-4F ? std::min(kMaxContrastGain, wanted / total) : 1.0F;
    for (std::size_t b = 0; b < bands_; ++b) {
        const float positive = std::max(0.0F, e[b]);
        const float target = fade * positive * positive * positive;
        blend.offset[b] = mean[b] > 0 ? target * (1 - amplify) : target;
        blend.gain[b] = mean[b] > 0 ? target * amplify / mean[b] : 0;
    }
    return blend;
}

}  // namespace sateen
