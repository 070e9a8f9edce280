// SPDX-License-Identifier: Apache-2.0
// Measurement to material, one call a stage.
#pragma once

#include <string>
#include <vector>

#include "sateen/analysis/options.hpp"
#include "sateen/analysis/range_map.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen {

struct Analysis {
    Material material;
    /// One line each, for the user: images left out, fields repaired.
    std::vector<std::string> notes;
    /// For each subspace the observation that represents it.
    std::vector<std::size_t> representatives;
    FieldChoice choice;  ///< of FieldKind::automatic
    /// Of the features that the BTF space was segmented by, see Segmentation; empty for
    /// photographs.
    std::vector<double> eigenvalues;
    /// Of the contrast of the representatives, what the shading of the surface explains; see
    /// ExplainedContrast.
    double shading_share = 0;
};

/// Makes the material of a measurement: segments the BTF space, then for each
/// representative image (or all photographs pooled) factorises spectrally and spatially
/// and estimates the fields [CAR2, section II].
/// \param surface  of this measurement, or null: its tiles go into the material, and its
///                 shading is divided out of the images where it explains them (delight.hpp)
/// \error of reading; singular for images
/// without any variation in size; cancelled \cost  one pass over all images, plus about
/// 0.2 s a megapixel of representatives
[[nodiscard]] Result<Analysis> analyse(const Measurement& measurement,
                                       const AnalysisOptions& options, Executor& executor,
                                       Progress& progress,
                                       const RangeMap* surface = nullptr);

}  // namespace sateen
