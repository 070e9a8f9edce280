// SPDX-License-Identifier: Apache-2.0
// One plane of a material on the infinite lattice. See infinite_field.hpp.
#include "synthesis/infinite_field.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
    Image whole = spectral_density(field, kBlockRows, kBlockCols, executor);
    suppress_unmeasured(field, whole.plane(0), kBlockCols);
    const double variance = mean_density(whole.plane(0), kBlockCols);
    const float unit = variance > 0 ? static_cast<float>(1 / std::sqrt(variance)) : 0.0F;

    const auto kernel = [&](const PlaneField& part,
                            bool pin_mean) -> Result<OverlapSave> {
        Image density = spectral_density(part, rows, cols, executor);
        if (pin_mean) suppress_unmeasured(part, density.plane(0), cols);
        SATEEN_TRY(OverlapSave overlap_save,
                   OverlapSave::create(density.plane(0), cols, pin_mean, executor));
        overlap_save.scale(unit);
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
                                 std::int32_t row, std::int32_t col, PlaneView<float> out,
                                 Executor& executor) const {
    fine_->draw({seed, noise_band(plane)}, period_, row, col, out, executor);
    if (!coarse_) return {};

    // The windows that each level needs of the next coarser one, then back up through
    // them.
    std::vector<Window> windows = {{{row, out.rows}, {col, out.cols}}};
    for (std::size_t level = 0; level < split_; ++level)
        windows.push_back(
            {expand_support(windows.back().rows), expand_support(windows.back().cols)});
    const Period coarse_period{period_.rows >> split_, period_.cols >> split_};
    const Window& coarsest = windows.back();
    Image present(1, coarsest.rows.count, coarsest.cols.count);
    coarse_->draw({seed, coarse_noise_band(plane)}, coarse_period, coarsest.rows.first,
                  coarsest.cols.first, present.plane(0), executor);
    for (std::size_t level = split_; level-- > 0;) {
        const LatticePoint from{windows[level + 1].rows.first,
                                windows[level + 1].cols.first};
        const LatticePoint to{windows[level].rows.first, windows[level].cols.first};
        if (level == 0) {
            expand_add_window(present.plane(0), from, out, to, executor);
        } else {
            Image finer(1, windows[level].rows.count, windows[level].cols.count);
            expand_window(present.plane(0), from, finer.plane(0), to, executor);
            present = std::move(finer);
        }
    }
    return {};
}

}  // namespace sateen
