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

/// The shading with light from elsewhere, (s + a) / (1 + a); see Surface::ambient.
[[nodiscard]] Image with_ambient(Image shading, float ambient);

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
    /// Where the shading is below kDark: how much there is, and Σ of image / mean and of the
    /// shading there.
    double dark = 0;
    double dark_image = 0;
    double dark_shading = 0;

    /// Adds an image; every other pixel is looked at along rows and columns.
    void add(const Image& image, const Image& of_surface, double weight);
    void add(const ExplainedContrast& other);
    [[nodiscard]] double share() const { return total > 0 ? explained / total : 0; }
    /// The light from elsewhere: images are as bright where the lamp hardly reaches as it
    /// makes them,
    ///
    ///     E[image / mean | s < kDark] = (E[s | s < kDark] + a) / (1 + a),
    ///
    /// other parts of the surface, gloss, and slopes that were found too steep. 0 to
    /// kMaxAmbient; 0 without dark places.
    [[nodiscard]] float ambient() const;
};

/// From this share on the images are divided by the shading of their surface.
inline constexpr double kLeastShadingShare = 0.25;

}  // namespace sateen
