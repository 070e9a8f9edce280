// SPDX-License-Identifier: Apache-2.0
// One plane of a material on the infinite lattice. See infinite_field.hpp.
#include "synthesis/infinite_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "sateen/core/pyramid.hpp"
#include "synthesis/noise_bands.hpp"

namespace sateen {
namespace {

/// Levels of the fine part. Two levels reach about 30 sites; the third would double that.
constexpr std::size_t kFineLevels = 2;
/// Blocks of the Fourier transforms: the smallest that keep the overlap below a third and
/// fit into the second-level cache.
constexpr std::size_t kBlockRows = 512;
constexpr std::size_t kBlockCols = 512;
/// Blocks that must hold the kernel of a whole pyramid.
constexpr std::size_t kWholeBlockRows = 1024;
constexpr std::size_t kWholeBlockCols = 1024;

bool divisible(Period period, std::size_t levels) {
    const auto mask = static_cast<std::int32_t>((std::size_t{1} << levels) - 1);
    return (period.rows & mask) == 0 && (period.cols & mask) == 0;
}

struct Window {
    LatticeRange rows;
    LatticeRange cols;
};

/// Levels that one kernel draws.
struct Part {
    PlaneField field;
    bool pinned;             ///< holds the low frequencies
    std::size_t expansions;  ///< to the finest level
    Image density;
};

/// What expansions make of a density along one axis, on average over the finest lattice: from
/// 2πk/n on the coarse lattice it comes out at the frequencies (2πk/n + 2πa) / 2^levels, each
/// level with the gain 2 cos⁸(ω/2) of its own ω.
std::vector<double> expansion_gain(std::size_t n, std::size_t levels) {
    const std::size_t copies = std::size_t{1} << levels;
    std::vector<double> gain(n, 0);
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t a = 0; a < copies; ++a) {
            double omega = 2 * std::numbers::pi * static_cast<double>(k + a * n) /
                           static_cast<double>(copies * n);
            double product = 1 / static_cast<double>(copies);
            for (std::size_t level = 0; level < levels; ++level, omega *= 2)
                product *= 2 * std::pow(std::cos(omega / 2), 8);
            gain[k] += product;
        }
    return gain;
}

/// The variance, on average over the finest lattice, of a field of this density that is expanded
/// so many times. On the grid of the kernel: a finer one, or a coarser one, would see more or
/// less of a peak near frequency 0.
double expanded_variance(PlaneView<const float> density, std::size_t cols,
                         std::size_t levels) {
    const std::vector<double> by_row = expansion_gain(density.rows, levels);
    const std::vector<double> by_col = expansion_gain(cols, levels);
    double sum = 0;
    for (std::size_t m = 0; m < density.rows; ++m)
        for (std::size_t n = 0; n < density.cols; ++n) {
            const double twice = n == 0 || 2 * n == cols ? 1 : 2;
            sum += twice * by_row[m] * by_col[n] * static_cast<double>(density(m, n));
        }
    return sum / static_cast<double>(density.rows * cols);
}

}  // namespace

Result<InfiniteField> InfiniteField::create(const PlaneField& field, Period period,
                                            Executor& executor) {
    InfiniteField result;
    result.period_ = period;
    const bool split =
        field.levels.size() > kFineLevels && divisible(period, kFineLevels);
    const std::size_t rows = split ? kBlockRows : kWholeBlockRows;
    const std::size_t cols = split ? kBlockCols : kWholeBlockCols;
    std::vector<Part> parts;
    if (split) {
        parts.push_back({field.finer(kFineLevels), false, 0, {}});
        parts.push_back({field.coarser(kFineLevels), true, kFineLevels, {}});
    } else {
        parts.push_back({field, true, 0, {}});
    }
    std::array<double, kMaxBands> variances{};
    for (Part& part : parts) {
        part.density = spectral_density(part.field, rows, cols, executor);
        for (std::size_t k = 0; part.pinned && k < part.density.bands(); ++k)
            suppress_unmeasured(part.field, part.density.plane(k), cols);
        for (std::size_t i = 0; i < field.planes; ++i)
            variances[i] += expanded_variance(part.density.plane(i * field.planes + i),
                                              cols, part.expansions);
    }
    std::vector<OverlapSave> kernels;
    for (const Part& part : parts) {
        std::optional<SampleExtent> sample;
        if (part.pinned)
            sample = SampleExtent{part.field.sample_rows, part.field.sample_cols};
        SATEEN_TRY(OverlapSave kernel,
                   OverlapSave::create(part.density.view(), cols, sample, executor));
        for (std::size_t i = 0; i < field.planes; ++i)
            kernel.scale(i, variances[i] > 0
                                ? static_cast<float>(1 / std::sqrt(variances[i]))
                                : 0.0F);
        kernels.push_back(std::move(kernel));
    }
    result.fine_ = std::move(kernels.front());
    if (split) {
        result.split_ = kFineLevels;
        result.coarse_ = std::move(kernels.back());
    }
    return result;
}

std::size_t InfiniteField::strip_rows() const {
    return fine_->block_rows();
}

Result<void> InfiniteField::draw(std::uint64_t seed, std::uint32_t plane,
                                 std::int32_t row, std::int32_t col,
                                 std::span<const PlaneView<float>> out,
                                 Executor& executor) const {
    std::vector<NoiseField> fine_noise;
    std::vector<NoiseField> coarse_noise;
    for (std::uint32_t i = 0; i < out.size(); ++i) {
        fine_noise.push_back({seed, noise_band(plane + i)});
        coarse_noise.push_back({seed, coarse_noise_band(plane + i)});
    }
    fine_->draw(fine_noise, period_, row, col, out, executor);
    if (!coarse_) return {};

    // The windows that each level needs of the next coarser one, then back up through
    // them.
    std::vector<Window> windows = {{{row, out[0].rows}, {col, out[0].cols}}};
    for (std::size_t level = 0; level < split_; ++level)
        windows.push_back(
            {expand_support(windows.back().rows), expand_support(windows.back().cols)});
    const Period coarse_period{period_.rows >> split_, period_.cols >> split_};
    const Window& coarsest = windows.back();
    Image coarse(out.size(), coarsest.rows.count, coarsest.cols.count);
    std::vector<PlaneView<float>> views;
    for (std::size_t i = 0; i < out.size(); ++i) views.push_back(coarse.plane(i));
    coarse_->draw(coarse_noise, coarse_period, coarsest.rows.first, coarsest.cols.first,
                  views, executor);
    for (std::size_t i = 0; i < out.size(); ++i) {
        PlaneView<const float> present = coarse.plane(i);
        Image kept;
        for (std::size_t level = split_; level-- > 0;) {
            const LatticePoint from{windows[level + 1].rows.first,
                                    windows[level + 1].cols.first};
            const LatticePoint to{windows[level].rows.first, windows[level].cols.first};
            if (level == 0) {
                expand_add_window(present, from, out[i], to, executor);
            } else {
                Image finer(1, windows[level].rows.count, windows[level].cols.count);
                expand_window(present, from, finer.plane(0), to, executor);
                kept = std::move(finer);
                present = kept.plane(0);
            }
        }
    }
    return {};
}

}  // namespace sateen
