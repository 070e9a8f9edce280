// SPDX-License-Identifier: Apache-2.0
#include "goniometer/tracer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "goniometer/surfaces.hpp"

namespace sateen::goniometer {
namespace {

/// A difference of coordinates on a circle.
float around(float difference, float period) {
    return std::abs(difference - period * std::round(difference / period));
}

// What the view v sees of a point lit from l, the view l sees of it lit from v: a point
// is lit from where it can be seen, and f(v, l) = f(l, v). The slopes, up to 1, shade.
TEST(Tracer, ViewAndLightCanBeExchangedAtEveryPoint) {
    constexpr float kSide = 32;
    const float turn = 2 * std::numbers::pi_v<float>;
    SurfaceMaps surface = test::grey_surface(256, kSide, 0.4F, [&](float x, float y) {
        return 2.0F * std::sin(turn * x / 16) * std::cos(turn * y / 32) +
               0.6F * std::sin(turn * (x + 2 * y) / 16);
    });
    surface.normal = normals_of(surface.height, kSide / 256, kSide / 256);
    auto tracer = Tracer::create(surface, kSide, kSide, 40);
    ASSERT_TRUE(tracer);
    SerialExecutor executor;
    std::vector<float> x;
    std::vector<float> y;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
            x.push_back(0.5F * static_cast<float>(j) + 0.21F);
            y.push_back(-0.5F * static_cast<float>(i) - 0.17F);
        }
    const Direction view = direction_from_degrees(50, 15);
    const Direction light = direction_from_degrees(60, 160);
    const Vector v = to_vector(view);
    const Vector l = to_vector(light);
    const Hits seen = tracer->trace(x, y, view, executor);
    std::vector<float> x_back(x.size());
    std::vector<float> y_back(y.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
        const Lanes& point = seen.blocks[k / kLanes].point;
        const std::size_t i = k % kLanes;
        x_back[k] = point.x[i] - point.z[i] * l[0] / l[2];
        y_back[k] = point.y[i] - point.z[i] * l[1] / l[2];
    }
    const Hits back = tracer->trace(x_back, y_back, light, executor);

    const Layer layer{true, 0.04F};
    std::size_t disagreements = 0;
    std::size_t lit_points = 0;
    for (std::size_t b = 0; b < seen.blocks.size(); ++b) {
        const Hits::Block& one = seen.blocks[b];
        const Hits::Block& other = back.blocks[b];
        const LaneMask lit = tracer->lit(one, l, true);
        const LaneMask back_lit = tracer->lit(other, v, true);
        const Reflected forth = reflect(one, layer, v, l, one.met);
        const Reflected here = reflect(other, layer, l, v, other.met);
        for (std::size_t i = 0; i < kLanes; ++i) {
            ASSERT_EQ(one.met[i], -1);
            const bool same = around(one.point.x[i] - other.point.x[i], kSide) < 2e-2F &&
                              around(one.point.y[i] - other.point.y[i], kSide) < 2e-2F;
            const Vector n = {one.normal.x[i], one.normal.y[i], one.normal.z[i]};
            if ((lit[i] != 0) != same) ++disagreements;
            if (lit[i] == 0 || !same || dot(n, v) < 0.1F || dot(n, l) < 0.1F) continue;
            ++lit_points;
            if (back_lit[i] == 0) ++disagreements;
            for (std::size_t band = 0; band < 3; ++band) {
                const float f_vl = forth[band][i] / dot(n, l);
                const float f_lv = here[band][i] / dot(n, v);
                EXPECT_NEAR(f_vl, f_lv, 0.02F * f_vl + 1e-4F);
            }
        }
    }
    EXPECT_GT(lit_points, 500U);
    EXPECT_LT(lit_points, 4000U);
    // Rays that graze an edge may fall on either side of it.
    EXPECT_LE(disagreements, 40U);
}

}  // namespace
}  // namespace sateen::goniometer
