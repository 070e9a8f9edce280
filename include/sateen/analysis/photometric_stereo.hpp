// SPDX-License-Identifier: Apache-2.0
// Over-determined photometric stereo: normals and albedo from many lights of one view.
// Theory: docs/theory/photometric_stereo.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen {

struct StereoOptions {
    /// Leaves out shadows and highlights; false is plain least squares [CAR2, SAR].
    bool robust = true;
    /// Rotates the normals so that their mean is (0, 0, 1).
    bool upright = true;
    /// Lights (numbers in MeasurementInfo::lights) that are not used.
    std::vector<std::uint32_t> without_lights = {};
    /// Go on past unreadable images.
    bool skip_bad = false;
    /// Of the images that are held at once; more are read in several passes.
    std::size_t memory_bytes = std::size_t{192} << 20U;
};

struct StereoEstimate {
    Image normals;  ///< (3, rows, cols), unit
    Image albedo;   ///< (bands, rows, cols): I = albedo · max(0, n · l)
    std::uint32_t view = 0;
    std::size_t lights = 0;  ///< images used
    double mean_used = 0;    ///< share of the values with weight, over the pixels
    std::array<double, 3> up = {0, 0, 1};  ///< mean normal before it was made upright
    std::vector<std::string> notes;        ///< images left out
};

/// Normals and albedo from all lights of the view nearest to the surface normal, by weighted
/// least squares over the lights
///
///     g = ρ n = (Lᵀ W L)⁻¹ Lᵀ W I    [Woodham 1980; CAR2, section II.B; SAR]
///
/// Plain: W = 1, I the luminance. Robust: Cauchy weights, without shadow and saturated values,
/// T max(0, g · l) with the light T that a layer lets through where that agrees better, and the
/// mixture of channels that gloss hardly enters. Albedo is fitted channel by channel with the
/// weights of the luminance.
/// \error invalid_argument  photographs without directions
/// \error singular          fewer than 3 lights, or all in one plane
/// \error of reading; cancelled
/// \cost one pass over the images of the view for every `memory_bytes` of them, and about
///       30 µs a pixel and thread for 81 lights
[[nodiscard]] Result<StereoEstimate> photometric_stereo(const Measurement& measurement,
                                                        const StereoOptions& options,
                                                        Executor& executor,
                                                        Progress& progress);

}  // namespace sateen
