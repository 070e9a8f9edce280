// SPDX-License-Identifier: Apache-2.0
// The textures of an evaluator and their blend. See evaluate.hpp; the surface is in
// evaluate_relief.cpp.
#include "sateen/synthesis/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/texel.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLeastSide = 16;
constexpr std::size_t kMostSide = 2048;

}  // namespace

Result<Evaluator> Evaluator::create(const Material& material,
                                    const EvaluatorOptions& options, Executor& executor,
                                    Progress& progress) {
    if (options.side < kLeastSide || options.side > kMostSide)
        return Error{Errc::invalid_argument,
                     "textures of " + std::to_string(options.side) +
                         " pixels a side, expected " + std::to_string(kLeastSide) +
                         " to " + std::to_string(kMostSide)};
    std::vector<std::size_t> all(material.subspaces.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<Image> textures;
    SynthesisOptions drawing;
    drawing.rows = options.side;
    drawing.cols = options.side;
    drawing.tileable = true;
    drawing.seed = options.seed;
    SATEEN_CHECK(synthesise_tiles(
        material, all, drawing,
        [&](std::size_t, Image texture) -> Result<void> {
            textures.push_back(std::move(texture));
            return {};
        },
        executor, progress));
    SATEEN_TRY(DirectionalInterpolation interpolation,
               DirectionalInterpolation::create(material, texture_moments(textures),
                                                options.interpolation));
    Evaluator out(std::move(interpolation));
    out.side_ = options.side;
    out.bands_ = material.bands;
    const std::size_t pixels = options.side * options.side;
    out.texels_.resize(textures.size() * pixels * 4);
    for (std::size_t k = 0; k < textures.size(); ++k)
        for (std::size_t b = 0; b < 3; ++b) {
            const float* from = textures[k].plane(std::min(b, out.bands_ - 1)).data;
            float* to = out.texels_.data() + k * pixels * 4 + b;
            for (std::size_t i = 0; i < pixels; ++i) to[4 * i] = from[i];
        }
    if (material.surface && options.relief != Relief::none) {
        out.mode_ = options.relief;
        out.self_shadow_ = options.self_shadow;
        SATEEN_CHECK(out.take_surface(*material.surface, options.seed));
        out.tabulate_shading();
    }
    return out;
}

Evaluator::Directional Evaluator::prepare(const std::array<float, 3>& view,
                                          const std::array<float, 3>& light) const {
    Directional at;
    at.view = view;
    at.light = light;
    FactorShape shading;
    if (delit_ && light[2] > 0) {
        const ShadingMoments moments = shading_moments(light);
        const float mean = std::max(moments.mean, 1e-4F);
        at.shading_scale = 1 / mean;
        shading.square = std::log(std::max(1.0F, moments.mean_square / (mean * mean)));
        shading.root = std::max(
            0.0F, 4 * std::log(mean / std::max(moments.mean_root * moments.mean_root,
                                               1e-4F * mean)));
    }
    at.blend = interpolation_.at(view, light, shading);
    if (bands_ == 1) {
        at.blend.gain[1] = at.blend.gain[2] = at.blend.gain[0];
        at.blend.offset[1] = at.blend.offset[2] = at.blend.offset[0];
    }
    return at;
}

std::array<float, 3> Evaluator::texture(const Blend& blend, float u, float v) const {
    const BilinearTaps taps(u, v, side_);
    Texel sum;
    for (std::size_t i = 0; i < blend.count; ++i)
        sum.add(texels_.data() + blend.subspace[i] * side_ * side_ * 4, taps,
                blend.weight[i]);
    const std::array<float, 4> value = sum.value();
    return {value[0], value[1], value[2]};
}

//     value_c = max(0, offset_c + gain_c (x_c s)^power),  x the blend, s the shading of mean 1
std::array<float, 3> Evaluator::sample(const Directional& at, float u, float v) const {
    float shading = 1;
    if (mode_ != Relief::none) {
        const auto [x, y] = displaced(at.view, u, v);
        u = x;
        v = y;
        if (delit_) {
            const std::array<float, 4> n = relief_at(u, v);
            shading = at.shading_scale *
                      std::max(0.0F, n[0] * at.light[0] + n[1] * at.light[1] +
                                         n[2] * at.light[2]);
        }
        if (self_shadow_ && is_shadowed(at.light, u, v)) shading = 0;
    }
    const std::array<float, 3> x = texture(at.blend, u, v);
    std::array<float, 3> out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = value_of(at.blend, c, x[c] * shading);
    return out;
}

void Evaluator::evaluate(std::span<const ShadingPoint> points,
                         std::span<std::array<float, 3>> out) const {
    Directional at;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ShadingPoint& point = points[i];
        if (i == 0 || point.view != at.view || point.light != at.light)
            at = prepare(point.view, point.light);
        out[i] = sample(at, point.u, point.v);
    }
}

}  // namespace sateen
