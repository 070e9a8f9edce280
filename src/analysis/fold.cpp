// SPDX-License-Identifier: Apache-2.0
// Folding images into cells. See fold.hpp.
#include "analysis/fold.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

namespace sateen {
namespace {

/// Rows are folded in so many parts, whose sums are added in order: the same bits for any
/// number of threads.
constexpr std::size_t kParts = 8;

/// What a site has of all planes, and its weight in the last: one vector of the machine.
constexpr std::size_t kLanes = CellTable::kPlanes + 1;
using Lanes = std::array<float, kLanes>;

}  // namespace

Image fold(std::span<const Image> images, const LatticeMap& map,
           std::span<const Image> displacements, std::size_t P, std::size_t Q,
           Executor& executor, double first, std::size_t stride) {
    const std::size_t d = images.front().bands();
    assert(d < kLanes);
    std::vector<std::vector<Lanes>> sums(images.size() * kParts);
    parallel_for(executor, sums.size(), [&](std::size_t number) {
        const Image& planes = images[number / kParts];
        const Image& displacement = displacements[number / kParts];
        const std::size_t part = number % kParts;
        std::vector<Lanes>& sum = sums[number];
        sum.resize(P * Q);
        // Whole strides: the same pixels whatever the parts.
        const auto row = [&](std::size_t k) {
            return (k * planes.rows() / kParts + stride - 1) / stride * stride;
        };
        const std::size_t end = std::min(row(part + 1), planes.rows());
        for (std::size_t r = row(part); r < end; r += stride) {
            std::array<const float*, kLanes> rows{};
            for (std::size_t plane = 0; plane < d; ++plane)
                rows[plane] = planes.plane(plane).row(r);
            for (std::size_t c = 0; c < planes.cols(); c += stride) {
                const auto u = phase_at(map, displacement, r, c);
                const CellTaps taps(u[0], u[1], P, Q, first);
                Lanes value{};
                for (std::size_t plane = 0; plane < d; ++plane)
                    value[plane] = rows[plane][c];
                value[kLanes - 1] = 1;
                for (std::size_t k = 0; k < 4; ++k) {
                    Lanes& site = sum[taps.sites[k]];
                    for (std::size_t lane = 0; lane < kLanes; ++lane)
                        site[lane] += taps.weights[k] * value[lane];
                }
            }
        }
    });
    Image cells(d, P, Q);
    for (std::size_t plane = 0; plane < d; ++plane) {
        double total = 0;
        double pixels = 0;
        std::vector<double> weights(P * Q);
        std::vector<double> values(P * Q);
        for (const std::vector<Lanes>& sum : sums)
            for (std::size_t i = 0; i < P * Q; ++i) {
                values[i] += static_cast<double>(sum[i][plane]);
                weights[i] += static_cast<double>(sum[i][kLanes - 1]);
            }
        for (std::size_t i = 0; i < P * Q; ++i) {
            total += values[i];
            pixels += weights[i];
        }
        for (std::size_t i = 0; i < P * Q; ++i)
            cells.plane(plane).data[i] = static_cast<float>(
                weights[i] > 1e-3 ? values[i] / weights[i] : total / pixels);
    }
    return cells;
}

Image subtract_cells(const Image& planes, const LatticeMap& map,
                     const Image& displacement, const Image& cells, Executor& executor) {
    Image rest(planes.bands(), planes.rows(), planes.cols());
    parallel_for(executor, planes.rows(), [&](std::size_t r) {
        for (std::size_t c = 0; c < planes.cols(); ++c) {
            const auto u = phase_at(map, displacement, r, c);
            const CellTaps taps(u[0], u[1], cells.rows(), cells.cols());
            for (std::size_t plane = 0; plane < planes.bands(); ++plane)
                rest(plane, r, c) =
                    planes(plane, r, c) - taps.read(cells.plane(plane).data);
        }
    });
    return rest;
}

}  // namespace sateen
