// SPDX-License-Identifier: Apache-2.0
// Lattice noise. See toroidal_noise.hpp.
#include "goniometer/toroidal_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace sateen::goniometer {
namespace {

/// The finaliser of SplitMix64 [Steele, Lea & Flood 2014]: cheap, and good enough where
/// nothing is estimated from the values.
std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
}

std::uint64_t hashed(NoiseKey key, std::int32_t i, std::int32_t j) {
    const std::uint64_t site = (std::uint64_t{static_cast<std::uint32_t>(i)} << 32) |
                               static_cast<std::uint32_t>(j);
    return mixed(site ^ mixed(key.seed ^ mixed(key.use)));
}

/// Bits 8 to 31 of half of a hash, as a number in [0, 1).
float to_unit(std::uint64_t half) {
    return static_cast<float>((half & 0xFFFFFFFFU) >> 8) * 0x1p-24F;
}

std::int32_t wrapped(std::int32_t i, int n) {
    const std::int32_t rest = i % n;
    return rest < 0 ? rest + n : rest;
}

/// 256 unit vectors.
const std::array<std::array<float, 2>, 256>& gradients() {
    static const auto kTable = [] {
        std::array<std::array<float, 2>, 256> table{};
        for (std::size_t k = 0; k < table.size(); ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / 256;
            table[k] = {static_cast<float>(std::cos(angle)),
                        static_cast<float>(std::sin(angle))};
        }
        return table;
    }();
    return kTable;
}

float fade(float t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

}  // namespace

float uniform(NoiseKey key, std::int32_t i, std::int32_t j) {
    return to_unit(hashed(key, i, j));
}

float gradient_noise(NoiseKey key, float u, float v, int across, int down) {
    const float x = u * static_cast<float>(across);
    const float y = v * static_cast<float>(down);
    const auto i = static_cast<std::int32_t>(std::floor(x));
    const auto j = static_cast<std::int32_t>(std::floor(y));
    const float dx = x - static_cast<float>(i);
    const float dy = y - static_cast<float>(j);
    const auto corner = [&](std::int32_t a, std::int32_t b) {
        const auto& gradient =
            gradients()[hashed(key, wrapped(i + a, across), wrapped(j + b, down)) >> 56];
        return gradient[0] * (dx - static_cast<float>(a)) +
               gradient[1] * (dy - static_cast<float>(b));
    };
    const float s = fade(dx);
    const float t = fade(dy);
    const float top = corner(0, 0) * (1 - s) + corner(1, 0) * s;
    const float bottom = corner(0, 1) * (1 - s) + corner(1, 1) * s;
    return top * (1 - t) + bottom * t;
}

float fractal_noise(NoiseKey key, float u, float v, int across, int down, int octaves,
                    float gain) {
    float sum = 0;
    float total = 0;
    float amplitude = 1;
    for (int k = 0; k < octaves; ++k) {
        const NoiseKey own = {key.seed, key.use + 1000U * static_cast<unsigned>(k)};
        sum += amplitude * gradient_noise(own, u, v, across << k, down << k);
        total += amplitude;
        amplitude *= gain;
    }
    return sum / total;
}

Cell cell_at(NoiseKey key, float u, float v, int across, int down) {
    const float x = u * static_cast<float>(across);
    const float y = v * static_cast<float>(down);
    const auto i0 = static_cast<std::int32_t>(std::floor(x));
    const auto j0 = static_cast<std::int32_t>(std::floor(y));
    constexpr float kJitter = 0.86F;
    struct Point {
        float dx = 0;
        float dy = 0;
        float squared = std::numeric_limits<float>::max();
    };
    Point first;
    Point second;
    Cell cell;
    std::array<Point, 25> points;
    std::size_t count = 0;
    // A point two cells away can be the second nearest.
    for (std::int32_t j = j0 - 2; j <= j0 + 2; ++j)
        for (std::int32_t i = i0 - 2; i <= i0 + 2; ++i) {
            const std::int32_t own_i = wrapped(i, across);
            const std::int32_t own_j = wrapped(j, down);
            const std::uint64_t random = hashed(key, own_i, own_j);
            const auto place = [](std::int32_t k, float jitter) {
                return static_cast<float>(k) + 0.5F + kJitter * (jitter - 0.5F);
            };
            Point point{place(i, to_unit(random)) - x,
                        place(j, to_unit(random >> 32)) - y};
            point.squared = point.dx * point.dx + point.dy * point.dy;
            points[count++] = point;
            if (point.squared < first.squared) {
                second = first;
                first = point;
                cell.i = own_i;
                cell.j = own_j;
            } else if (point.squared < second.squared) {
                second = point;
            }
        }
    cell.nearest = std::sqrt(first.squared);
    const float apart = std::hypot(second.dx - first.dx, second.dy - first.dy);
    cell.border = (second.squared - first.squared) / (2 * apart);
    constexpr float kSharpness = 9;
    float nearness = 0;
    for (const Point& point : points) {
        if (point.squared == first.squared) continue;
        const float distance = std::hypot(point.dx - first.dx, point.dy - first.dy);
        nearness +=
            std::exp(-kSharpness * (point.squared - first.squared) / (2 * distance));
    }
    cell.rounded = -std::log(nearness) / kSharpness;
    return cell;
}

float smooth_step(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3 - 2 * t);
}

}  // namespace sateen::goniometer
