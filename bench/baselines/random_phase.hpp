// SPDX-License-Identifier: Apache-2.0
// Random phase noise: the full-parameter limit of every stationary Gaussian field.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::baselines {

/// Adds one random phase to all planes of the periodic component, which keeps every auto-
/// and cross-spectrum and the mean [Galerne, Gousseau & Morel 2011].
///
/// Phases are those of white noise. A result larger than the image is made from the image
/// less its mean, set into zeros and scaled by the root of the ratio of areas; a smaller
/// one from the centre of the image. Values are taken as given: encode first for a
/// display. \error invalid_argument  rows or cols is not a size the transforms accept
[[nodiscard]] Result<Image> random_phase(const Image& image, std::size_t rows,
                                         std::size_t cols, std::uint64_t seed);

}  // namespace sateen::baselines
