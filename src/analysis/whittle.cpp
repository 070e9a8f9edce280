// SPDX-License-Identifier: Apache-2.0
// Whittle's deviance. See whittle.hpp.
#include "sateen/analysis/whittle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "analysis/lag_transform.hpp"

namespace sateen {
namespace {

int reach_of(const std::vector<Offset>& offsets) {
    int reach = 0;
    for (const Offset s : offsets)
        reach = std::max({reach, std::abs(int{s.row}), std::abs(int{s.col})});
    return reach;
}

void add(Autocovariance& b, int row, int col, double value) {
    if (row >= 0) b.at(row, col) += value;  // b(-s) = b(s)
}

}  // namespace

//     |Λ|² = Σ_s Σ_t c_s c_t e^{-jω·(s - t)},   c = (1, -a)
Autocovariance inverse_covariance(const Car2d& field) {
    std::vector<Offset> support = {{0, 0}};
    std::vector<double> c = {1};
    for (std::size_t i = 0; i < field.a.size(); ++i) {
        support.push_back(field.neighbourhood[i]);
        c.push_back(-static_cast<double>(field.a[i]));
    }
    Autocovariance b(2 * reach_of(support), 0);
    for (std::size_t i = 0; i < c.size(); ++i)
        for (std::size_t j = 0; j < c.size(); ++j)
            add(b, support[i].row - support[j].row, support[i].col - support[j].col,
                c[i] * c[j] / static_cast<double>(field.variance));
    return b;
}

Autocovariance inverse_covariance(const Gmrf2d& field) {
    Autocovariance b(reach_of(field.neighbourhood), 0);
    const auto variance = static_cast<double>(field.variance);
    add(b, 0, 0, 1 / variance);
    for (std::size_t i = 0; i < field.a.size(); ++i) {
        const Offset s = field.neighbourhood[i];
        const double value = -static_cast<double>(field.a[i]) / variance;
        add(b, s.row, s.col, value);
        add(b, -s.row, -s.col, value);
    }
    return b;
}

double field_variance(const Autocovariance& inverse, int grid) {
    const LagTransform lags(grid, grid, inverse.reach());
    return lags.mean(lags.spectrum(inverse).cwiseInverse());
}

double whittle_deviance(const Autocovariance& inverse, const Autocovariance& R,
                        int grid) {
    const LagTransform lags(grid, grid, inverse.reach());
    double fit = 0;
    for (int row = -inverse.reach(); row <= inverse.reach(); ++row)
        for (int col = -inverse.reach(); col <= inverse.reach(); ++col)
            if (const double b = inverse(row, col); b != 0) fit += b * R(row, col);
    return fit - lags.mean_log(lags.spectrum(inverse));
}

double bayesian_information(double deviance, double sites, std::size_t coefficients) {
    return sites * deviance + static_cast<double>(coefficients + 1) * std::log(sites);
}

}  // namespace sateen
