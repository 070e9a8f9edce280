// SPDX-License-Identifier: Apache-2.0
// Finding and bending the lattice of a texture. See periodic_layer.hpp.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/fold.hpp"
#include "analysis/periodic_layer.hpp"
#include "analysis/smooth_field.hpp"
#include "analysis/smooth_part.hpp"

namespace sateen {
namespace {

/// Slow changes of brightness wider than this many cells do not count.
constexpr double kSlow = 1.5;
constexpr int kIterations = 18;
constexpr int kWideIterations = 6;
/// Windows: in cells at first, then shrinking by kShrink to kFloor cells, but not below
/// kSmallestWindow pixels, where displacements begin to follow the noise.
constexpr double kFirstWindow = 0.45;
constexpr double kFloor = 0.08;
constexpr double kShrink = 0.75;
constexpr double kSmallestWindow = 5;
/// Cells smaller than this gain nothing from finer windows.
constexpr double kFineCell = 20;
constexpr double kDamping = 0.25;
/// A step is no longer than this share of the cell.
constexpr double kLongestStep = 0.15;
/// Sites of the displacement in the material, in cells.
constexpr double kSpacing = 0.35;
constexpr std::size_t kSmallestCell = 6;
constexpr std::size_t kLargestCell = 80;

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

/// Central differences of a periodic cell along u and v, per unit of phase.
struct CellGradient {
    Image u;
    Image v;
    explicit CellGradient(const Image& cells)
        : u(cells.bands(), cells.rows(), cells.cols()),
          v(cells.bands(), cells.rows(), cells.cols()) {
        const std::size_t P = cells.rows();
        const std::size_t Q = cells.cols();
        for (std::size_t plane = 0; plane < cells.bands(); ++plane)
            for (std::size_t r = 0; r < P; ++r)
                for (std::size_t c = 0; c < Q; ++c) {
                    u(plane, r, c) =
                        static_cast<float>(P) / 2 *
                        (cells(plane, (r + 1) % P, c) - cells(plane, (r + P - 1) % P, c));
                    v(plane, r, c) =
                        static_cast<float>(Q) / 2 *
                        (cells(plane, r, (c + 1) % Q) - cells(plane, r, (c + Q - 1) % Q));
                }
    }
};

class Alignment {
  public:
    Alignment(const Image& planes, const Lattice& lattice, Executor& executor)
        : executor_(executor),
          a_(lattice.a),
          b_(lattice.b),
          cell_(std::sqrt(std::abs(lattice.area()))),
          shortest_(std::hypot(lattice.a[0], lattice.a[1])),
          P_(side_of(lattice.a)),
          Q_(side_of(lattice.b)),
          Y_(planes.bands(), planes.rows(), planes.cols()),
          D_(2, planes.rows(), planes.cols()) {
        const double slow =
            kSlow * std::max(std::hypot(a_[0], a_[1]), std::hypot(b_[0], b_[1]));
        for (std::size_t plane = 0; plane < planes.bands(); ++plane)
            subtract_smooth_part(planes.plane(plane), slow, Y_.plane(plane), executor);
    }

    void run() {
        const double floor = std::max(kSmallestWindow, kFloor * cell_);
        double window = std::max(kSmallestWindow, kFirstWindow * cell_);
        for (int i = 0; i < kIterations; ++i) {
            if (i >= kWideIterations && cell_ >= kFineCell)
                window = std::max(floor, window * kShrink);
            step(window);
            straighten();
        }
    }

    AlignedLayer result(double periodicity) && {
        AlignedLayer aligned;
        PeriodicLayer& layer = aligned.layer;
        layer.a = {static_cast<float>(a_[0]), static_cast<float>(a_[1])};
        layer.b = {static_cast<float>(b_[0]), static_cast<float>(b_[1])};
        layer.rows = static_cast<std::uint16_t>(P_);
        layer.cols = static_cast<std::uint16_t>(Q_);
        const double octave = std::floor(std::log2(std::max(1.0, kSpacing * cell_)));
        layer.spacing = static_cast<std::uint16_t>(
            std::min(std::exp2(octave), double{PeriodicLayer::kMaxSpacing}));
        for (std::size_t axis = 0; axis < 2; ++axis)
            layer.displacement[axis] = fit_smooth_field(
                sampled(D_.plane(axis), layer.spacing).plane(0), executor_);
        aligned.displacement = std::move(D_);
        aligned.periodicity = periodicity;
        return aligned;
    }

  private:
    static std::size_t side_of(const std::array<double, 2>& vector) {
        const auto length =
            static_cast<std::size_t>(std::lround(std::hypot(vector[0], vector[1])));
        return std::clamp(length, kSmallestCell, kLargestCell);
    }

    static Image sampled(PlaneView<const float> plane, std::size_t spacing) {
        Image result(1, (plane.rows + spacing - 1) / spacing,
                     (plane.cols + spacing - 1) / spacing);
        for (std::size_t r = 0; r < result.rows(); ++r)
            for (std::size_t c = 0; c < result.cols(); ++c)
                result(0, r, c) = plane(r * spacing, c * spacing);
        return result;
    }

    /// One step of Lucas and Kanade. Sums are kept on a grid half as coarse as the window.
    void step(double window) {
        const auto grid =
            std::max<std::size_t>(1, static_cast<std::size_t>(window / 2.5));
        const std::size_t rows = (D_.rows() + grid - 1) / grid;
        const std::size_t cols = (D_.cols() + grid - 1) / grid;
        Image sums = gradient_sums(grid, rows, cols);
        parallel_for(executor_, kSums, [&](std::size_t k) {
            blur(sums.plane(k), window / static_cast<double>(grid));
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
            const double longest = kLongestStep * shortest_;
            if (length > longest) {
                row *= longest / length;
                col *= longest / length;
            }
            delta.plane(0).data[i] = static_cast<float>(row);
            delta.plane(1).data[i] = static_cast<float>(col);
        }
        add_expanded(delta, grid);
    }

    /// Of Σ g gᵀ: rows, columns, mixed; of Σ g r: rows, columns; over the blocks of a grid.
    Image gradient_sums(std::size_t grid, std::size_t rows, std::size_t cols) const {
        const LatticeMap map(a_, b_);
        const Image cells = fold(Y_, map, D_, P_, Q_, executor_);
        const CellGradient gradient(cells);
        const auto down = map.to_cell(1, 0);
        const auto across = map.to_cell(0, 1);
        const std::array<float, 4> chain = {
            static_cast<float>(down[0]), static_cast<float>(down[1]),
            static_cast<float>(across[0]), static_cast<float>(across[1])};
        Image sums(kSums, rows, cols);
        parallel_for(executor_, rows, [&](std::size_t block_row) {
            const std::size_t end = std::min((block_row + 1) * grid, D_.rows());
            for (std::size_t r = block_row * grid; r < end; ++r)
                for (std::size_t c = 0; c < D_.cols(); ++c) {
                    const auto u = phase_at(map, D_, r, c);
                    const CellTaps taps(u[0], u[1], P_, Q_);
                    for (std::size_t plane = 0; plane < Y_.bands(); ++plane) {
                        const float rest =
                            Y_(plane, r, c) - taps.read(cells.plane(plane).data);
                        const float gu = taps.read(gradient.u.plane(plane).data);
                        const float gv = taps.read(gradient.v.plane(plane).data);
                        const float row = gu * chain[0] + gv * chain[1];
                        const float col = gu * chain[2] + gv * chain[3];
                        const std::array<float, kSums> add = {
                            row * row, col * col, row * col, row * rest, col * rest};
                        for (std::size_t k = 0; k < kSums; ++k)
                            sums(k, block_row, c / grid) += add[k];
                    }
                }
        });
        return sums;
    }

    /// D += δ, linear between the middles of the blocks.
    void add_expanded(const Image& delta, std::size_t grid) {
        const auto place = [grid](std::size_t pixel, std::size_t n) {
            const double x =
                (static_cast<double>(pixel) + 0.5) / static_cast<double>(grid) - 0.5;
            const double inside = std::clamp(x, 0.0, static_cast<double>(n - 1));
            const auto low = static_cast<std::size_t>(inside);
            return std::pair(low, static_cast<float>(inside - static_cast<double>(low)));
        };
        parallel_for(executor_, D_.rows(), [&](std::size_t r) {
            const auto row = place(r, delta.rows());
            const std::size_t below = std::min(row.first + 1, delta.rows() - 1);
            for (std::size_t c = 0; c < D_.cols(); ++c) {
                const auto col = place(c, delta.cols());
                const std::size_t right = std::min(col.first + 1, delta.cols() - 1);
                for (std::size_t axis = 0; axis < 2; ++axis) {
                    const PlaneView<const float> d = delta.plane(axis);
                    const float top =
                        d(row.first, col.first) +
                        col.second * (d(row.first, right) - d(row.first, col.first));
                    const float bottom =
                        d(below, col.first) +
                        col.second * (d(below, right) - d(below, col.first));
                    D_(axis, r, c) += top + row.second * (bottom - top);
                }
            }
        });
    }

    /// What of D is affine goes into the basis:
    ///
    ///     x + D = (I + A) x + t + D',   B ← (I + A)⁻¹ B,   D ← (I + A)⁻¹ (D' + t)
    ///
    /// and t, a shift of the cell, is dropped.
    void straighten() {
        const auto middle_row = static_cast<double>(D_.rows() - 1) / 2;
        const auto middle_col = static_cast<double>(D_.cols() - 1) / 2;
        std::array<std::array<double, 3>, 2>
            fit{};  // of each axis: along rows, cols, constant
        const auto n = static_cast<double>(D_.plane_size());
        const double row_power =
            (static_cast<double>(D_.rows()) * static_cast<double>(D_.rows()) - 1) / 12 *
            n;
        const double col_power =
            (static_cast<double>(D_.cols()) * static_cast<double>(D_.cols()) - 1) / 12 *
            n;
        for (std::size_t axis = 0; axis < 2; ++axis)
            for (std::size_t r = 0; r < D_.rows(); ++r)
                for (std::size_t c = 0; c < D_.cols(); ++c) {
                    const auto d = static_cast<double>(D_(axis, r, c));
                    fit[axis][0] += d * (static_cast<double>(r) - middle_row) / row_power;
                    fit[axis][1] += d * (static_cast<double>(c) - middle_col) / col_power;
                    fit[axis][2] += d / n;
                }
        const double m00 = 1 + fit[0][0];
        const double m01 = fit[0][1];
        const double m10 = fit[1][0];
        const double m11 = 1 + fit[1][1];
        const double det = m00 * m11 - m01 * m10;
        if (!(std::abs(det) > 0.5)) return;
        const auto solve = [&](double row, double col) {
            return std::array<double, 2>{(m11 * row - m01 * col) / det,
                                         (m00 * col - m10 * row) / det};
        };
        parallel_for(executor_, D_.rows(), [&](std::size_t r) {
            for (std::size_t c = 0; c < D_.cols(); ++c) {
                const double row = static_cast<double>(r) - middle_row;
                const double col = static_cast<double>(c) - middle_col;
                std::array<double, 2> rest{};
                for (std::size_t axis = 0; axis < 2; ++axis)
                    rest[axis] = static_cast<double>(D_(axis, r, c)) -
                                 fit[axis][0] * row - fit[axis][1] * col - fit[axis][2];
                const auto d = solve(rest[0], rest[1]);
                D_(0, r, c) = static_cast<float>(d[0]);
                D_(1, r, c) = static_cast<float>(d[1]);
            }
        });
        a_ = solve(a_[0], a_[1]);
        b_ = solve(b_[0], b_[1]);
    }

    Executor& executor_;
    std::array<double, 2> a_;
    std::array<double, 2> b_;
    double cell_;      ///< side of a square as large as the cell
    double shortest_;  ///< |a|
    std::size_t P_;
    std::size_t Q_;
    Image Y_;  ///< the planes without their slow changes
    Image D_;
};

}  // namespace

Result<std::optional<AlignedLayer>> align_layer(const Image& planes, Executor& executor) {
    SATEEN_TRY(const std::optional<Lattice> lattice,
               find_lattice(planes.plane(0), executor));
    if (!lattice) return std::optional<AlignedLayer>();
    Alignment alignment(planes, *lattice, executor);
    alignment.run();
    return std::optional<AlignedLayer>(std::move(alignment).result(lattice->periodicity));
}

}  // namespace sateen
