// SPDX-License-Identifier: Apache-2.0
// One plane of a material on the infinite lattice. See infinite_field.hpp.
#include "synthesis/infinite_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

}  // namespace

Result<InfiniteField> InfiniteField::create(const PlaneField& field, Period period,
                                            Executor& executor) {
    InfiniteField result;
    result.period_ = period;
    const bool split =
        field.levels.size() > kFineLevels && divisible(period, kFineLevels);
    const std::size_t rows = split ? kBlockRows : kWholeBlockRows;
    const std::size_t cols = split ? kBlockCols : kWholeBlockCols;
    const std::size_t d = field.planes;
    const auto density_of = [&](const PlaneField& part, bool suppress) {
        Image density = spectral_density(part, rows, cols, executor);
        for (std::size_t k = 0; suppress && k < density.bands(); ++k)
            suppress_unmeasured(part, density.plane(k), cols);
        return density;
    };
    const Image whole = density_of(field, true);
    std::array<float, kMaxBands> units{};
    for (std::size_t i = 0; i < d; ++i) {
        const double variance = mean_density(whole.plane(i * d + i), cols);
        units[i] = variance > 0 ? static_cast<float>(1 / std::sqrt(variance)) : 0.0F;
    }

    const auto kernel = [&](const PlaneField& part,
                            bool pin_mean) -> Result<OverlapSave> {
        const Image density = density_of(part, pin_mean);
        std::optional<SampleExtent> pinned;
        if (pin_mean) pinned = SampleExtent{part.sample_rows, part.sample_cols};
        SATEEN_TRY(OverlapSave overlap_save,
                   OverlapSave::create(density.view(), cols, pinned, executor));
        for (std::size_t i = 0; i < d; ++i) overlap_save.scale(i, units[i]);
        return overlap_save;
    };
    if (!split) {
        SATEEN_TRY(result.fine_, kernel(field, true));
        return result;
    }
    result.split_ = kFineLevels;
    SATEEN_TRY(result.fine_, kernel(field.finer(kFineLevels), false));
    SATEEN_TRY(result.coarse_, kernel(field.coarser(kFineLevels), true));
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
