// SPDX-License-Identifier: Apache-2.0
// Folding images into cells. See fold.hpp.
#include "analysis/fold.hpp"

#include <algorithm>
#include <vector>

namespace sateen {
namespace {

/// Rows are folded in so many parts, whose sums are added in order: the same bits for any
/// number of threads.
constexpr std::size_t kParts = 8;

}  // namespace

Image fold(std::span<const Image> images, const LatticeMap& map,
           std::span<const Image> displacements, std::size_t P, std::size_t Q,
           Executor& executor, double first) {
    const std::size_t d = images.front().bands();
    // Of the planes, then of the weights: all of a site together.
    std::vector<std::vector<float>> sums(images.size() * kParts);
    parallel_for(executor, sums.size(), [&](std::size_t number) {
        const Image& planes = images[number / kParts];
        const Image& displacement = displacements[number / kParts];
        const std::size_t part = number % kParts;
        std::vector<float>& sum = sums[number];
        sum.resize(P * Q * (d + 1));
        const std::size_t end = (part + 1) * planes.rows() / kParts;
        for (std::size_t r = part * planes.rows() / kParts; r < end; ++r)
            for (std::size_t c = 0; c < planes.cols(); ++c) {
                const auto u = phase_at(map, displacement, r, c);
                const CellTaps taps(u[0], u[1], P, Q, first);
                for (std::size_t k = 0; k < 4; ++k) {
                    float* site = sum.data() + taps.sites[k] * (d + 1);
                    for (std::size_t plane = 0; plane < d; ++plane)
                        site[plane] += taps.weights[k] * planes(plane, r, c);
                    site[d] += taps.weights[k];
                }
            }
    });
    Image cells(d, P, Q);
    for (std::size_t plane = 0; plane < d; ++plane) {
        double total = 0;
        double pixels = 0;
        std::vector<double> weights(P * Q);
        std::vector<double> values(P * Q);
        for (const std::vector<float>& sum : sums)
            for (std::size_t i = 0; i < P * Q; ++i) {
                values[i] += static_cast<double>(sum[i * (d + 1) + plane]);
                weights[i] += static_cast<double>(sum[i * (d + 1) + d]);
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
