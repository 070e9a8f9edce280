// SPDX-License-Identifier: Apache-2.0
// Octave bands by short filters. See band_split.hpp.
#include "sateen/core/band_split.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/band_rows.hpp"

namespace sateen {
namespace {

/// Rows that one piece of work filters.
constexpr std::size_t kRowsAtATime = 16;

/// The row, or column, that stands for one beyond the border.
std::size_t site_of(std::int64_t k, std::size_t n, Border border) {
    const auto count = static_cast<std::int64_t>(n);
    if (border == Border::wrap)
        return static_cast<std::size_t>(((k % count) + count) % count);
    const std::int64_t period = 2 * count;
    const std::int64_t place = ((k % period) + period) % period;
    return static_cast<std::size_t>(place < count ? place : period - 1 - place);
}

void filter(PlaneView<const float> in, std::size_t spacing, Border border, bool squared,
            PlaneView<float> rest, PlaneView<float> out, Executor& executor) {
    const std::size_t pad = 2 * spacing;
    const auto step = static_cast<std::int64_t>(spacing);
    std::vector<std::size_t> left;
    std::vector<std::size_t> right;
    for (std::size_t k = 0; k < pad; ++k) {
        left.push_back(
            site_of(static_cast<std::int64_t>(k) - static_cast<std::int64_t>(pad),
                    in.cols, border));
        right.push_back(site_of(static_cast<std::int64_t>(in.cols + k), in.cols, border));
    }
    const std::size_t pieces = (in.rows + kRowsAtATime - 1) / kRowsAtATime;
    parallel_for(executor, pieces, [&](std::size_t piece) {
        std::vector<float> line(in.cols + 2 * pad);
        float* const middle = line.data() + pad;
        const std::size_t end = std::min(in.rows, (piece + 1) * kRowsAtATime);
        for (std::size_t r = piece * kRowsAtATime; r < end; ++r) {
            const float* rows[5];
            for (std::size_t j = 0; j < 5; ++j)
                rows[j] = in.row(site_of(static_cast<std::int64_t>(r) +
                                             (static_cast<std::int64_t>(j) - 2) * step,
                                         in.rows, border));
            smooth_rows(rows, squared, middle, in.cols);
            for (std::size_t k = 0; k < pad; ++k) {
                line[k] = middle[left[k]];
                middle[in.cols + k] = middle[right[k]];
            }
            smooth_columns(line.data(), spacing, in.row(r),
                           rest.data != nullptr ? rest.row(r) : nullptr, out.row(r),
                           in.cols);
        }
    });
}

}  // namespace

void split_band(PlaneView<const float> in, std::size_t spacing, Border border,
                PlaneView<float> rest, PlaneView<float> out, Executor& executor) {
    filter(in, spacing, border, false, rest, out, executor);
}

void local_energy(PlaneView<const float> band, std::size_t level, Border border,
                  PlaneView<float> work, PlaneView<float> out, Executor& executor) {
    const std::size_t spacing = std::size_t{1} << level;
    filter(band, std::max<std::size_t>(1, spacing / 2), border, true, {}, work, executor);
    filter(work, spacing, border, false, {}, out, executor);
}

}  // namespace sateen
