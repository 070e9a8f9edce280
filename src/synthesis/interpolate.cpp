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

// Least and most of h/C of a blend: 1 for lognormal values, 4 where a square root changes no
// contrast, as where all is either black or white.
constexpr float kLeastRoot = 0.5F;
constexpr float kMostRoot = 2.83F;
constexpr float kLeastPower = 0.5F;
// Blends of less than this for C, a contrast of 10^-4, are left alone.
constexpr float kUniform = 1e-8F;

// -8 ln E[√(x / mean)]
double root_shape(double mean, double root_mean) {
    if (!(mean > 0) || !(root_mean > 0)) return 0;
    return std::max(0.0, -8 * std::log(root_mean / std::sqrt(mean)));
}

}  // namespace

TextureMoments texture_moments(std::span<const Image> textures) {
    TextureMoments moments;
    const std::size_t n = textures.size();
    moments.mean.resize(n);
    moments.shape.resize(n);
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
        std::array<double, 4> roots{};
        for (std::size_t i = 0; i < pixels; ++i) {
            std::array<float, 3> colour{};
            for (std::size_t b = 0; b < bands; ++b) {
                colour[b] = textures[k].plane(b).data[i];
                roots[b] += static_cast<double>(std::sqrt(colour[b]));
            }
            const float Y = luminance(colour, bands);
            roots[3] += static_cast<double>(std::sqrt(Y));
            deviations[k][i] = Y - mean;
        }
        const auto root = [&](float of, double sum) {
            return root_shape(static_cast<double>(of), sum / static_cast<double>(pixels));
        };
        const double variance =
            std::inner_product(deviations[k].begin(), deviations[k].end(),
                               deviations[k].begin(), 0.0) /
            static_cast<double>(pixels);
        const auto Y = static_cast<double>(mean);
        const double C = Y > 0 ? std::log1p(variance / (Y * Y)) : 0.0;
        const double h = root(mean, roots[3]);
        moments.shape[k] = {1, 1, 1, 0};
        // Of nearly uniform textures it is rounding.
        if (!(C > 1e-5)) continue;
        for (std::size_t b = 0; b < bands; ++b)
            moments.shape[k][b] =
                static_cast<float>(root(moments.mean[k][b], roots[b]) / h);
        moments.shape[k][3] = static_cast<float>((h - C) / (C * C));
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
    for (const std::array<float, 3>& mean : out.moments_.mean)
        out.luminances_.push_back(luminance(mean, material.bands));
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
                                   const FactorShape& factor) const {
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
    std::array<float, 4> shape{};
    float variance = 0;
    float own = 0;
    for (std::size_t i = 0; i < blend.count; ++i) {
        const std::size_t k = blend.subspace[i];
        const float Y = blend.weight[i] * luminances_[k];
        own += Y;
        for (std::size_t b = 0; b < 3; ++b)
            mean[b] += blend.weight[i] * moments_.mean[k][b];
        for (std::size_t c = 0; c < 4; ++c) shape[c] += Y * moments_.shape[k][c];
        const float* covariance = moments_.covariance.data() + k * n;
        float half = 0.5F * blend.weight[i] * covariance[k];
        for (std::size_t j = 0; j < i; ++j)
            half += blend.weight[j] * covariance[blend.subspace[j]];
        variance += 2 * blend.weight[i] * half;
    }
    fade = cosine_for(root * root * root);
    // ln E[t²] and -8 ln E[√t] of the texture, then of the texture times the factor.
    float C = 0;
    float h = 0;
    if (own > 0) {
        for (float& value : shape) value /= own;
        C = std::log1p(std::max(0.0F, variance) / (own * own));
        h = C + C * C * shape[3];
    }
    C += factor.square;
    const float wanted = std::max(0.0F, e[bands_]);
    float amplify = 1;
    float slope = 0;  // of c_c / h_c in the power
    if (C > kUniform) {
        const float H = std::clamp(h + factor.root, kLeastRoot * C, kMostRoot * C);
        // ln(1 + contrast²) of t^γ is H/4 at γ = ½, C at 1, and taken for C γ^p.
        const float p = std::log2(4 * C / H);
        const float power = std::pow(std::log1p(wanted * wanted) / C, 1 / p);
        blend.power = std::clamp(power, kLeastPower, 1.0F);
        // What is left for the straight line.
        const float contrast = std::sqrt(std::expm1(C * std::pow(blend.power, p)));
        amplify = std::min(kMaxContrastGain, wanted / contrast);
        slope = (C / H - 1) / 1.5F;
    }
    const float gamma = blend.power;
    const float curve = 0.5F * gamma * (1 - gamma) * (1 + slope * (gamma - 0.5F));
    for (std::size_t b = 0; b < bands_; ++b) {
        const float positive = std::max(0.0F, e[b]);
        const float target = fade * positive * positive * positive;
        // μ^γ E[(x/μ)^γ], E[t^γ] = exp(-γ (1 - γ)/2 c(γ)), c linear through h at ½ and C at 2.
        const float of_power =
            std::pow(mean[b], gamma) * std::exp(-curve * (shape[b] * h + factor.root));
        blend.offset[b] = mean[b] > 0 ? target * (1 - amplify) : target;
        blend.gain[b] = mean[b] > 0 ? target * amplify / of_power : 0;
    }
    return blend;
}

}  // namespace sateen
