// SPDX-License-Identifier: Apache-2.0
// The first tile and those interchangeable with it. See roller_tiles.hpp.
#include "analysis/roller_tiles.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "analysis/fourier.hpp"
#include "analysis/roller_cut.hpp"

namespace sateen {
namespace {

using Plane = BasicImage<double>;

// Pixels along the border that are equal in all tiles: slopes across it are, too.
constexpr std::size_t kEqualBorder = 2;
// So few of the shifts agree about as well as the best.
constexpr std::size_t kOneOfShifts = 10;
// Of Gauss and Seidel, at each spacing.
constexpr std::size_t kSweeps = 12;
// Of squares of pixels: nothing is divided by less.
constexpr double kFlat = 1e-12;

struct Step {
    int down = 0;
    int right = 0;
};
/// A pixel and those within two steps: slopes change over from one piece to another there.
constexpr std::array<Step, 13> kAround = {{{0, 0},
                                           {-2, 0},
                                           {-1, -1},
                                           {-1, 0},
                                           {-1, 1},
                                           {0, -2},
                                           {0, -1},
                                           {0, 1},
                                           {0, 2},
                                           {1, -1},
                                           {1, 0},
                                           {1, 1},
                                           {2, 0}}};

/// Site of the pixel a few steps from one of a tile.
std::size_t neighbour(const TileLattice& lattice, std::size_t r, std::size_t c, int down,
                      int right) {
    const auto row = static_cast<std::ptrdiff_t>(r) + down;
    // Above the tile lies one that is shifted back.
    const std::size_t shift = row < 0 ? lattice.shear : 0;
    const auto col = static_cast<std::ptrdiff_t>(c + lattice.cols + shift) + right;
    return lattice.site(
        static_cast<std::size_t>(row < 0 ? row + static_cast<std::ptrdiff_t>(lattice.rows)
                                         : row),
        static_cast<std::size_t>(col));
}

double mean_square(std::span<const double> values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return sum / static_cast<double>(std::max<std::size_t>(1, values.size()));
}

void set_weights(SlopeStack& stack) {
    stack.z_weight = 1 / (mean_square(stack.z.values()) + kFlat);
    stack.slope_weight = 1 / (mean_square(stack.slopes.values()) + kFlat);
}

/// Of (rows + 1, cols + 1) heights: forward differences, along y from the row above.
SlopeStack open_stack(const Plane& height) {
    SlopeStack out{Plane(1, height.rows() - 1, height.cols() - 1),
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

/// What a pixel of the tile shows: its site in the sample, after both cuts.
std::vector<std::size_t> cut_sites(const SlopeStack& sample, const TileLattice& lattice) {
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

Seams seams_of_cut(std::span<const std::size_t> sites, std::size_t sample_cols,
                   const TileLattice& lattice) {
    Seams out{std::vector<std::uint8_t>(sites.size()),
              std::vector<std::uint8_t>(sites.size())};
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c) {
            const std::size_t at = lattice.site(r, c);
            const std::size_t right = sites[lattice.site(r, c + 1)];
            const std::size_t down = sites[lattice.site(r + 1, c)];
            out.right[at] = static_cast<std::uint8_t>(right != sites[at] + 1);
            out.down[at] = static_cast<std::uint8_t>(down != sites[at] + sample_cols);
        }
    return out;
}

/// Of a torus.
SlopeStack closed_stack(const Plane& tile, const TileLattice& lattice) {
    SlopeStack out{tile, SlopeField(2, lattice.rows, lattice.cols)};
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c) {
            const double here = tile(0, r, c);
            out.slopes(0, r, c) = tile.values()[lattice.site(r, c + 1)] - here;
            out.slopes(1, r, c) = tile.values()[lattice.above(r, c)] - here;
        }
    set_weights(out);
    return out;
}

std::size_t band_width(const TileLattice& lattice) {
    return std::max<std::size_t>(2, std::min(lattice.rows, lattice.cols) / 6);
}

/// 1 for the pixels along the border, 0 inside.
Plane border_mask(const TileLattice& lattice, std::size_t width) {
    Plane mask(1, lattice.rows, lattice.cols);
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c)
            mask(0, r, c) =
                std::min({r, c, lattice.rows - 1 - r, lattice.cols - 1 - c}) < width ? 1
                                                                                     : 0;
    return mask;
}

Plane inner_mask(const TileLattice& lattice, std::size_t width) {
    Plane mask = border_mask(lattice, width);
    for (double& v : mask.values()) v = 1 - v;
    return mask;
}

/// Σ_x a(x) b(x + s) for every shift s of the torus.
class Correlation {
  public:
    explicit Correlation(const TileLattice& lattice)
        : shear_(lattice.shear), sum_(lattice.rows, lattice.cols) {}
    void add(const Plane& a, PlaneView<const double> b, double factor) {
        const Spectrum A = lattice_spectrum(a.plane(0), shear_);
        const Spectrum B = lattice_spectrum(b, shear_);
        for (std::size_t i = 0; i < sum_.values.size(); ++i)
            sum_.values[i] += factor * std::conj(A.values[i]) * B.values[i];
    }
    [[nodiscard]] Plane values() && { return lattice_plane(sum_, shear_); }

  private:
    std::size_t shear_;
    Spectrum sum_;
};

/// A torus that begins at (row, col) of the old one.
template <class T>
void rotate(std::span<T> values, const TileLattice& lattice, std::size_t row,
            std::size_t col) {
    const std::vector<T> old(values.begin(), values.end());
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c)
            values[r * lattice.cols + c] = old[lattice.site(r + row, c + col)];
}

/// Means over squares of the torus.
Plane blurred(const Plane& plane, const TileLattice& lattice, std::size_t radius) {
    Plane along(1, lattice.rows, lattice.cols);
    Plane out(1, lattice.rows, lattice.cols);
    const auto width = static_cast<double>(2 * radius + 1);
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c)
            for (std::size_t i = 0; i <= 2 * radius; ++i)
                along(0, r, c) +=
                    plane.values()[lattice.site(r, c + lattice.cols + i - radius)] /
                    width;
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c)
            for (std::size_t i = 0; i <= 2 * radius; ++i)
                out.values()[lattice.site(r + radius, c)] +=
                    along.values()[lattice.site(r + i, c)] / width;
    return out;
}

/// How far from usual height and roughness are around a pixel, squared twice: one pit or one
/// flat counts more than many small ones.
Plane salience_of(const Plane& z, const TileLattice& lattice) {
    const std::size_t radius = band_width(lattice) / 3;
    const SlopeStack stack = closed_stack(z, lattice);
    Plane power(1, lattice.rows, lattice.cols);
    for (std::size_t i = 0; i < power.plane_size(); ++i) {
        const double p = stack.slopes.plane(0).data[i];
        const double q = stack.slopes.plane(1).data[i];
        power.values()[i] = p * p + q * q;
    }
    Plane roughness = blurred(power, lattice, radius);
    for (double& v : roughness.values()) v = std::log(v + kFlat);
    Plane out(1, lattice.rows, lattice.cols);
    for (Plane feature : {blurred(z, lattice, radius), std::move(roughness)}) {
        double mean = 0;
        for (const double v : feature.values()) mean += v;
        mean /= static_cast<double>(feature.plane_size());
        for (double& v : feature.values()) v -= mean;
        const double variance = mean_square(feature.values()) + kFlat;
        for (std::size_t i = 0; i < out.plane_size(); ++i)
            out.values()[i] +=
                std::pow(feature.values()[i] * feature.values()[i] / variance, 2);
    }
    return out;
}

std::size_t around(std::size_t a, std::size_t b, std::size_t n) {
    const std::size_t distance = a > b ? a - b : b - a;
    return std::min(distance, n - std::min(distance, n));
}

}  // namespace

RolledTile cut_tile(const Plane& height, const TileLattice& lattice) {
    const SlopeStack stack = open_stack(height);
    const std::vector<std::size_t> sites = cut_sites(stack, lattice);
    const std::size_t cols = stack.z.cols();
    SlopeField slopes(2, lattice.rows, lattice.cols);
    for (std::size_t r = 0; r < lattice.rows; ++r)
        for (std::size_t c = 0; c < lattice.cols; ++c) {
            const std::size_t own = sites[lattice.site(r, c)];
            // What the pieces of the pixels around show here.
            double sums[2] = {};
            for (const auto& [down, right] : kAround) {
                const std::size_t other = sites[neighbour(lattice, r, c, down, right)] -
                                          static_cast<std::size_t>(down) * cols -
                                          static_cast<std::size_t>(right);
                const std::size_t at = other < stack.z.plane_size() ? other : own;
                for (std::size_t band = 0; band < 2; ++band)
                    sums[band] += stack.slopes.plane(band).data[at];
            }
            for (std::size_t band = 0; band < 2; ++band)
                slopes(band, r, c) = sums[band] / kAround.size();
        }
    return {integrate(slopes, Difference::forward, Periodicity::torus, lattice.shear),
            seams_of_cut(sites, cols, lattice)};
}

void begin_at_plain_border(RolledTile& tile, const TileLattice& lattice) {
    constexpr double kClearly = 0.75;
    const Plane salience = salience_of(tile.z, lattice);
    Correlation correlation(lattice);
    correlation.add(border_mask(lattice, band_width(lattice) / 2), salience.plane(0), 1);
    const Plane seen = std::move(correlation).values();
    const auto plainest = std::min_element(seen.values().begin(), seen.values().end());
    if (!(*plainest < kClearly * seen.values()[0])) return;
    const auto at = static_cast<std::size_t>(plainest - seen.values().begin());
    const std::size_t row = at / lattice.cols;
    const std::size_t col = at % lattice.cols;
    rotate(tile.z.values(), lattice, row, col);
    rotate(std::span(tile.seams.right), lattice, row, col);
    rotate(std::span(tile.seams.down), lattice, row, col);
}

Interchange::Interchange(const RolledTile& tile, const TileLattice& lattice)
    : tile_(tile),
      lattice_(lattice),
      band_(band_width(lattice)),
      stack_(closed_stack(tile.z, lattice)),
      salience_(salience_of(tile.z, lattice)),
      shown_(1, lattice.rows, lattice.cols),
      band_errors_(band_errors()) {
    std::fill(shown_.values().begin(), shown_.values().end(), 1.0);
}

RolledTile Interchange::another() {
    const Shift shift = best_shift();
    taken_.push_back(shift);
    Plane error(1, lattice_.rows, lattice_.cols);
    for (std::size_t r = 0; r < lattice_.rows; ++r)
        for (std::size_t c = 0; c < lattice_.cols; ++c)
            error(0, r, c) = stack_.error(lattice_.site(r, c), shifted(r, c, shift));
    const std::vector<std::uint8_t> inside = minimum_error_inside(error, band_);
    for (std::size_t r = 0; r < lattice_.rows; ++r)
        for (std::size_t c = 0; c < lattice_.cols; ++c)
            shown_.values()[shifted(r, c, shift)] += inside[lattice_.site(r, c)];
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
    RolledTile out{
        integrate(slopes, Difference::forward, Periodicity::torus, lattice_.shear),
        seams_of(inside, shift)};
    equalise_border(out.z);
    return out;
}

Seams Interchange::seams_of(const std::vector<std::uint8_t>& inside, Shift shift) const {
    Seams out = tile_.seams;
    for (std::size_t r = 0; r < lattice_.rows; ++r)
        for (std::size_t c = 0; c < lattice_.cols; ++c) {
            const std::size_t at = lattice_.site(r, c);
            const std::size_t from = inside[at] != 0 ? shifted(r, c, shift) : at;
            const auto seam = [&](std::uint8_t own, std::size_t next) {
                return static_cast<std::uint8_t>(own != 0 || inside[at] != inside[next]);
            };
            out.right[at] = seam(tile_.seams.right[from], lattice_.site(r, c + 1));
            out.down[at] = seam(tile_.seams.down[from], lattice_.site(r + 1, c));
        }
    return out;
}

/// Of the pixels around, how many are inside.
double Interchange::share_of(const std::vector<std::uint8_t>& inside, std::size_t r,
                             std::size_t c) const {
    int count = 0;
    for (const auto& [down, right] : kAround)
        count += inside[neighbour(lattice_, r, c, down, right)];
    return count / static_cast<double>(kAround.size());
}

bool Interchange::is_new(Shift shift) const {
    const std::size_t near = std::min(lattice_.rows, lattice_.cols) / 4;
    const auto is_near = [&](Shift other) {
        return around(shift.row, other.row, lattice_.rows) < near &&
               around(shift.col, other.col, lattice_.cols) < near;
    };
    return !is_near({0, 0}) && std::none_of(taken_.begin(), taken_.end(), is_near);
}

/// Σ over the band along the border of the squared difference between the torus and itself
/// shifted, for all shifts s at once: with the mask M,
///
///     Σ M w (f - f(· + s))² = Σ M w f² + (M ⋆ w f²)(s) - 2 (M w f ⋆ f)(s)
std::vector<double> Interchange::band_errors() const {
    const Plane mask = border_mask(lattice_, band_);
    Correlation correlation(lattice_);
    Plane squares(1, lattice_.rows, lattice_.cols);
    double constant = 0;
    const auto add_plane = [&](PlaneView<const double> f, double weight) {
        Plane masked(1, lattice_.rows, lattice_.cols);
        for (std::size_t i = 0; i < masked.plane_size(); ++i) {
            masked.values()[i] = mask.values()[i] * f.data[i];
            squares.values()[i] += weight * f.data[i] * f.data[i];
            constant += weight * masked.values()[i] * f.data[i];
        }
        correlation.add(masked, f, -2 * weight);
    };
    add_plane(stack_.z.plane(0), stack_.z_weight);
    add_plane(stack_.slopes.plane(0), stack_.slope_weight);
    add_plane(stack_.slopes.plane(1), stack_.slope_weight);
    correlation.add(mask, std::as_const(squares).plane(0), 1);
    const Plane errors = std::move(correlation).values();
    std::vector<double> out(errors.values().begin(), errors.values().end());
    for (double& error : out) error += constant;
    return out;
}

/// Of the shifts whose borders agree best, the one whose inside shows least of what stands out
/// and was shown before.
Interchange::Shift Interchange::best_shift() const {
    std::vector<std::size_t> shifts;
    for (std::size_t at = 0; at < band_errors_.size(); ++at)
        if (is_new({at / lattice_.cols, at % lattice_.cols})) shifts.push_back(at);
    if (shifts.empty()) return {lattice_.rows / 2, lattice_.cols / 2};
    const auto few =
        shifts.begin() + static_cast<std::ptrdiff_t>(shifts.size() / kOneOfShifts + 1);
    std::partial_sort(
        shifts.begin(), std::min(few, shifts.end()), shifts.end(),
        [&](std::size_t x, std::size_t y) { return band_errors_[x] < band_errors_[y]; });
    Plane seen(1, lattice_.rows, lattice_.cols);
    for (std::size_t i = 0; i < seen.plane_size(); ++i)
        seen.values()[i] = salience_.values()[i] * shown_.values()[i];
    Correlation correlation(lattice_);
    correlation.add(inner_mask(lattice_, band_), std::as_const(seen).plane(0), 1);
    const Plane again = std::move(correlation).values();
    const std::size_t best = *std::min_element(
        shifts.begin(), std::min(few, shifts.end()), [&](std::size_t x, std::size_t y) {
            return again.values()[x] < again.values()[y];
        });
    return {best / lattice_.cols, best % lattice_.cols};
}

/// Adds a smooth surface that takes the border to that of the first tile, from which it hardly
/// differs: Laplace's equation, relaxed on grids of half the spacing in turn.
void Interchange::equalise_border(Plane& out) const {
    const std::size_t rows = lattice_.rows;
    const std::size_t cols = lattice_.cols;
    const auto is_border = [&](std::size_t r, std::size_t c) {
        return std::min({r, c, rows - 1 - r, cols - 1 - c}) < kEqualBorder;
    };
    Plane correction(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c)
            if (is_border(r, c)) correction(0, r, c) = tile_.z(0, r, c) - out(0, r, c);
    // Innermost pixels of the border, beyond which nothing is looked for.
    constexpr std::size_t kFirst = kEqualBorder - 1;
    const std::size_t last_row = rows - 1 - kFirst;
    const std::size_t last_col = cols - 1 - kFirst;
    for (std::size_t step = std::bit_floor(std::max(rows, cols) / 2); step > 0; step /= 2)
        for (std::size_t sweep = 0; sweep < kSweeps; ++sweep)
            for (std::size_t r = kFirst + step; r < last_row; r += step) {
                const std::size_t up = r - step;
                const std::size_t down = std::min(r + step, last_row);
                for (std::size_t c = kFirst + step; c < last_col; c += step) {
                    const std::size_t right = std::min(c + step, last_col);
                    correction(0, r, c) =
                        (correction(0, up, c) + correction(0, down, c) +
                         correction(0, r, c - step) + correction(0, r, right)) /
                        4;
                }
            }
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c)
            out(0, r, c) =
                is_border(r, c) ? tile_.z(0, r, c) : out(0, r, c) + correction(0, r, c);
}

}  // namespace sateen
