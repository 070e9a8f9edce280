// SPDX-License-Identifier: Apache-2.0
// Choice of the contextual neighbourhood. See neighbourhood.hpp.
#include "sateen/analysis/neighbourhood.hpp"

#include <Eigen/Core>
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

}  // namespace

int reach_of(const NeighbourhoodOptions& options) {
    switch (options.rule) {
        case NeighbourhoodRule::order:
        case NeighbourhoodRule::evidence:
            return reach_of_order(options.value);
        case NeighbourhoodRule::correlation:
            return kCorrelationReach;
        case NeighbourhoodRule::forward:
            return kMaxReach;
        case NeighbourhoodRule::nearest:
            return 1;
    }
    return 1;
}

int affordable_order(double sites, int order) {
    while (order > 1 &&
           kSitesPerCoefficient *
                   static_cast<double>(hierarchical_half_plane(order).size()) >
               sites)
        --order;
    return order;
}

/// All offsets of the half plane in a window.
std::vector<Offset> half_plane_window(int reach) {
    std::vector<Offset> offsets;
    for (int row = 0; row <= reach; ++row)
        for (int col = -reach; col <= reach; ++col) {
            const Offset s{static_cast<std::int8_t>(row), static_cast<std::int8_t>(col)};
            if (is_causal(s)) offsets.push_back(s);
        }
    return offsets;
}

std::vector<Offset> select_by_correlation(const Autocovariance& R, std::size_t count,
                                          int reach) {
    std::vector<Offset> offsets = half_plane_window(reach);
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

// The covariance matrix of (candidates, Y), swept on the offsets chosen so far, holds in its last
// column the covariances of the remaining candidates with the residual of Y, and on its diagonal
// their own residual variances: adding s lowers the residual variance of Y by C(s,Y)²/C(s,s).
std::vector<Offset> select_forward(const Autocovariance& R, std::size_t count,
                                   int reach) {
    const std::vector<Offset> candidates = half_plane_window(reach);
    const auto n = static_cast<Eigen::Index>(candidates.size());
    Eigen::MatrixXd C(n + 1, n + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Offset s = candidates[static_cast<std::size_t>(i)];
        for (Eigen::Index j = 0; j < n; ++j) {
            const Offset t = candidates[static_cast<std::size_t>(j)];
            C(i, j) = R(s.row - t.row, s.col - t.col);
        }
        C(i, n) = C(n, i) = R(s);
    }
    C(n, n) = R.variance();

    // Candidates that the chosen ones nearly determine are left alone.
    const double smallest = 1e-6 * R.variance();
    std::vector<Offset> chosen;
    std::vector<bool> taken(candidates.size(), false);
    while (chosen.size() < count) {
        Eigen::Index best = -1;
        double best_gain = 0;
        for (Eigen::Index i = 0; i < n; ++i) {
            if (taken[static_cast<std::size_t>(i)] || C(i, i) < smallest) continue;
            const double gain = C(i, n) * C(i, n) / C(i, i);
            if (gain > best_gain) {
                best_gain = gain;
                best = i;
            }
        }
        if (best < 0 || best_gain >= C(n, n)) break;
        const double benefit = -R.sites() * std::log1p(-best_gain / C(n, n));
        if (benefit < std::log(R.sites())) break;
        taken[static_cast<std::size_t>(best)] = true;
        chosen.push_back(candidates[static_cast<std::size_t>(best)]);
        const Eigen::VectorXd column = C.col(best);
        C.noalias() -= column * column.transpose() / column(best);
    }
    std::sort(chosen.begin(), chosen.end());
    if (chosen.empty()) chosen.push_back({0, 1});
    return chosen;
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
        case NeighbourhoodRule::forward:
            return select_forward(R, count, kMaxReach);
        case NeighbourhoodRule::nearest:
            break;
    }
    std::vector<Offset> nearest = {{0, 1}, {1, 0}, {1, 1}};
    nearest.resize(std::min(count, nearest.size()));
    return nearest;
}

}  // namespace sateen
