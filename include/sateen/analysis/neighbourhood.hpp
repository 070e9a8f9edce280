// SPDX-License-Identifier: Apache-2.0
// Choice of the contextual neighbourhood of a causal field. Theory:
// docs/theory/neighbourhood.md.
#pragma once

#include <vector>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/analysis/car2d.hpp"
#include "sateen/analysis/options.hpp"

namespace sateen {

/// How far a rule's offsets can reach: autocovariances are needed to twice this lag.
[[nodiscard]] int reach_of(const NeighbourhoodOptions& options);

/// The offsets of the half plane of largest |R(s)|, `count` of them within `reach`
/// ([GMRF] ref. 25, [SAR] ref. 15).
[[nodiscard]] std::vector<Offset> select_by_correlation(const Autocovariance& R,
                                                        std::size_t count, int reach);

/// The hierarchical half plane of the order 1 … max_order whose evidence is largest.
[[nodiscard]] Result<std::vector<Offset>> select_by_evidence(
    const Autocovariance& R, int max_order, const Car2dPrior& prior = {});

/// Applies a rule; never more than one coefficient for every 8 sites.
[[nodiscard]] Result<std::vector<Offset>> select_neighbourhood(
    const Autocovariance& R, const NeighbourhoodOptions& options);

}  // namespace sateen
