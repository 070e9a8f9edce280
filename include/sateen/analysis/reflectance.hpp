// SPDX-License-Identifier: Apache-2.0
// Mean colour and contrast by direction: measured, completed where nothing was measured,
// and factorised. Theory: docs/theory/reflectance.md, docs/theory/restoration.md.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/reflectance.hpp"

namespace sateen {

/// First and second moments of an image.
struct ImageMoments {
    std::array<double, 3> mean = {};  ///< of each band, linear; one band: the first entry
    double deviation = 0;             ///< of the luminance
    double luminance = 0;             ///< its mean
};

/// Of an image of 1 or 3 bands of linear values. \cost 0.5 ns a pixel
[[nodiscard]] ImageMoments image_moments(ImageView<const float> image);

/// e_0 … e_d of an image (material/reflectance.hpp).
[[nodiscard]] EncodedAppearance encode_appearance(const ImageMoments& moments,
                                                  std::size_t bands);

/// What is known of a pair of directions.
struct MeasuredAppearance {
    std::size_t view = 0;
    std::size_t light = 0;
    EncodedAppearance encoded = {};
};

/// The directions of a table of appearances and what its values are.
struct AppearanceGrid {
    std::span<const Direction> views;
    std::span<const Direction> lights;
    std::size_t channels = 4;     ///< d + 1
    bool cosine_included = true;  ///< values contain cos θ of the light
};

/// Pairs of directions of the largest table that is completed and factorised.
inline constexpr std::size_t kMaxAppearancePairs = std::size_t{1} << 18U;

/// Appearances of all pairs, those that were measured and predictions of the others:
/// (lights, views, channels). Each channel is a regression on a few smooth functions of
/// the angles plus a Gaussian process of covariance
///
///     k((l, v), (l', v')) = exp(-(1 - l·l')/ℓ²) exp(-(1 - v·v')/ℓ²),
///     ℓ = 1.9 n^(-1/4), between 0.2 and 0.5, for n known pairs,
///
/// with 1 % of noise. One pair alone gives a Lambertian material of its colour.
/// \error invalid_argument  no pair, or more than kMaxAppearancePairs
/// \cost nothing for a complete grid; else 100 products of lights² views and lights views²
[[nodiscard]] Result<std::vector<float>> complete_appearance(
    const AppearanceGrid& grid, std::span<const MeasuredAppearance> known);

struct FactorisationOptions {
    std::size_t rank = Reflectance::kMaxRank;  ///< at most
    /// Root mean square of what may be left out, in units of e; about 0.3 of a Delta E.
    double tolerance = 2e-3;
};

/// The best approximation of low rank (singular values), its light factors rounded to the
/// 8 bits of the file before the view factors are fitted to them.
/// \param table  (lights, views, channels), as complete_appearance() gives it
[[nodiscard]] Reflectance factorise_appearance(const AppearanceGrid& grid,
                                               std::span<const float> table,
                                               const FactorisationOptions& options = {});

}  // namespace sateen
