// SPDX-License-Identifier: Apache-2.0
// Points shaded a second: each with directions of its own, and under common ones.
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "figures.hpp"
#include "sateen/synthesis/evaluate.hpp"
#include "support/directions.hpp"
#include "support/random_material.hpp"

namespace sateen::bench {
namespace {

Material material() {
    Material m = test::random_material(
        {.seed = 1, .subspaces = 20, .levels = 3, .views = 81, .lights = 81, .rank = 16});
    m.views = m.lights = test::ubo2003_directions();
    // Patches of subspaces, as the segmentation makes them.
    for (IndexEntry& entry : m.index)
        entry.subspace =
            static_cast<std::uint8_t>((entry.light / 9 + entry.view / 27) % 20);
    return m;
}

using Vec = std::array<float, 3>;

float dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The pixels of a picture of a sphere that a light from the upper left falls on, in the
// order of a picture: every pixel has directions of its own.
std::vector<ShadingPoint> sphere() {
    constexpr int kSide = 512;
    const Vec light = to_vector(direction_from_degrees(50, 135));
    std::vector<ShadingPoint> out;
    for (int r = 0; r < kSide; ++r)
        for (int c = 0; c < kSide; ++c) {
            const float x = 2 * (static_cast<float>(c) + 0.5F) / kSide - 1;
            const float y = 1 - 2 * (static_cast<float>(r) + 0.5F) / kSide;
            if (x * x + y * y >= 0.999F) continue;
            const float z = std::sqrt(1 - x * x - y * y);
            const Vec normal = {x, y, z};
            const float across = std::sqrt(x * x + z * z);
            const Vec right = {z / across, 0, -x / across};
            const Vec up = {-x * y / across, across, -y * z / across};
            if (dot(normal, light) <= 0) continue;
            out.push_back({std::atan2(x, z),
                           std::asin(y),
                           {right[2], up[2], z},
                           {dot(right, light), dot(up, light), dot(normal, light)}});
        }
    return out;
}

// Nothing in common from point to point: as a path tracer would ask.
std::vector<ShadingPoint> scattered() {
    std::mt19937_64 engine(2);
    const auto uniform = [&] {
        return static_cast<float>(static_cast<double>(engine() >> 11U) * 0x1p-53);
    };
    const auto direction = [&] {
        return to_vector({std::acos(uniform()), 6.2831853F * uniform()});
    };
    std::vector<ShadingPoint> out(200000);
    for (ShadingPoint& p : out) p = {uniform(), uniform(), direction(), direction()};
    return out;
}

// A plane seen and lit from afar.
std::vector<ShadingPoint> plane() {
    std::vector<ShadingPoint> out = sphere();
    for (ShadingPoint& p : out) p.view = out[0].view, p.light = out[0].light;
    return out;
}

int run() {
    SerialExecutor executor;
    Progress progress;
    const auto evaluator = Evaluator::create(material(), {}, executor, progress);
    if (!evaluator) return 1;
    const auto rate = [&](const std::vector<ShadingPoint>& points) {
        std::vector<Vec> out(points.size());
        Shortest time;
        for (int i = 0; i < 7; ++i)
            time.add(processor_seconds([&] { evaluator->evaluate(points, out); }));
        return static_cast<double>(points.size()) / time.seconds() / 1e6;
    };
    const std::vector<Figure> figures = {
        {"sphere",
         rate(sphere()),
         "M points/s",
         5,
         Figure::Bound::at_least,
         {{"scattered points", rate(scattered())}}},
        {"plane", rate(plane()), "M points/s", 5, Figure::Bound::at_least, {}}};
    print("evaluate", figures);
    return 0;
}

}  // namespace
}  // namespace sateen::bench

int main() {
    return sateen::bench::run();
}
