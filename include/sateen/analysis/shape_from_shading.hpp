// SPDX-License-Identifier: Apache-2.0
// Shape from the shading of one photograph. Theory: docs/theory/shape_from_shading.md.
#pragma once

#include <cstddef>
#include <optional>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

struct ShadingOptions {
    /// Towards the light; none: estimated, with an assumed elevation of 45 degrees.
    std::optional<Direction> light = {};
    std::size_t iterations = 100;  ///< on each scale
};

struct ShadingEstimate {
    BasicImage<double> height_px;  ///< (1, rows, cols), a torus
    Direction light;
    bool light_estimated = false;
    double albedo = 0;  ///< of the whole: I = albedo · n · l
    /// Root mean square of what the surface leaves of the image, against its deviation.
    double residual = 0;
};

/// Height of a Lambertian surface of constant albedo from one image, by the iteration
///
///     p̃ = p̄ + λ (I - R(p̄, q̄)) R_p / ρ²,  q̃ likewise,  (p, q) the slopes of the
///     integrable surface nearest to (p̃, q̃)
///
/// with R = ρ (-l1 p - l2 q + l3) / sqrt(1 + p² + q²) [GMRF, eq. 1, whose light sign is
/// corrected; Horn and Brooks 1986, Frankot and Chellappa 1988]; coarse to fine. Slopes
/// across the direction of the light do not show in the image and are not found.
/// \param image  (1 or 3, rows, cols), linear; its largest part of FFT size is used, made
///               periodic
/// \error invalid_argument  smaller than 16 pixels, a light from straight above or below
///                          the horizon, or no contrast; cancelled
/// \cost 4 FFTs an iteration: about 2 s for 800 x 800
[[nodiscard]] Result<ShadingEstimate> shape_from_shading(const Image& image,
                                                         const ShadingOptions& options,
                                                         Executor& executor,
                                                         Progress& progress);

}  // namespace sateen
