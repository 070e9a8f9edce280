// SPDX-License-Identifier: Apache-2.0
// The value of a material at a point, for a view and a light: the reference for every
// front end. docs/theory/evaluation.md gives the same formulas for shaders.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/synthesis/interpolate.hpp"

namespace sateen {

/// Relief of the surface, where a material has one.
enum class Relief : std::uint8_t {
    none,      ///< the smooth texture alone
    shading,   ///< multiplied by the shading of the surface's normals
    parallax,  ///< and displaced by the height under the point (Kaneko 2001)
    marched,   ///< and displaced to where the view ray meets the surface
};

struct EvaluatorOptions {
    std::size_t side = 256;  ///< pixels of the toroidal textures, a side: 16 … 2048
    std::uint64_t seed = 0;
    Relief relief = Relief::shading;
    bool self_shadow = false;  ///< march towards the light as well
    InterpolationOptions interpolation = {};
};

/// A point of the surface in its own frame: x along the columns of the texture, y up (minus
/// rows), z along the normal.
struct ShadingPoint {
    float u = 0;  ///< columns in units of the texture's side; any number, it repeats
    float v = 0;  ///< upwards, in the same units: row = -v · side
    std::array<float, 3> view = {0, 0, 1};   ///< unit vector towards the eye
    std::array<float, 3> light = {0, 0, 1};  ///< unit vector towards the light
};

/// Means over the surface of t = max(0, n·l) + a mean max(0, n·l), its square and its square
/// root, by light; a = Surface::ambient.
struct ShadingMoments {
    float mean = 1;
    float mean_square = 1;
    float mean_root = 1;
};

/// A material made ready: toroidal textures of all subspaces, drawn once from one noise.
///
///     value_c = max(0, offset_c + gain_c (s Σ_k w_k t_k,c(u))^power)   (docs/theory/evaluation.md)
///
/// is π times the radiance towards `view` for unit irradiance measured perpendicular to
/// `light`: reflectance times cos θ of the light. A Lambertian white gives cos θ.
class Evaluator {
  public:
    /// \error invalid_argument, cancelled
    /// \cost a texture of side² pixels for each subspace, 16 bytes a pixel
    [[nodiscard]] static Result<Evaluator> create(const Material& material,
                                                  const EvaluatorOptions& options,
                                                  Executor& executor, Progress& progress);

    /// What depends on the directions alone; holds for any number of points.
    struct Directional {
        Blend blend;
        std::array<float, 3> view = {};
        std::array<float, 3> light = {};
        float shading_scale = 1;  ///< 1 / mean of t
    };
    [[nodiscard]] Directional prepare(const std::array<float, 3>& view,
                                      const std::array<float, 3>& light) const;

    [[nodiscard]] std::array<float, 3> sample(const Directional& at, float u,
                                              float v) const;

    /// prepare and sample. Grey materials give three equal values.
    [[nodiscard]] std::array<float, 3> evaluate(const ShadingPoint& point) const {
        return sample(prepare(point.view, point.light), point.u, point.v);
    }
    /// Many points: 64 at a time in vectors, or prepared once where all directions agree.
    /// \cost about 80 ns a point of its own directions, 30 ns with common ones
    void evaluate(std::span<const ShadingPoint> points,
                  std::span<std::array<float, 3>> out) const;

    [[nodiscard]] const DirectionalInterpolation& interpolation() const {
        return interpolation_;
    }
    [[nodiscard]] std::size_t side() const { return side_; }
    /// The texture of subspace k, (rows, cols, 4): red, green, blue, 0.
    [[nodiscard]] std::span<const float> texels(std::size_t k) const {
        return std::span(texels_).subspan(k * side_ * side_ * 4, side_ * side_ * 4);
    }
    /// The surface, (rows, cols, 4): its unit normal and its height in units of the side;
    /// empty without one.
    [[nodiscard]] std::span<const float> relief() const { return relief_; }
    [[nodiscard]] ShadingMoments shading_moments(const std::array<float, 3>& light) const;

    /// Of the map (x, y) / (1 + z) ∈ [-1, 1]² on which the moments are tabulated.
    static constexpr std::size_t kMomentSide = 33;

  private:
    explicit Evaluator(DirectionalInterpolation interpolation)
        : interpolation_(std::move(interpolation)) {}
    Result<void> take_surface(const Surface& surface, std::uint64_t seed);
    /// \param shading  room for t at as many normals
    [[nodiscard]] ShadingMoments moments_under(const std::array<float, 3>& light,
                                               std::span<double> shading) const;
    void tabulate_shading();
    void evaluate_batch(std::span<const ShadingPoint> points,
                        std::span<std::array<float, 3>> out) const;
    [[nodiscard]] FactorShape shading_shape(const ShadingMoments& moments) const;
    /// The shading of a point, which is moved to where the view ray meets the surface.
    [[nodiscard]] float shaded(const std::array<float, 3>& view,
                               const std::array<float, 3>& light, float scale, float& u,
                               float& v) const;
    [[nodiscard]] std::array<float, 4> relief_at(float u, float v) const;
    [[nodiscard]] std::array<float, 2> displaced(const std::array<float, 3>& view,
                                                 float u, float v) const;
    [[nodiscard]] bool is_shadowed(const std::array<float, 3>& light, float u,
                                   float v) const;

    DirectionalInterpolation interpolation_;
    std::size_t side_ = 0;
    std::size_t bands_ = 0;
    std::vector<float> texels_;
    std::vector<float> relief_;  // as relief()
    float lowest_ = 0;
    float highest_ = 0;
    bool delit_ = false;
    Relief mode_ = Relief::none;
    bool self_shadow_ = false;
    std::vector<ShadingMoments> moments_;
    float ambient_ = 0;
    float least_shading_ = 0;  ///< a / (1 + a): of what the lamp does not reach
};

}  // namespace sateen
