// SPDX-License-Identifier: Apache-2.0
// The base colour of a material: what renderers light by themselves.
#pragma once

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen::cli {

/// The texture seen and lit from straight above, brought to the mean reflectance that the
/// view from above shows under lights between 20 and 60 degrees: the median of
/// value / cos θ over them, which a highlight in some of them does not move. Materials
/// without reflectance by direction keep the mean of the texture.
[[nodiscard]] Result<Image> draw_base_colour(const Material& material,
                                             const SynthesisOptions& options,
                                             Executor& executor, Progress& progress);

}  // namespace sateen::cli
