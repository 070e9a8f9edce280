// SPDX-License-Identifier: Apache-2.0
// One subspace: spectral factorisation, pyramid and fields of its representative image.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/band_modulation.hpp"
#include "analysis/periodic_layer.hpp"
#include "sateen/analysis/options.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

struct SubspaceFit {
    Subspace subspace;
    std::vector<std::string> notes;
    FieldChoice choice;
    std::optional<SharedModulation> modulation;  ///< where the subspace has one
};

/// \param images     linear, of one number of bands: a representative image, or photographs
///                   whose statistics are pooled
/// \param reference  the transform to align with, or null
/// \param layer      the periodic layer to take away first, of one image; or null
/// \param modulation that of the first subspace, or null to look for one
[[nodiscard]] Result<SubspaceFit> fit_subspace(std::vector<Image> images,
                                               const AnalysisOptions& options,
                                               const SpectralTransform* reference,
                                               const AlignedLayer* layer,
                                               const SharedModulation* modulation,
                                               Executor& executor);

/// The number of levels for samples whose smaller side is `side_px`, by the options.
[[nodiscard]] std::size_t choose_levels(std::size_t side_px,
                                        const AnalysisOptions& options);

}  // namespace sateen
