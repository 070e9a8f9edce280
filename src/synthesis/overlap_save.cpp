// SPDX-License-Identifier: Apache-2.0
// Windows of the infinite lattice by overlap-save. See overlap_save.hpp.
#include "synthesis/overlap_save.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "synthesis/hermitian_matrix.hpp"

namespace sateen {
namespace {

/// The kernel is cut where no more than this share of its energy lies outside: the field
/// changes by 2 % of its deviation at most, and by a smooth change of its spectrum.
constexpr double kTailShare = 5e-4;
constexpr std::size_t kReachStep = 8;

std::int32_t floor_div(std::int32_t a, std::int32_t b) {
    return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0);
}

/// The distance of index k from 0 on a circle of n.
std::size_t circular_distance(std::size_t k, std::size_t n) {
    return std::min(k, n - k);
}

/// The next multiple of kReachStep, at most a quarter of the block.
std::size_t stepped_reach(double reach, std::size_t block) {
    const std::size_t furthest = block / 4 / kReachStep * kReachStep;
    if (reach >= static_cast<double>(furthest)) return furthest;
    return std::min((static_cast<std::size_t>(reach) / kReachStep + 1) * kReachStep,
                    furthest);
}

/// The smallest multiple of kReachStep beyond which the energies sum to less than the
/// share, at most a quarter of the block.
std::size_t choose_reach(const std::vector<double>& energy_at_distance,
                         std::size_t block) {
    double total = 0;
    for (const double energy : energy_at_distance) total += energy;
    double tail = 0;
    std::size_t reach = energy_at_distance.size();
    while (reach > 0 && tail + energy_at_distance[reach - 1] <= kTailShare * total)
        tail += energy_at_distance[--reach];
    return stepped_reach(static_cast<double>(reach), block);
}

/// 1 up to ¾ of the reach, then a cosine down to 0 at the reach.
float taper(std::size_t distance, std::size_t reach) {
    const double x = static_cast<double>(distance) / static_cast<double>(reach);
    if (x >= 1) return 0;
    if (x <= 0.75) return 1;
    return static_cast<float>(0.5 + 0.5 * std::cos(std::numbers::pi * (x - 0.75) * 4));
}

/// A smooth bump over the whole reach.
float bump(std::size_t distance, std::size_t reach) {
    const double x = static_cast<double>(distance) / static_cast<double>(reach);
    return x >= 1 ? 0.0F : static_cast<float>(0.5 + 0.5 * std::cos(std::numbers::pi * x));
}

struct Reach {
    std::size_t rows;
    std::size_t cols;
};

/// Of all kernels together.
Reach reach_of(const Image& kernels) {
    std::vector<double> by_row(kernels.rows() / 2 + 1);
    std::vector<double> by_col(kernels.cols() / 2 + 1);
    for (std::size_t k = 0; k < kernels.bands(); ++k)
        for (std::size_t r = 0; r < kernels.rows(); ++r)
            for (std::size_t c = 0; c < kernels.cols(); ++c) {
                const double h = static_cast<double>(kernels(k, r, c));
                by_row[circular_distance(r, kernels.rows())] += h * h;
                by_col[circular_distance(c, kernels.cols())] += h * h;
            }
    return {choose_reach(by_row, kernels.rows()), choose_reach(by_col, kernels.cols())};
}

template <class Window>
Image separable_window(const Image& like, Reach reach, Window window) {
    Image result(1, like.rows(), like.cols());
    for (std::size_t r = 0; r < like.rows(); ++r) {
        const float row = window(circular_distance(r, like.rows()), reach.rows);
        for (std::size_t c = 0; c < like.cols(); ++c)
            result(0, r, c) = row * window(circular_distance(c, like.cols()), reach.cols);
    }
    return result;
}

/// Subtracts as much of a wide bump as makes the kernel sum to 0: a notch at frequency 0
/// as narrow as the reach allows.
void subtract_mean(PlaneView<float> kernel, const Image& wide) {
    double kernel_sum = 0;
    double bump_sum = 0;
    for (std::size_t i = 0; i < kernel.size(); ++i) {
        kernel_sum += static_cast<double>(kernel.data[i]);
        bump_sum += static_cast<double>(wide.values()[i]);
    }
    const float share = static_cast<float>(kernel_sum / bump_sum);
    for (std::size_t i = 0; i < kernel.size(); ++i)
        kernel.data[i] -= share * wide.values()[i];
}

/// The kernels of a matrix of d planes: (i, j) with i ≤ j, row by row. Those with i > j are
/// mirrored ones, h_ji(r) = h_ij(-r).
struct Pair {
    std::size_t i, j;
};

std::vector<Pair> pairs_of(std::size_t planes) {
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < planes; ++i)
        for (std::size_t j = i; j < planes; ++j) pairs.push_back({i, j});
    return pairs;
}

/// Σ_j Σ_r h_ij(r)² for every plane i: its variance.
std::array<double, 3> variances(const Image& kernels, const std::vector<Pair>& pairs) {
    std::array<double, 3> sums{};
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        double energy = 0;
        const PlaneView<const float> kernel = kernels.plane(k);
        for (std::size_t n = 0; n < kernel.size(); ++n)
            energy +=
                static_cast<double>(kernel.data[n]) * static_cast<double>(kernel.data[n]);
        sums[pairs[k].i] += energy;
        if (pairs[k].i != pairs[k].j) sums[pairs[k].j] += energy;
    }
    return sums;
}

void copy_plane(PlaneView<const float> from, PlaneView<float> to) {
    for (std::size_t m = 0; m < to.rows; ++m)
        std::copy_n(from.row(m), to.cols, to.row(m));
}

/// E^{1/2} at every frequency.
Image root_of(ImageView<const float> density, Executor& executor) {
    Image root(density.bands, density.rows, density.cols);
    std::copy_n(density.data, density.size(), root.values().begin());
    if (density.bands == 1)
        for (float& value : root.values()) value = std::sqrt(value);
    else
        parallel_for(executor, root.rows(), [&](std::size_t m) {
            hermitian_root(hermitian_rows(root.view(), m), root.cols());
        });
    return root;
}

std::int32_t wrapped(std::int32_t k, std::int32_t period) {
    if (period == 0) return k;
    const std::int32_t rest = k % period;
    return rest < 0 ? rest + period : rest;
}

/// One row of noise of a lattice that may be a torus.
void draw_noise_row(NoiseField noise, Period period, std::int32_t row, std::int32_t col,
                    std::span<float> out) {
    const std::int32_t wrapped_row = wrapped(row, period.rows);
    while (!out.empty()) {
        const std::int32_t wrapped_col = wrapped(col, period.cols);
        std::size_t count = out.size();
        if (period.cols != 0)
            count = std::min(count, static_cast<std::size_t>(period.cols - wrapped_col));
        draw_normals(noise, wrapped_row, wrapped_col, out.first(count));
        out = out.subspan(count);
        col += static_cast<std::int32_t>(count);
    }
}

}  // namespace

Result<OverlapSave> OverlapSave::create(ImageView<const float> density, std::size_t cols,
                                        std::optional<SampleExtent> pinned,
                                        Executor& executor) {
    SATEEN_TRY(Fft2d fft, Fft2d::create(density.rows, cols));
    OverlapSave result(std::move(fft));
    const std::size_t d = density.bands == 1 ? 1 : 3;
    const std::vector<Pair> pairs = pairs_of(d);
    const Image root = root_of(density, executor);
    SplitComplexPlane spectrum(density.rows, density.cols);
    Image kernels(pairs.size(), density.rows, cols);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto [i, j] = pairs[k];
        spectrum = SplitComplexPlane(density.rows, density.cols);
        copy_plane(root.plane(i * d + j), spectrum.view().re);
        if (i != j) copy_plane(root.plane(j * d + i), spectrum.view().im);
        result.fft_.inverse(spectrum.view(), kernels.plane(k), executor);
    }

    const std::array<double, 3> whole = variances(kernels, pairs);
    // A notch narrower than what the sample shows of the lowest frequencies needs a bump as
    // wide as the sample; as wide as the kernel alone it would take its low frequencies.
    Reach reach = reach_of(kernels);
    if (pinned) {
        reach.rows = std::max(reach.rows, stepped_reach(pinned->rows, density.rows));
        reach.cols = std::max(reach.cols, stepped_reach(pinned->cols, cols));
    }
    const Image window = separable_window(kernels, reach, taper);
    const Image wide = separable_window(kernels, reach, bump);
    result.filter_ = Image(density.bands, density.rows, density.cols);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const PlaneView<float> kernel = kernels.plane(k);
        for (std::size_t n = 0; n < kernel.size(); ++n)
            kernel.data[n] *= window.values()[n];
        if (pinned) subtract_mean(kernel, wide);
        const auto [i, j] = pairs[k];
        result.fft_.forward(kernel, spectrum.view(), executor);
        copy_plane(spectrum.view().re, result.filter_.plane(i * d + j));
        if (i != j) copy_plane(spectrum.view().im, result.filter_.plane(j * d + i));
    }
    const std::array<double, 3> kept = variances(kernels, pairs);
    result.planes_ = d;
    for (std::size_t i = 0; i < d; ++i)
        result.gains_[i] =
            kept[i] > 0 ? static_cast<float>(std::sqrt(whole[i] / kept[i])) : 0.0F;
    result.reach_rows_ = reach.rows;
    result.reach_cols_ = reach.cols;
    return result;
}

void OverlapSave::apply_filter(std::span<SplitComplexPlane> spectra) const {
    for (std::size_t m = 0; m < fft_.rows(); ++m) {
        ComplexRows<float> y;
        ComplexRows<const float> w;
        for (std::size_t i = 0; i < planes_; ++i) {
            w.re[i] = y.re[i] = spectra[i].view().re.row(m);
            w.im[i] = y.im[i] = spectra[i].view().im.row(m);
        }
        if (planes_ == 1) {
            const float* filter = filter_.plane(0).row(m);
            for (std::size_t n = 0; n < fft_.spectrum_cols(); ++n) {
                const float factor = gains_[0] * filter[n];
                y.re[0][n] *= factor;
                y.im[0][n] *= factor;
            }
        } else {
            multiply_hermitian(hermitian_rows(filter_.view(), m), gains_, w, y,
                               fft_.spectrum_cols());
        }
    }
}

void OverlapSave::draw(std::span<const NoiseField> noise, Period period, std::int32_t row,
                       std::int32_t col, std::span<const PlaneView<float>> out,
                       Executor& executor) const {
    const auto height = static_cast<std::int32_t>(block_rows());
    const auto width = static_cast<std::int32_t>(block_cols());
    const std::int32_t end_row = row + static_cast<std::int32_t>(out[0].rows);
    const std::int32_t end_col = col + static_cast<std::int32_t>(out[0].cols);
    const std::int32_t first_block_row = floor_div(row, height);
    const std::int32_t first_block_col = floor_div(col, width);
    const auto blocks_down =
        static_cast<std::size_t>(floor_div(end_row - 1, height) - first_block_row + 1);
    const auto blocks_across =
        static_cast<std::size_t>(floor_div(end_col - 1, width) - first_block_col + 1);

    parallel_for(executor, blocks_down * blocks_across, [&](std::size_t block) {
        const std::int32_t top =
            (first_block_row + static_cast<std::int32_t>(block / blocks_across)) * height;
        const std::int32_t left =
            (first_block_col + static_cast<std::int32_t>(block % blocks_across)) * width;
        SerialExecutor serial;
        Image field(planes_, fft_.rows(), fft_.cols());
        std::vector<SplitComplexPlane> spectra;
        for (std::size_t plane = 0; plane < planes_; ++plane) {
            for (std::size_t r = 0; r < fft_.rows(); ++r)
                draw_noise_row(noise[plane], period,
                               top - static_cast<std::int32_t>(reach_rows_) +
                                   static_cast<std::int32_t>(r),
                               left - static_cast<std::int32_t>(reach_cols_),
                               {field.plane(plane).row(r), fft_.cols()});
            spectra.emplace_back(fft_.rows(), fft_.spectrum_cols());
            fft_.forward(field.plane(plane), spectra.back().view(), serial);
        }
        apply_filter(spectra);
        for (std::size_t plane = 0; plane < planes_; ++plane)
            fft_.inverse(spectra[plane].view(), field.plane(plane), serial);

        const std::int32_t from_row = std::max(top, row);
        const std::int32_t to_row = std::min(top + height, end_row);
        const std::int32_t from_col = std::max(left, col);
        const std::int32_t to_col = std::min(left + width, end_col);
        for (std::size_t plane = 0; plane < planes_; ++plane)
            for (std::int32_t r = from_row; r < to_row; ++r)
                std::copy_n(
                    field.plane(plane).row(reach_rows_ +
                                           static_cast<std::size_t>(r - top)) +
                        reach_cols_ + static_cast<std::size_t>(from_col - left),
                    static_cast<std::size_t>(to_col - from_col),
                    out[plane].row(static_cast<std::size_t>(r - row)) + (from_col - col));
    });
}

}  // namespace sateen
