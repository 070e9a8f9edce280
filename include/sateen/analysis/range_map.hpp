// SPDX-License-Identifier: Apache-2.0
// The range map of a material, from measurement to tiles, one call a stage.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/surface.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen {

enum class SurfaceMethod {
    automatic,  ///< stereo where there are lights enough, else none
    stereo,
    shading,
    none,
};

/// "auto", "stereo", "shading" or "none". \error invalid_argument
[[nodiscard]] Result<SurfaceMethod> parse_surface_method(std::string_view text);

struct RangeMapOptions {
    SurfaceMethod method = SurfaceMethod::automatic;
    bool robust = true;     ///< stereo; plain least squares in paper mode
    std::size_t tiles = 4;  ///< at most, 1 … 8
    /// Largest size of the tiles in the file, estimated: coarser steps, then fewer tiles.
    std::size_t budget_bytes = 88U << 10U;
    std::optional<Direction> light = {};  ///< of a photograph, for shading
    bool skip_bad = false;
};

/// What was found, at the pixels of the measurement, and the tiles made of it.
struct RangeMap {
    SurfaceMethod method = SurfaceMethod::none;
    Image height_px;  ///< (1, rows, cols)
    Image normals;    ///< (3, rows, cols)
    Image albedo;     ///< (bands, rows, cols), or one value for shading
    Direction light;  ///< of the photograph, for shading
    bool light_estimated = false;
    Surface surface;
    double seam_ratio = 1;         ///< see RolledSurface
    double normal_seam_ratio = 1;  ///< of normals derived from the tiles
    std::size_t estimated_bytes = 0;
    std::vector<std::string> notes;
};

/// Estimates the range map: slopes by photometric stereo or shading, height by integration,
/// tiles by the Roller, codes of at most 0.5 % error. Nothing for method none, and for
/// automatic where there is no view with five lights.
/// \error of the stages
[[nodiscard]] Result<std::optional<RangeMap>> estimate_range_map(
    const Measurement& measurement, const RangeMapOptions& options, Executor& executor,
    Progress& progress);

}  // namespace sateen
