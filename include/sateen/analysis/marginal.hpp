// SPDX-License-Identifier: Apache-2.0
// The marginal distribution of a plane, and the plane made Gaussian by it.
// Theory: docs/theory/marginal.md. Partner: synthesis/spectral.
#pragma once

#include <span>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The distribution of one plane of one or more images.
class MarginalDistribution {
  public:
    /// \param planes  of the same factor, pooled; values about 0, as decorrelated ones are:
    ///                they are told apart to 0.2 % of themselves
    explicit MarginalDistribution(std::span<const PlaneView<const float>> planes);

    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double standard_deviation() const { return deviation_; }

    /// y ← Φ⁻¹(F(y)) by mid-ranks: the plane with a standard normal marginal.
    /// \param in  one of the planes of the constructor
    void gaussianise(PlaneView<const float> in, PlaneView<float> out) const;

    /// The least-squares curve through the quantiles,
    ///
    ///     min_c ∫ φ(g) (F⁻¹(Φ(g)) - Σ_j c_j h_j(g))² dg,    h_j hat functions on the
    ///     knots,
    ///
    /// made monotone. Hats sum to 1, so the mean is that of the plane.
    [[nodiscard]] Marginal fit_curve() const;
    /// A Gaussian marginal of the same deviation: no curve (paper mode).
    [[nodiscard]] Marginal without_curve() const;

  private:
    /// Values with equal leading bits, and the normal quantile of their mid-rank.
    struct Bin {
        double value = 0;  ///< mean of its members
        double count = 0;
        float normal = 0;
    };
    std::vector<std::uint32_t> bin_of_key_;
    std::vector<Bin> bins_;
    double count_ = 0;
    double mean_ = 0;
    double deviation_ = 0;
};

/// q(g)
[[nodiscard]] double value_at(const Marginal& marginal, double g);

/// Φ⁻¹(p), 0 < p < 1, to about 1e-9 relative [Acklam, one step of Halley].
[[nodiscard]] double normal_quantile(double p);

}  // namespace sateen
