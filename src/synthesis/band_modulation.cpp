// SPDX-License-Identifier: Apache-2.0
// Drawing the modulation of bands. See band_modulation.hpp.
#include "synthesis/band_modulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sateen/core/fft.hpp"
#include "synthesis/cubic_taps.hpp"
#include "synthesis/noise_bands.hpp"

namespace sateen {
namespace {

/// Rows that one piece of work interpolates.
constexpr std::size_t kRowsAtATime = 16;

/// A side of the torus of sites: an accepted FFT size nearest to a whole number of spacings.
std::int32_t sites_of(std::int32_t pixels, std::size_t spacing) {
    const auto wanted = static_cast<std::size_t>(std::max(
        1.0, std::round(static_cast<double>(pixels) / static_cast<double>(spacing))));
    return static_cast<std::int32_t>(fft_size_at_most(wanted));
}

}  // namespace

Result<AmplitudeFields> AmplitudeFields::create(const BandModulation& fields,
                                                std::uint64_t seed, Period period,
                                                Executor& executor) {
    AmplitudeFields result;
    for (std::size_t level = 0; level < BandModulation::kLevels; ++level) {
        if (!(fields.fields[level].deviation > 0)) continue;
        const std::size_t spacing = field_spacing(level);
        const auto step = static_cast<double>(spacing);
        Period sites;
        double row_step = step;
        double col_step = step;
        if (period.rows != 0) {
            sites = {sites_of(period.rows, spacing), sites_of(period.cols, spacing)};
            row_step = static_cast<double>(period.rows) / sites.rows;
            col_step = static_cast<double>(period.cols) / sites.cols;
        }
        SATEEN_TRY(SmoothLattice lattice,
                   SmoothLattice::create(fields.fields[level],
                                         {seed, modulation_noise_band(level)}, sites,
                                         step / row_step, step / col_step, executor));
        result.lattices_[level] = Lattice{std::move(lattice), row_step, col_step};
    }
    return result;
}

void AmplitudeFields::draw(std::size_t level, std::int32_t row, std::int32_t col,
                           PlaneView<float> out, Executor& executor) const {
    const Lattice& lattice = *lattices_[level];
    const auto last = [](std::int32_t first, std::size_t count) {
        return std::int64_t{first} + static_cast<std::int64_t>(count) - 1;
    };
    const std::int32_t first_row = site_before(row, lattice.row_step) - 1;
    const std::int32_t first_col = site_before(col, lattice.col_step) - 1;
    const auto count = [](std::int32_t first, std::int32_t end) {
        return static_cast<std::size_t>(end + 3 - first);
    };
    Image sites(1, count(first_row, site_before(last(row, out.rows), lattice.row_step)),
                count(first_col, site_before(last(col, out.cols), lattice.col_step)));
    lattice.sites.draw(first_row, first_col, sites.plane(0), executor);
    std::vector<CubicTaps> across;
    for (std::size_t c = 0; c < out.cols; ++c)
        across.push_back(cubic_taps(std::int64_t{col} + static_cast<std::int64_t>(c),
                                    lattice.col_step, first_col));
    const std::size_t pieces = (out.rows + kRowsAtATime - 1) / kRowsAtATime;
    parallel_for(executor, pieces, [&](std::size_t piece) {
        std::vector<float> line(sites.cols());
        const std::size_t end = std::min(out.rows, (piece + 1) * kRowsAtATime);
        for (std::size_t r = piece * kRowsAtATime; r < end; ++r) {
            const CubicTaps down =
                cubic_taps(std::int64_t{row} + static_cast<std::int64_t>(r),
                           lattice.row_step, first_row);
            const PlaneView<const float> from = std::as_const(sites).plane(0);
            const std::array<const float*, 4> rows = {
                from.row(down.first), from.row(down.first + 1), from.row(down.first + 2),
                from.row(down.first + 3)};
            for (std::size_t c = 0; c < line.size(); ++c)
                line[c] = (down.weights[0] * rows[0][c] + down.weights[1] * rows[1][c]) +
                          (down.weights[2] * rows[2][c] + down.weights[3] * rows[3][c]);
            float* const to = out.row(r);
            for (std::size_t c = 0; c < out.cols; ++c) {
                const CubicTaps& taps = across[c];
                const float* const at = line.data() + taps.first;
                to[c] = (taps.weights[0] * at[0] + taps.weights[1] * at[1]) +
                        (taps.weights[2] * at[2] + taps.weights[3] * at[3]);
            }
        }
    });
}

void modulate_planes(const BandModulation& fields, const Subspace& subspace,
                     const AmplitudeFields& amplitudes, Border border, std::int32_t row,
                     std::int32_t col, ImageView<float> planes, Executor& executor) {
    modulate_bands(
        fields, *subspace.modulation,
        [&](std::size_t level, PlaneView<float> out, Executor& threads) {
            amplitudes.draw(level, row, col, out, threads);
        },
        border, planes, executor);
}

}  // namespace sateen
