// SPDX-License-Identifier: Apache-2.0
// The textures of an evaluator and their blend. See evaluate.hpp; the surface is in
// evaluate_relief.cpp.
#include "sateen/synthesis/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/blend_batch.hpp"
#include "synthesis/texel.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLeastSide = 16;
constexpr std::size_t kMostSide = 2048;
constexpr float kLeastShading = 1e-4F;

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
    if (material.surface) {
        out.mode_ = options.relief;
        out.self_shadow_ = options.self_shadow && options.relief != Relief::none;
        SATEEN_CHECK(out.take_surface(*material.surface, options.seed));
        if (options.relief == Relief::none) out.delit_ = false;
        if (out.delit_) {
            out.ambient_ = material.surface->ambient;
            out.least_shading_ = out.ambient_ / (1 + out.ambient_);
        }
        out.tabulate_shading();
    }
    return out;
}

FactorShape Evaluator::shading_shape(const ShadingMoments& moments) const {
    const float mean = std::max(moments.mean, kLeastShading);
    FactorShape shape;
    shape.square = std::log(std::max(1.0F, moments.mean_square / (mean * mean)));
    const float root = moments.mean_root * moments.mean_root;
    shape.root =
        std::max(0.0F, 4 * std::log(mean / std::max(root, kLeastShading * mean)));
    return shape;
}

Evaluator::Directional Evaluator::prepare(const std::array<float, 3>& view,
                                          const std::array<float, 3>& light) const {
    Directional at;
    at.view = view;
    at.light = light;
    FactorShape shading;
    if (delit_ && light[2] > 0) {
        const ShadingMoments moments = shading_moments(light);
        at.shading_scale = 1 / std::max(moments.mean, kLeastShading);
        shading = shading_shape(moments);
    }
    at.blend = interpolation_.at(view, light, shading);
    return at;
}

float Evaluator::shaded(const std::array<float, 3>& view,
                        const std::array<float, 3>& light, float scale, float& u,
                        float& v) const {
    const auto [x, y] = displaced(view, u, v);
    u = x;
    v = y;
    if (self_shadow_ && is_shadowed(light, u, v)) return least_shading_;
    if (!delit_) return 1;
    const std::array<float, 4> n = relief_at(u, v);
    return scale * std::max(0.0F, n[0] * light[0] + n[1] * light[1] + n[2] * light[2]) +
           least_shading_;
}

//     value_c = max(0, offset_c + gain_c (x_c s)^power),  x the blend, s the shading of mean 1
std::array<float, 3> Evaluator::sample(const Directional& at, float u, float v) const {
    float shading = 1;
    if (mode_ != Relief::none)
        shading = shaded(at.view, at.light, at.shading_scale, u, v);
    const BilinearTaps taps(u, v, side_);
    Texel sum;
    for (std::size_t i = 0; i < at.blend.count; ++i)
        sum.add(texels(at.blend.subspace[i]).data(), taps, at.blend.weight[i]);
    std::array<float, 3> out;
    for (std::size_t c = 0; c < 3; ++c)
        out[c] = value_of(at.blend, c, sum.value()[c] * shading);
    return out;
}

void Evaluator::evaluate(std::span<const ShadingPoint> points,
                         std::span<std::array<float, 3>> out) const {
    for (std::size_t first = 0; first < points.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, points.size() - first);
        const std::span batch = points.subspan(first, count);
        const ShadingPoint& common = batch.front();
        if (std::all_of(batch.begin(), batch.end(), [&](const ShadingPoint& point) {
                return point.view == common.view && point.light == common.light;
            })) {
            const Directional at = prepare(common.view, common.light);
            for (std::size_t i = 0; i < count; ++i)
                out[first + i] = sample(at, batch[i].u, batch[i].v);
        } else {
            evaluate_batch(batch, out.subspan(first, count));
        }
    }
}

void Evaluator::evaluate_batch(std::span<const ShadingPoint> points,
                               std::span<std::array<float, 3>> out) const {
    const std::size_t count = points.size();
    DirectionBatch directions;
    FactorBatch factors;
    BatchLane scale;
    directions.count = count;
    // Lanes up to the end of the last vector repeat the last point.
    for (std::size_t i = 0; i < kBatch; ++i) {
        const ShadingPoint& point = points[std::min(i, count - 1)];
        for (std::size_t c = 0; c < 3; ++c) {
            directions.view[c][i] = point.view[c];
            directions.light[c][i] = point.light[c];
        }
        factors.square[i] = 0;
        factors.root[i] = 0;
        scale[i] = 1;
        if (!delit_ || point.light[2] <= 0) continue;
        const ShadingMoments moments = shading_moments(point.light);
        const FactorShape shape = shading_shape(moments);
        factors.square[i] = shape.square;
        factors.root[i] = shape.root;
        scale[i] = 1 / std::max(moments.mean, kLeastShading);
    }
    BlendBatch blends;
    interpolation_.at(directions, factors, blends);
    BatchLane u;
    BatchLane v;
    BatchLane shading;
    for (std::size_t i = 0; i < kBatch; ++i) {
        const ShadingPoint& point = points[std::min(i, count - 1)];
        u[i] = point.u;
        v[i] = point.v;
        shading[i] = 1;
        if (mode_ != Relief::none)
            shading[i] = shaded(point.view, point.light, scale[i], u[i], v[i]);
    }
    VectorBatch x = {};
    texture_batch(texels_.data(), side_, blends, u, v, count, x);
    if (delit_ || self_shadow_)
        for (BatchLane& band : x)
            for (std::size_t i = 0; i < kBatch; ++i) band[i] *= shading[i];
    shape_batch(blends, count, x);
    for (std::size_t i = 0; i < count; ++i) out[i] = {x[0][i], x[1][i], x[2][i]};
}

}  // namespace sateen
