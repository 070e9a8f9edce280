// SPDX-License-Identifier: Apache-2.0
// The surface of an evaluator: displacement, shading, shadow. See evaluate.hpp.
#include <algorithm>
#include <cmath>

#include "sateen/synthesis/evaluate.hpp"
#include "sateen/synthesis/surface.hpp"
#include "synthesis/texel.hpp"

namespace sateen {
namespace {

constexpr int kViewSteps = 32;
constexpr int kBisections = 5;
constexpr int kLightSteps = 16;
// Directions lower than this are followed as if they had this height.
constexpr float kLeastHeight = 0.1F;

}  // namespace

// On the torus of the textures: their pixels are those of the range map.
Result<void> Evaluator::take_surface(const Surface& surface, std::uint64_t seed) {
    SATEEN_TRY(const ToroidalRange range,
               draw_toroidal_range(surface, side_, side_, seed));
    const Image normals = normals_of(range.height_px.plane(0), Border::wraps);
    const float unit = 1 / static_cast<float>(side_);
    relief_.resize(4 * side_ * side_);
    for (std::size_t i = 0; i < side_ * side_; ++i) {
        for (std::size_t c = 0; c < 3; ++c) relief_[4 * i + c] = normals.plane(c).data[i];
        const float height = unit * range.height_px.plane(0).data[i];
        relief_[4 * i + 3] = height;
        lowest_ = i == 0 ? height : std::min(lowest_, height);
        highest_ = i == 0 ? height : std::max(highest_, height);
    }
    delit_ = surface.delit;
    return {};
}

// Normal, not renormalised, and height.
std::array<float, 4> Evaluator::relief_at(float u, float v) const {
    Texel sum;
    sum.add(relief_.data(), BilinearTaps(u, v, side_), 1);
    return sum.value();
}

// Where the view ray through (u, v, 0) meets the surface.
std::array<float, 2> Evaluator::displaced(const std::array<float, 3>& view, float u,
                                          float v) const {
    if (mode_ == Relief::shading) return {u, v};
    const float slope = 1 / std::max(view[2], kLeastHeight);
    const float dx = view[0] * slope;
    const float dy = view[1] * slope;
    const auto height = [&](float z) { return relief_at(u + z * dx, v + z * dy)[3]; };
    if (mode_ == Relief::parallax) {
        const float z = height(0);
        return {u + z * dx, v + z * dy};
    }
    // From the highest plane down until the ray is below the surface, then by bisection.
    const float step = (highest_ - lowest_) / static_cast<float>(kViewSteps);
    float above = highest_;
    float below = lowest_;
    for (int i = 1; i <= kViewSteps; ++i) {
        const float z = highest_ - step * static_cast<float>(i);
        if (height(z) >= z) {
            below = z;
            break;
        }
        above = z;
    }
    for (int i = 0; i < kBisections; ++i) {
        const float z = 0.5F * (above + below);
        (height(z) >= z ? below : above) = z;
    }
    const float z = 0.5F * (above + below);
    return {u + z * dx, v + z * dy};
}

bool Evaluator::is_shadowed(const std::array<float, 3>& light, float u, float v) const {
    const float slope = 1 / std::max(light[2], kLeastHeight);
    // A start a hundredth of the range above the surface does not shade itself.
    const float start = relief_at(u, v)[3] + 0.01F * (highest_ - lowest_);
    const float step = (highest_ - start) / static_cast<float>(kLightSteps);
    for (int i = 1; i <= kLightSteps; ++i) {
        const float rise = step * static_cast<float>(i);
        const float x = u + rise * light[0] * slope;
        const float y = v + rise * light[1] * slope;
        if (relief_at(x, y)[3] > start + rise) return true;
    }
    return false;
}

ShadingMoments Evaluator::moments_under(const std::array<float, 3>& light,
                                        std::span<double> shading) const {
    const std::size_t every = side_ * side_ / shading.size();
    double sum = 0;
    for (std::size_t i = 0; i < shading.size(); ++i) {
        const float* n = relief_.data() + 4 * i * every;
        shading[i] = static_cast<double>(
            std::max(0.0F, n[0] * light[0] + n[1] * light[1] + n[2] * light[2]));
        sum += shading[i];
    }
    const auto count = static_cast<double>(shading.size());
    const double elsewhere = static_cast<double>(ambient_) * sum / count;
    double squares = 0;
    double roots = 0;
    for (double& t : shading) {
        t += elsewhere;
        squares += t * t;
        roots += std::sqrt(t);
    }
    return {static_cast<float>(sum / count + elsewhere),
            static_cast<float>(squares / count), static_cast<float>(roots / count)};
}

void Evaluator::tabulate_shading() {
    if (!delit_) return;
    // A few thousand normals tell the moments to a percent.
    constexpr std::size_t kNormals = 4096;
    std::vector<double> shading(std::min(kNormals, side_ * side_));
    moments_.resize(kMomentSide * kMomentSide);
    constexpr float kHalf = 0.5F * static_cast<float>(kMomentSide - 1);
    for (std::size_t r = 0; r < kMomentSide; ++r)
        for (std::size_t c = 0; c < kMomentSide; ++c) {
            float x = static_cast<float>(c) / kHalf - 1;
            float y = static_cast<float>(r) / kHalf - 1;
            // Past the horizon, where the table is read only to interpolate: the horizon.
            const float out = std::max(1.0F, std::sqrt(x * x + y * y));
            x /= out;
            y /= out;
            const float s = x * x + y * y;
            moments_[r * kMomentSide + c] = moments_under(
                {2 * x / (1 + s), 2 * y / (1 + s), (1 - s) / (1 + s)}, shading);
        }
}

ShadingMoments Evaluator::shading_moments(const std::array<float, 3>& light) const {
    if (moments_.empty()) return {};
    constexpr float kHalf = 0.5F * static_cast<float>(kMomentSide - 1);
    constexpr auto kLast = static_cast<float>(kMomentSide - 2);
    const float scale = kHalf / (1 + std::max(0.0F, light[2]));
    const float x = kHalf + light[0] * scale;
    const float y = kHalf + light[1] * scale;
    const float col = std::clamp(std::floor(x), 0.0F, kLast);
    const float row = std::clamp(std::floor(y), 0.0F, kLast);
    const float px = x - col;
    const float py = y - row;
    const ShadingMoments* at = moments_.data() +
                               static_cast<std::size_t>(row) * kMomentSide +
                               static_cast<std::size_t>(col);
    const auto mix = [&](float ShadingMoments::*part) {
        return (1 - py) * ((1 - px) * at[0].*part + px * at[1].*part) +
               py * ((1 - px) * at[kMomentSide].*part + px * at[kMomentSide + 1].*part);
    };
    return {mix(&ShadingMoments::mean), mix(&ShadingMoments::mean_square),
            mix(&ShadingMoments::mean_root)};
}

}  // namespace sateen
