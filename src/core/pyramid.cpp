// SPDX-License-Identifier: Apache-2.0
// Reduction and expansion with the kernel [1 4 6 4 1]/16, a row at a time.
// Theory: docs/theory/pyramid.md.
#include "sateen/core/pyramid.hpp"

#include "core/pyramid_rows.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <string>
#include <utility>

namespace sateen {
namespace {

// Rows of the result in one piece of parallel work; does not affect the result.
constexpr std::size_t kRowsAtOnce = 32;

// body(first, last) over blocks of [0, rows).
template <class Body>
void for_row_blocks(Executor& executor, std::size_t rows, Body&& body) {
    const std::size_t blocks = (rows + kRowsAtOnce - 1) / kRowsAtOnce;
    parallel_for(executor, blocks, [&](std::size_t block) {
        const std::size_t first = block * kRowsAtOnce;
        body(first, std::min(rows, first + kRowsAtOnce));
    });
}

void expand_on_torus(PlaneView<const float> coarse, PlaneView<float> fine, Update update,
                     Executor& executor) {
    assert(fine.rows == 2 * coarse.rows && fine.cols == 2 * coarse.cols);
    const std::size_t rows = coarse.rows;
    const std::size_t cols = coarse.cols;
    for_row_blocks(executor, fine.rows, [&](std::size_t first, std::size_t last) {
        std::vector<float> line(cols + 2);
        for (std::size_t y = first; y < last; ++y) {
            const std::size_t i = y / 2;
            expand_rows(coarse.row((i + rows - 1) % rows), coarse.row(i),
                        coarse.row((i + 1) % rows), y % 2 == 1, line.data() + 1, cols);
            line[0] = line[cols];
            line[cols + 1] = line[1];
            expand_columns(line.data(), false, fine.row(y), fine.cols, update);
        }
    });
}

// Division by 2 that rounds down; C++20 shifts do.
std::int32_t half_below(std::int32_t x) {
    return x >> 1;
}
std::int32_t half_above(std::int32_t x) {
    return x / 2 + (x % 2 > 0 ? 1 : 0);
}

void expand_on_window(PlaneView<const float> coarse, LatticePoint coarse_origin,
                      PlaneView<float> fine, LatticePoint fine_origin, Update update,
                      Executor& executor) {
    if (fine.rows == 0 || fine.cols == 0) return;
    const LatticeRange cols = expand_support({fine_origin.col, fine.cols});
    assert(coarse_origin.col <= cols.first);
    const auto left = static_cast<std::size_t>(cols.first - coarse_origin.col);
    assert(left + cols.count <= coarse.cols);
    for_row_blocks(executor, fine.rows, [&](std::size_t first, std::size_t last) {
        std::vector<float> line(cols.count);
        for (std::size_t r = first; r < last; ++r) {
            const std::int32_t y = fine_origin.row + static_cast<std::int32_t>(r);
            const bool odd = y % 2 != 0;
            const auto i = static_cast<std::size_t>(half_below(y) - coarse_origin.row);
            const float* here = coarse.row(i) + left;
            const float* below = coarse.row(i + 1) + left;
            const float* above = odd ? here : coarse.row(i - 1) + left;
            expand_rows(above, here, below, odd, line.data(), cols.count);
            expand_columns(line.data(), fine_origin.col % 2 != 0, fine.row(r), fine.cols,
                           update);
        }
    });
}

Error not_divisible(const char* name, std::size_t size, std::size_t levels) {
    return {Errc::invalid_argument, "pyramid: " + std::to_string(levels) +
                                        " levels need " + name + " divisible by 2^" +
                                        std::to_string(levels - 1) + ", found " +
                                        std::to_string(size)};
}

}  // namespace

void reduce(PlaneView<const float> fine, PlaneView<float> coarse, Executor& executor) {
    assert(fine.rows == 2 * coarse.rows && fine.cols == 2 * coarse.cols);
    const std::size_t rows = fine.rows;
    const std::size_t cols = fine.cols;
    for_row_blocks(executor, coarse.rows, [&](std::size_t first, std::size_t last) {
        std::vector<float> line(cols + 5);  // one more is read in pairs
        float* const inside = line.data() + 2;
        for (std::size_t i = first; i < last; ++i) {
            const float* from[5];
            for (std::size_t tap = 0; tap < 5; ++tap) {
                from[tap] = fine.row((2 * i + tap + 2 * rows - 2) % rows);
            }
            reduce_rows(from, inside, cols);
            line[0] = inside[cols - 2];
            line[1] = inside[cols - 1];
            inside[cols] = inside[0];
            inside[cols + 1] = inside[1];
            reduce_columns(line.data(), coarse.row(i), coarse.cols);
        }
    });
}

void expand(PlaneView<const float> coarse, PlaneView<float> fine, Executor& executor) {
    expand_on_torus(coarse, fine, Update::assign, executor);
}

void expand_add(PlaneView<const float> coarse, PlaneView<float> fine,
                Executor& executor) {
    expand_on_torus(coarse, fine, Update::add, executor);
}

LatticeRange expand_support(LatticeRange fine) {
    const std::int32_t last = fine.first + static_cast<std::int32_t>(fine.count - 1);
    const std::int32_t first = half_above(fine.first) - 1;
    return {first, static_cast<std::size_t>(half_below(last) + 2 - first)};
}

void expand_window(PlaneView<const float> coarse, LatticePoint coarse_origin,
                   PlaneView<float> fine, LatticePoint fine_origin, Executor& executor) {
    expand_on_window(coarse, coarse_origin, fine, fine_origin, Update::assign, executor);
}

void expand_add_window(PlaneView<const float> coarse, LatticePoint coarse_origin,
                       PlaneView<float> fine, LatticePoint fine_origin,
                       Executor& executor) {
    expand_on_window(coarse, coarse_origin, fine, fine_origin, Update::add, executor);
}

Result<std::vector<Image>> decompose(ImageView<const float> image, std::size_t levels,
                                     Executor& executor) {
    constexpr std::size_t kMostLevels = 32;
    if (levels == 0 || levels > kMostLevels) {
        return Error{Errc::invalid_argument,
                     "pyramid: expected 1 to 32 levels, found " + std::to_string(levels)};
    }
    if (image.size() == 0) {
        return Error{Errc::invalid_argument, "pyramid: the image is empty"};
    }
    const std::size_t divisor = std::size_t{1} << (levels - 1);
    if (image.rows % divisor != 0) return not_divisible("rows", image.rows, levels);
    if (image.cols % divisor != 0) return not_divisible("columns", image.cols, levels);

    std::vector<Image> bands;
    bands.reserve(levels);
    bands.emplace_back(image.bands, image.rows, image.cols);
    std::copy_n(image.data, image.size(), bands[0].values().data());
    for (std::size_t k = 0; k + 1 < levels; ++k) {
        bands.emplace_back(image.bands, bands[k].rows() / 2, bands[k].cols() / 2);
        for (std::size_t plane = 0; plane < image.bands; ++plane) {
            reduce(std::as_const(bands[k]).plane(plane), bands[k + 1].plane(plane),
                   executor);
            expand_on_torus(std::as_const(bands[k + 1]).plane(plane),
                            bands[k].plane(plane), Update::subtract, executor);
        }
    }
    return bands;
}

Result<Image> collapse(std::vector<Image> levels, Executor& executor) {
    if (levels.empty()) {
        return Error{Errc::invalid_argument, "pyramid: there are no levels to collapse"};
    }
    for (std::size_t k = 1; k < levels.size(); ++k) {
        const Image& fine = levels[k - 1];
        const Image& coarse = levels[k];
        if (coarse.bands() == fine.bands() && 2 * coarse.rows() == fine.rows() &&
            2 * coarse.cols() == fine.cols() && !coarse.empty()) {
            continue;
        }
        const auto shape = [](const Image& image) {
            return std::to_string(image.bands()) + " x " + std::to_string(image.rows()) +
                   " x " + std::to_string(image.cols());
        };
        return Error{Errc::invalid_argument,
                     "pyramid: level " + std::to_string(k) + " is " + shape(coarse) +
                         ", expected half the size of level " + std::to_string(k - 1) +
                         ", " + shape(fine)};
    }
    while (levels.size() > 1) {
        const Image coarse = std::move(levels.back());
        levels.pop_back();
        for (std::size_t plane = 0; plane < coarse.bands(); ++plane) {
            expand_add(coarse.plane(plane), levels.back().plane(plane), executor);
        }
    }
    return std::move(levels.front());
}

}  // namespace sateen
