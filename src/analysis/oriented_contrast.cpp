// SPDX-License-Identifier: Apache-2.0
// Oriented contrast of an image. See oriented_contrast.hpp.
#include "sateen/analysis/oriented_contrast.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace sateen {
namespace {

// Steps (rows, cols) of nearly one length. Rows point down, directions count upwards.
struct Step {
    std::size_t rows;
    std::ptrdiff_t cols;
};

std::array<Step, 4> steps_of(std::size_t length) {
    const auto diagonal = static_cast<std::size_t>(
        std::lround(static_cast<double>(length) / std::sqrt(2.0)));
    const auto cols = static_cast<std::ptrdiff_t>(diagonal);
    return {{{0, static_cast<std::ptrdiff_t>(length)},
             {diagonal, -cols},
             {length, 0},
             {diagonal, cols}}};
}

// L in 0 … 255. std::max with the constant first gives 0 for NaN.
std::vector<std::int16_t> quantise(PlaneView<const float> L) {
    constexpr float kScale = 255.0F / 100.0F;
    std::vector<std::int16_t> quantised(L.size());
    for (std::size_t r = 0; r < L.rows; ++r) {
        const float* from = L.row(r);
        std::int16_t* to = quantised.data() + r * L.cols;
        for (std::size_t c = 0; c < L.cols; ++c) {
            const float x = std::max(0.0F, from[c] * kScale + 0.5F);
            to[c] = static_cast<std::int16_t>(std::min(255.0F, x));
        }
    }
    return quantised;
}

// Σ (a_i - b_i)²; a row of 2^15 pixels fits into 32 bits.
std::uint64_t squared_difference(const std::int16_t* a, const std::int16_t* b,
                                 std::size_t count) {
    constexpr std::size_t kChunk = std::size_t{1} << 15U;
    std::uint64_t total = 0;
    for (std::size_t at = 0; at < count; at += kChunk) {
        const std::size_t end = std::min(count, at + kChunk);
        std::int32_t sum = 0;
        for (std::size_t i = at; i < end; ++i) {
            const auto d = static_cast<std::int16_t>(a[i] - b[i]);
            sum += d * d;
        }
        total += static_cast<std::uint64_t>(sum);
    }
    return total;
}

}  // namespace

OrientedContrast oriented_contrast(PlaneView<const float> L, std::size_t step) {
    const std::array<Step, 4> steps = steps_of(step);
    const std::vector<std::int16_t> quantised = quantise(L);
    OrientedContrast contrast = {};
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const auto across = static_cast<std::size_t>(std::abs(steps[k].cols));
        if (L.rows <= steps[k].rows || L.cols <= across) continue;
        const std::size_t rows = L.rows - steps[k].rows;
        const std::size_t cols = L.cols - across;
        // Steps to the left start at the right end.
        const std::size_t from = steps[k].cols < 0 ? across : 0;
        const std::size_t to = steps[k].cols < 0 ? 0 : across;
        std::uint64_t sum = 0;
        for (std::size_t r = 0; r < rows; ++r) {
            sum += squared_difference(
                quantised.data() + r * L.cols + from,
                quantised.data() + (r + steps[k].rows) * L.cols + to, cols);
        }
        const double mean = static_cast<double>(sum) / static_cast<double>(rows * cols);
        contrast[k] = std::sqrt(mean / 2.0) * (100.0 / 255.0);
    }
    return contrast;
}

}  // namespace sateen
