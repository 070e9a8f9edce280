// SPDX-License-Identifier: Apache-2.0
#include "sateen/render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/vector.hpp"
#include "sateen/io/executor.hpp"

namespace sateen {
namespace {

const ShadePoints kWhite = [](std::span<const LitPoint> points,
                              std::span<Vector3> values) {
    for (std::size_t k = 0; k < points.size(); ++k)
        values[k] = {points[k].light[2], points[k].light[2], points[k].light[2]};
};

Image picture_of(const Scene& scene, const ShadePoints& shade,
                 const RenderOptions& options, std::size_t threads = 1) {
    const auto executor = make_executor(threads);
    Progress progress;
    auto image = render(scene, shade, options, *executor, progress);
    if (!image) ADD_FAILURE() << image.error().message;
    return image ? std::move(*image) : Image();
}

/// Where the ray through the centre of a pixel meets the unit sphere; false if not.
bool sphere_point(const RenderOptions& options, std::size_t r, std::size_t c,
                  Vector3& point) {
    const float half = std::tan(options.field_of_view / 2);
    const auto size = static_cast<float>(options.rows);
    const float x = half * (2 * (static_cast<float>(c) + 0.5F) / size - 1);
    const float y = -half * (2 * (static_cast<float>(r) + 0.5F) / size - 1);
    // Seen from +z with +y up.
    const float distance = 1.06F / std::sin(options.field_of_view / 2);
    const Vector3 d = vector3::unit({x, y, -1});
    const float along = -distance * d[2];
    const float rest = along * along - (distance * distance - 1);
    if (rest < 0.12F) return false;
    const float t = along - std::sqrt(rest);
    point = {t * d[0], t * d[1], distance + t * d[2]};
    return true;
}

TEST(Renderer, AWhiteLambertianSphereIsShadedByTheCosineOfItsLights) {
    const Mesh mesh = sphere_mesh(1);
    const Direction first = direction_from_degrees(40, 20);
    const Direction second = direction_from_degrees(70, 200);
    Scene scene;
    scene.mesh = &mesh;
    scene.lights = {{first, 1}, {second, 0.5F}};
    RenderOptions options;
    options.rows = options.cols = 96;
    options.view = {};
    const Image image = picture_of(scene, kWhite, options);
    std::size_t compared = 0;
    for (std::size_t r = 0; r < 96; ++r)
        for (std::size_t c = 0; c < 96; ++c) {
            Vector3 p{};
            if (!sphere_point(options, r, c, p)) continue;
            const float one = vector3::dot(p, to_vector(first));
            const float two = vector3::dot(p, to_vector(second));
            // Pixels on a terminator are means over its bend.
            if (std::min(std::abs(one), std::abs(two)) < 0.05F) continue;
            const float expected = std::max(0.0F, one) + 0.5F * std::max(0.0F, two);
            EXPECT_NEAR(image(1, r, c), expected, 0.012F) << r << "," << c;
            ++compared;
        }
    EXPECT_GT(compared, 3500U);
}

TEST(Renderer, UnderAUniformSkyAWhiteSphereIsAsBrightAsTheSky) {
    Image sky(3, 8, 16);
    std::fill(sky.values().begin(), sky.values().end(), 0.6F);
    const auto environment = Environment::create(sky);
    ASSERT_TRUE(environment);
    const Mesh mesh = sphere_mesh(1);
    Scene scene;
    scene.mesh = &mesh;
    scene.environment = &*environment;
    RenderOptions options;
    options.rows = options.cols = 24;
    options.environment_samples = 16;
    const Image image = picture_of(scene, kWhite, options);
    double sum = 0;
    for (std::size_t r = 8; r < 16; ++r)
        for (std::size_t c = 8; c < 16; ++c) {
            EXPECT_NEAR(image(0, r, c), 0.6F, 0.12F);
            sum += static_cast<double>(image(0, r, c));
        }
    EXPECT_NEAR(sum / 64, 0.6, 0.01);
    EXPECT_FLOAT_EQ(image(2, 0, 0), 0.6F);
}

TEST(Renderer, PointsAreGivenInTheFrameOfTheSurface) {
    const Mesh mesh = plane_mesh(1);
    const Direction light = direction_from_degrees(30, 60);
    Scene scene;
    scene.mesh = &mesh;
    scene.lights = {{light, 1}};
    RenderOptions options;
    options.rows = options.cols = 16;
    options.view = direction_from_degrees(20, 270);
    const ShadePoints shade = [&](std::span<const LitPoint> points,
                                  std::span<Vector3> values) {
        const Vector3 expected = to_vector(light);
        for (std::size_t k = 0; k < points.size(); ++k) {
            for (std::size_t i = 0; i < 3; ++i)
                EXPECT_NEAR(points[k].light[i], expected[i], 1e-5F);
            EXPECT_LT(points[k].view[1], 0);
            EXPECT_GT(points[k].view[2], 0.8F);
            values[k] = {points[k].u, points[k].v, 0};
        }
    };
    const Image image = picture_of(scene, shade, options);
    // u grows to the right, v upwards.
    EXPECT_GT(image(0, 8, 10), image(0, 8, 5) + 0.1F);
    EXPECT_GT(image(1, 5, 8), image(1, 10, 8) + 0.1F);
}

TEST(Renderer, OneThingShadesAnother) {
    // A small square above a large one, both facing up.
    Mesh mesh = plane_mesh(1);
    const auto offset = static_cast<std::uint32_t>(mesh.position.size());
    const Mesh small = plane_mesh(1);
    for (const Vector3& p : small.position)
        mesh.position.push_back({0.2F * p[0] + 0.4F, 0.2F * p[1], 0.4F});
    mesh.uv.insert(mesh.uv.end(), small.uv.begin(), small.uv.end());
    for (const auto& [a, b, c] : small.triangles)
        mesh.triangles.push_back({a + offset, b + offset, c + offset});
    mesh.normal.clear();
    complete_frames(mesh);
    Scene scene;
    scene.mesh = &mesh;
    // From the right at 45 degrees: the shadow falls on the centre.
    scene.lights = {{direction_from_degrees(45, 0), 1}};
    RenderOptions options;
    options.rows = options.cols = 65;
    options.view = {};
    const Image image = picture_of(scene, kWhite, options);
    EXPECT_EQ(image(0, 32, 32), 0);
    EXPECT_NEAR(image(0, 32, 15), std::sqrt(0.5F), 1e-3F);
}

TEST(Renderer, PicturesAreTheSameForAnyNumberOfThreads) {
    Image sky(3, 4, 8);
    std::fill(sky.values().begin(), sky.values().end(), 0.3F);
    sky(0, 1, 5) = 9;
    const auto environment = Environment::create(sky);
    ASSERT_TRUE(environment);
    const Mesh mesh = cloth_mesh(2);
    Scene scene;
    scene.mesh = &mesh;
    scene.lights = {{direction_from_degrees(40, 20), 1}};
    scene.environment = &*environment;
    RenderOptions options;
    options.rows = 24;
    options.cols = 40;
    const Image one = picture_of(scene, kWhite, options, 1);
    for (const std::size_t threads : {2U, 3U}) {
        const Image other = picture_of(scene, kWhite, options, threads);
        EXPECT_TRUE(
            std::equal(one.values().begin(), one.values().end(), other.values().begin()));
    }
}

TEST(Renderer, NothingToRenderIsAnError) {
    const auto executor = make_executor(1);
    Progress progress;
    EXPECT_FALSE(render({}, kWhite, {}, *executor, progress));
    const Mesh mesh = plane_mesh(1);
    Scene scene;
    scene.mesh = &mesh;
    RenderOptions none;
    none.rows = 0;
    EXPECT_FALSE(render(scene, kWhite, none, *executor, progress));
}

}  // namespace
}  // namespace sateen
