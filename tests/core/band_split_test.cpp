// SPDX-License-Identifier: Apache-2.0
// Octave bands by short filters, against their definition.
#include "sateen/core/band_split.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "reference/band_modulation.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

Image noise(std::size_t rows, std::size_t cols) {
    Image image(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        draw_normals({7, 0}, static_cast<std::int32_t>(r), 0,
                     {image.plane(0).row(r), cols});
    return image;
}

void expect_near(const Image& found, const reference::Plane& expected) {
    for (std::size_t i = 0; i < found.values().size(); ++i)
        ASSERT_NEAR(static_cast<double>(found.values()[i]), expected.values[i], 2e-6);
}

// Sizes below the reach of the filters, odd ones, and of whole vectors.
constexpr std::pair<std::size_t, std::size_t> kSizes[] = {{3, 5}, {16, 32}, {37, 41}};

TEST(BandSplit, IsTheConvolutionItSays) {
    SerialExecutor executor;
    for (const Border border : {Border::wrap, Border::mirror})
        for (const auto& [rows, cols] : kSizes)
            for (const std::size_t spacing : {1U, 2U, 8U}) {
                const Image in = noise(rows, cols);
                Image rest(1, rows, cols);
                Image out(1, rows, cols);
                split_band(in.plane(0), spacing, border, rest.plane(0), out.plane(0),
                           executor);
                expect_near(
                    out, reference::smoothed(reference::plane_of(in.plane(0)),
                                             static_cast<std::int64_t>(spacing), border));
                for (std::size_t i = 0; i < in.values().size(); ++i)
                    ASSERT_EQ(rest.values()[i], in.values()[i] - out.values()[i]);
            }
}

TEST(BandSplit, BandsAddUpToThePlane) {
    SerialExecutor executor;
    const Image plane = noise(40, 48);
    Image sum(1, 40, 48);
    Image from = plane;
    for (std::size_t spacing = 1; spacing <= 8; spacing *= 2) {
        Image rest(1, 40, 48);
        Image low(1, 40, 48);
        split_band(from.plane(0), spacing, Border::wrap, rest.plane(0), low.plane(0),
                   executor);
        for (std::size_t i = 0; i < sum.values().size(); ++i)
            sum.values()[i] += rest.values()[i];
        from = std::move(low);
    }
    for (std::size_t i = 0; i < sum.values().size(); ++i)
        ASSERT_NEAR(sum.values()[i] + from.values()[i], plane.values()[i], 2e-6F);
}

TEST(LocalEnergy, IsTheSmoothedSquare) {
    SerialExecutor executor;
    const Image band = noise(37, 41);
    for (std::size_t level = 0; level < 4; ++level) {
        Image work(1, 37, 41);
        Image out(1, 37, 41);
        local_energy(band.plane(0), level, Border::wrap, work.plane(0), out.plane(0),
                     executor);
        expect_near(out, reference::energy_of(reference::plane_of(band.plane(0)), level,
                                              Border::wrap));
    }
}

TEST(LocalEnergy, OfAPlainWaveIsItsMeanSquare) {
    // At the frequency where the band passes most, the square has no ripple left to speak of.
    SerialExecutor executor;
    for (std::size_t level = 1; level < 4; ++level) {
        const std::size_t period = std::size_t{4} << level;
        Image wave(1, 64, 64);
        for (std::size_t r = 0; r < 64; ++r)
            for (std::size_t c = 0; c < 64; ++c)
                wave(0, r, c) = static_cast<float>(
                    std::sin(2 * 3.14159265358979 * static_cast<double>(c) /
                             static_cast<double>(period)));
        Image work(1, 64, 64);
        Image out(1, 64, 64);
        local_energy(wave.plane(0), level, Border::wrap, work.plane(0), out.plane(0),
                     executor);
        for (const float value : out.values()) EXPECT_NEAR(value, 0.5F, 0.04F);
    }
}

TEST(BandSplit, WhatIsFurtherFromTheBorderThanItsReachDoesNotDependOnIt) {
    SerialExecutor executor;
    const Image in = noise(60, 70);
    Image a(2, 60, 70);
    Image b(2, 60, 70);
    split_band(in.plane(0), 4, Border::wrap, a.plane(0), a.plane(1), executor);
    split_band(in.plane(0), 4, Border::mirror, b.plane(0), b.plane(1), executor);
    for (std::size_t r = 8; r < 52; ++r)
        for (std::size_t c = 8; c < 62; ++c) ASSERT_EQ(a(1, r, c), b(1, r, c));
}

}  // namespace
}  // namespace sateen
