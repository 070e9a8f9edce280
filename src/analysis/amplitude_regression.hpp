// SPDX-License-Identifier: Apache-2.0
// The log amplitudes of the bands of a texture, and curves of what is coarser that explain
// them. Theory: docs/theory/band_modulation.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "sateen/core/band_split.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/band_modulation.hpp"

namespace sateen {

/// The bands of one plane with what their amplitudes are explained by, standardised.
struct BandFeatures {
    Image amplitude;  ///< (levels): ½ L(E / variance)
    Image value;      ///< (levels): of what is coarser, over its deviation
    /// The band has a share in the plane: one that has not is not seen, and what varies in it
    /// is rounding.
    std::array<bool, BandModulation::kLevels> seen{};
};

[[nodiscard]] BandFeatures band_features(PlaneView<const float> plane, Border border,
                                         Executor& executor);

/// Values at the knots of the three curves: of the value, the parent, the first plane.
inline constexpr std::size_t kAmplitudeFeatures = 3;
using AmplitudeKnots = std::array<double, kAmplitudeFeatures * AmplitudeCurve::kKnots>;

/// The features of the sites of one plane and level as weights of the knots.
class Explanation {
  public:
    /// \param first  features of the first plane, or null for none
    Explanation(const BandFeatures& own, const BandFeatures* first, std::size_t level)
        : own_(own), first_(first), level_(level) {}

    struct Site {
        std::array<std::size_t, 2 * kAmplitudeFeatures> knot{};  ///< ascending
        std::array<double, 2 * kAmplitudeFeatures> weight{};
        std::size_t count = 0;
    };
    [[nodiscard]] Site at(std::size_t r, std::size_t c) const {
        Site site;
        add(0, own_.value(level_, r, c), -ModulatedBand::kValueRange,
            ModulatedBand::kValueRange, site);
        if (level_ + 1 < BandModulation::kLevels)
            add_amplitude(1, own_.amplitude(level_ + 1, r, c), site);
        if (first_ != nullptr) add_amplitude(2, first_->amplitude(level_, r, c), site);
        return site;
    }
    [[nodiscard]] float amplitude(std::size_t r, std::size_t c) const {
        return own_.amplitude(level_, r, c);
    }
    [[nodiscard]] std::size_t rows() const { return own_.amplitude.rows(); }
    [[nodiscard]] std::size_t cols() const { return own_.amplitude.cols(); }
    /// Pixels between the sites that are looked at: energies are smooth.
    [[nodiscard]] std::size_t stride() const {
        return std::max<std::size_t>(2, std::size_t{1} << level_);
    }

  private:
    static void add_amplitude(std::size_t feature, float octaves, Site& site) {
        add(feature, octaves, ModulatedBand::kAmplitudeLow, ModulatedBand::kAmplitudeHigh,
            site);
    }
    /// The two hats that x lies between.
    static void add(std::size_t feature, float x, float low, float high, Site& site) {
        constexpr std::size_t kKnots = AmplitudeCurve::kKnots;
        const double t =
            std::clamp((static_cast<double>(x) - static_cast<double>(low)) /
                           (static_cast<double>(high) - static_cast<double>(low)),
                       0.0, 1.0) *
            static_cast<double>(kKnots - 1);
        const auto j = std::min(static_cast<std::size_t>(t), kKnots - 2);
        const double part = t - static_cast<double>(j);
        site.knot[site.count] = feature * kKnots + j;
        site.weight[site.count++] = 1 - part;
        site.knot[site.count] = feature * kKnots + j + 1;
        site.weight[site.count++] = part;
    }

    const BandFeatures& own_;
    const BandFeatures* first_;
    std::size_t level_;
};

/// Curves of one image, and the covariances of the hats over it.
struct AmplitudeRegression {
    AmplitudeKnots knots{};
    double mean = 0;  ///< of the amplitude
    std::vector<AmplitudeKnots> covariances;

    /// Of any curves over the image.
    [[nodiscard]] double variance(const AmplitudeKnots& of) const;
};

/// Least squares of the amplitude, about its mean, on the curves.
[[nodiscard]] AmplitudeRegression regress(const Explanation& explanation);

/// What the curves leave of the amplitude, on every spacing-th pixel.
[[nodiscard]] Image remainder_of(const Explanation& explanation,
                                 const AmplitudeRegression& fit, std::size_t spacing);

}  // namespace sateen
