// SPDX-License-Identifier: Apache-2.0
// The normal of one pixel from its values under many lights.
// Theory: docs/theory/photometric_stereo.md.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sateen {

/// What a body returns of light from l besides cos: all of it, or what passes a dielectric
/// layer twice, (1 - F(n·l)) (1 - F(n·v)) over its value at l = n = v [Wolff 1994], F after
/// Schlick (1994).
enum class Body { lambert, under_a_layer };

struct PixelNormal {
    Eigen::Vector3d g = {0, 0, 1};  ///< ρ n
    /// Median residual over ρ: how badly the lights agree.
    double disagreement = 0;
    std::size_t used = 0;  ///< lights with at least a tenth of their weight
};

/// Solves I_k = T_k max(0, g · l_k) for g by weighted least squares over the lights k. Holds the
/// arrays of a fit: one for each thread.
class PixelFitter {
  public:
    /// \param lights  unit vectors, outlive this
    PixelFitter(std::span<const std::array<double, 3>> lights, Body body);

    /// W = 1, T = 1 [CAR2, SAR]. Nothing if the lights lie in one plane.
    std::optional<PixelNormal> plain(std::span<const double> values);
    /// Iteratively reweighted, without what lies in shadow. Nothing where too few lights are
    /// left.
    /// \param usable  false (0) for saturated values
    std::optional<PixelNormal> robust(std::span<const double> values,
                                      std::span<const std::uint8_t> usable);

    /// Weights of the last fit, and what T_k max(0, n · l_k) a normal gives.
    [[nodiscard]] std::span<const double> weights() const { return weights_; }
    std::span<const double> shading(const Eigen::Vector3d& normal);

  private:
    std::optional<Eigen::Vector3d> solve(std::span<const double> values);
    void choose(std::span<const double> values, std::span<const std::uint8_t> usable);
    void leave_out_highlights(std::span<const double> values);
    void transmit(const Eigen::Vector3d& g);
    std::optional<double> reweight(std::span<const double> values,
                                   const Eigen::Vector3d& g);

    std::span<const std::array<double, 3>> lights_;
    Body body_;
    std::vector<std::uint8_t> lit_;
    std::vector<double> transmitted_;  ///< T
    std::vector<double> cosines_;      ///< n · l
    std::vector<double> weights_;
    std::vector<double> residuals_;
    std::vector<double> sorted_;
};

/// Do the lights span space, well enough for a normal?
[[nodiscard]] bool span_space(std::span<const std::array<double, 3>> lights);

/// The mixture w of channels whose error is least against what it shows of the body colour b:
/// generalised least squares, w ∝ C⁻¹ b with w · b = luminance of b, where C is the weighted
/// covariance of the residuals c_k - s_k b. Grey gloss lies across the colour of the body, so it
/// counts little; residuals of the body's colour (shadow) change nothing. Nothing for black.
/// \param colours  of every light
/// \param shading  s_k
[[nodiscard]] std::optional<std::array<double, 3>> quiet_mixture(
    std::span<const std::array<double, 3>> colours, std::span<const double> shading,
    std::span<const double> weights, const std::array<double, 3>& body);

/// Σ w s c / Σ w s²: the colour of a body of known shading.
[[nodiscard]] std::array<double, 3> body_colour(
    std::span<const std::array<double, 3>> colours, std::span<const double> shading,
    std::span<const double> weights);

/// Of one channel or three.
[[nodiscard]] inline double luminance(const std::array<double, 3>& colour,
                                      std::size_t bands) {
    if (bands == 1) return colour[0];
    return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
}

}  // namespace sateen
