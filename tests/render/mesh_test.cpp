// SPDX-License-Identifier: Apache-2.0
#include "sateen/render/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/vector.hpp"

namespace sateen {
namespace {

using vector3::cross;
using vector3::difference;
using vector3::dot;

void expect_frames(const Mesh& mesh) {
    ASSERT_EQ(mesh.normal.size(), mesh.position.size());
    ASSERT_EQ(mesh.tangent.size(), mesh.position.size());
    for (std::size_t k = 0; k < mesh.position.size(); ++k) {
        EXPECT_NEAR(dot(mesh.normal[k], mesh.normal[k]), 1, 1e-4F);
        EXPECT_NEAR(dot(mesh.tangent[k], mesh.tangent[k]), 1, 1e-4F);
        EXPECT_NEAR(dot(mesh.tangent[k], mesh.normal[k]), 0, 1e-4F);
        EXPECT_LE(dot(mesh.position[k], mesh.position[k]), 2.01F);
    }
}

/// The smallest cosine between the tangents of the corners of a triangle.
float smallest_cosine(const Mesh& mesh) {
    float smallest = 1;
    for (const auto& [a, b, c] : mesh.triangles)
        for (const auto& [i, j] : {std::pair{a, b}, {b, c}, {c, a}}) {
            // Where all longitudes meet there is no one tangent.
            if (std::abs(mesh.normal[i][2]) > 0.995F) continue;
            smallest = std::min(smallest, dot(mesh.tangent[i], mesh.tangent[j]));
        }
    return smallest;
}

TEST(Mesh, FramesAreOrthonormalAndContinuous) {
    for (const Mesh& mesh : {sphere_mesh(3), plane_mesh(2)}) {
        expect_frames(mesh);
        EXPECT_GT(smallest_cosine(mesh), 0.99F);
    }
    const Mesh cloth = cloth_mesh(3);
    expect_frames(cloth);
    EXPECT_GT(smallest_cosine(cloth), 0.7F);
}

TEST(Mesh, TheSphereIsRoundAndItsTextureMeetsAround) {
    for (const float repeats : {0.4F, 1.0F, 3.3F}) {
        const Mesh mesh = sphere_mesh(repeats);
        for (const Vector3& p : mesh.position) EXPECT_NEAR(dot(p, p), 1, 1e-4F);
        const float around = mesh.uv[256][0] - mesh.uv[0][0];
        EXPECT_FLOAT_EQ(around, std::round(around));
        EXPECT_GE(around, 1);
    }
}

TEST(Mesh, ThePlaneHasItsTextureUpright) {
    const Mesh mesh = plane_mesh(1);
    for (std::size_t k = 0; k < mesh.position.size(); ++k) {
        EXPECT_EQ(mesh.normal[k], (Vector3{0, 0, 1}));
        EXPECT_EQ(mesh.tangent[k], (Vector3{1, 0, 0}));
        EXPECT_EQ(mesh.uv[k][1] > 0.5F, mesh.position[k][1] > 0);
    }
}

TEST(Obj, ACubeIsReadAndFitted) {
    const std::string text =
        "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "f 1/1 2/2 3/3 4/4\n";
    const auto mesh = parse_obj(text, "square.obj", 2);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->triangles.size(), 2U);
    expect_frames(*mesh);
    float farthest = 0;
    for (const Vector3& p : mesh->position) farthest = std::max(farthest, dot(p, p));
    EXPECT_NEAR(farthest, 1, 1e-5F);
    // The file's y is up: z here; what faces its +z looks along -y here.
    EXPECT_NEAR(mesh->normal[0][1], -1, 1e-5F);
    float widest = 0;
    for (const auto& uv : mesh->uv) widest = std::max(widest, uv[0]);
    EXPECT_FLOAT_EQ(widest, 2);
}

TEST(Obj, WhatCannotBeUsedIsNamed) {
    const auto message = [](const std::string& text) {
        const auto mesh = parse_obj(text, "x.obj", 1);
        return mesh ? std::string() : mesh.error().message;
    };
    EXPECT_THAT(message(""), testing::HasSubstr("x.obj: found no face"));
    EXPECT_THAT(message("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                testing::HasSubstr("texture"));
    EXPECT_NE(message("v 0 0 0\nvt 0 0\nf 1/1 7/1 9/1\n"), "");
}

}  // namespace
}  // namespace sateen
