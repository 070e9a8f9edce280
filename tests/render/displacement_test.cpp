// SPDX-License-Identifier: Apache-2.0
#include "sateen/render/displacement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "render/vector.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/render/renderer.hpp"

namespace sateen {
namespace {

Mesh displaced(const Mesh& mesh, const HeightAt& height, std::size_t most = 20000) {
    DisplacementOptions options;
    options.max_triangles = most;
    Progress progress;
    auto result = displace(mesh, height, options, progress);
    if (!result) ADD_FAILURE() << result.error().message;
    return result ? std::move(result->mesh) : Mesh();
}

/// How many triangles meet at every edge.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges_of(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    return edges;
}

TEST(Displacement, AllowedTrianglesAreUsedAndHaveNoGaps) {
    const Mesh plane = plane_mesh(2);
    for (const std::size_t most : {100U, 5000U, 20000U}) {
        const Mesh mesh = displaced(
            plane, [](float, float, float) { return 0.0F; }, most);
        EXPECT_LE(mesh.triangles.size(), most);
        EXPECT_GE(mesh.triangles.size(), most / 5);
        const auto edges = edges_of(mesh);
        // Euler's formula for a disc, and a rim as long as the plane's.
        EXPECT_EQ(mesh.position.size() + mesh.triangles.size(), edges.size() + 1);
        float rim = 0;
        for (const auto& [ends, count] : edges) {
            ASSERT_LE(count, 2);
            const Vector3 d = vector3::difference(mesh.position[ends.first],
                                                  mesh.position[ends.second]);
            if (count == 1) rim += std::sqrt(vector3::dot(d, d));
        }
        EXPECT_NEAR(rim, 8, 1e-3F);
    }
}

TEST(Displacement, VerticesStandAtTheHeightOfTheirPlace) {
    // Two periods on a side of 2: a period is 1 long.
    const auto ridges = [](float u, float, float) {
        return 0.05F * std::sin(2 * std::numbers::pi_v<float> * u);
    };
    const Mesh mesh = displaced(plane_mesh(2), ridges);
    float highest = 0;
    for (std::size_t k = 0; k < mesh.position.size(); ++k) {
        const Vector3& p = mesh.position[k];
        EXPECT_NEAR(p[2], ridges(p[0] + 1, 0, 0), 1e-5F);
        EXPECT_NEAR(mesh.uv[k][0], p[0] + 1, 1e-5F);
        EXPECT_EQ(mesh.normal[k], (Vector3{0, 0, 1}));
        highest = std::max(highest, p[2]);
    }
    EXPECT_NEAR(highest, 0.05F, 1e-3F);
}

TEST(Displacement, DetailEndsAtTheTexel) {
    DisplacementOptions options;
    options.detail = 1.0F / 8;
    Progress progress;
    const auto result = displace(
        plane_mesh(1), [](float, float, float width) { return 0 * width; }, options,
        progress);
    ASSERT_TRUE(result);
    // 8 x 8 squares of two triangles, whose diagonals are longer than a texel.
    EXPECT_LE(result->mesh.triangles.size(), 4U * 8 * 8 * 2);
    EXPECT_GE(result->mesh.triangles.size(), 8U * 8 * 2);
}

TEST(Displacement, ASphereGrowsByTheHeightOfAPeriod) {
    // Once the texture around the equator: a period is 2π long.
    const Mesh mesh = displaced(
        sphere_mesh(0.6F), [](float, float, float) { return 0.02F; }, 100000);
    for (const Vector3& p : mesh.position) {
        if (std::abs(p[2]) > 0.1F) continue;
        EXPECT_NEAR(std::sqrt(vector3::dot(p, p)), 1 + 0.04F * std::numbers::pi_v<float>,
                    2e-2F);
    }
}

const ShadePoints kWhite = [](std::span<const LitPoint> points,
                              std::span<Vector3> values) {
    for (std::size_t k = 0; k < points.size(); ++k)
        values[k] = {points[k].light[2], points[k].light[2], points[k].light[2]};
};

Image picture(const Mesh& mesh, Direction view, Direction light) {
    Scene scene;
    scene.mesh = &mesh;
    scene.lights = {{light, 1}};
    scene.background_top = scene.background_bottom = {};
    scene.shadow_lift = 1e-4F;
    RenderOptions options;
    options.rows = options.cols = 64;
    options.view = view;
    const auto executor = make_executor(1);
    Progress progress;
    auto image = render(scene, kWhite, options, *executor, progress);
    if (!image) ADD_FAILURE() << image.error().message;
    return image ? std::move(*image) : Image();
}

std::size_t lit(const Image& image) {
    return static_cast<std::size_t>(
        std::count_if(image.plane(0).data, image.plane(0).data + image.plane_size(),
                      [](float v) { return v > 0.1F; }));
}

// Walls half a period wide and a quarter high, and valleys as wide.
float wall(float at) {
    return std::fmod(at + 10, 1.0F) < 0.5F ? 0.25F : 0.0F;
}

TEST(Displacement, SilhouettesAreThoseOfTheRelief) {
    const Mesh plane = plane_mesh(1);
    // The further half stands 0.5 high.
    const Mesh rough =
        displaced(plane, [](float, float v, float) { return wall(v + 0.5F); });
    const Direction low = direction_from_degrees(88, 270);
    // 2 degrees above the plane.
    EXPECT_GT(lit(picture(rough, low, {})), 2 * lit(picture(plane, low, {})));
}

TEST(Displacement, ReliefCastsShadows) {
    const Mesh rough =
        displaced(plane_mesh(1), [](float u, float, float) { return wall(u); });
    // A wall of 0.5 under light at 45 degrees shades 0.5 of the valley of 1.
    const Image image = picture(rough, {}, direction_from_degrees(45, 180));
    const auto share = [&](std::size_t from, std::size_t to) {
        std::size_t dark = 0;
        for (std::size_t c = from; c < to; ++c) dark += image(0, 32, c) < 0.1F ? 1U : 0U;
        return static_cast<double>(dark) / static_cast<double>(to - from);
    };
    // The plane's valley is its right half, from the middle of the picture.
    EXPECT_LT(share(13, 30), 0.1);
    EXPECT_NEAR(share(33, 61), 0.5, 0.15);
}

TEST(Displacement, WhatCannotBeDisplacedIsAnError) {
    Progress progress;
    const auto flat = [](float, float, float) { return 0.0F; };
    EXPECT_FALSE(displace({}, flat, {}, progress));
    Mesh bare = plane_mesh(1);
    bare.tangent.clear();
    EXPECT_FALSE(displace(bare, flat, {}, progress));
}

}  // namespace
}  // namespace sateen
