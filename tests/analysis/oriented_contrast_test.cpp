// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/oriented_contrast.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

// L = 50 + 10 N(0, 1), a value a site.
Image noise(std::size_t rows, std::size_t cols) {
    Image L(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        float* row = L.plane(0).row(r);
        draw_normals({7, 0}, static_cast<std::int32_t>(r), 0, {row, cols});
        for (std::size_t c = 0; c < cols; ++c) row[c] = 50.0F + 10.0F * row[c];
    }
    return L;
}

OrientedContrast contrast_of(const Image& L) {
    return oriented_contrast(L.view().plane(0));
}

TEST(OrientedContrast, IsTheRootMeanSquareDifferenceByDefinition) {
    constexpr std::array<std::array<int, 2>, 4> kUpwards = {
        {{0, 3}, {2, 2}, {3, 0}, {2, -2}}};
    const Image L = noise(23, 31);
    const OrientedContrast found = contrast_of(L);
    for (std::size_t k = 0; k < 4; ++k) {
        double sum = 0;
        double count = 0;
        for (int r = 0; r < 23; ++r) {
            for (int c = 0; c < 31; ++c) {
                const int r2 = r - kUpwards[k][0];
                const int c2 = c + kUpwards[k][1];
                if (r2 < 0 || c2 < 0 || c2 >= 31) continue;
                const auto at = [&](int row, int col) {
                    return static_cast<double>(L.view().plane(0)(
                        static_cast<std::size_t>(row), static_cast<std::size_t>(col)));
                };
                sum += std::pow(at(r, c) - at(r2, c2), 2);
                ++count;
            }
        }
        // L is rounded to 0.39.
        EXPECT_NEAR(found[k], std::sqrt(sum / count / 2), 0.02);
    }
}

TEST(OrientedContrast, OfWhiteNoiseIsItsStandardDeviation) {
    // 65 000 differences: a standard error of 0.04.
    for (const double value : contrast_of(noise(256, 256))) EXPECT_NEAR(value, 10, 0.2);
}

TEST(OrientedContrast, SeesTheDirectionOfStripes) {
    Image columns(1, 60, 60);
    Image diagonals(1, 60, 60);
    for (std::size_t r = 0; r < 60; ++r) {
        for (std::size_t c = 0; c < 60; ++c) {
            columns(0, r, c) = c / 3 % 2 == 0 ? 20.0F : 60.0F;
            // Constant where c + r is: along 45°, upwards to the right.
            diagonals(0, r, c) = (r + c) / 4 % 2 == 0 ? 20.0F : 60.0F;
        }
    }
    EXPECT_NEAR(contrast_of(columns)[0], 40 / std::sqrt(2.0), 0.2);
    EXPECT_EQ(contrast_of(columns)[2], 0.0);
    EXPECT_EQ(contrast_of(diagonals)[1], 0.0);
    EXPECT_NEAR(contrast_of(diagonals)[3], 40 / std::sqrt(2.0), 0.2);
}

TEST(OrientedContrast, OfAPlaneTooSmallForAStepIsZero) {
    for (const std::size_t rows : {1U, 2U, 3U}) {
        for (const std::size_t cols : {1U, 2U, 3U}) {
            const OrientedContrast found = contrast_of(noise(rows, cols));
            EXPECT_EQ(found[0], 0.0);
            EXPECT_EQ(found[2], 0.0);
        }
    }
}

TEST(OrientedContrast, OfALongRowDoesNotOverflow) {
    Image L(1, 1, 100003);
    for (std::size_t c = 0; c < 100003; ++c) L(0, 0, c) = c / 3 % 2 == 0 ? 0.0F : 100.0F;
    EXPECT_NEAR(contrast_of(L)[0], 100 / std::sqrt(2.0), 1e-6);
}

}  // namespace
}  // namespace sateen
