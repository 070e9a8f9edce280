// SPDX-License-Identifier: Apache-2.0
#include "sateen/goniometer/surface_maps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

Image noise(std::size_t rows, std::size_t cols) {
    Image image(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        draw_normals({1, 0}, static_cast<std::int32_t>(r), 0,
                     {image.plane(0).row(r), cols});
    return image;
}

double mean(const Image& image) {
    double sum = 0;
    for (const float v : image.values()) sum += static_cast<double>(v);
    return sum / static_cast<double>(image.values().size());
}

TEST(SurfaceMaps, NormalsOfAWaveAreThoseOfItsSlope) {
    Image height(1, 64, 64);
    for (std::size_t r = 0; r < 64; ++r)
        for (std::size_t c = 0; c < 64; ++c)
            height(0, r, c) = 2 * std::sin(kTurn * static_cast<float>(c) / 64) +
                              std::cos(kTurn * static_cast<float>(r) / 32);
    const Image normal = normals_of(height, 1, 1);
    for (std::size_t r = 0; r < 64; ++r)
        for (std::size_t c = 0; c < 64; ++c) {
            const float p = 2 * kTurn / 64 * std::cos(kTurn * static_cast<float>(c) / 64);
            // y goes up while rows go down.
            const float q = kTurn / 32 * std::sin(kTurn * static_cast<float>(r) / 32);
            const float length = std::sqrt(p * p + q * q + 1);
            EXPECT_NEAR(normal(0, r, c), -p / length, 2e-3F);
            EXPECT_NEAR(normal(1, r, c), -q / length, 2e-3F);
            EXPECT_NEAR(normal(2, r, c), 1 / length, 2e-3F);
        }
}

TEST(SurfaceMaps, ResamplingKeepsTheMeanAndCommutesWithShiftsOfTheTorus) {
    const Image fine = noise(48, 60);
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{24, 30}, {20, 12}, {96, 120}, {48, 60}}) {
        const Image other = resample(fine, rows, cols);
        EXPECT_NEAR(mean(other), mean(fine), 1e-5);
    }
    Image moved(1, 48, 60);
    for (std::size_t r = 0; r < 48; ++r)
        for (std::size_t c = 0; c < 60; ++c)
            moved(0, (r + 4) % 48, (c + 56) % 60) = fine(0, r, c);
    const Image a = resample(fine, 24, 30);
    const Image b = resample(moved, 24, 30);
    for (std::size_t r = 0; r < 24; ++r)
        for (std::size_t c = 0; c < 30; ++c)
            EXPECT_NEAR(b(0, (r + 2) % 24, (c + 28) % 30), a(0, r, c), 1e-5F);
}

TEST(SurfaceMaps, ResamplingToHalfTakesMeansOfFour) {
    const Image fine = noise(8, 8);
    const Image half = resample(fine, 4, 4);
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            EXPECT_NEAR(half(0, r, c),
                        (fine(0, 2 * r, 2 * c) + fine(0, 2 * r + 1, 2 * c) +
                         fine(0, 2 * r, 2 * c + 1) + fine(0, 2 * r + 1, 2 * c + 1)) /
                            4,
                        1e-6F);
}

TEST(SurfaceMaps, ResamplingToTheSameSizeChangesNothing) {
    const Image fine = noise(9, 7);
    const Image same = resample(fine, 9, 7);
    for (std::size_t i = 0; i < fine.values().size(); ++i)
        EXPECT_NEAR(same.values()[i], fine.values()[i], 1e-6F);
}

}  // namespace
}  // namespace sateen
