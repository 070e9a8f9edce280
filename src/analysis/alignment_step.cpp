// SPDX-License-Identifier: Apache-2.0
// One step of Lucas and Kanade towards the mean cell. See alignment_step.hpp.
#include "analysis/alignment_step.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/fold.hpp"

namespace sateen {
namespace {

constexpr double kDamping = 0.25;
/// Windows are so many steps of the grid of the sums wide.
constexpr double kGridOfWindow = 2.5;
/// Wide windows need not every pixel: at least so many a deviation.
constexpr double kPixelsOfWindow = 10;
/// And so many for each site of the cell.
constexpr std::size_t kPixelsOfSite = 16;
/// The accumulated sums of one window: Σ g gᵀ and Σ g r.
constexpr std::size_t kSums = 5;

/// Blurs a plane by a Gaussian, with the border repeated; small deviations.
void blur(PlaneView<float> plane, double sigma) {
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3 * sigma));
    std::vector<float> kernel;
    float sum = 0;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
        const double x = static_cast<double>(k) / sigma;
        kernel.push_back(static_cast<float>(std::exp(-x * x / 2)));
        sum += kernel.back();
    }
    for (float& weight : kernel) weight /= sum;
    const auto filtered = [&](std::size_t n, const auto& value, const auto& put) {
        std::vector<float> line(n + 2 * static_cast<std::size_t>(reach));
        for (std::size_t i = 0; i < line.size(); ++i) {
            const auto at = static_cast<std::ptrdiff_t>(i) - reach;
            line[i] = value(static_cast<std::size_t>(
                std::clamp<std::ptrdiff_t>(at, 0, static_cast<std::ptrdiff_t>(n) - 1)));
        }
        for (std::size_t i = 0; i < n; ++i) {
            float total = 0;
            for (std::size_t k = 0; k < kernel.size(); ++k)
                total += kernel[k] * line[i + k];
            put(i, total);
        }
    };
    for (std::size_t r = 0; r < plane.rows; ++r)
        filtered(
            plane.cols, [&](std::size_t c) { return plane(r, c); },
            [&](std::size_t c, float v) { plane(r, c) = v; });
    for (std::size_t c = 0; c < plane.cols; ++c)
        filtered(
            plane.rows, [&](std::size_t r) { return plane(r, c); },
            [&](std::size_t r, float v) { plane(r, c) = v; });
}

/// The cell of every plane with its derivatives along rows and columns, per pixel, by central
/// differences; all of a site together, in vectors of the machine.
class CellWithGradient {
  public:
    static constexpr std::size_t kLanes = 4;
    using Lanes = std::array<float, kLanes>;
    /// m, then its derivatives, of all planes; 0 beyond them.
    using Site = std::array<Lanes, 3>;

    CellWithGradient(const Image& cells, const LatticeMap& map) {
        const std::size_t P = cells.rows();
        const std::size_t Q = cells.cols();
        assert(cells.bands() <= kLanes);
        const auto down = map.to_cell(1, 0);
        const auto across = map.to_cell(0, 1);
        sites_.resize(P * Q);
        for (std::size_t plane = 0; plane < cells.bands(); ++plane)
            for (std::size_t r = 0; r < P; ++r)
                for (std::size_t c = 0; c < Q; ++c) {
                    const float gu =
                        static_cast<float>(P) / 2 *
                        (cells(plane, (r + 1) % P, c) - cells(plane, (r + P - 1) % P, c));
                    const float gv =
                        static_cast<float>(Q) / 2 *
                        (cells(plane, r, (c + 1) % Q) - cells(plane, r, (c + Q - 1) % Q));
                    Site& site = sites_[r * Q + c];
                    site[0][plane] = cells(plane, r, c);
                    site[1][plane] = gu * static_cast<float>(down[0]) +
                                     gv * static_cast<float>(down[1]);
                    site[2][plane] = gu * static_cast<float>(across[0]) +
                                     gv * static_cast<float>(across[1]);
                }
    }

    [[nodiscard]] Site read(const CellTaps& taps) const {
        Site sum{};
        for (std::size_t k = 0; k < 4; ++k) {
            const Site& site = sites_[taps.sites[k]];
            for (std::size_t i = 0; i < sum.size(); ++i)
                for (std::size_t lane = 0; lane < kLanes; ++lane)
                    sum[i][lane] += taps.weights[k] * site[i][lane];
        }
        return sum;
    }

  private:
    std::vector<Site> sites_;
};

/// Of Σ g gᵀ: rows, columns, mixed; of Σ g r: rows, columns; over the blocks of a grid.
Image gradient_sums(const Image& Y, const LatticeMap& map, const AlignmentStep& step,
                    const Image& D, std::size_t grid, Executor& executor) {
    const auto stride =
        std::max<std::size_t>(1, static_cast<std::size_t>(step.window / kPixelsOfWindow));
    const auto dense = static_cast<std::size_t>(
        std::sqrt(static_cast<double>(D.plane_size()) /
                  static_cast<double>(step.rows * step.cols * kPixelsOfSite)));
    const CellWithGradient cells(
        fold({&Y, 1}, map, {&D, 1}, step.rows, step.cols, executor, 0,
             std::clamp<std::size_t>(dense, 1, stride)),
        map);
    Image sums(kSums, (D.rows() + grid - 1) / grid, (D.cols() + grid - 1) / grid);
    parallel_for(executor, sums.rows(), [&](std::size_t block_row) {
        const std::size_t end = std::min((block_row + 1) * grid, D.rows());
        for (std::size_t r = block_row * grid; r < end; r += stride)
            for (std::size_t c = 0; c < D.cols(); c += stride) {
                const auto u = phase_at(map, D, r, c);
                const CellTaps taps(u[0], u[1], step.rows, step.cols);
                const auto [mean, down, across] = cells.read(taps);
                std::array<float, kSums> add{};
                for (std::size_t plane = 0; plane < Y.bands(); ++plane) {
                    const float rest = Y(plane, r, c) - mean[plane];
                    add[0] += down[plane] * down[plane];
                    add[1] += across[plane] * across[plane];
                    add[2] += down[plane] * across[plane];
                    add[3] += down[plane] * rest;
                    add[4] += across[plane] * rest;
                }
                for (std::size_t k = 0; k < kSums; ++k)
                    sums(k, block_row, c / grid) += add[k];
            }
    });
    return sums;
}

/// D += δ, linear between the middles of the blocks.
void add_expanded(const Image& delta, std::size_t grid, Image& D, Executor& executor) {
    const auto place = [grid](std::size_t pixel, std::size_t n) {
        const double x =
            (static_cast<double>(pixel) + 0.5) / static_cast<double>(grid) - 0.5;
        const double inside = std::clamp(x, 0.0, static_cast<double>(n - 1));
        const auto low = static_cast<std::size_t>(inside);
        return std::pair(low, static_cast<float>(inside - static_cast<double>(low)));
    };
    parallel_for(executor, D.rows(), [&](std::size_t r) {
        const auto row = place(r, delta.rows());
        const std::size_t below = std::min(row.first + 1, delta.rows() - 1);
        for (std::size_t c = 0; c < D.cols(); ++c) {
            const auto col = place(c, delta.cols());
            const std::size_t right = std::min(col.first + 1, delta.cols() - 1);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                const PlaneView<const float> d = delta.plane(axis);
                const float top =
                    d(row.first, col.first) +
                    col.second * (d(row.first, right) - d(row.first, col.first));
                const float bottom = d(below, col.first) +
                                     col.second * (d(below, right) - d(below, col.first));
                D(axis, r, c) += top + row.second * (bottom - top);
            }
        }
    });
}

}  // namespace

void move_towards_cells(const Image& Y, const LatticeMap& map, const AlignmentStep& step,
                        Image& displacement, Executor& executor) {
    const auto grid =
        std::max<std::size_t>(1, static_cast<std::size_t>(step.window / kGridOfWindow));
    Image sums = gradient_sums(Y, map, step, displacement, grid, executor);
    const std::size_t rows = sums.rows();
    const std::size_t cols = sums.cols();
    parallel_for(executor, kSums, [&](std::size_t k) {
        blur(sums.plane(k), step.window / static_cast<double>(grid));
    });
    double mean = 0;
    for (std::size_t i = 0; i < rows * cols; ++i)
        mean += static_cast<double>(sums.plane(0).data[i] + sums.plane(1).data[i]) /
                static_cast<double>(2 * rows * cols);
    if (!(mean > 0)) return;
    Image delta(2, rows, cols);
    for (std::size_t i = 0; i < rows * cols; ++i) {
        const auto sum = [&](std::size_t k) {
            return static_cast<double>(sums.plane(k).data[i]);
        };
        const double g00 = sum(0) + kDamping * mean;
        const double g11 = sum(1) + kDamping * mean;
        const double det = g00 * g11 - sum(2) * sum(2);
        double row = (g11 * sum(3) - sum(2) * sum(4)) / det;
        double col = (g00 * sum(4) - sum(2) * sum(3)) / det;
        const double length = std::hypot(row, col);
        if (length > step.longest) {
            row *= step.longest / length;
            col *= step.longest / length;
        }
        delta.plane(0).data[i] = static_cast<float>(row);
        delta.plane(1).data[i] = static_cast<float>(col);
    }
    add_expanded(delta, grid, displacement, executor);
}

}  // namespace sateen
