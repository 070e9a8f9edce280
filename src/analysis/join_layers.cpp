// SPDX-License-Identifier: Apache-2.0
// One periodic layer under several photographs. See periodic_layer.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/fold.hpp"
#include "analysis/periodic_layer.hpp"

namespace sateen {
namespace {

/// Bases differ by no more than this share of the shorter vector.
constexpr double kNearBasis = 0.1;
constexpr double kLeastCorrelation = 0.5;

/// B N⁻¹ of the unimodular N that brings B nearest to `reference`; nothing where it is
/// another lattice.
std::optional<LatticeMap> same_basis(const PeriodicLayer& layer,
                                     const PeriodicLayer& reference) {
    const LatticeMap map(layer);
    const LatticeMap known(reference);
    const auto p = known.to_cell(map.a()[0], map.a()[1]);
    const auto q = known.to_cell(map.b()[0], map.b()[1]);
    const double n00 = std::round(p[0]);
    const double n10 = std::round(p[1]);
    const double n01 = std::round(q[0]);
    const double n11 = std::round(q[1]);
    const double det = n00 * n11 - n01 * n10;
    if (std::abs(det) != 1) return std::nullopt;
    const auto combined = [&](double k, double l) {
        return std::array<double, 2>{(k * map.a()[0] + l * map.b()[0]) / det,
                                     (k * map.a()[1] + l * map.b()[1]) / det};
    };
    const LatticeMap same(combined(n11, -n10), combined(-n01, n00));
    const double shortest = std::min(std::hypot(known.a()[0], known.a()[1]),
                                     std::hypot(known.b()[0], known.b()[1]));
    const double off =
        std::max(std::hypot(same.a()[0] - known.a()[0], same.a()[1] - known.a()[1]),
                 std::hypot(same.b()[0] - known.b()[0], same.b()[1] - known.b()[1]));
    if (off > kNearBasis * shortest) return std::nullopt;
    return same;
}

struct Shift {
    std::size_t rows = 0;
    std::size_t cols = 0;
    double correlation = -1;
};

void remove_means(Image& cells) {
    for (std::size_t plane = 0; plane < cells.bands(); ++plane) {
        double sum = 0;
        const PlaneView<float> view = cells.plane(plane);
        for (std::size_t i = 0; i < view.size(); ++i)
            sum += static_cast<double>(view.data[i]);
        for (std::size_t i = 0; i < view.size(); ++i)
            view.data[i] -= static_cast<float>(sum / static_cast<double>(view.size()));
    }
}

double energy(const Image& cells) {
    double sum = 0;
    for (const float value : cells.values())
        sum += static_cast<double>(value) * static_cast<double>(value);
    return sum;
}

/// The s of the largest Σ cells(u + s) reference(u).
Shift best_shift(const Image& cells, const Image& reference, Executor& executor) {
    const std::size_t P = cells.rows();
    const std::size_t Q = cells.cols();
    std::vector<double> sums(P * Q);
    parallel_for(executor, P, [&](std::size_t down) {
        for (std::size_t across = 0; across < Q; ++across) {
            float sum = 0;
            for (std::size_t plane = 0; plane < cells.bands(); ++plane)
                for (std::size_t r = 0; r < P; ++r) {
                    const float* known = reference.plane(plane).row(r);
                    const float* row = cells.plane(plane).row((r + down) % P);
                    for (std::size_t c = 0; c < Q - across; ++c)
                        sum += row[c + across] * known[c];
                    for (std::size_t c = Q - across; c < Q; ++c)
                        sum += row[c + across - Q] * known[c];
                }
            sums[down * Q + across] = static_cast<double>(sum);
        }
    });
    const auto best = std::ranges::max_element(sums);
    const auto at = static_cast<std::size_t>(best - sums.begin());
    const double norm = std::sqrt(energy(cells) * energy(reference));
    return {at / Q, at % Q, norm > 0 ? *best / norm : 0};
}

/// D' with B⁻¹ (x + D') = B_k⁻¹ (x + D_k) - shift: the phase of the reference.
void rebase(Image& displacement, const LatticeMap& own, const LatticeMap& reference,
            double u_shift, double v_shift, Executor& executor) {
    parallel_for(executor, displacement.rows(), [&](std::size_t r) {
        for (std::size_t c = 0; c < displacement.cols(); ++c) {
            const auto phase = phase_at(own, displacement, r, c);
            const double u = phase[0] - u_shift;
            const double v = phase[1] - v_shift;
            for (std::size_t axis = 0; axis < 2; ++axis)
                displacement(axis, r, c) =
                    static_cast<float>(u * reference.a()[axis] + v * reference.b()[axis] -
                                       static_cast<double>(axis == 0 ? r : c));
        }
    });
}

}  // namespace

std::optional<AlignedLayer> join_layers(std::vector<std::optional<AlignedLayer>> layers,
                                        std::span<const Image> planes,
                                        Executor& executor) {
    std::optional<std::size_t> plainest;
    for (std::size_t k = 0; k < layers.size(); ++k)
        if (layers[k] &&
            (!plainest || layers[k]->periodicity > layers[*plainest]->periodicity))
            plainest = k;
    if (!plainest) return std::nullopt;
    AlignedLayer joined;
    joined.layer = layers[*plainest]->layer;
    joined.periodicity = layers[*plainest]->periodicity;
    joined.photographs.clear();
    const PeriodicLayer& layer = joined.layer;
    const auto cells_of = [&](std::size_t k, const LatticeMap& map) {
        Image cells = fold(planes.subspan(k, 1), map, layers[k]->displacements,
                           layer.rows, layer.cols, executor);
        remove_means(cells);
        return cells;
    };
    const LatticeMap map(layer);
    const Image reference = cells_of(*plainest, map);
    for (std::size_t k = 0; k < layers.size(); ++k) {
        if (!layers[k]) continue;
        Image& displacement = layers[k]->displacements.front();
        if (k != *plainest) {
            const std::optional<LatticeMap> own = same_basis(layers[k]->layer, layer);
            if (!own) continue;
            const Shift shift = best_shift(cells_of(k, *own), reference, executor);
            if (shift.correlation < kLeastCorrelation) continue;
            rebase(displacement, *own, map,
                   static_cast<double>(shift.rows) / static_cast<double>(layer.rows),
                   static_cast<double>(shift.cols) / static_cast<double>(layer.cols),
                   executor);
        }
        joined.displacements.push_back(std::move(displacement));
        joined.photographs.push_back(k);
    }
    return joined;
}

}  // namespace sateen
