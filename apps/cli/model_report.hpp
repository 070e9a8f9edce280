// SPDX-License-Identifier: Apache-2.0
// The page that `sateen model --report` writes: a material beside its measurement.
#pragma once

#include <cstddef>
#include <string>

#include "sateen/analysis/analyse.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen::cli {

/// Every subspace drawn beside the image that it was modelled from, with scores; bytes by
/// part and subspace; why the field models are what they are; the notes.
/// \param bytes  of the material's file
/// \error as compare_subspaces()
[[nodiscard]] Result<std::string> model_page(const Analysis& analysis,
                                             const Measurement& measurement,
                                             std::size_t bytes, Executor& executor,
                                             Progress& progress);

}  // namespace sateen::cli
