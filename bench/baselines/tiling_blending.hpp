// SPDX-License-Identifier: Apache-2.0
// Histogram-preserving tiling and blending: the rival that keeps the exemplar.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::baselines {

/// High-performance by-example noise [Heitz & Neyret 2018, Deliot & Heitz 2019]: every
/// principal channel of the exemplar is made Gaussian by ranks; a pixel blends three pieces of
/// it, placed at random for each vertex of a grid of triangles,
///
///     g = Σ w_i g_i / √(Σ w_i²)
///
/// which keeps mean and variance, and the inverse of the ranks gives back the distribution.
/// The exemplar is read on a torus: where it does not tile, its seam shows.
/// \param image  encoded for a display, 3 bands
[[nodiscard]] Result<Image> tiling_blending(const Image& image, std::size_t rows,
                                            std::size_t cols, std::uint64_t seed);

}  // namespace sateen::baselines
