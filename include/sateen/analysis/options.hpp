// SPDX-License-Identifier: Apache-2.0
// Options of the analysis, listed once, with their defaults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// How the contextual neighbourhood of a field is chosen.
enum class NeighbourhoodRule {
    order,        ///< hierarchical half plane of an order
    correlation,  ///< the offsets of largest spatial correlation [SAR, GMRF]
    evidence,     ///< the hierarchical order of largest posterior evidence [CAR2]
    nearest,  ///< {(0,1), (1,0), (1,1)}, the first `count` of them: [SAR]'s and [CAR2]'s
};

/// On the command line: "order:6", "correlation:14", "evidence:10", "nearest:3".
struct NeighbourhoodOptions {
    NeighbourhoodRule rule = NeighbourhoodRule::evidence;
    /// The order, the number of offsets, the largest order tried, the number of sites.
    int value = 6;
};

/// \error invalid_argument  says what was found and what can be given
[[nodiscard]] Result<NeighbourhoodOptions> parse_neighbourhood(std::string_view text);
[[nodiscard]] std::string to_string(const NeighbourhoodOptions& options);

struct AnalysisOptions {
    /// Exactly what [CAR2] prints: few neighbours, at most 3 levels, no marginal curves,
    /// no power compensation, fit on interior sites, drawn by causal recursion.
    bool paper = false;
    /// Subspaces of a BTF, 1 … 20; 0 lets the segmentation choose.
    std::size_t subspaces = 0;
    /// Levels of the pyramid, 1 … 8; 0: 5 where the sample has 512 pixels or more each
    /// way, 4 from 128, fewer below; 3 in paper mode.
    std::size_t levels = 0;
    NeighbourhoodOptions neighbourhood;
    Tone tone = Tone::srgb;
    std::uint64_t seed = 0;
    /// Go on past unreadable images.
    bool skip_bad = false;
};

}  // namespace sateen
