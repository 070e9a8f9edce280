// SPDX-License-Identifier: Apache-2.0
// Corduroy, weaves and knit: ribs and yarns.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "goniometer/preset_parts.hpp"
#include "goniometer/toroidal_noise.hpp"
#include "goniometer/tubes.hpp"

namespace sateen::goniometer {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

/// Plies that wind around a yarn: 0 in the grooves between them to 1 on top.
float plies(const Uppermost& top, float count, float turns_per_width) {
    const float angle = std::asin(std::clamp(top.across, -1.0F, 1.0F));
    const float phase =
        count * (angle / std::numbers::pi_v<float> + turns_per_width * top.along);
    return std::abs(std::cos(std::numbers::pi_v<float> * phase));
}

/// A weave of as many warps (down) as wefts (across).
struct Weave {
    int threads = 16;
    float radius = 0.5F;  ///< of a thread, in spacings
    float flatness = 0.6F;
    float lift = 0.3F;  ///< of a thread over another, in spacings
    float weft_radius = 0.5F;
};

/// Warp and weft; `warp_on_top(i, j)` at the crossing of warp i and weft j.
template <class F>
TubeCanvas woven(std::size_t side, NoiseKey key, const Weave& weave,
                 const F& warp_on_top) {
    TubeCanvas canvas(side);
    const int n = weave.threads;
    const float spacing = 1 / static_cast<float>(n);
    constexpr int kPieces = 8;
    const auto sign = [&](bool warp, int thread, int crossing) {
        const int other = (crossing % n + n) % n;
        const bool up = warp ? warp_on_top(thread, other) : !warp_on_top(other, thread);
        return up ? 1.0F : -1.0F;
    };
    for (const bool warp : {false, true})
        for (int thread = 0; thread < n; ++thread) {
            const auto yarn = static_cast<std::int32_t>(warp ? thread : n + thread);
            const float thick = 1 + 0.16F * (uniform(key, yarn, 0) - 0.5F);
            const float aside = 0.14F * (uniform(key, yarn, 1) - 0.5F);
            std::vector<AxisPoint> axis;
            for (int k = 0; k <= n * kPieces; ++k) {
                // Crossings lie at the middle of each spacing.
                const float at = static_cast<float>(k) / kPieces;
                const int before = static_cast<int>(std::floor(at - 0.5F));
                const float t = smooth_step(0, 1, at - 0.5F - static_cast<float>(before));
                const float z = (1 - t) * sign(warp, thread, before) +
                                t * sign(warp, thread, before + 1);
                const float place = (static_cast<float>(thread) + 0.5F + aside) * spacing;
                const float height = 0.5F * weave.lift * z * spacing;
                axis.push_back(warp ? AxisPoint{place, at * spacing, height}
                                    : AxisPoint{at * spacing, place, height});
            }
            const float radius = warp ? weave.radius : weave.weft_radius;
            canvas.draw(yarn, axis, thick * radius * spacing, weave.flatness);
        }
    return canvas;
}

/// What `spot(u, v, top)` makes of the yarns, its height added to theirs; `gap` is between
/// them.
template <class F>
SurfaceMaps paint_yarns(const TubeCanvas& canvas, const Spot& gap, const F& spot) {
    return paint(canvas.side(), [&](float u, float v, std::size_t r, std::size_t c) {
        const Uppermost& top = canvas.at(r, c);
        if (top.yarn < 0) return gap;
        Spot yarn = spot(u, v, top);
        yarn.height += top.z;
        return yarn;
    });
}

/// How the yarns of a weave are spun.
struct Yarns {
    float plies = 2;
    float turns = 10;            ///< of the plies along the cloth
    std::array<int, 2> slubs{};  ///< thick places, across and down
    int fuzz = 90;               ///< cells of the finest grain
};

/// A point of a yarn.
struct YarnPoint {
    float ply = 0;
    float slub = 0;
    float fuzz = 0;
    float tone = 0;  ///< of the whole yarn, -0.5 to 0.5
    bool warp = false;
};

/// A weave whose yarns are what `spot(point)` makes of them.
template <class Crossing, class F>
SurfaceMaps paint_weave(std::size_t side, std::uint64_t seed, const Weave& weave,
                        const Yarns& yarns, const Spot& gap, const Crossing& warp_on_top,
                        const F& spot) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    const TubeCanvas canvas = woven(side, key(1), weave, warp_on_top);
    return paint_yarns(canvas, gap, [&](float u, float v, const Uppermost& top) {
        return spot(
            YarnPoint{plies(top, yarns.plies, yarns.turns),
                      fractal_noise(key(2), u, v, yarns.slubs[0], yarns.slubs[1], 3),
                      fractal_noise(key(3), u, v, yarns.fuzz, yarns.fuzz, 2, 0.7F),
                      uniform(key(4), top.yarn, 0) - 0.5F, top.yarn < weave.threads});
    });
}

}  // namespace

SurfaceMaps corduroy(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    constexpr int kRibs = 11;
    constexpr float kTufts = 52;
    return paint(side, [&](float u, float v, std::size_t, std::size_t) {
        // The ends of the pile, bent this way and that, fray the edges of a rib.
        const float fray = fractal_noise(key(6), u, v, 6 * kRibs, 70, 2, 0.7F);
        const float sway =
            0.10F * fractal_noise(key(1), u, v, kRibs, 8, 2) + 0.16F * fray;
        const float across = kRibs * u + sway;
        const auto rib = static_cast<std::int32_t>(std::floor(across)) % kRibs;
        const float s = 2 * std::abs(across - std::floor(across) - 0.5F);
        const float pile = 1 - smooth_step(0.42F, 1.0F, s);
        // The tufts of one weft are combed together; rows of them show along the rib.
        const float shift = uniform(key(2), rib, 0);
        const float tuft = std::cos(kTurn * (kTufts * v + shift) +
                                    2.5F * gradient_noise(key(3), u, v, kRibs * 2, 26));
        const float fuzz = fractal_noise(key(4), u, v, 130, 60, 2, 0.7F);
        const float worn = fractal_noise(key(5), u, v, 5, 5, 3);
        Spot spot;
        spot.height = 0.018F * pile + 0.0011F * pile * tuft +
                      0.0050F * (0.3F + pile) * fuzz + 0.002F * worn;
        const float shade = (0.36F + 0.64F * pile) * (1 + 0.08F * tuft + 0.55F * fuzz +
                                                      0.20F * worn + 0.25F * fray);
        spot.colour = scaled({0.34F, 0.175F, 0.062F}, std::max(0.05F, shade));
        spot.roughness = 0.9F;
        return spot;
    });
}

SurfaceMaps plain_weave(std::size_t side, std::uint64_t seed) {
    constexpr Weave kWeave{16, 0.50F, 0.55F, 0.42F, 0.50F};
    return paint_weave(
        side, seed, kWeave, {.plies = 3, .turns = 11, .slubs = {12, 12}, .fuzz = 90},
        {.height = -0.035F, .colour = {0.06F, 0.05F, 0.035F}},
        [](int i, int j) { return (i + j) % 2 == 0; },
        [](const YarnPoint& at) {
            const Colour flax =
                at.warp ? Colour{0.56F, 0.48F, 0.345F} : Colour{0.50F, 0.415F, 0.285F};
            Spot spot;
            spot.height = 0.0022F * at.ply + 0.0012F * at.fuzz + 0.003F * at.slub;
            spot.colour =
                scaled(flax, (0.72F + 0.28F * at.ply) *
                                 (1 + 0.22F * at.tone + 0.3F * at.slub + 0.3F * at.fuzz));
            spot.roughness = 0.75F;
            return spot;
        });
}

SurfaceMaps twill(std::size_t side, std::uint64_t seed) {
    constexpr Weave kWeave{24, 0.54F, 0.6F, 0.55F, 0.46F};
    return paint_weave(
        side, seed, kWeave, {.plies = 2, .turns = 16, .slubs = {24, 5}, .fuzz = 100},
        {.height = -0.03F, .colour = {0.02F, 0.02F, 0.03F}},
        [](int i, int j) { return (i + j) % 4 != 0; },
        [](const YarnPoint& at) {
            // Indigo does not reach the core of a yarn: raised parts wear pale.
            const float worn = std::clamp(0.28F * at.ply + 0.7F * at.slub +
                                              0.25F * at.fuzz - 0.06F + 0.25F * at.tone,
                                          0.0F, 1.0F);
            const Colour blue =
                mixed({0.035F, 0.06F, 0.145F}, {0.30F, 0.36F, 0.46F}, worn);
            Spot spot;
            spot.height = 0.0014F * at.ply + 0.001F * at.fuzz + 0.002F * at.slub;
            spot.colour = scaled(at.warp ? blue : Colour{0.56F, 0.55F, 0.50F},
                                 1 + 0.3F * at.fuzz + 0.15F * at.tone);
            spot.roughness = 0.8F;
            return spot;
        });
}

SurfaceMaps knit(std::size_t side, std::uint64_t seed) {
    const auto key = [seed](std::uint32_t use) { return NoiseKey{seed, use}; };
    constexpr int kWales = 9;
    constexpr int kCourses = 12;
    constexpr int kPieces = 48;
    constexpr float kWale = 1.0F / kWales;
    constexpr float kCourse = 1.0F / kCourses;
    constexpr float kRadius = 0.225F * kWale;
    TubeCanvas canvas(side);
    // A course is one yarn that loops up through the course above: the face shows the
    // legs in front, heads and feet behind.
    for (int course = 0; course < kCourses; ++course) {
        std::vector<AxisPoint> axis;
        for (int k = 0; k <= kWales * kPieces; ++k) {
            const float t = kTurn * static_cast<float>(k) / kPieces;
            const float jitter =
                0.02F * gradient_noise(key(1), static_cast<float>(k) / (kWales * kPieces),
                                       static_cast<float>(course) / kCourses, 2 * kWales,
                                       kCourses);
            axis.push_back(
                {kWale * (t / kTurn + 0.20F * std::sin(2 * t) + jitter),
                 kCourse * (static_cast<float>(course) + 0.88F * std::cos(t) + jitter),
                 -0.20F * kWale * std::cos(2 * t)});
        }
        canvas.draw(course, axis, kRadius, 0.85F);
    }
    return paint_yarns(
        canvas, {.height = -0.06F, .colour = {0.03F, 0.01F, 0.01F}},
        [&](float u, float v, const Uppermost& top) {
            const float ply = plies(top, 3, 10);
            const float fuzz = fractal_noise(key(2), u, v, 80, 80, 2, 0.7F);
            const float heather = fractal_noise(key(3), u, v, 40, 40, 3, 0.7F);
            Spot spot;
            spot.height = 0.005F * ply + 0.0025F * fuzz;
            spot.colour =
                scaled({0.42F, 0.075F, 0.055F},
                       (0.62F + 0.38F * ply) * (1 + 0.45F * fuzz + 0.4F * heather));
            spot.roughness = 0.92F;
            return spot;
        });
}

}  // namespace sateen::goniometer
