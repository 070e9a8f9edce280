// SPDX-License-Identifier: Apache-2.0
// The lattice of tiles by autocorrelation. See roller_lattice.hpp.
#include "analysis/roller_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "analysis/fourier.hpp"

namespace sateen {
namespace {

using Plane = BasicImage<double>;

// Overlaps between these parts of the sample.
constexpr std::size_t kNarrowest = 12;
constexpr std::size_t kWidest = 3;
// An oblique shift must agree so much better than one along an axis.
constexpr double kObliqueGain = 0.8;
// Of what unrelated pieces differ by: a sample that repeats so well is near-regular.
constexpr double kRegular = 0.35;
// Rows for each column that the sample may be sheared by to lay a period along the rows.
constexpr double kLargestDrop = 0.1;
// What is left over must do for a cut.
constexpr std::size_t kLeastOverlap = 4;

/// Mean squared difference between the sample and itself shifted.
class ShiftError {
  public:
    explicit ShiftError(const Plane& z)
        : rows_(z.rows()),
          cols_(z.cols()),
          squares_((rows_ + 1) * (cols_ + 1), 0),
          product_(fast_size(2 * rows_), fast_size(2 * cols_)) {
        for (std::size_t r = 0; r < rows_; ++r)
            for (std::size_t c = 0; c < cols_; ++c) {
                product_(r, c) = z(0, r, c);
                squares_[(r + 1) * (cols_ + 1) + c + 1] = z(0, r, c) * z(0, r, c) +
                                                          sum_to(r, c + 1) +
                                                          sum_to(r + 1, c) - sum_to(r, c);
            }
        forward(product_);
        for (auto& value : product_.values) value = std::norm(value);
        inverse(product_);
    }

    /// \param dr  |dr| < rows
    /// \param dc  |dc| < cols
    [[nodiscard]] double at(std::ptrdiff_t dr, std::ptrdiff_t dc) const {
        if (dr < 0) return at(-dr, -dc);
        const auto down = static_cast<std::size_t>(dr);
        const auto reach = static_cast<std::size_t>(std::abs(dc));
        const std::size_t height = rows_ - down;
        const std::size_t width = cols_ - reach;
        const std::size_t from = dc >= 0 ? 0 : reach;
        const std::size_t to = dc >= 0 ? reach : 0;
        const double squares =
            window(0, from, height, width) + window(down, to, height, width);
        const std::size_t column = dc >= 0 || reach == 0 ? reach : product_.cols - reach;
        return std::max(0.0, squares - 2 * product_(down, column).real()) /
               static_cast<double>(height * width);
    }

    /// What unrelated pieces differ by: twice the variance.
    [[nodiscard]] double unrelated() const {
        return 2 * sum_to(rows_, cols_) / static_cast<double>(rows_ * cols_);
    }

  private:
    /// Even, without prime factors beyond 5.
    static std::size_t fast_size(std::size_t n) {
        for (;; ++n) {
            std::size_t rest = n;
            for (const std::size_t p : {2U, 3U, 5U})
                while (rest % p == 0) rest /= p;
            if (rest == 1) return n;
        }
    }
    [[nodiscard]] double sum_to(std::size_t r, std::size_t c) const {
        return squares_[r * (cols_ + 1) + c];
    }
    [[nodiscard]] double window(std::size_t r, std::size_t c, std::size_t height,
                                std::size_t width) const {
        return sum_to(r + height, c + width) - sum_to(r, c + width) -
               sum_to(r + height, c) + sum_to(r, c);
    }

    std::size_t rows_;
    std::size_t cols_;
    std::vector<double> squares_;  ///< summed-area table
    Spectrum product_;
};

struct Shift {
    std::ptrdiff_t row = 0;
    std::ptrdiff_t col = 0;
    double error = std::numeric_limits<double>::infinity();
};

struct ShiftRange {
    std::ptrdiff_t first = 0;
    std::ptrdiff_t last = 0;
};

ShiftRange range_of(std::size_t side) {
    const std::size_t narrowest = std::max(kLeastOverlap, side / kNarrowest);
    return {static_cast<std::ptrdiff_t>(side - side / kWidest),
            static_cast<std::ptrdiff_t>(side - narrowest)};
}

Shift best_of(const ShiftError& error, ShiftRange rows, ShiftRange cols) {
    Shift best;
    for (std::ptrdiff_t r = rows.first; r <= rows.last; ++r)
        for (std::ptrdiff_t c = cols.first; c <= cols.last; ++c)
            if (const double e = error.at(r, c); e < best.error) best = {r, c, e};
    return best;
}

/// The better of a shift along an axis and an oblique one, which must be clearly so.
Shift better(const Shift& straight, const Shift& oblique) {
    return oblique.error < kObliqueGain * straight.error ? oblique : straight;
}

/// Where a parabola through the errors beside the least one has its minimum; what is whole but
/// for a tenth of a pixel is left whole.
std::array<double, 2> refined(const ShiftError& error, const Shift& shift) {
    const auto vertex = [&](double before, double after) {
        const double bend = before + after - 2 * shift.error;
        const double at = bend > 0 ? (before - after) / (2 * bend) : 0.0;
        return std::abs(at) < 0.1 ? 0.0 : std::clamp(at, -0.5, 0.5);
    };
    return {static_cast<double>(shift.row) + vertex(error.at(shift.row - 1, shift.col),
                                                    error.at(shift.row + 1, shift.col)),
            static_cast<double>(shift.col) + vertex(error.at(shift.row, shift.col - 1),
                                                    error.at(shift.row, shift.col + 1))};
}

std::size_t wrapped(std::ptrdiff_t shift, std::size_t n) {
    const auto period = static_cast<std::ptrdiff_t>(n);
    return static_cast<std::size_t>((shift % period + period) % period);
}

TileLattice whole(const Shift& down, const Shift& along) {
    const auto cols = static_cast<std::size_t>(along.col);
    return {static_cast<std::size_t>(down.row), cols, wrapped(down.col, cols)};
}

/// (rows, shear) and (0, cols) become `down` and `along`.
FoundLattice strained(const std::array<double, 2>& down,
                      const std::array<double, 2>& along) {
    const double rows = std::round(down[0]);
    const double cols = std::round(along[1]);
    const double shear = std::round(down[1]);
    FoundLattice out;
    out.tile = {
        static_cast<std::size_t>(rows), static_cast<std::size_t>(cols),
        wrapped(static_cast<std::ptrdiff_t>(shear), static_cast<std::size_t>(cols))};
    for (std::size_t i = 0; i < 2; ++i) {
        out.to_sample.col[i] = along[i] / cols;
        out.to_sample.row[i] = (down[i] - shear * out.to_sample.col[i]) / rows;
    }
    return out;
}

/// Keys' cubic convolution kernel for the four values around a point `t` beyond the second.
std::array<double, 4> cubic_weights(double t) {
    const double s = 1 - t;
    return {-0.5 * t * s * s, 1 + t * t * (1.5 * t - 2.5), 1 + s * s * (1.5 * s - 2.5),
            -0.5 * s * t * t};
}

struct Window {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::array<double, 2> first = {};  ///< in the sample
};

/// As large as all four corners stay where the kernel has values.
Window window_inside(const Plane& sample, const PixelMap& map) {
    Window out{sample.rows(), sample.cols()};
    for (; out.rows > 1 && out.cols > 1; --out.rows, --out.cols) {
        bool inside = true;
        const std::array<std::size_t, 2> sides = {sample.rows(), sample.cols()};
        for (std::size_t i = 0; i < 2; ++i) {
            const double across = map.row[i] * static_cast<double>(out.rows - 1);
            const double along = map.col[i] * static_cast<double>(out.cols - 1);
            const double low = std::min(0.0, across) + std::min(0.0, along);
            const double high = std::max(0.0, across) + std::max(0.0, along);
            const double room = static_cast<double>(sides[i] - 4) - (high - low);
            inside = inside && room >= 0;
            out.first[i] = 1 - low + room / 2;
        }
        if (inside) break;
    }
    return out;
}

}  // namespace

FoundLattice find_tile_lattice(const Plane& height) {
    const ShiftError error(height);
    const ShiftRange rows = range_of(height.rows());
    const ShiftRange cols = range_of(height.cols());
    const auto shear = static_cast<std::ptrdiff_t>(height.cols() / 4);
    const Shift down =
        better(best_of(error, rows, {0, 0}), best_of(error, rows, {-shear, shear}));
    const Shift straight = best_of(error, {0, 0}, cols);
    const FoundLattice unstrained{whole(down, straight), {}};

    const double regular = kRegular * error.unrelated();
    const auto drop =
        static_cast<std::ptrdiff_t>(kLargestDrop * static_cast<double>(cols.first));
    const Shift along = better(straight, best_of(error, {-drop, drop}, cols));
    if (down.error > regular || along.error > regular) return unstrained;
    FoundLattice out = strained(refined(error, down), refined(error, along));
    const Window left = window_inside(height, out.to_sample);
    const bool enough = left.rows >= out.tile.rows + kLeastOverlap &&
                        left.cols >= out.tile.cols + kLeastOverlap;
    return enough ? out : unstrained;
}

Plane straightened(const Plane& sample, const PixelMap& to_sample) {
    const Window window = window_inside(sample, to_sample);
    Plane out(1, window.rows, window.cols);
    for (std::size_t r = 0; r < window.rows; ++r)
        for (std::size_t c = 0; c < window.cols; ++c) {
            std::array<std::size_t, 2> before = {};
            std::array<std::array<double, 4>, 2> weights = {};
            for (std::size_t i = 0; i < 2; ++i) {
                const double at = window.first[i] +
                                  to_sample.row[i] * static_cast<double>(r) +
                                  to_sample.col[i] * static_cast<double>(c);
                // Rounding may leave the last point a hair beyond its pixel.
                const std::size_t last = i == 0 ? sample.rows() - 3 : sample.cols() - 3;
                before[i] = std::min(static_cast<std::size_t>(at), last);
                weights[i] = cubic_weights(at - static_cast<double>(before[i]));
            }
            double sum = 0;
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t j = 0; j < 4; ++j)
                    sum += weights[0][i] * weights[1][j] *
                           sample(0, before[0] + i - 1, before[1] + j - 1);
            out(0, r, c) = sum;
        }
    return out;
}

}  // namespace sateen
