// SPDX-License-Identifier: Apache-2.0
// Drawing the periodic layer. See periodic_layer.hpp.
#include "synthesis/periodic_layer.hpp"

#include <algorithm>
#include <cmath>

#include "sateen/core/fft.hpp"
#include "sateen/synthesis/torus_size.hpp"
#include "synthesis/noise_bands.hpp"

namespace sateen {
namespace {

/// How far the search for a better size goes, as a part of the size and in pixels, and what a
/// change of size costs.
constexpr std::size_t kSearchShare = 8;
constexpr std::size_t kFurthestSearch = 256;
constexpr double kPriceOfChange = 0.02;

/// A side of the torus of sites: an accepted FFT size nearest to a whole number of spacings.
std::int32_t sites_of(std::int32_t pixels, std::uint16_t spacing) {
    const auto wanted = static_cast<std::size_t>(
        std::max(1.0, std::round(static_cast<double>(pixels) / spacing)));
    return static_cast<std::int32_t>(fft_size_at_most(wanted));
}

/// The largest singular value of a 2 x 2 matrix.
double norm(double m00, double m01, double m10, double m11) {
    const double sum = m00 * m00 + m01 * m01 + m10 * m10 + m11 * m11;
    const double det = m00 * m11 - m01 * m10;
    const double root = std::sqrt(std::max(0.0, sum * sum - 4 * det * det));
    return std::sqrt((sum + root) / 2);
}

/// ‖B' B⁻¹ - I‖: B⁻¹ takes the unit vectors to cells, B' takes those back.
double strain_of(const PeriodicLayer& layer, std::size_t rows, std::size_t cols) {
    const LatticeMap map(layer);
    const LatticeMap closed = closed_lattice(layer, rows, cols);
    const auto& a = closed.a();
    const auto& b = closed.b();
    const auto down = map.to_cell(1, 0);
    const auto across = map.to_cell(0, 1);
    return norm(a[0] * down[0] + b[0] * down[1] - 1, a[0] * across[0] + b[0] * across[1],
                a[1] * down[0] + b[1] * down[1], a[1] * across[0] + b[1] * across[1] - 1);
}

/// q(g) of one plane.
float apply(const Marginal& marginal, float g) {
    if (marginal.knots.empty()) return marginal.scale * g;
    constexpr auto kSteps = static_cast<float>(Marginal::kKnots - 1);
    const float t =
        (std::clamp(g, -Marginal::kRange, Marginal::kRange) + Marginal::kRange) *
        (kSteps / (2 * Marginal::kRange));
    const auto j = std::min(static_cast<std::size_t>(t), Marginal::kKnots - 2);
    const float low = marginal.knots[j];
    return marginal.scale *
           (low + (t - static_cast<float>(j)) * (marginal.knots[j + 1] - low));
}

}  // namespace

LatticeMap closed_lattice(const PeriodicLayer& layer, std::size_t rows,
                          std::size_t cols) {
    const LatticeMap map(layer);
    const auto M = static_cast<double>(rows);
    const auto N = static_cast<double>(cols);
    auto down = map.to_cell(M, 0);
    auto across = map.to_cell(0, N);
    for (auto* cells : {&down, &across})
        for (double& k : *cells) k = std::round(k);
    double det = down[0] * across[1] - across[0] * down[1];
    if (det == 0) {
        down = {1, 0};
        across = {0, 1};
        det = 1;
    }
    // B' = diag(M, N) K⁻¹ with K = (down across).
    return {{M * across[1] / det, -N * down[1] / det},
            {-M * across[0] / det, N * down[0] / det}};
}

TorusSize torus_of(const Material& material, std::size_t rows, std::size_t cols) {
    if (!material.structure) return {rows, cols, 0};
    return {rows, cols, strain_of(material.structure->periodic, rows, cols)};
}

TorusSize best_torus(const Material& material, std::size_t rows, std::size_t cols) {
    TorusSize best = torus_of(material, rows, cols);
    double lowest = best.strain;
    const auto change = [](std::size_t now, std::size_t asked) {
        return std::abs(static_cast<double>(now) / static_cast<double>(asked) - 1);
    };
    const auto reach = [](std::size_t side) {
        return std::min(side / kSearchShare, kFurthestSearch);
    };
    for (std::size_t M = rows - reach(rows); M <= rows + reach(rows); ++M)
        for (std::size_t N = cols - reach(cols); N <= cols + reach(cols); ++N) {
            const TorusSize size = torus_of(material, M, N);
            const double cost =
                size.strain + kPriceOfChange * (change(M, rows) + change(N, cols));
            if (cost >= lowest) continue;
            lowest = cost;
            best = size;
        }
    return best;
}

Result<PeriodicPhase> PeriodicPhase::create(const PeriodicLayer& layer,
                                            std::uint64_t seed, Period period,
                                            Executor& executor) {
    Period sites;
    double row_step = layer.spacing;
    double col_step = layer.spacing;
    LatticeMap map(layer);
    if (period.rows != 0) {
        sites = {sites_of(period.rows, layer.spacing),
                 sites_of(period.cols, layer.spacing)};
        row_step = static_cast<double>(period.rows) / sites.rows;
        col_step = static_cast<double>(period.cols) / sites.cols;
        map = closed_lattice(layer, static_cast<std::size_t>(period.rows),
                             static_cast<std::size_t>(period.cols));
    }
    const auto draw = [&](std::size_t axis) {
        return SmoothLattice::create(
            layer.displacement[axis],
            {seed, displacement_noise_band(static_cast<std::uint32_t>(axis))}, sites,
            layer.spacing / row_step, layer.spacing / col_step, executor);
    };
    SATEEN_TRY(SmoothLattice down, draw(0));
    SATEEN_TRY(SmoothLattice across, draw(1));
    PeriodicPhase phase({std::move(down), std::move(across)});
    phase.map_ = map;
    phase.row_step_ = row_step;
    phase.col_step_ = col_step;
    return phase;
}

PeriodicPhase::Window::Window(const PeriodicPhase& phase, std::int32_t row,
                              std::int32_t col, std::size_t rows, std::size_t cols,
                              Executor& executor)
    : phase_(phase), row_(row), col_(col) {
    const std::int64_t last_row = std::int64_t{row} + static_cast<std::int64_t>(rows) - 1;
    const std::int64_t last_col = std::int64_t{col} + static_cast<std::int64_t>(cols) - 1;
    first_row_ = site_before(row, phase.row_step_) - 1;
    const std::int32_t first_col = site_before(col, phase.col_step_) - 1;
    const auto count = [](std::int32_t first, std::int32_t last) {
        return static_cast<std::size_t>(last + 3 - first);
    };
    sites_ = Image(2, count(first_row_, site_before(last_row, phase.row_step_)),
                   count(first_col, site_before(last_col, phase.col_step_)));
    for (std::size_t axis = 0; axis < 2; ++axis)
        phase.displacement_[axis].draw(first_row_, first_col, sites_.plane(axis),
                                       executor);
    for (std::int64_t c = col; c <= last_col; ++c)
        col_taps_.push_back(cubic_taps(c, phase.col_step_, first_col));
}

void PeriodicPhase::Window::phases(std::size_t r, std::span<double> u,
                                   std::span<double> v) const {
    const std::int64_t row = std::int64_t{row_} + static_cast<std::int64_t>(r);
    const CubicTaps down = cubic_taps(row, phase_.row_step_, first_row_);
    std::array<std::vector<float>, 2> D;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        D[axis].resize(sites_.cols());
        for (std::size_t i = 0; i < 4; ++i) {
            const float* sites = sites_.plane(axis).row(down.first + i);
            for (std::size_t c = 0; c < sites_.cols(); ++c)
                D[axis][c] += down.weights[i] * sites[c];
        }
    }
    for (std::size_t c = 0; c < u.size(); ++c) {
        const CubicTaps& across = col_taps_[c];
        std::array<float, 2> at{};
        for (std::size_t axis = 0; axis < 2; ++axis)
            for (std::size_t i = 0; i < 4; ++i)
                at[axis] += across.weights[i] * D[axis][across.first + i];
        const auto cell = phase_.map_.to_cell(
            static_cast<double>(row) + static_cast<double>(at[0]),
            static_cast<double>(std::int64_t{col_} + static_cast<std::int64_t>(c)) +
                static_cast<double>(at[1]));
        u[c] = cell[0];
        v[c] = cell[1];
    }
}

void apply_periodic_layer(const Structure& structure, const Subspace& subspace,
                          const PeriodicPhase& phase, std::int32_t row, std::int32_t col,
                          ImageView<float> planes, Executor& executor) {
    const auto& cells = subspace.structure->cells;
    const CellTable table(structure.periodic, cells);
    const PeriodicPhase::Window window(phase, row, col, planes.rows, planes.cols,
                                       executor);
    parallel_for(executor, planes.rows, [&](std::size_t r) {
        std::vector<double> u(planes.cols);
        std::vector<double> v(planes.cols);
        window.phases(r, u, v);
        for (std::size_t c = 0; c < planes.cols; ++c) {
            const auto cell = table.at(u[c], v[c]);
            std::array<float, CellTable::kPlanes> R{};
            for (std::size_t plane = 0; plane < planes.bands; ++plane) {
                float& value = planes.plane(plane).row(r)[c];
                R[plane] = apply(subspace.marginals[plane], value);
                float x = cell[plane] + cell[CellTable::kPlanes + plane] * R[plane];
                for (std::size_t j = 0; j < plane; ++j)
                    x += cell[CellTable::mixing(plane, j)] * R[j];
                value = apply(cells[plane].curve, x);
            }
        }
    });
}

}  // namespace sateen
