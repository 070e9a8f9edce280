// SPDX-License-Identifier: Apache-2.0
// Planes drawn by causal recursion. See recursive_field.hpp.
#include "synthesis/recursive_field.hpp"

#include <algorithm>
#include <cmath>
#include <span>
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

Result<Image> RecursiveField::draw_block(std::uint64_t seed, std::uint32_t plane,
                                         std::int32_t row, std::int32_t col) const {
    struct Window {
        LatticeRange rows;
        LatticeRange cols;
    };
    std::vector<Window> windows = {{{row, kBlockSide}, {col, kBlockSide}}};
    while (windows.size() < levels_.size())
        windows.push_back(
            {expand_support(windows.back().rows), expand_support(windows.back().cols)});

    SerialExecutor serial;
    Image coarser;
    for (std::size_t k = levels_.size(); k-- > 0;) {
        const LevelRecursion& level = levels_[k];
        const Window& window = windows[k];
        const std::size_t left = level.margin.left;
        Image padded(1, window.rows.count + level.margin.down,
                     window.cols.count + left + level.margin.right);
        for (std::size_t r = 0; r < padded.rows(); ++r) {
            const std::span<float> noise(padded.plane(0).row(r), padded.cols());
            draw_normals({seed, recursion_noise_band(plane, k)},
                         window.rows.first + static_cast<std::int32_t>(r) -
                             static_cast<std::int32_t>(level.margin.down),
                         window.cols.first - static_cast<std::int32_t>(left), noise);
        }
        SATEEN_CHECK(causal_recursion(level.taps, level.deviation, padded.plane(0)));
        Image field(1, window.rows.count, window.cols.count);
        for (std::size_t r = 0; r < field.rows(); ++r)
            std::copy_n(padded.plane(0).row(level.margin.down + r) + left, field.cols(),
                        field.plane(0).row(r));
        if (k + 1 < levels_.size())
            expand_add_window(
                coarser.plane(0), {windows[k + 1].rows.first, windows[k + 1].cols.first},
                field.plane(0), {window.rows.first, window.cols.first}, serial);
        coarser = std::move(field);
    }
    return coarser;
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
        const std::int32_t top =
            (block_of(row) + static_cast<std::int32_t>(number / across)) * kBlockSide;
        const std::int32_t left =
            (block_of(col) + static_cast<std::int32_t>(number % across)) * kBlockSide;
        const Result<Image> drawn = draw_block(seed, plane, top, left);
        if (!drawn) {
            results[number] = drawn.error();
            return;
        }
        const Image& block = *drawn;
        const std::int32_t from_row = std::max(top, row);
        const std::int32_t to_row = std::min(top + kBlockSide, end_row);
        const std::int32_t from_col = std::max(left, col);
        const std::int32_t to_col = std::min(left + kBlockSide, end_col);
        for (std::int32_t r = from_row; r < to_row; ++r)
            std::copy_n(
                block.plane(0).row(static_cast<std::size_t>(r - top)) + (from_col - left),
                static_cast<std::size_t>(to_col - from_col),
                out.row(static_cast<std::size_t>(r - row)) + (from_col - col));
    });
    for (Result<void>& result : results) SATEEN_CHECK(std::move(result));
    return {};
}

}  // namespace sateen
