// SPDX-License-Identifier: Apache-2.0
// Textures that one transform does not draw, in strips of rows from top to bottom.
#pragma once

#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/synthesis/synthesise.hpp"

namespace sateen {

/// A window of the infinite plane, by recursion where the options or the material ask for it.
[[nodiscard]] Result<void> draw_window(const Material& material, const Subspace& subspace,
                                       const SynthesisOptions& options,
                                       const StripSink& sink, Executor& executor,
                                       Progress& progress);

/// A torus that one transform cannot draw: the infinite lattice with periodic noise.
[[nodiscard]] Result<void> draw_periodic(const Material& material,
                                         const Subspace& subspace,
                                         SynthesisOptions options, const StripSink& sink,
                                         Executor& executor, Progress& progress);

}  // namespace sateen
