// SPDX-License-Identifier: Apache-2.0
// Planes drawn by causal recursion. See recursive_field.hpp.
#include "synthesis/recursive_field.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sateen/core/normal.hpp"
#include "sateen/core/pyramid.hpp"
#include "synthesis/noise_bands.hpp"

namespace sateen {
namespace {

constexpr std::int32_t kBlockSide = 512;
/// An impulse is forgotten where its response is below this share of its peak.
constexpr float kForgotten = 1e-3F;
/// Rows that are expanded into while they are in the cache.
constexpr std::size_t kStripRows = 16;

std::int32_t block_of(std::int32_t site) {
    return site >= 0 ? site / kBlockSide : -((-site - 1) / kBlockSide) - 1;
}

}  // namespace

Result<RecursiveField::Margin> RecursiveField::impulse_margin(const LevelRecursion& level,
                                                              std::size_t number) {
    constexpr std::size_t kCentre = kLongestMargin;
    Image response(1, kLongestMargin + 1, 2 * kCentre + 1);
    response(0, 0, kCentre) = 1;
    SATEEN_CHECK(causal_recursion(level.taps, 1, response.plane(0)));
    Margin margin;
    for (std::size_t r = 0; r < response.rows(); ++r)
        for (std::size_t c = 0; c < response.cols(); ++c) {
            const float felt = std::abs(response(0, r, c));
            if (felt <= kForgotten) continue;
            margin.down = std::max(margin.down, r + 1);
            if (c < kCentre) margin.right = std::max(margin.right, kCentre - c);
            if (c > kCentre) margin.left = std::max(margin.left, c - kCentre);
        }
    if (margin.down > kLongestMargin || margin.left >= kCentre || margin.right >= kCentre)
        return Error{Errc::not_stationary,
                     "level " + std::to_string(number) +
                         ": the causal recursion is still at more than " +
                         std::to_string(kForgotten) + " of an impulse after " +
                         std::to_string(kLongestMargin) +
                         " sites; draw it tileable instead"};
    return margin;
}

Result<RecursiveField> RecursiveField::create(const PlaneField& field) {
    RecursiveField result;
    for (std::size_t number = 0; number < field.levels.size(); ++number) {
        const auto* car = std::get_if<Car2d>(&field.field(number));
        if (car == nullptr)
            return Error{Errc::unsupported,
                         "level " + std::to_string(number) +
                             ": only 2D CAR fields have a causal recursion"};
        LevelRecursion level;
        for (std::size_t i = 0; i < car->a.size(); ++i)
            level.taps.push_back(
                {car->neighbourhood[i].row, car->neighbourhood[i].col, car->a[i]});
        level.deviation = std::sqrt(car->variance);
        SATEEN_TRY(level.margin, impulse_margin(level, number));
        result.levels_.push_back(std::move(level));
    }
    return result;
}

std::size_t RecursiveField::strip_rows() const {
    return kBlockSide;
}

Result<void> RecursiveField::draw_level(std::size_t level, NoiseField noise,
                                        const Window& block, const Expanded& coarser,
                                        LatticePoint from, PlaneView<float> out) const {
    const LevelRecursion& model = levels_[level];
    // Noise is made in groups of four columns.
    const auto extra = static_cast<std::size_t>(
        (block.cols.first - static_cast<std::int32_t>(model.margin.left)) & 3);
    const std::size_t left = model.margin.left + extra;
    const std::int32_t first_col = block.cols.first - static_cast<std::int32_t>(left);
    SATEEN_TRY(CausalRecursion recursion,
               CausalRecursion::create(model.taps, model.deviation,
                                       left + block.cols.count + model.margin.right));
    std::int32_t row = block.rows.first - static_cast<std::int32_t>(model.margin.down);
    const auto next_row = [&] {
        draw_normals(noise, row++, first_col, recursion.noise());
        return recursion.next_row();
    };
    while (row < from.row) (void)next_row();

    SerialExecutor serial;
    const auto skipped = static_cast<std::size_t>(from.col - first_col);
    for (std::size_t first = 0; first < out.rows; first += kStripRows) {
        const auto strip =
            out.window(first, 0, std::min(kStripRows, out.rows - first), out.cols);
        const LatticePoint origin{row, from.col};
        for (std::size_t r = 0; r < strip.rows; ++r)
            std::copy_n(next_row().data() + skipped, out.cols, strip.row(r));
        if (coarser.field.size() != 0)
            expand_add_window(coarser.field, coarser.origin, strip, origin, serial);
    }
    return {};
}

Result<void> RecursiveField::draw_part(std::uint64_t seed, std::uint32_t plane,
                                       LatticePoint block, LatticePoint from,
                                       PlaneView<float> out) const {
    // Columns are those of the whole block: its right part is felt on the left.
    const std::int32_t end = from.row + static_cast<std::int32_t>(out.rows);
    std::vector<Window> windows = {
        {{block.row, static_cast<std::size_t>(end - block.row)},
         {block.col, kBlockSide}}};
    while (windows.size() < levels_.size())
        windows.push_back(
            {expand_support(windows.back().rows), expand_support(windows.back().cols)});

    Image coarser;
    Expanded expanded;
    for (std::size_t k = levels_.size(); k-- > 1;) {
        const LatticePoint origin{windows[k].rows.first, windows[k].cols.first};
        Image field(1, windows[k].rows.count, windows[k].cols.count);
        SATEEN_CHECK(draw_level(k, {seed, recursion_noise_band(plane, k)}, windows[k],
                                expanded, origin, field.plane(0)));
        coarser = std::move(field);
        expanded = {std::as_const(coarser).plane(0), origin};
    }
    return draw_level(0, {seed, recursion_noise_band(plane, 0)}, windows[0], expanded,
                      from, out);
}

Result<void> RecursiveField::draw(std::uint64_t seed, std::uint32_t plane,
                                  std::int32_t row, std::int32_t col,
                                  PlaneView<float> out, Executor& executor) const {
    const std::int32_t end_row = row + static_cast<std::int32_t>(out.rows);
    const std::int32_t end_col = col + static_cast<std::int32_t>(out.cols);
    const auto down = static_cast<std::size_t>(block_of(end_row - 1) - block_of(row) + 1);
    const auto across =
        static_cast<std::size_t>(block_of(end_col - 1) - block_of(col) + 1);
    std::vector<Result<void>> results(down * across);
    parallel_for(executor, down * across, [&](std::size_t number) {
        const LatticePoint block{
            (block_of(row) + static_cast<std::int32_t>(number / across)) * kBlockSide,
            (block_of(col) + static_cast<std::int32_t>(number % across)) * kBlockSide};
        const LatticePoint from{std::max(block.row, row), std::max(block.col, col)};
        const std::int32_t to_row = std::min(block.row + kBlockSide, end_row);
        const std::int32_t to_col = std::min(block.col + kBlockSide, end_col);
        results[number] =
            draw_part(seed, plane, block, from,
                      out.window(static_cast<std::size_t>(from.row - row),
                                 static_cast<std::size_t>(from.col - col),
                                 static_cast<std::size_t>(to_row - from.row),
                                 static_cast<std::size_t>(to_col - from.col)));
    });
    for (Result<void>& result : results) SATEEN_CHECK(std::move(result));
    return {};
}

}  // namespace sateen
