// SPDX-License-Identifier: Apache-2.0
// Windows of the infinite lattice by overlap-save. See overlap_save.hpp.
#include "synthesis/overlap_save.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

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
    reach = (reach / kReachStep + 1) * kReachStep;
    return std::min(reach, block / 4 / kReachStep * kReachStep);
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

double energy(const Image& kernel) {
    double sum = 0;
    for (const float h : kernel.values())
        sum += static_cast<double>(h) * static_cast<double>(h);
    return sum;
}

struct Reach {
    std::size_t rows;
    std::size_t cols;
};

Reach reach_of(const Image& kernel) {
    std::vector<double> by_row(kernel.rows() / 2 + 1);
    std::vector<double> by_col(kernel.cols() / 2 + 1);
    for (std::size_t r = 0; r < kernel.rows(); ++r)
        for (std::size_t c = 0; c < kernel.cols(); ++c) {
            const double h = static_cast<double>(kernel(0, r, c));
            by_row[circular_distance(r, kernel.rows())] += h * h;
            by_col[circular_distance(c, kernel.cols())] += h * h;
        }
    return {choose_reach(by_row, kernel.rows()), choose_reach(by_col, kernel.cols())};
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
/// that is as narrow as the reach allows.
void subtract_mean(Image& kernel, Reach reach) {
    const Image wide = separable_window(kernel, reach, bump);
    double kernel_sum = 0;
    double bump_sum = 0;
    for (const float h : kernel.values()) kernel_sum += static_cast<double>(h);
    for (const float w : wide.values()) bump_sum += static_cast<double>(w);
    const float share = static_cast<float>(kernel_sum / bump_sum);
    for (std::size_t i = 0; i < kernel.values().size(); ++i)
        kernel.values()[i] -= share * wide.values()[i];
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

Result<OverlapSave> OverlapSave::create(PlaneView<const float> density, std::size_t cols,
                                        bool pin_mean, Executor& executor) {
    SATEEN_TRY(Fft2d fft, Fft2d::create(density.rows, cols));
    OverlapSave result(std::move(fft));
    SplitComplexPlane spectrum(density.rows, density.cols);
    for (std::size_t m = 0; m < density.rows; ++m)
        for (std::size_t n = 0; n < density.cols; ++n)
            spectrum.view().re(m, n) = std::sqrt(density(m, n));
    Image kernel(1, density.rows, cols);
    result.fft_.inverse(spectrum.view(), kernel.plane(0), executor);

    const double whole = energy(kernel);
    const Reach reach = reach_of(kernel);
    const Image window = separable_window(kernel, reach, taper);
    for (std::size_t i = 0; i < kernel.values().size(); ++i)
        kernel.values()[i] *= window.values()[i];
    if (pin_mean) subtract_mean(kernel, reach);
    const double kept = energy(kernel);

    result.fft_.forward(kernel.plane(0), spectrum.view(), executor);
    result.filter_ = Image(1, density.rows, density.cols);
    for (std::size_t m = 0; m < density.rows; ++m)
        std::copy_n(spectrum.view().re.row(m), density.cols,
                    result.filter_.plane(0).row(m));
    result.reach_rows_ = reach.rows;
    result.reach_cols_ = reach.cols;
    result.scale(kept > 0 ? static_cast<float>(std::sqrt(whole / kept)) : 0.0F);
    return result;
}

void OverlapSave::scale(float factor) {
    for (float& value : filter_.values()) value *= factor;
}

void OverlapSave::draw(NoiseField noise, Period period, std::int32_t row,
                       std::int32_t col, PlaneView<float> out, Executor& executor) const {
    const auto height = static_cast<std::int32_t>(block_rows());
    const auto width = static_cast<std::int32_t>(block_cols());
    const std::int32_t end_row = row + static_cast<std::int32_t>(out.rows);
    const std::int32_t end_col = col + static_cast<std::int32_t>(out.cols);
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
        Image field(1, fft_.rows(), fft_.cols());
        for (std::size_t r = 0; r < fft_.rows(); ++r)
            draw_noise_row(noise, period,
                           top - static_cast<std::int32_t>(reach_rows_) +
                               static_cast<std::int32_t>(r),
                           left - static_cast<std::int32_t>(reach_cols_),
                           {field.plane(0).row(r), fft_.cols()});
        SplitComplexPlane spectrum(fft_.rows(), fft_.spectrum_cols());
        fft_.forward(field.plane(0), spectrum.view(), serial);
        for (std::size_t m = 0; m < fft_.rows(); ++m) {
            const float* filter = filter_.plane(0).row(m);
            float* re = spectrum.view().re.row(m);
            float* im = spectrum.view().im.row(m);
            for (std::size_t n = 0; n < fft_.spectrum_cols(); ++n) {
                re[n] *= filter[n];
                im[n] *= filter[n];
            }
        }
        fft_.inverse(spectrum.view(), field.plane(0), serial);

        const std::int32_t from_row = std::max(top, row);
        const std::int32_t to_row = std::min(top + height, end_row);
        const std::int32_t from_col = std::max(left, col);
        const std::int32_t to_col = std::min(left + width, end_col);
        for (std::int32_t r = from_row; r < to_row; ++r)
            std::copy_n(
                field.plane(0).row(reach_rows_ + static_cast<std::size_t>(r - top)) +
                    reach_cols_ + static_cast<std::size_t>(from_col - left),
                static_cast<std::size_t>(to_col - from_col),
                out.row(static_cast<std::size_t>(r - row)) + (from_col - col));
    });
}

}  // namespace sateen
