// SPDX-License-Identifier: Apache-2.0
// A virtual goniometer: ray traces the images of a Bidirectional Texture Function of a
// surface whose truth is known. Theory: docs/theory/goniometer.md.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/goniometer/surface_maps.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen {

struct GoniometerOptions {
    std::size_t rows = 128;  ///< of the images, which show one period of the surface
    std::size_t cols = 128;
    /// Every pixel is the mean of samples x samples points on a regular grid.
    std::size_t samples = 2;
    /// False: a Lambertian surface, without the specular layer.
    bool specular = true;
    float f0 = 0.04F;  ///< reflectance of the specular layer at normal incidence
    /// Rays that gather light scattered once between parts of the surface, at every
    /// pixel; 0 for none.
    std::size_t gather_rays = 64;
    bool shadows = true;
    /// No view has a larger theta.
    float max_view_theta = 75 * kRadiansPerDegree;
};

/// Lights and views beyond are refused: the rays that end a shadow would be too long.
inline constexpr float kMaxTheta = 89 * kRadiansPerDegree;

/// Takes the image of one light, by its index. Called from any thread, in any order.
using LitImageSink = std::function<Result<void>(std::size_t light, const Image& image)>;

/// Traces a surface under fixed lights. Views are orthographic and rectified: a pixel
/// shows what the ray through its point of the mean plane meets. Its value is
///
///     v = π L / E⊥,   L the radiance towards the view, E⊥ the irradiance of a plane
///                     facing the light
///
/// so cos θ of the light is included, and a white Lambertian plane gives v = cos θ.
/// Reflectance is a Lambertian body under a GGX layer, through which its light passes
/// twice:
///
///     π f = (1 - F(n·l)) (1 - F(n·v)) ρ + π F(v·h) D V,    F(c) = F0 + (1 - F0) (1 - c)⁵
///
/// with D and the height-correlated V of [Walter et al. 2007, Heitz 2014]. Masking and
/// shadowing are exact for the triangles between the texels; light scattered once between
/// parts of the surface is diffuse, gathered at pixel centres.
class Goniometer {
  public:
    /// \param lights   measure() refers to them by index
    /// \error invalid_argument  the surface (validate), no pixels, no samples, or an angle
    ///                          beyond kMaxTheta
    /// \error limit_exceeded    the surface and what rays meet beside it is too large
    [[nodiscard]] static Result<Goniometer> create(const SurfaceMaps& surface,
                                                   std::vector<Direction> lights,
                                                   const GoniometerOptions& options,
                                                   Executor& executor);
    Goniometer(Goniometer&&) noexcept;
    Goniometer& operator=(Goniometer&&) noexcept;
    ~Goniometer();

    /// Images of one view, linear, (3, rows, cols), under the lights whose indices are
    /// given. The same values for any executor.
    /// \cost a primary ray a sample, and a shadow ray a sample and light
    /// \error invalid_argument  the view is beyond max_view_theta
    /// \error cancelled, or the first error of `take`
    [[nodiscard]] Result<void> measure(Direction view,
                                       std::span<const std::size_t> lights,
                                       const LitImageSink& take, Executor& executor,
                                       const Progress& progress) const;

    /// What the surface is at the pixels of an image: means over each pixel, seen from
    /// above; heights with the mean plane at 0, unit normals.
    [[nodiscard]] SurfaceMaps truth(Executor& executor) const;

    [[nodiscard]] const GoniometerOptions& options() const;
    [[nodiscard]] std::span<const Direction> lights() const;

  private:
    struct State;
    explicit Goniometer(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// A measurement that is traced on reading, for tests and experiments: all pairs of views
/// and lights, which are sorted by (theta, phi) first.
[[nodiscard]] Result<std::unique_ptr<Measurement>> virtual_measurement(
    const SurfaceMaps& surface, std::vector<Direction> views,
    std::vector<Direction> lights, const GoniometerOptions& options, Executor& executor);

}  // namespace sateen
