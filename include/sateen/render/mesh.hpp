// SPDX-License-Identifier: Apache-2.0
// Triangle meshes with texture coordinates and tangent frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sateen/core/result.hpp"

namespace sateen {

using Vector3 = std::array<float, 3>;

/// One entry a vertex. Lengths are those of the object; meshes made here fit a sphere of
/// radius 1 about the origin, z up.
struct Mesh {
    std::vector<Vector3> position;
    std::vector<Vector3> normal;   ///< unit
    std::vector<Vector3> tangent;  ///< unit, along growing u, orthogonal to the normal
    std::vector<std::array<float, 2>> uv;  ///< 1 is one period of the texture; v upwards
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// \param repeats  periods of the texture across the object; whole around the sphere
[[nodiscard]] Mesh sphere_mesh(float repeats);
/// The square of side 2 in the plane z = 0; from above the texture is upright.
[[nodiscard]] Mesh plane_mesh(float repeats);
/// A square cloth over a ball, in folds where it hangs.
[[nodiscard]] Mesh cloth_mesh(float repeats);

/// A Wavefront OBJ, moved and scaled into the sphere of radius 1. Faces are made
/// triangles; normals are computed where the file has none, texture coordinates are
/// required.
/// \param name  for messages
/// \error bad_format  not an OBJ, no faces, or faces without texture coordinates
[[nodiscard]] Result<Mesh> parse_obj(std::string_view text, std::string_view name,
                                     float repeats);

/// Sets tangents from the texture coordinates, and normals where there are none.
void complete_frames(Mesh& mesh);

}  // namespace sateen
