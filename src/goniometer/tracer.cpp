// SPDX-License-Identifier: Apache-2.0
// Primary and shadow rays, and reflectance. See tracer.hpp.
#include "goniometer/tracer.hpp"

#include <algorithm>
#include <utility>

#include "goniometer/reflectance.hpp"

namespace sateen::goniometer {
namespace {

/// Shadow rays begin so far above the surface, in texels.
constexpr float kLift = 2e-3F;
constexpr std::size_t kBlocksTogether = 64;

float wrapped(float value, float period) {
    const float rest = value - period * std::floor(value / period);
    return rest < period ? rest : 0;
}

}  // namespace

Result<Tracer> Tracer::create(const SurfaceMaps& surface, float width, float depth,
                              float reach) {
    const std::size_t rows = surface.height.rows();
    const std::size_t cols = surface.height.cols();
    const float cell_x = width / static_cast<float>(cols);
    const float cell_y = depth / static_cast<float>(rows);
    SATEEN_TRY(HeightScene scene,
               HeightScene::create(surface.height, cell_x, cell_y, reach));
    Tracer tracer(std::move(scene));
    tracer.rows_ = rows;
    tracer.cols_ = cols;
    tracer.width_ = width;
    tracer.depth_ = depth;
    const auto [low, high] = std::minmax_element(surface.height.values().begin(),
                                                 surface.height.values().end());
    tracer.lowest_ = *low;
    tracer.highest_ = *high;
    tracer.lift_ = kLift * std::min(cell_x, cell_y);
    tracer.texels_.resize(rows * cols);
    const std::size_t plane = rows * cols;
    for (std::size_t i = 0; i < plane; ++i)
        for (std::size_t band = 0; band < 3; ++band) {
            tracer.texels_[i][band] = surface.normal.values()[band * plane + i];
            tracer.texels_[i][3 + band] = surface.colour.values()[band * plane + i];
            tracer.texels_[i][6] = surface.roughness.values()[i];
        }
    return tracer;
}

float Tracer::wrap_x(float x) const {
    return wrapped(x, width_);
}

float Tracer::wrap_y(float y) const {
    return -wrapped(-y, depth_);
}

/// Bilinear between texel centres.
void Tracer::look_up(Hits::Block& block, std::size_t lane) const {
    const float col = block.point.x[lane] / width_ * static_cast<float>(cols_) - 0.5F;
    const float row = -block.point.y[lane] / depth_ * static_cast<float>(rows_) - 0.5F;
    const float left = std::floor(col);
    const float top = std::floor(row);
    const float u = col - left;
    const float v = row - top;
    // From -1 to the last: below zero is the last of the period before.
    const std::size_t c0 = left < 0 ? cols_ - 1 : static_cast<std::size_t>(left) % cols_;
    const std::size_t r0 = top < 0 ? rows_ - 1 : static_cast<std::size_t>(top) % rows_;
    const std::size_t c1 = (c0 + 1) % cols_;
    const std::size_t r1 = (r0 + 1) % rows_;
    const Texel& a = texels_[r0 * cols_ + c0];
    const Texel& b = texels_[r0 * cols_ + c1];
    const Texel& c = texels_[r1 * cols_ + c0];
    const Texel& d = texels_[r1 * cols_ + c1];
    Texel mean;
    for (std::size_t i = 0; i < mean.size(); ++i)
        mean[i] = (1 - v) * ((1 - u) * a[i] + u * b[i]) + v * ((1 - u) * c[i] + u * d[i]);
    const Vector normal = normalised({mean[0], mean[1], mean[2]});
    block.normal.x[lane] = normal[0];
    block.normal.y[lane] = normal[1];
    block.normal.z[lane] = normal[2];
    block.colour.x[lane] = mean[3];
    block.colour.y[lane] = mean[4];
    block.colour.z[lane] = mean[5];
    block.roughness[lane] = mean[6];
    block.alpha[lane] = alpha_of(mean[6]);
}

Hits Tracer::trace(std::span<const float> x, std::span<const float> y, Direction view,
                   Executor& executor) const {
    Hits hits;
    hits.count = x.size();
    hits.blocks.resize((x.size() + kLanes - 1) / kLanes);
    const Vector out = to_vector(view);
    const Vector in = {-out[0], -out[1], -out[2]};
    const float start = (highest_ + 1) / out[2];
    const auto trace_block = [&](std::size_t b) {
        Hits::Block& block = hits.blocks[b];
        Lanes origins;
        for (std::size_t i = 0; i < kLanes && b * kLanes + i < hits.count; ++i) {
            const std::size_t k = b * kLanes + i;
            block.met[i] = -1;
            origins.x[i] = x[k] + start * out[0];
            origins.y[i] = y[k] + start * out[1];
            origins.z[i] = start * out[2];
        }
        const std::array<float, kLanes> t = scene_.distances(origins, in, block.met);
        for (std::size_t i = 0; i < kLanes; ++i) {
            if (!std::isfinite(t[i])) block.met[i] = 0;
            if (block.met[i] == 0) {
                block.normal.z[i] = 1;
                block.alpha[i] = 1;
                continue;
            }
            block.point.x[i] = wrap_x(origins.x[i] + t[i] * in[0]);
            block.point.y[i] = wrap_y(origins.y[i] + t[i] * in[1]);
            block.point.z[i] = std::clamp(origins.z[i] + t[i] * in[2], lowest_, highest_);
            look_up(block, i);
        }
    };
    const std::size_t pieces =
        (hits.blocks.size() + kBlocksTogether - 1) / kBlocksTogether;
    parallel_for(executor, pieces, [&](std::size_t piece) {
        const std::size_t end =
            std::min(hits.blocks.size(), (piece + 1) * kBlocksTogether);
        for (std::size_t b = piece * kBlocksTogether; b < end; ++b) trace_block(b);
    });
    return hits;
}

Lanes Tracer::lifted(const Hits::Block& block) const {
    Lanes origins;
    for (std::size_t i = 0; i < kLanes; ++i) {
        origins.x[i] = block.point.x[i] + lift_ * block.normal.x[i];
        origins.y[i] = block.point.y[i] + lift_ * block.normal.y[i];
        origins.z[i] = block.point.z[i] + lift_ * block.normal.z[i];
    }
    return origins;
}

LaneMask Tracer::lit(const Hits::Block& block, const Vector& direction,
                     bool shadows) const {
    LaneMask facing{};
    std::int32_t any = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float cosine = block.normal.x[i] * direction[0] +
                             block.normal.y[i] * direction[1] +
                             block.normal.z[i] * direction[2];
        facing[i] = cosine > 0 ? block.met[i] : 0;
        any |= facing[i];
    }
    if (any == 0 || !shadows) return facing;
    return scene_.unoccluded(lifted(block), direction, facing);
}

std::array<float, kLanes> Tracer::free_path(const Hits::Block& block,
                                            const Vector& direction,
                                            const LaneMask& mask) const {
    return scene_.distances(lifted(block), direction, mask);
}

Reflected reflect(const Hits::Block& block, const Layer& layer, const Vector& view,
                  const Vector& light, const LaneMask& mask) {
    const Vector half =
        normalised({view[0] + light[0], view[1] + light[1], view[2] + light[2]});
    const float f = layer.specular ? fresnel(layer.f0, dot(view, half)) : 0;
    const Lanes& n = block.normal;
    Reflected result;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float nl = n.x[i] * light[0] + n.y[i] * light[1] + n.z[i] * light[2];
        const float nv = n.x[i] * view[0] + n.y[i] * view[1] + n.z[i] * view[2];
        const float nh = n.x[i] * half[0] + n.y[i] * half[1] + n.z[i] * half[2];
        const float received = mask[i] != 0 ? nl : 0.0F;
        const float body = layer.specular ? through_layer(layer.f0, nl, nv) : 1.0F;
        const float gloss = f * ggx(nl, nv, nh, block.alpha[i]);
        result[0][i] = received * (body * block.colour.x[i] + gloss);
        result[1][i] = received * (body * block.colour.y[i] + gloss);
        result[2][i] = received * (body * block.colour.z[i] + gloss);
    }
    return result;
}

}  // namespace sateen::goniometer
