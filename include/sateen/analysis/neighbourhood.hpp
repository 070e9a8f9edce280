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

/// The largest order up to `order` whose coefficients the sites can bear, at least 1.
[[nodiscard]] int affordable_order(double sites, int order);

/// The offsets of the half plane of largest |R(s)|, `count` of them within `reach`
/// ([GMRF] ref. 25, [SAR] ref. 15).
[[nodiscard]] std::vector<Offset> select_by_correlation(const Autocovariance& R,
                                                        std::size_t count, int reach);

/// The hierarchical half plane of the order 1 … max_order whose evidence is largest.
[[nodiscard]] Result<std::vector<Offset>> select_by_evidence(
    const Autocovariance& R, int max_order, const Car2dPrior& prior = {});

/// Forward selection: starting from no offset, adds the one of the half plane within `reach`
/// that lowers the residual λ most, as long as n Δ ln λ pays for a coefficient by the
/// evidence's leading terms, n ln λ + η ln n, and at most `count` times. Finds the periods of
/// weaves and ribs, which no disc of the same number of offsets reaches.
/// \cost  O(count · reach⁴): one sweep of the covariance matrix of the window an offset
[[nodiscard]] std::vector<Offset> select_forward(const Autocovariance& R,
                                                 std::size_t count, int reach);

/// Applies a rule; never more than one coefficient for every 8 sites.
[[nodiscard]] Result<std::vector<Offset>> select_neighbourhood(
    const Autocovariance& R, const NeighbourhoodOptions& options);

}  // namespace sateen
