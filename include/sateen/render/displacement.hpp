// SPDX-License-Identifier: Apache-2.0
// True displacement: a mesh of small triangles moved along its normals.
// Theory: docs/theory/render.md.
#pragma once

#include <cstddef>
#include <functional>

#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/render/mesh.hpp"

namespace sateen {

/// Height of the surface in periods of the texture, a mean over a square of side `width`
/// around (u, v), all in periods. Called from one thread.
using HeightAt = std::function<float(float u, float v, float width)>;

struct DisplacementOptions {
    /// Triangles at most, unless the mesh has more to begin with.
    std::size_t max_triangles = 2'000'000;
    /// Edges shorter than this, in periods, hold nothing more to show: a texel.
    float detail = 1.0F / 512;
};

struct DisplacedMesh {
    /// Positions are displaced; normals, tangents and texture coordinates are those of the
    /// surface before, in whose frame a material is defined.
    Mesh mesh;
    float highest = 0;  ///< furthest out, in units of the mesh
    float lowest = 0;
};

/// Edges are halved until they are as short as the number of triangles allows, then every
/// vertex is moved along its normal by the height times the length of a period there, the
/// square root of the ratio of the areas on the object and in the texture.
///
/// An edge is halved or not by its own length alone, so that the mesh has no gaps but
/// those it had: where texture coordinates or normals of one point differ, it tears.
/// \cost about 1 µs and 100 bytes a triangle
/// \error invalid_argument  a mesh without triangles or frames;  cancelled
[[nodiscard]] Result<DisplacedMesh> displace(const Mesh& mesh, const HeightAt& height,
                                             const DisplacementOptions& options,
                                             Progress& progress);

}  // namespace sateen
