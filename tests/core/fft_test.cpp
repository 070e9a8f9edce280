// SPDX-License-Identifier: Apache-2.0
#include "sateen/core/fft.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "reference/dft.hpp"
#include "support/simd_targets.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

using reference::ComplexPlane;

// Relative root mean square error against double; single precision gives 1e-7 to 3e-7.
constexpr double kTolerance = 1e-6;

Image noise(std::size_t bands, std::size_t rows, std::size_t cols, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    Image image(bands, rows, cols);
    for (float& value : image.values()) value = uniform(engine);
    return image;
}

ComplexPlane widened(SplitComplexView<const float> plane) {
    ComplexPlane out(plane.re.rows, plane.re.cols);
    for (std::size_t r = 0; r < out.rows; ++r) {
        for (std::size_t c = 0; c < out.cols; ++c) {
            out(r, c) = {static_cast<double>(plane.re(r, c)),
                         static_cast<double>(plane.im(r, c))};
        }
    }
    return out;
}

ComplexPlane widened(PlaneView<const float> plane) {
    ComplexPlane out(plane.rows, plane.cols);
    for (std::size_t r = 0; r < out.rows; ++r) {
        for (std::size_t c = 0; c < out.cols; ++c) {
            out(r, c) = static_cast<double>(plane(r, c));
        }
    }
    return out;
}

ComplexPlane widened(const SplitComplexPlane& plane) {
    return widened(plane.view());
}

/// ‖found - expected‖ / ‖expected‖ over the columns of `found`, the first of `expected`.
double relative_error(const ComplexPlane& found, const ComplexPlane& expected) {
    double error = 0;
    double norm = 0;
    for (std::size_t r = 0; r < found.rows; ++r) {
        for (std::size_t c = 0; c < found.cols; ++c) {
            error += std::norm(found(r, c) - expected(r, c));
            norm += std::norm(expected(r, c));
        }
    }
    return std::sqrt(error / norm);
}

SplitComplexPlane forward(const Image& image, Executor& executor) {
    const Fft2d fft = *Fft2d::create(image.rows(), image.cols());
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(image.plane(0), spectrum.view(), executor);
    return spectrum;
}

Image inverse(SplitComplexPlane spectrum, std::size_t cols, Executor& executor) {
    const Fft2d fft = *Fft2d::create(spectrum.rows(), cols);
    Image image(1, fft.rows(), cols);
    fft.inverse(spectrum.view(), image.plane(0), executor);
    return image;
}

std::vector<std::size_t> sizes_to(std::size_t limit) {
    std::vector<std::size_t> sizes;
    for (std::size_t n = 1; n <= limit; ++n) {
        if (is_fft_size(n)) sizes.push_back(n);
    }
    return sizes;
}

/// Every kernel and every remainder: lines both ways, planes that are not whole blocks.
std::vector<std::pair<std::size_t, std::size_t>> shapes() {
    std::vector<std::pair<std::size_t, std::size_t>> shapes;
    for (const std::size_t n : sizes_to(64)) {
        shapes.emplace_back(1, n);
        shapes.emplace_back(n, 1);
        shapes.emplace_back(n, 40);
        shapes.emplace_back(45, n);
    }
    for (const auto& [rows, cols] : {std::pair<std::size_t, std::size_t>{3, 5},
                                     {15, 27},
                                     {16, 16},
                                     {25, 81},
                                     {32, 64},
                                     {75, 50},
                                     {125, 135},
                                     {128, 96},
                                     {405, 375},
                                     {160, 243}}) {
        shapes.emplace_back(rows, cols);
    }
    return shapes;
}

TEST(FftSize, AcceptsProductsOfTwoThreeAndFive) {
    const std::vector<std::size_t> expected = {1,  2,  3,  4,  5,  6,  8,  9,  10,
                                               12, 15, 16, 18, 20, 24, 25, 27, 30};
    EXPECT_EQ(sizes_to(31), expected);
    EXPECT_FALSE(is_fft_size(0));
}

TEST(FftSize, NearestSizesHoldTheMultiple) {
    EXPECT_EQ(fft_size_at_most(511), 500U);
    EXPECT_EQ(fft_size_at_most(511, 16), 480U);
    EXPECT_EQ(fft_size_at_most(512, 16), 512U);
    EXPECT_EQ(fft_size_at_most(15, 16), 0U);
    EXPECT_EQ(fft_size_at_most(0), 0U);
    EXPECT_EQ(fft_size_at_least(511), 512U);
    EXPECT_EQ(fft_size_at_least(513, 16), 576U);
    EXPECT_EQ(fft_size_at_least(7, 8), 8U);
    EXPECT_EQ(fft_size_at_least(0, 8), 8U);
    for (std::size_t n = 1; n < 2000; ++n) {
        const std::size_t low = fft_size_at_most(n, 4);
        const std::size_t high = fft_size_at_least(n, 4);
        EXPECT_TRUE(low <= n && low % 4 == 0 && (low == 0 || is_fft_size(low))) << n;
        EXPECT_TRUE(high >= n && high % 4 == 0 && is_fft_size(high)) << n;
        for (std::size_t m = low + 1; m < high; ++m) {
            EXPECT_TRUE(m == n || m % 4 != 0 || !is_fft_size(m)) << n << ' ' << m;
        }
    }
}

TEST(Fft2d, RefusesOtherSizesByName) {
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{7, 8}, {8, 14}, {0, 4}, {4, 0}}) {
        const auto fft = Fft2d::create(rows, cols);
        ASSERT_FALSE(fft.has_value());
        EXPECT_EQ(fft.error().code, Errc::invalid_argument);
        const std::string shape = std::to_string(rows) + " x " + std::to_string(cols);
        EXPECT_NE(fft.error().message.find(shape), std::string::npos);
        EXPECT_FALSE(Fft2dComplex::create(rows, cols).has_value());
    }
}

TEST(Fft2d, EqualsTheDefinitionBothWaysOnEverySimdTarget) {
    SerialExecutor executor;
    unsigned seed = 1;
    for (const auto& [rows, cols] : shapes()) {
        SCOPED_TRACE(testing::Message() << rows << " x " << cols);
        const Image image = noise(1, rows, cols, seed++);
        const ComplexPlane original = widened(image.plane(0));
        const ComplexPlane expected = reference::dft2d(original);
        test::for_each_simd_target([&] {
            const SplitComplexPlane found = forward(image, executor);
            ASSERT_EQ(found.cols(), image.cols() / 2 + 1);
            EXPECT_LT(relative_error(widened(found), expected), kTolerance);
            const Image back = inverse(found, image.cols(), executor);
            EXPECT_LT(relative_error(widened(back.plane(0)), original), kTolerance);
        });
    }
}

TEST(Fft2d, InverseOfTheDefinitionIsTheImage) {
    SerialExecutor executor;
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{27, 40}, {40, 27}, {1, 2}, {36, 1}}) {
        const Image image = noise(1, rows, cols, 1000);
        const ComplexPlane transformed = reference::dft2d(widened(image.plane(0)));
        SplitComplexPlane spectrum(rows, cols / 2 + 1);
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < spectrum.cols(); ++c) {
                spectrum.view().re(r, c) = static_cast<float>(transformed(r, c).real());
                spectrum.view().im(r, c) = static_cast<float>(transformed(r, c).imag());
            }
        }
        const Image found = inverse(std::move(spectrum), cols, executor);
        EXPECT_LT(relative_error(widened(found.plane(0)), widened(image.plane(0))),
                  kTolerance)
            << rows << " x " << cols;
    }
}

TEST(Fft2dComplex, EqualsTheDefinitionBothWaysOnEverySimdTarget) {
    SerialExecutor executor;
    unsigned seed = 2000;
    for (const auto& [rows, cols] : shapes()) {
        SCOPED_TRACE(testing::Message() << rows << " x " << cols);
        const Image image = noise(2, rows, cols, seed++);
        const ComplexPlane original = widened({image.plane(0), image.plane(1)});
        const ComplexPlane expected = reference::dft2d(original);
        const Fft2dComplex fft = *Fft2dComplex::create(rows, cols);
        test::for_each_simd_target([&] {
            Image copy = image;
            const SplitComplexView<float> plane = {copy.plane(0), copy.plane(1)};
            fft.forward(plane, executor);
            EXPECT_LT(relative_error(widened({plane.re, plane.im}), expected),
                      kTolerance);
            fft.inverse(plane, executor);
            EXPECT_LT(relative_error(widened({plane.re, plane.im}), original),
                      kTolerance);
        });
    }
}

TEST(Fft2d, KeepsEnergy) {
    SerialExecutor executor;
    const std::size_t rows = 96;
    const std::size_t cols = 90;
    const Image image = noise(1, rows, cols, 5);
    const ComplexPlane spectrum = widened(forward(image, executor));
    double energy = 0;
    for (const float value : image.values()) energy += std::pow(value, 2);
    double spectral = 0;
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < spectrum.cols; ++c) {
            const double weight = c == 0 || 2 * c == cols ? 1 : 2;
            spectral += weight * std::norm(spectrum(r, c));
        }
    }
    EXPECT_NEAR(spectral / (energy * static_cast<double>(rows * cols)), 1.0, 1e-6);
}

TEST(Fft2d, IsLinear) {
    SerialExecutor executor;
    const Image a = noise(1, 60, 72, 6);
    const Image b = noise(1, 60, 72, 7);
    Image sum(1, 60, 72);
    for (std::size_t i = 0; i < sum.values().size(); ++i) {
        sum.values()[i] = 2 * a.values()[i] - 3 * b.values()[i];
    }
    const ComplexPlane A = widened(forward(a, executor));
    const ComplexPlane B = widened(forward(b, executor));
    ComplexPlane expected(A.rows, A.cols);
    for (std::size_t i = 0; i < A.values.size(); ++i) {
        expected.values[i] = 2.0 * A.values[i] - 3.0 * B.values[i];
    }
    EXPECT_LT(relative_error(widened(forward(sum, executor)), expected), kTolerance);
}

TEST(Fft2d, InverseIgnoresWhatNoRealPlaneHas) {
    SerialExecutor executor;
    const std::size_t rows = 6;
    for (const std::size_t cols : {8U, 9U}) {
        const Image image = noise(1, rows, cols, 12);
        SplitComplexPlane spectrum = forward(image, executor);
        // Odd real and even imaginary parts in m: the transforms of imaginary columns.
        for (const std::size_t c : {std::size_t{0}, cols / 2}) {
            if (c != 0 && cols % 2 != 0) continue;
            spectrum.view().im(0, c) += 3;
            spectrum.view().re(1, c) += 2;
            spectrum.view().re(rows - 1, c) -= 2;
            spectrum.view().im(2, c) += 1;
            spectrum.view().im(rows - 2, c) += 1;
        }
        const Image found = inverse(std::move(spectrum), cols, executor);
        EXPECT_LT(relative_error(widened(found.plane(0)), widened(image.plane(0))),
                  kTolerance);
    }
}

TEST(Fft2d, GivesTheSameBytesForEveryExecutor) {
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{405, 375}, {256, 128}, {1, 50}, {50, 1}}) {
        const Image image = noise(1, rows, cols, 8);
        SerialExecutor serial;
        const SplitComplexPlane expected = forward(image, serial);
        const Image expected_image = inverse(expected, cols, serial);
        for (const std::size_t threads : {2U, 3U, 7U}) {
            test::ThreadedExecutor executor(threads);
            const SplitComplexPlane found = forward(image, executor);
            for (std::size_t r = 0; r < rows; ++r) {
                const std::size_t bytes = found.cols() * sizeof(float);
                EXPECT_EQ(
                    std::memcmp(found.view().re.row(r), expected.view().re.row(r), bytes),
                    0);
                EXPECT_EQ(
                    std::memcmp(found.view().im.row(r), expected.view().im.row(r), bytes),
                    0);
            }
            EXPECT_TRUE(std::ranges::equal(inverse(found, cols, executor).values(),
                                           expected_image.values()));
        }
    }
}

TEST(Fft2d, LeavesWhatIsOutsideTheViewsAlone) {
    SerialExecutor executor;
    const std::size_t rows = 50;
    const std::size_t cols = 45;
    const Fft2d fft = *Fft2d::create(rows, cols);
    Image frame = noise(1, rows + 3, cols + 7, 9);
    const Image frame_before = frame;
    const PlaneView<float> plane = frame.plane(0).window(1, 3, rows, cols);
    Image re = noise(1, rows + 2, fft.spectrum_cols() + 5, 10);
    Image im = noise(1, rows + 2, fft.spectrum_cols() + 11, 11);
    const Image re_before = re;
    const Image im_before = im;
    const SplitComplexView<float> spectrum = {
        re.plane(0).window(1, 2, rows, fft.spectrum_cols()),
        im.plane(0).window(2, 9, rows, fft.spectrum_cols())};
    const ComplexPlane original = widened(plane);

    fft.forward(plane, spectrum, executor);
    EXPECT_TRUE(std::ranges::equal(frame.values(), frame_before.values()));
    EXPECT_LT(
        relative_error(widened({spectrum.re, spectrum.im}), reference::dft2d(original)),
        kTolerance);
    std::ranges::fill(frame.values(), 0.0F);
    fft.inverse(spectrum, plane, executor);
    EXPECT_LT(relative_error(widened(plane), original), kTolerance);

    const auto expect_frame = [](const Image& now, const Image& before, std::size_t r0,
                                 std::size_t c0, std::size_t height, std::size_t width) {
        for (std::size_t r = 0; r < now.rows(); ++r) {
            for (std::size_t c = 0; c < now.cols(); ++c) {
                const bool inside =
                    r >= r0 && r < r0 + height && c >= c0 && c < c0 + width;
                if (inside) continue;
                EXPECT_EQ(now(0, r, c), before(0, r, c)) << r << ' ' << c;
            }
        }
    };
    expect_frame(frame, Image(1, frame.rows(), frame.cols()), 1, 3, rows, cols);
    expect_frame(re, re_before, 1, 2, rows, fft.spectrum_cols());
    expect_frame(im, im_before, 2, 9, rows, fft.spectrum_cols());
}

}  // namespace
}  // namespace sateen
