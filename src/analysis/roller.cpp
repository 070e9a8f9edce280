// SPDX-License-Identifier: Apache-2.0
// The Roller. See roller.hpp.
#include "sateen/analysis/roller.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>

#include "analysis/fourier.hpp"
#include "analysis/roller_cut.hpp"
#include "sateen/analysis/integrate.hpp"
#include "sateen/material/surface.hpp"

namespace sateen {
namespace {

using Plane = BasicImage<double>;

constexpr std::size_t kSmallestSide = 16;
// Overlaps between these parts of the sample.
constexpr std::size_t kNarrowest = 12;
constexpr std::size_t kWidest = 3;
// A shifted row of tiles must agree so much better than an unshifted one.
constexpr double kShearGain = 0.8;
// Steps across the borders of a torus are those of the inside, but for chance.
constexpr double kToroidalStep = 1.6;
// Pixels along the border that are equal in all tiles: slopes across it are, too.
constexpr std::size_t kEqualBorder = 2;

struct Lattice {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::size_t shear = 0;

    /// Number of the site (r, c) of the plane in a tile.
    [[nodiscard]] std::size_t site(std::size_t r, std::size_t c) const {
        const std::size_t turns = r / rows;
        const std::size_t shifted = c + (cols - shear) % cols * turns;
        return r % rows * cols + shifted % cols;
    }
    [[nodiscard]] std::size_t above(std::size_t r, std::size_t c) const {
        return r > 0 ? site(r - 1, c) : (rows - 1) * cols + (c + shear) % cols;
    }
};

/// Height and its forward differences: what is compared, with weights of 1 / variance, and
/// what is cut. The differences are cut as they are, so that the height which they are
/// integrated to continues across every cut.
struct Stack {
    Plane z;
    SlopeField slopes;
    double z_weight = 0;
    double slope_weight = 0;

    [[nodiscard]] double error(std::size_t a, std::size_t b) const {
        const double dz = z.values()[a] - z.values()[b];
        const double dp = slopes.plane(0).data[a] - slopes.plane(0).data[b];
        const double dq = slopes.plane(1).data[a] - slopes.plane(1).data[b];
        return z_weight * dz * dz + slope_weight * (dp * dp + dq * dq);
    }
};

double mean_square(std::span<const double> values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return sum / static_cast<double>(std::max<std::size_t>(1, values.size()));
}

void set_weights(Stack& stack) {
    constexpr double kFlat = 1e-12;
    // Heights that differ by something smooth are joined without a seam: slopes count.
    constexpr double kHeight = 0.05;
    stack.z_weight = kHeight / (mean_square(stack.z.values()) + kFlat);
    stack.slope_weight = 1 / (mean_square(stack.slopes.values()) + kFlat);
}

/// Of (rows + 1, cols + 1) heights: forward differences, along y from the row above.
Stack open_stack(const Plane& height) {
    Stack out{Plane(1, height.rows() - 1, height.cols() - 1),
              SlopeField(2, height.rows() - 1, height.cols() - 1)};
    for (std::size_t r = 0; r + 1 < height.rows(); ++r)
        for (std::size_t c = 0; c + 1 < height.cols(); ++c) {
            const double here = height(0, r + 1, c);
            out.z(0, r, c) = here;
            out.slopes(0, r, c) = height(0, r + 1, c + 1) - here;
            out.slopes(1, r, c) = height(0, r, c) - here;
        }
    set_weights(out);
    return out;
}

Plane centre(const Plane& height, std::size_t largest) {
    const std::size_t rows = std::min(height.rows(), largest);
    const std::size_t cols = std::min(height.cols(), largest);
    Plane out(1, rows, cols);
    const std::size_t top = (height.rows() - rows) / 2;
    const std::size_t left = (height.cols() - cols) / 2;
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c)
            out(0, r, c) = height(0, top + r, left + c);
    return out;
}

/// Mean squared difference between the sample and itself shifted, for all shifts, by
/// correlation: Σ (a - b)² = Σ a² + Σ b² - 2 Σ a b over what overlaps.
class ShiftError {
  public:
    explicit ShiftError(const Plane& z)
        : rows_(z.rows()),
          cols_(z.cols()),
          squares_((rows_ + 1) * (cols_ + 1), 0),
          product_(2 * rows_, 2 * cols_) {
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

    /// \param dr  0 … rows - 1
    /// \param dc  |dc| < cols
    [[nodiscard]] double at(std::size_t dr, std::ptrdiff_t dc) const {
        const auto reach = static_cast<std::size_t>(std::abs(dc));
        const std::size_t height = rows_ - dr;
        const std::size_t width = cols_ - reach;
        const std::size_t from = dc >= 0 ? 0 : reach;
        const std::size_t to = dc >= 0 ? reach : 0;
        const double squares =
            window(0, from, height, width) + window(dr, to, height, width);
        const std::size_t column = dc >= 0 ? reach : 2 * cols_ - reach;
        const double product = product_(dr, column % (2 * cols_)).real();
        return std::max(0.0, squares - 2 * product) / static_cast<double>(height * width);
    }

  private:
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

/// The shifts of the lattice under which the sample agrees best with itself.
Lattice find_lattice(const Plane& z) {
    const ShiftError error(z);
    const auto range = [](std::size_t side) {
        const std::size_t narrowest = std::max<std::size_t>(4, side / kNarrowest);
        return std::pair{side - side / kWidest, side - narrowest};
    };
    Lattice best;
    double least = std::numeric_limits<double>::infinity();
    const auto [first_col, last_col] = range(z.cols());
    for (std::size_t dc = first_col; dc <= last_col; ++dc) {
        const double e = error.at(0, static_cast<std::ptrdiff_t>(dc));
        if (e >= least) continue;
        least = e;
        best.cols = dc;
    }
    const auto [first_row, last_row] = range(z.rows());
    double straight = std::numeric_limits<double>::infinity();
    double sheared = straight;
    std::size_t straight_rows = first_row;
    std::size_t sheared_rows = first_row;
    std::ptrdiff_t shift = 0;
    const auto widest = static_cast<std::ptrdiff_t>(z.cols() / 4);
    for (std::size_t dr = first_row; dr <= last_row; ++dr)
        for (std::ptrdiff_t dc = -widest; dc <= widest; ++dc) {
            const double e = error.at(dr, dc);
            if (dc == 0 && e < straight) {
                straight = e;
                straight_rows = dr;
            }
            if (e < sheared) {
                sheared = e;
                sheared_rows = dr;
                shift = dc;
            }
        }
    const bool shear = sheared < kShearGain * straight;
    best.rows = shear ? sheared_rows : straight_rows;
    const auto cols = static_cast<std::ptrdiff_t>(best.cols);
    if (shear) best.shear = static_cast<std::size_t>((shift % cols + cols) % cols);
    return best;
}

/// What a pixel of the tile shows: its site in the sample, after both cuts.
std::vector<std::size_t> cut_tile(const Stack& sample, const Lattice& lattice) {
    const std::size_t rows = sample.z.rows();
    const std::size_t cols = sample.z.cols();
    // Down the overlap of columns: every row becomes a torus of its own.
    const std::size_t wide = cols - lattice.cols;
    Plane down(1, rows, wide);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < wide; ++c)
            down(0, r, c) = sample.error(r * cols + c, r * cols + c + lattice.cols);
    const std::vector<std::size_t> cut = minimum_error_path(down, false);
    const auto strip = [&](std::size_t r, std::size_t c) {
        c %= lattice.cols;
        return r * cols + (c < cut[r] ? c + lattice.cols : c);
    };
    // Along the overlap of rows, on that torus: closed.
    const std::size_t high = rows - lattice.rows;
    Plane along(1, lattice.cols, high);
    for (std::size_t c = 0; c < lattice.cols; ++c)
        for (std::size_t r = 0; r < high; ++r)
            along(0, c, r) =
                sample.error(strip(r, c), strip(r + lattice.rows, c + lattice.shear));
    const std::vector<std::size_t> closed = minimum_error_path(along, true);
    std::vector<std::size_t> sites(lattice.rows * lattice.cols);
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c)
            sites[r * lattice.cols + c] =
                r < closed[c] ? strip(r + lattice.rows, c + lattice.shear) : strip(r, c);
    return sites;
}

/// Root mean square step of height across seams, against that which the pieces on both
/// sides have there by themselves.
class SeamRatio {
  public:
    void add(double step, double natural_before, double natural_after) {
        seam_ += step * step;
        natural_ += (natural_before * natural_before + natural_after * natural_after) / 2;
    }
    [[nodiscard]] double value() const {
        return natural_ > 0 ? std::sqrt(seam_ / natural_) : 1;
    }

  private:
    double seam_ = 0;
    double natural_ = 0;
};

/// Of a tile that was cut from sites of a sample.
void add_seams(const Plane& tile, const Lattice& lattice, const Stack& sample,
               std::span<const std::size_t> sites, SeamRatio& ratio) {
    const std::size_t cols = sample.z.cols();
    const std::span<const double> z = sample.z.values();
    const auto consider = [&](std::size_t here, std::size_t next, std::size_t step) {
        const std::size_t a = sites[here];
        const std::size_t b = sites[next];
        if (b == a + step || a + step >= z.size() || b < step) return;
        ratio.add(tile.values()[next] - tile.values()[here], z[a + step] - z[a],
                  z[b] - z[b - step]);
    };
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c) {
            consider(lattice.site(r, c), lattice.site(r, c + 1), 1);
            consider(lattice.site(r, c), lattice.site(r + 1, c), cols);
        }
}

/// Further tiles, from one that is a torus.
class Interchange {
  public:
    Interchange(const Plane& tile, const Lattice& lattice)
        : tile_(tile),
          lattice_(lattice),
          band_(std::max<std::size_t>(2, std::min(lattice.rows, lattice.cols) / 6)),
          stack_{tile, SlopeField(2, lattice.rows, lattice.cols)} {
        for (std::size_t r = 0; r < lattice.rows; ++r)
            for (std::size_t c = 0; c < lattice.cols; ++c) {
                const double here = tile(0, r, c);
                stack_.slopes(0, r, c) = tile.values()[lattice.site(r, c + 1)] - here;
                stack_.slopes(1, r, c) = tile.values()[lattice.above(r, c)] - here;
            }
        set_weights(stack_);
    }

    /// The tile again, its inside replaced by the torus shifted to where it fits best.
    Plane another(SeamRatio& ratio) {
        const Shift shift = best_shift();
        taken_.push_back(shift);
        Plane error(1, lattice_.rows, lattice_.cols);
        for (std::size_t r = 0; r < lattice_.rows; ++r)
            for (std::size_t c = 0; c < lattice_.cols; ++c)
                error(0, r, c) = stack_.error(lattice_.site(r, c), shifted(r, c, shift));
        const std::vector<std::uint8_t> inside = minimum_error_inside(error, band_);
        SlopeField slopes(2, lattice_.rows, lattice_.cols);
        for (std::size_t r = 0; r < lattice_.rows; ++r)
            for (std::size_t c = 0; c < lattice_.cols; ++c) {
                const double share = share_of(inside, r, c);
                for (std::size_t band = 0; band < 2; ++band) {
                    const double* slope = stack_.slopes.plane(band).data;
                    slopes(band, r, c) = share * slope[shifted(r, c, shift)] +
                                         (1 - share) * slope[lattice_.site(r, c)];
                }
            }
        Plane out =
            integrate(slopes, Difference::forward, Periodicity::torus, lattice_.shear);
        equalise_border(out);
        const auto consider = [&](std::size_t r, std::size_t c, std::size_t down,
                                  std::size_t right) {
            const std::size_t a = lattice_.site(r, c);
            const std::size_t b = lattice_.site(r + down, c + right);
            if (inside[a] == inside[b]) return;
            const auto z = tile_.values();
            ratio.add(out.values()[b] - out.values()[a], z[b] - z[a],
                      z[shifted(r + down, c + right, shift)] - z[shifted(r, c, shift)]);
        };
        for (std::size_t r = 0; r < lattice_.rows; ++r)
            for (std::size_t c = 0; c < lattice_.cols; ++c) {
                consider(r, c, 0, 1);
                consider(r, c, 1, 0);
            }
        return out;
    }

  private:
    struct Shift {
        std::size_t row = 0;
        std::size_t col = 0;
    };

    [[nodiscard]] std::size_t shifted(std::size_t r, std::size_t c, Shift shift) const {
        return lattice_.site(r + shift.row, c + shift.col);
    }

    /// Of a pixel and its four neighbours, how many are inside: slopes change over from one
    /// to the other within two pixels.
    [[nodiscard]] double share_of(const std::vector<std::uint8_t>& inside, std::size_t r,
                                  std::size_t c) const {
        const int count = inside[lattice_.site(r, c)] + inside[lattice_.site(r, c + 1)] +
                          inside[lattice_.site(r + 1, c)] + inside[lattice_.above(r, c)] +
                          inside[lattice_.site(r, c + lattice_.cols - 1)];
        return count / 5.0;
    }

    [[nodiscard]] static std::size_t around(std::size_t a, std::size_t b, std::size_t n) {
        const std::size_t distance = a > b ? a - b : b - a;
        return std::min(distance, n - std::min(distance, n));
    }

    [[nodiscard]] bool is_new(Shift shift) const {
        const std::size_t near = std::min(lattice_.rows, lattice_.cols) / 6;
        const auto is_near = [&](Shift other) {
            return around(shift.row, other.row, lattice_.rows) < near &&
                   around(shift.col, other.col, lattice_.cols) < near;
        };
        return !is_near({0, 0}) && std::none_of(taken_.begin(), taken_.end(), is_near);
    }

    [[nodiscard]] double band_error(Shift shift) const {
        double sum = 0;
        const std::size_t step = 1 + lattice_.rows * lattice_.cols / 40000;
        const auto add = [&](std::size_t r, std::size_t c) {
            sum += stack_.error(lattice_.site(r, c), shifted(r, c, shift));
        };
        for (std::size_t depth = 0; depth < band_; depth += 2) {
            for (std::size_t c = 0; c < lattice_.cols; c += step) {
                add(depth, c);
                add(lattice_.rows - 1 - depth, c);
            }
            for (std::size_t r = 0; r < lattice_.rows; r += step) {
                add(r, depth);
                add(r, lattice_.cols - 1 - depth);
            }
        }
        return sum;
    }

    /// On a coarse grid, then around its best.
    [[nodiscard]] Shift best_shift() const {
        Shift best{lattice_.rows / 2, lattice_.cols / 2};
        double least = std::numeric_limits<double>::infinity();
        const auto consider = [&](Shift shift) {
            if (!is_new(shift)) return;
            const double e = band_error(shift);
            if (e >= least) return;
            least = e;
            best = shift;
        };
        const std::size_t step = 1 + std::max(lattice_.rows, lattice_.cols) / 48;
        for (std::size_t row = 0; row < lattice_.rows; row += step)
            for (std::size_t col = 0; col < lattice_.cols; col += step)
                consider({row, col});
        const Shift coarse = best;
        for (std::size_t row = 0; row < 2 * step; ++row)
            for (std::size_t col = 0; col < 2 * step; ++col)
                consider({(coarse.row + row + lattice_.rows - step) % lattice_.rows,
                          (coarse.col + col + lattice_.cols - step) % lattice_.cols});
        return best;
    }

    /// Adds the smoothest surface that takes the border to that of the first tile, from
    /// which it hardly differs: Laplace's equation, by successive over-relaxation.
    void equalise_border(Plane& out) const {
        const std::size_t rows = lattice_.rows;
        const std::size_t cols = lattice_.cols;
        const auto is_border = [&](std::size_t r, std::size_t c) {
            return std::min({r, c, rows - 1 - r, cols - 1 - c}) < kEqualBorder;
        };
        Plane correction(1, rows, cols);
        double mean = 0;
        for (std::size_t i = 0; i < out.plane_size(); ++i) {
            correction.values()[i] = tile_.values()[i] - out.values()[i];
            if (is_border(i / cols, i % cols)) mean += correction.values()[i];
        }
        mean /= static_cast<double>(2 * kEqualBorder * (rows + cols - 2 * kEqualBorder));
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c)
                if (!is_border(r, c)) correction(0, r, c) = mean;
        const auto side = static_cast<double>(std::max(rows, cols));
        const double relaxation = 2 / (1 + std::sin(std::numbers::pi / side));
        for (std::size_t sweep = 0; sweep < 3 * std::max(rows, cols); ++sweep)
            for (std::size_t r = kEqualBorder; r + kEqualBorder < rows; ++r)
                for (std::size_t c = kEqualBorder; c + kEqualBorder < cols; ++c) {
                    double& z = correction(0, r, c);
                    const double around =
                        correction(0, r - 1, c) + correction(0, r + 1, c) +
                        correction(0, r, c - 1) + correction(0, r, c + 1);
                    z += relaxation * (around / 4 - z);
                }
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c)
                out(0, r, c) =
                    is_border(r, c) ? tile_(0, r, c) : out(0, r, c) + correction(0, r, c);
    }

    const Plane& tile_;
    const Lattice& lattice_;
    std::size_t band_;
    Stack stack_;
    std::vector<Shift> taken_;
};

Image to_float(const Plane& plane) {
    Image out(1, plane.rows(), plane.cols());
    for (std::size_t i = 0; i < plane.plane_size(); ++i)
        out.values()[i] = static_cast<float>(plane.values()[i]);
    return out;
}

}  // namespace

bool is_toroidal(const BasicImage<double>& z) {
    const std::size_t rows = z.rows();
    const std::size_t cols = z.cols();
    double inside[2] = {};
    double across[2] = {};
    const auto curvature = [](double a, double b, double c, double d) {
        return std::array<double, 2>{(c - b) * (c - b),
                                     (d - c - (b - a)) * (d - c - (b - a))};
    };
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            const auto right =
                curvature(z(0, r, (c + cols - 1) % cols), z(0, r, c),
                          z(0, r, (c + 1) % cols), z(0, r, (c + 2) % cols));
            const auto down = curvature(z(0, (r + rows - 1) % rows, c), z(0, r, c),
                                        z(0, (r + 1) % rows, c), z(0, (r + 2) % rows, c));
            for (std::size_t i = 0; i < 2; ++i) {
                (c + 1 == cols ? across : inside)[i] += right[i];
                (r + 1 == rows ? across : inside)[i] += down[i];
            }
        }
    const auto border = static_cast<double>(rows + cols);
    const double all = 2 * static_cast<double>(rows * cols) - border;
    constexpr double kLimit = kToroidalStep * kToroidalStep;
    return across[0] / border <= kLimit * inside[0] / all &&
           across[1] / border <= kLimit * inside[1] / all;
}

Result<RolledSurface> roll(const BasicImage<double>& height,
                           const RollerOptions& options) {
    if (options.tiles < 1 || options.tiles > kMaxSurfaceTiles)
        return Error{Errc::invalid_argument, "roller: " + std::to_string(options.tiles) +
                                                 " tiles, expected 1 to 8"};
    if (std::min(height.rows(), height.cols()) < kSmallestSide)
        return Error{Errc::invalid_argument, "roller: a range map of " +
                                                 std::to_string(height.cols()) + " x " +
                                                 std::to_string(height.rows()) +
                                                 " pixels, expected at least 16 a side"};
    RolledSurface out;
    SeamRatio ratio;
    Plane tile = height;
    Lattice lattice{tile.rows(), tile.cols(), 0};
    out.was_toroidal =
        std::max(tile.rows(), tile.cols()) <= options.largest_side && is_toroidal(tile);
    if (!out.was_toroidal) {
        Plane sample = centre(height, options.largest_side);
        remove_tilt(sample);
        const Stack stack = open_stack(sample);
        lattice = find_lattice(stack.z);
        out.overlap_rows = stack.z.rows() - lattice.rows;
        out.overlap_cols = stack.z.cols() - lattice.cols;
        const std::vector<std::size_t> sites = cut_tile(stack, lattice);
        SlopeField slopes(2, lattice.rows, lattice.cols);
        for (std::size_t band = 0; band < 2; ++band)
            for (std::size_t i = 0; i < sites.size(); ++i)
                slopes.plane(band).data[i] = stack.slopes.plane(band).data[sites[i]];
        tile = integrate(slopes, Difference::forward, Periodicity::torus, lattice.shear);
        add_seams(tile, lattice, stack, sites, ratio);
    }
    out.shear_px = static_cast<std::uint32_t>(lattice.shear);
    out.tiles.push_back(to_float(tile));
    Interchange interchange(tile, lattice);
    while (out.tiles.size() < options.tiles)
        out.tiles.push_back(to_float(interchange.another(ratio)));
    out.seam_ratio = ratio.value();
    return out;
}

}  // namespace sateen
