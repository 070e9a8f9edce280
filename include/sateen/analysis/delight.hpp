// SPDX-License-Identifier: Apache-2.0
// De-lighting: what is left of an image when the shading of its surface is divided out.
// Theory: docs/theory/delighting.md.
#pragma once

#include "sateen/analysis/range_map.hpp"
#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"

namespace sateen {

/// The shading of a surface as an image from `view` shows it,
///
///     s(x) = max(0, n(x')·l) / mean,   x' where the ray through x meets the surface,
///
/// since rectified images have parallax. Beyond its borders the surface repeats its last
/// pixels. \returns (1, rows, cols) of mean 1, or all 1 where no pixel is lit
/// \cost 30 ns a pixel from above, up to 300 ns at 75 degrees
[[nodiscard]] Image shading_seen(const RangeMap& surface, Direction view,
                                 Direction light);

/// Divides the shading out of an image, softly: the value q of least squares that explains
/// the image I = s q and stays near its mean m where s is small,
///
///     q = (s I + f² m) / (s² + f²),   f = kShadingFloor,
///
/// then brings every band to the mean it had, which is that of the product of q with
/// another, independent shading of mean 1. Where s is 0, q is the mean: a shadow tells
/// nothing of what lies in it. \param shading  of the image's size
[[nodiscard]] Image divide_by_shading(Image image, const Image& shading);
inline constexpr float kShadingFloor = 0.2F;

/// How much of the contrast of images shading explains.
struct ExplainedContrast {
    double explained = 0;  ///< Σ weight · correlation² · (deviation / mean)²
    double total = 0;      ///< Σ weight · (deviation / mean)²

    /// Adds an image; every other pixel is looked at along rows and columns.
    void add(const Image& image, const Image& shading, double weight);
    [[nodiscard]] double share() const { return total > 0 ? explained / total : 0; }
};

/// From this share on the images are divided by the shading of their surface.
inline constexpr double kLeastShadingShare = 0.25;

}  // namespace sateen
