// SPDX-License-Identifier: Apache-2.0
// Lab histograms of an image and the cumulative feature made of them, by which the images
// of a BTF are compared. Theory: docs/theory/segmentation.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sateen/core/image.hpp"

namespace sateen {

/// Equal bins of one Lab channel; values outside fall into the first or the last.
struct Bins {
    double origin = 0;  ///< lower edge of the first
    double width = 1;
    std::size_t count = 0;
};

/// What images are counted in. L has the bins of the feature; those of a and b are finer
/// and cover all that the sRGB gamut reaches, because the range that a material occupies
/// is known only after the pass. A neutral grey lies in the middle of a bin, so that
/// rounding cannot scatter it over two.
inline constexpr std::array<Bins, 3> kLabBins = {
    {{0.0, 100.0 / 64, 64}, {-128.25, 0.5, 512}, {-128.25, 0.5, 512}}};

/// Pixels per bin of one channel, from the first occupied bin to the last.
struct ChannelHistogram {
    std::uint32_t first = 0;
    std::vector<std::uint32_t> counts;
};

/// Histograms of L, a and b of an image.
struct ColourHistogram {
    std::array<ChannelHistogram, 3> channels;
    std::uint64_t pixels = 0;
};

/// Counts the pixels of an image (1 or 3 bands, linear sRGB) in kLabBins. NaN counts as
/// the lowest value. \cost 2 to 3 ns a pixel
/// \param lightness  where L of every pixel is wanted: a contiguous plane of its size
[[nodiscard]] ColourHistogram colour_histogram(ImageView<const float> image,
                                               PlaneView<float> lightness = {});

/// The mean of L, from the middles of the bins.
[[nodiscard]] double mean_lightness(const ColourHistogram& histogram);

inline constexpr std::size_t kFeatureBins = 64;  ///< a channel
inline constexpr std::size_t kColourFeatures = 3 * kFeatureBins;

/// The bins that the features of a material share: per channel, `merge` neighbours of
/// kLabBins in one, starting with bin `first`.
struct FeatureGrid {
    std::array<std::size_t, 3> first = {};
    std::array<std::size_t, 3> merge = {1, 1, 1};
    [[nodiscard]] double width(std::size_t channel) const {
        return kLabBins[channel].width * static_cast<double>(merge[channel]);
    }
};

/// The finest grid that covers every pixel of the images: L from 0 to 100, a and b the
/// range that they occupy. Images without pixels are passed over.
[[nodiscard]] FeatureGrid common_grid(std::span<const ColourHistogram> histograms);

/// The cumulative histograms of the three channels, one after the other, scaled so that
/// the squared Euclidean distance of two features is their Cramér distance in Lab units:
///
///     f_{c,b} = √w_c F_c(b),  F_c(b) = share of pixels up to the upper edge of bin b
///     ‖f - g‖² = Σ_c Σ_b w_c (F_c(b) - G_c(b))² ≈ Σ_c ∫ (F_c - G_c)² dx
void cumulative_feature(const ColourHistogram& histogram, const FeatureGrid& grid,
                        std::span<double, kColourFeatures> feature);

}  // namespace sateen
