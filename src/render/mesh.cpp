// SPDX-License-Identifier: Apache-2.0
// Sphere, plane, cloth, tangent frames. See mesh.hpp.
#include "sateen/render/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/vector.hpp"

namespace sateen {
namespace {

using vector3::cross;
using vector3::difference;
using vector3::dot;
using vector3::sum;
using vector3::times;
using vector3::unit;

constexpr float kPi = std::numbers::pi_v<float>;

/// A grid of quadrilaterals over the unit square; `place(s, t)` gives position and
/// texture coordinates.
struct Placed {
    Vector3 position;
    std::array<float, 2> uv;
};
template <class F>
Mesh grid(std::uint32_t across, std::uint32_t up, const F& place) {
    Mesh mesh;
    for (std::uint32_t j = 0; j <= up; ++j)
        for (std::uint32_t i = 0; i <= across; ++i) {
            const Placed placed =
                place(static_cast<float>(i) / static_cast<float>(across),
                      static_cast<float>(j) / static_cast<float>(up));
            mesh.position.push_back(placed.position);
            mesh.uv.push_back(placed.uv);
        }
    for (std::uint32_t j = 0; j < up; ++j)
        for (std::uint32_t i = 0; i < across; ++i) {
            const std::uint32_t a = j * (across + 1) + i;
            const std::uint32_t b = a + across + 1;
            mesh.triangles.push_back({a, a + 1, b + 1});
            mesh.triangles.push_back({a, b + 1, b});
        }
    return mesh;
}

/// Any unit vector orthogonal to `normal`.
Vector3 orthogonal(const Vector3& normal) {
    const Vector3 axis = std::abs(normal[0]) < 0.7F ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
    return unit(difference(axis, times(normal, dot(normal, axis))));
}

void add_normals(Mesh& mesh) {
    mesh.normal.assign(mesh.position.size(), Vector3{});
    for (const auto& [a, b, c] : mesh.triangles) {
        // Twice the area long: large triangles count for more.
        const Vector3 n = cross(difference(mesh.position[b], mesh.position[a]),
                                difference(mesh.position[c], mesh.position[a]));
        for (const std::uint32_t k : {a, b, c}) mesh.normal[k] = sum(mesh.normal[k], n);
    }
    for (Vector3& n : mesh.normal) n = dot(n, n) > 0 ? unit(n) : Vector3{0, 0, 1};
}

}  // namespace

void complete_frames(Mesh& mesh) {
    if (mesh.normal.size() != mesh.position.size()) add_normals(mesh);
    mesh.tangent.assign(mesh.position.size(), Vector3{});
    for (const auto& [a, b, c] : mesh.triangles) {
        // dP = T du + B dv along two sides, solved for T.
        const Vector3 p = difference(mesh.position[b], mesh.position[a]);
        const Vector3 q = difference(mesh.position[c], mesh.position[a]);
        const float pu = mesh.uv[b][0] - mesh.uv[a][0];
        const float pv = mesh.uv[b][1] - mesh.uv[a][1];
        const float qu = mesh.uv[c][0] - mesh.uv[a][0];
        const float qv = mesh.uv[c][1] - mesh.uv[a][1];
        const float orientation = pu * qv - qu * pv < 0 ? -1.0F : 1.0F;
        const Vector3 t = times(difference(times(p, qv), times(q, pv)), orientation);
        for (const std::uint32_t k : {a, b, c}) mesh.tangent[k] = sum(mesh.tangent[k], t);
    }
    for (std::size_t k = 0; k < mesh.tangent.size(); ++k) {
        const Vector3& n = mesh.normal[k];
        const Vector3 flat =
            difference(mesh.tangent[k], times(n, dot(n, mesh.tangent[k])));
        mesh.tangent[k] = dot(flat, flat) > 0 ? unit(flat) : orthogonal(n);
    }
}

Mesh sphere_mesh(float repeats) {
    // Half as many up as around, so that texels are square at the equator.
    const float around = std::max(1.0F, std::round(kPi * repeats / 2)) * 2;
    Mesh mesh = grid(256, 128, [&](float s, float t) {
        const float phi = 2 * kPi * s;
        const float theta = kPi * (1 - t);
        return Placed{{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta)},
                      {around / 2 * s, around / 4 * t}};
    });
    mesh.normal = mesh.position;
    for (Vector3& n : mesh.normal) n = unit(n);
    complete_frames(mesh);
    // The triangles at a pole have no one tangent; east is what their neighbours have.
    for (std::size_t k = 0; k < mesh.uv.size(); ++k) {
        const float phi = 2 * kPi * static_cast<float>(k % 257) / 256;
        mesh.tangent[k] = {-std::sin(phi), std::cos(phi), 0};
    }
    return mesh;
}

Mesh plane_mesh(float repeats) {
    Mesh mesh = grid(1, 1, [&](float s, float t) {
        return Placed{{2 * s - 1, 2 * t - 1, 0}, {repeats * s, repeats * t}};
    });
    complete_frames(mesh);
    return mesh;
}

Mesh cloth_mesh(float repeats) {
    constexpr float kBall = 0.5F;
    constexpr float kLeaves = 1.2F;  // radians from the top where it leaves the ball
    constexpr float kFolds = 8;
    Mesh mesh = grid(320, 320, [&](float s, float t) {
        const float x = 2 * s - 1;
        const float y = 2 * t - 1;
        const float length = std::sqrt(x * x + y * y);
        const float phi = std::atan2(y, x);
        const float angle = std::min(length / kBall, kLeaves);
        const float hanging = std::max(0.0F, length - kBall * kLeaves);
        // Steeper and steeper below the ball; folds grow with the length that hangs.
        const float bend = 1 - std::exp(-3 * hanging);
        const float slope = kLeaves + bend * (1.5F - kLeaves);
        const float fold =
            0.30F * bend * hanging *
            std::cos(kFolds * phi + 0.8F * std::sin(2 * phi + 0.5F) + 0.4F);
        const float radius = kBall * std::sin(angle) + hanging * std::cos(slope) + fold;
        const float z = kBall * std::cos(angle) - hanging * std::sin(slope) * 0.95F;
        return Placed{{1.25F * radius * std::cos(phi), 1.25F * radius * std::sin(phi),
                       1.25F * z + 0.05F},
                      {repeats * s, repeats * t}};
    });
    complete_frames(mesh);
    return mesh;
}

}  // namespace sateen
