// SPDX-License-Identifier: Apache-2.0
// The page `sateen compare --report` writes: everything in one file, nothing to load.
#pragma once

#include <string>
#include <vector>

#include "sateen/analysis/quality.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::cli {

/// Two images and how near they are.
struct Comparison {
    std::string title;  ///< e.g. the subspace; may be empty
    std::string reference_name;
    std::string candidate_name;
    Image reference;
    Image candidate;
    TextureScore score;
    TextureCrossCheck cross_check;
    SeamRatio seam;  ///< of the candidate
};

/// A self-contained HTML page: pictures, scores, spectra, histograms, autocovariances.
/// \param total  the score of the whole
[[nodiscard]] Result<std::string> comparison_page(
    const std::vector<Comparison>& comparisons, double total);

}  // namespace sateen::cli
