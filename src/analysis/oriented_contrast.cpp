// SPDX-License-Identifier: Apache-2.0
// Oriented contrast of an image. See oriented_contrast.hpp.
#include "sateen/analysis/oriented_contrast.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "sateen/core/colour.hpp"

namespace sateen {
namespace {

// Steps (rows, cols) of nearly one length. Rows point down, directions count upwards.
struct Step {
    std::size_t rows;
    std::ptrdiff_t cols;
};
constexpr std::array<Step, 4> kSteps = {{{0, 3}, {2, -2}, {3, 0}, {2, 2}}};

// L of all pixels in 0 … 255. std::max with the constant first gives 0 for NaN.
std::vector<std::int16_t> quantised_lightness(ImageView<const float> image) {
    constexpr std::size_t kBlock = 512;
    constexpr float kScale = 255.0F / 100.0F;
    const auto& weight = kRelativeXyzOfLinearSrgb[1];
    const auto red = static_cast<float>(weight[0]);
    const auto green = static_cast<float>(weight[1]);
    const auto blue = static_cast<float>(weight[2]);
    const std::size_t count = image.plane_size();
    std::vector<std::int16_t> quantised(count);
    std::array<float, kBlock> Y;
    std::array<float, kBlock> L;
    for (std::size_t at = 0; at < count; at += kBlock) {
        const std::size_t size = std::min(kBlock, count - at);
        const float* first = image.data + at;
        if (image.bands == 1) {
            std::copy_n(first, size, Y.begin());
        } else {
            for (std::size_t i = 0; i < size; ++i)
                Y[i] = red * first[i] + green * first[i + count] +
                       blue * first[i + 2 * count];
        }
        lightness_from_linear(std::span(Y).first(size), std::span(L).first(size));
        for (std::size_t i = 0; i < size; ++i) {
            const float x = std::max(0.0F, L[i] * kScale + 0.5F);
            quantised[at + i] = static_cast<std::int16_t>(std::min(x, 255.0F));
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
            const int d = a[i] - b[i];
            sum += d * d;
        }
        total += static_cast<std::uint64_t>(sum);
    }
    return total;
}

}  // namespace

OrientedContrast oriented_contrast(ImageView<const float> image) {
    assert(image.bands == 1 || image.bands == 3);
    const std::vector<std::int16_t> L = quantised_lightness(image);
    OrientedContrast contrast = {};
    for (std::size_t k = 0; k < kSteps.size(); ++k) {
        const auto across = static_cast<std::size_t>(std::abs(kSteps[k].cols));
        if (image.rows <= kSteps[k].rows || image.cols <= across) continue;
        const std::size_t rows = image.rows - kSteps[k].rows;
        const std::size_t cols = image.cols - across;
        // Steps to the left start at the right end.
        const std::size_t from = kSteps[k].cols < 0 ? across : 0;
        const std::size_t to = kSteps[k].cols < 0 ? 0 : across;
        std::uint64_t sum = 0;
        for (std::size_t r = 0; r < rows; ++r) {
            sum += squared_difference(&L[r * image.cols + from],
                                      &L[(r + kSteps[k].rows) * image.cols + to], cols);
        }
        const double mean = static_cast<double>(sum) / static_cast<double>(rows * cols);
        contrast[k] = std::sqrt(mean / 2.0) * (100.0 / 255.0);
    }
    return contrast;
}

}  // namespace sateen
