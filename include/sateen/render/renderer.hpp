// SPDX-License-Identifier: Apache-2.0
// Pictures of lit objects. Theory: docs/theory/render.md.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/render/environment.hpp"
#include "sateen/render/mesh.hpp"

namespace sateen {

/// A point of a surface in its own frame: x along u, y along v, z along the normal.
struct LitPoint {
    float u = 0;
    float v = 0;
    Vector3 view = {0, 0, 1};  ///< unit, towards the eye
    Vector3 light = {0, 0, 1};
};

/// What a material makes of points: π times the radiance towards the view for unit
/// irradiance of a plane facing the light, so a white Lambertian gives cos θ of the
/// light. Called from several threads at a time.
using ShadePoints = std::function<void(std::span<const LitPoint>, std::span<Vector3>)>;

/// A distant light; a white plane that faces it has radiance `strength`.
struct DistantLight {
    Direction direction;  ///< in the frame of the object, theta from +z
    float strength = 1;
};

struct Scene {
    const Mesh* mesh = nullptr;
    std::vector<DistantLight> lights;
    const Environment* environment = nullptr;  ///< light, and what is seen behind
    Vector3 background_top = {0.16F, 0.17F, 0.19F};
    Vector3 background_bottom = {0.035F, 0.035F, 0.04F};
    /// Shadow rays begin so far above the surface; objects have radius 1.
    float shadow_lift = 1e-3F;
};

struct RenderOptions {
    std::size_t rows = 512;
    std::size_t cols = 512;
    /// Where the camera stands, as seen from the object.
    Direction view = direction_from_degrees(65, 270);
    float field_of_view = 28 * kRadiansPerDegree;  ///< of the smaller side
    std::size_t environment_samples = 4;  ///< for each of the 16 samples of a pixel
    std::uint64_t seed = 0;
};

/// One picture, linear, (3, rows, cols): a pinhole camera that looks at the origin from
/// where a sphere of radius 1 just fits, 4 x 4 samples a pixel; lights and environment
/// cast shadows. The same values for any executor.
/// \cost 16 primary rays a pixel, one shadow ray and one point a sample and light
/// \error invalid_argument  no mesh, no pixels;  cancelled
[[nodiscard]] Result<Image> render(const Scene& scene, const ShadePoints& shade,
                                   const RenderOptions& options, Executor& executor,
                                   Progress& progress);

}  // namespace sateen
