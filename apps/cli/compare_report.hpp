// SPDX-License-Identifier: Apache-2.0
// The page that `sateen compare --report` and `sateen model --report` write.
#pragma once

#include <string>
#include <vector>

#include "comparison.hpp"
#include "sateen/core/result.hpp"

namespace sateen::cli {

/// A self-contained HTML page: pictures, scores, spectra, histograms, autocovariances.
/// \param title  plain text \param lead  HTML that comes before the comparisons
[[nodiscard]] Result<std::string> comparison_page(
    const std::string& title, const std::string& lead,
    const std::vector<Comparison>& comparisons);

}  // namespace sateen::cli
