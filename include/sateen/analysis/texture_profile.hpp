// SPDX-License-Identifier: Apache-2.0
// What a texture looks like to statistics, as curves and pictures for a report.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// Curves of one image; all but the histograms are of lightness. Images of different
/// sizes have profiles that can be laid over each other.
struct TextureProfile {
    static constexpr std::size_t kBins = 128;
    static constexpr float kAxisRange = 64;  ///< of a and b, either side of 0

    /// Shares of the pixels by L (0 to 100) and by a and b (-kAxisRange to kAxisRange),
    /// the end bins holding what lies beyond.
    std::array<std::array<double, kBins>, 3> histogram{};
    /// Mean power density by frequency, cycles a pixel, in rings a tenth of an octave
    /// wide: ΔE² a bin, so that white noise of variance v has v everywhere.
    std::vector<double> frequency;
    std::vector<double> power;
    /// Autocovariance over the variance at lags 0, 1, … pixels along columns and rows.
    std::vector<double> along_cols;
    std::vector<double> along_rows;
    /// (1, n, n): log10 of the power density, zero frequency in the middle, averaged to n
    /// bins a side.
    Image spectrum;
};

/// \param image  (1 or 3, rows, cols), linear
/// \error invalid_argument  as for TextureReference::create()
[[nodiscard]] Result<TextureProfile> texture_profile(const Image& image);

}  // namespace sateen
