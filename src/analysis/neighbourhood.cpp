// SPDX-License-Identifier: Apache-2.0
// Choice of the contextual neighbourhood. See neighbourhood.hpp.
#include "sateen/analysis/neighbourhood.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sateen {
namespace {

constexpr double kSitesPerCoefficient = 8;
/// Correlations are ranked within this window.
constexpr int kCorrelationReach = 5;

int reach_of_order(int order) {
    int reach = 0;
    for (const Offset s : hierarchical_half_plane(order))
        reach =
            std::max({reach, static_cast<int>(s.row), std::abs(static_cast<int>(s.col))});
    return reach;
}

/// The largest order up to `order` that the sites can bear, at least 1.
int affordable_order(double sites, int order) {
    while (order > 1 &&
           kSitesPerCoefficient *
                   static_cast<double>(hierarchical_half_plane(order).size()) >
               sites)
        --order;
    return order;
}

}  // namespace

int reach_of(const NeighbourhoodOptions& options) {
    switch (options.rule) {
        case NeighbourhoodRule::order:
        case NeighbourhoodRule::evidence:
            return reach_of_order(options.value);
        case NeighbourhoodRule::correlation:
            return kCorrelationReach;
        case NeighbourhoodRule::nearest:
            return 1;
    }
    return 1;
}

std::vector<Offset> select_by_correlation(const Autocovariance& R, std::size_t count,
                                          int reach) {
    std::vector<Offset> offsets;
    for (int row = 0; row <= reach; ++row)
        for (int col = -reach; col <= reach; ++col) {
            const Offset s{static_cast<std::int8_t>(row), static_cast<std::int8_t>(col)};
            if (is_causal(s)) offsets.push_back(s);
        }
    std::stable_sort(offsets.begin(), offsets.end(),
                     [&](Offset s, Offset t) { return std::abs(R(s)) > std::abs(R(t)); });
    offsets.resize(std::min(count, offsets.size()));
    return offsets;
}

Result<std::vector<Offset>> select_by_evidence(const Autocovariance& R, int max_order,
                                               const Car2dPrior& prior) {
    std::vector<Offset> best;
    double best_evidence = 0;
    for (int order = 1; order <= affordable_order(R.sites(), max_order); ++order) {
        SATEEN_TRY(
            const Car2dEstimate estimate,
            estimate_car2d(toroidal_normal_equations(R, hierarchical_half_plane(order)),
                           prior));
        if (best.empty() || estimate.log_evidence > best_evidence) {
            best = estimate.model.neighbourhood;
            best_evidence = estimate.log_evidence;
        }
    }
    return best;
}

Result<std::vector<Offset>> select_neighbourhood(const Autocovariance& R,
                                                 const NeighbourhoodOptions& options) {
    const auto affordable =
        static_cast<std::size_t>(std::max(1.0, R.sites() / kSitesPerCoefficient));
    const auto count = std::min(static_cast<std::size_t>(options.value), affordable);
    switch (options.rule) {
        case NeighbourhoodRule::order:
            return hierarchical_half_plane(affordable_order(R.sites(), options.value));
        case NeighbourhoodRule::correlation:
            return select_by_correlation(R, count, kCorrelationReach);
        case NeighbourhoodRule::evidence:
            return select_by_evidence(R, options.value);
        case NeighbourhoodRule::nearest:
            break;
    }
    std::vector<Offset> nearest = {{0, 1}, {1, 0}, {1, 1}};
    nearest.resize(std::min(count, nearest.size()));
    return nearest;
}

}  // namespace sateen
