// SPDX-License-Identifier: Apache-2.0
// Which subspaces a view and a light see, how much of each, and how the sum is brought to
// the mean colour and contrast of these directions. Theory: docs/theory/evaluation.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sateen/core/direction_mesh.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The textures of the subspaces as wholes: what their blends have for mean and contrast.
struct TextureMoments {
    std::vector<std::array<float, 3>> mean;  ///< of each subspace and band
    /// Of the luminances of every two subspaces, (subspaces, subspaces). The fields share
    /// their noise, so the textures vary together.
    std::vector<float> covariance;
    /// How each is distributed, h = -8 ln E[√(t / mean)] beside C = ln(1 + contrast²), to
    /// which it is equal for lognormal values: h of every band over that of the luminance,
    /// and (h - C) / C² of the luminance.
    std::vector<std::array<float, 4>> shape;
};

/// Of textures of equal size, one a subspace, drawn from the same noise.
[[nodiscard]] TextureMoments texture_moments(std::span<const Image> textures);

/// A weighted sum of subspaces and the map of its values:
///
///     x_c = Σ_k weight_k t_k,c(u),   value_c = max(0, offset_c + gain_c x_c^power)
///
/// Contrast is raised by a straight line (power 1) and lowered by a power, under which black
/// stays black; from the square root on by a straight line again.
struct Blend {
    static constexpr std::size_t kMost = 9;
    std::size_t count = 0;
    std::array<std::uint8_t, kMost> subspace = {};  ///< distinct
    std::array<float, kMost> weight = {};           ///< > 0, of sum 1
    std::array<float, 3> gain = {};
    std::array<float, 3> offset = {};
    float power = 1;  ///< in [1/2, 1]
};

/// The value of a blend, of a texture multiplied by a shading of mean 1.
[[nodiscard]] inline float value_of(const Blend& blend, std::size_t band, float x) {
    const float shaped = blend.power == 1 ? x : std::pow(std::max(0.0F, x), blend.power);
    return std::max(0.0F, blend.offset[band] + blend.gain[band] * shaped);
}

/// How a factor s of mean 1 is distributed, which is independent of the texture.
struct FactorShape {
    float square = 0;  ///< ln E[s²]
    float root = 0;    ///< -8 ln E[√s]
};

// Vectors of them, in synthesis/blend_batch.hpp.
struct BlendBatch;
struct BlendTables;
struct DirectionBatch;
struct FactorBatch;

struct InterpolationOptions {
    /// The three nearest directions, as [CAR2], instead of the triangulation.
    bool three_nearest = false;
    /// Apply the mean colours and contrasts of the material's Reflectance.
    bool reflectance = true;
};

/// Interpolates a material over views and lights [CAR2, section III].
///
/// Values are π times the radiance of a surface lit by unit irradiance measured
/// perpendicular to the light: reflectance times cos θ of the light.
class DirectionalInterpolation {
  public:
    /// \param material  valid; needed only during the call
    /// \error invalid_argument  directions that cannot be interpolated, see DirectionMesh
    [[nodiscard]] static Result<DirectionalInterpolation> create(
        const Material& material, TextureMoments moments,
        const InterpolationOptions& options = {});

    /// \param view, light  unit vectors; below the surface the value is 0
    /// \param factor  what the texture will be multiplied by, such as the shading of its
    ///        surface
    /// \cost about 200 ns; 50 ns each in batches
    [[nodiscard]] Blend at(const std::array<float, 3>& view,
                           const std::array<float, 3>& light,
                           const FactorShape& factor = {}) const;
    /// The same of up to kBatch points (synthesis/blend_batch.hpp).
    void at(const DirectionBatch& directions, const FactorBatch& factors,
            BlendBatch& out) const;

    /// Contrast is raised at most so many times: representatives of nearly uniform images
    /// hold noise.
    static constexpr float kMaxContrastGain = 3;

    /// Empty for photographs.
    [[nodiscard]] const std::optional<DirectionMesh>& views() const { return views_; }
    [[nodiscard]] const std::optional<DirectionMesh>& lights() const { return lights_; }
    /// The subspace of every pair, (lights, views): pairs that were not measured have that
    /// of the nearest one, by the sum of the cosines between views and between lights.
    [[nodiscard]] std::span<const std::uint8_t> index() const { return index_; }

  private:
    DirectionalInterpolation() = default;
    std::optional<DirectionMesh> views_;
    std::optional<DirectionMesh> lights_;
    InterpolationOptions options_;
    std::vector<std::uint8_t> index_;
    std::shared_ptr<const BlendTables> tables_;  // none for photographs
};

}  // namespace sateen
