// SPDX-License-Identifier: Apache-2.0
#include "sateen/core/periodic_part.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>

#include "reference/dft.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using reference::ComplexPlane;

/// A ramp both ways, a wave and noise: nothing about it is periodic.
Image slope(std::size_t rows, std::size_t cols) {
    std::mt19937 engine(static_cast<unsigned>(rows * 1000 + cols));
    std::uniform_real_distribution<float> uniform(-0.01F, 0.01F);
    Image image(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < cols; ++c) {
            const float x = static_cast<float>(c) / static_cast<float>(cols);
            const float y = static_cast<float>(r) / static_cast<float>(rows);
            image(0, r, c) =
                0.5F + x - 2 * y + 0.1F * std::sin(7 * x + 9 * y) + uniform(engine);
        }
    }
    return image;
}

Image periodic(const Image& image, Executor& executor) {
    Image out(1, image.rows(), image.cols());
    EXPECT_TRUE(periodic_part(image.plane(0), out.plane(0), executor).has_value());
    return out;
}

/// The definition in double: the jump of every pair of neighbours that the torus adds,
/// DFT, division, inverse DFT.
ComplexPlane naive_periodic_part(const Image& u) {
    const std::size_t rows = u.rows();
    const std::size_t cols = u.cols();
    const auto at = [&](std::size_t r, std::size_t c) {
        return static_cast<double>(u(0, r, c));
    };
    ComplexPlane v(rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < cols; ++c) {
            if (r == 0) v(r, c) += at(rows - 1, c) - at(r, c);
            if (r == rows - 1) v(r, c) += at(0, c) - at(r, c);
            if (c == 0) v(r, c) += at(r, cols - 1) - at(r, c);
            if (c == cols - 1) v(r, c) += at(r, 0) - at(r, c);
        }
    }
    ComplexPlane s = reference::dft2d(v);
    for (std::size_t q = 0; q < rows; ++q) {
        for (std::size_t n = 0; n < cols; ++n) {
            const double tau = 2 * std::numbers::pi;
            const double y = tau * static_cast<double>(q) / static_cast<double>(rows);
            const double x = tau * static_cast<double>(n) / static_cast<double>(cols);
            s(q, n) /= q + n == 0 ? 1 : 2 * std::cos(y) + 2 * std::cos(x) - 4;
        }
    }
    s(0, 0) = 0;
    s = reference::dft2d(s, 1);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < cols; ++c) {
            s(r, c) = at(r, c) - s(r, c) / static_cast<double>(rows * cols);
        }
    }
    return s;
}

double mean(const Image& image) {
    return std::accumulate(image.values().begin(), image.values().end(), 0.0) /
           static_cast<double>(image.plane_size());
}

TEST(PeriodicPart, EqualsTheDefinition) {
    SerialExecutor executor;
    for (const auto& [rows, cols] : {std::pair<std::size_t, std::size_t>{1, 1},
                                     {1, 12},
                                     {12, 1},
                                     {2, 2},
                                     {3, 2},
                                     {25, 27},
                                     {48, 64},
                                     {90, 75}}) {
        const Image image = slope(rows, cols);
        const Image found = periodic(image, executor);
        const ComplexPlane expected = naive_periodic_part(image);
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < cols; ++c) {
                ASSERT_NEAR(found(0, r, c), expected(r, c).real(), 2e-6)
                    << rows << " x " << cols << ": " << r << ' ' << c;
            }
        }
    }
}

TEST(PeriodicPart, KeepsTheMean) {
    SerialExecutor executor;
    const Image image = slope(96, 120);
    EXPECT_NEAR(mean(periodic(image, executor)), mean(image), 1e-6);
}

TEST(PeriodicPart, LeavesAConstantAlone) {
    SerialExecutor executor;
    Image image(1, 20, 30);
    std::ranges::fill(image.values(), 0.3F);
    EXPECT_TRUE(std::ranges::equal(periodic(image, executor).values(), image.values()));
}

TEST(PeriodicPart, ClosesTheSeams) {
    SerialExecutor executor;
    const std::size_t rows = 128;
    const std::size_t cols = 160;
    const Image found = periodic(slope(rows, cols), executor);
    const auto rms_step = [&](std::size_t from, std::size_t to) {
        double sum = 0;
        for (std::size_t r = 0; r < rows; ++r) {
            sum += std::pow(static_cast<double>(found(0, r, to) - found(0, r, from)), 2);
        }
        return std::sqrt(sum / static_cast<double>(rows));
    };
    EXPECT_LT(rms_step(cols - 1, 0), 1.5 * rms_step(cols / 2, cols / 2 + 1));
}

TEST(PeriodicPart, WithBandsRemovesARampAsWhole) {
    SerialExecutor executor;
    Image ramp(1, 64, 80);
    for (std::size_t r = 0; r < 64; ++r)
        for (std::size_t c = 0; c < 80; ++c)
            ramp(0, r, c) = 0.01F * static_cast<float>(c) - 0.02F * static_cast<float>(r);
    Image out(1, 64, 80);
    ASSERT_TRUE(periodic_part(ramp.plane(0), out.plane(0), executor, 0.125).has_value());
    const Image whole = periodic(ramp, executor);
    for (std::size_t i = 0; i < out.values().size(); ++i)
        ASSERT_NEAR(out.values()[i], whole.values()[i], 1e-5);
}

// Ribs that fill the torus exactly: their neighbours across the border differ as much as
// anywhere, which is no reason to add a ramp.
TEST(PeriodicPart, WithBandsLeavesRibsAlone) {
    SerialExecutor executor;
    Image ribs(1, 128, 128);
    for (std::size_t r = 0; r < 128; ++r)
        for (std::size_t c = 0; c < 128; ++c)
            ribs(0, r, c) = static_cast<float>(
                std::sin(2 * std::numbers::pi * 16 * static_cast<double>(c) / 128 + 0.7));
    Image out(1, 128, 128);
    ASSERT_TRUE(periodic_part(ribs.plane(0), out.plane(0), executor, 0.125).has_value());
    for (std::size_t i = 0; i < out.values().size(); ++i)
        ASSERT_NEAR(out.values()[i], ribs.values()[i], 1e-4);
}

TEST(PeriodicPart, WorksInPlaceAndWithAnyExecutor) {
    SerialExecutor serial;
    test::ThreadedExecutor threaded(3);
    Image image = slope(135, 100);
    const Image expected = periodic(image, serial);
    ASSERT_TRUE(periodic_part(image.plane(0), image.plane(0), threaded).has_value());
    EXPECT_TRUE(std::ranges::equal(image.values(), expected.values()));
}

TEST(PeriodicPart, RefusesOtherSizes) {
    SerialExecutor executor;
    Image image(1, 7, 8);
    const auto result = periodic_part(image.plane(0), image.plane(0), executor);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace sateen
