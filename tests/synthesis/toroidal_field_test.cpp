// SPDX-License-Identifier: Apache-2.0
#include "synthesis/toroidal_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "reference/stationary_field.hpp"
#include "support/materials.hpp"

namespace sateen {
namespace {

using reference::DoublePlane;

Image draw(const std::vector<Level>& levels, std::size_t rows, std::size_t cols,
           std::uint64_t seed, double sample = 64) {
    SerialExecutor executor;
    auto fft = Fft2d::create(rows, cols);
    EXPECT_TRUE(fft);
    std::vector<SplitComplexPlane> spectra;
    spectra.emplace_back(rows, fft->spectrum_cols());
    const auto gains =
        colour_noise({levels, 0, sample, sample}, cols, {seed, {}}, spectra, executor);
    Image plane(1, rows, cols);
    fft->inverse(spectra[0].view(), plane.plane(0), executor);
    for (float& value : plane.values()) value *= gains[0];
    return plane;
}

/// ŵ on the whole torus.
reference::ComplexPlane whole_noise(std::uint64_t seed, std::size_t rows,
                                    std::size_t cols) {
    SerialExecutor executor;
    SplitComplexPlane half(rows, cols / 2 + 1);
    draw_noise_spectrum({seed, 0}, cols, half.view(), executor);
    const SplitComplexView<const float> w = std::as_const(half).view();
    reference::ComplexPlane whole(rows, cols);
    for (std::size_t m = 0; m < rows; ++m)
        for (std::size_t n = 0; n < cols; ++n) {
            const bool inside = n <= cols / 2;
            const std::size_t row = inside ? m : (rows - m) % rows;
            const std::size_t col = inside ? n : cols - n;
            whole(m, n) = {static_cast<double>(w.re(row, col)),
                           static_cast<double>(w.im(row, col)) * (inside ? 1 : -1)};
        }
    return whole;
}

struct Moments {
    double mean = 0;
    double variance = 0;
};
Moments moments_of(const Image& plane) {
    const auto n = static_cast<double>(plane.plane_size());
    Moments moments;
    for (const float value : plane.values())
        moments.mean += static_cast<double>(value) / n;
    for (const float value : plane.values()) {
        const double centred = static_cast<double>(value) - moments.mean;
        moments.variance += centred * centred / n;
    }
    return moments;
}

TEST(NoiseSpectrum, IsOfRealWhiteNoise) {
    for (const auto& [rows, cols] : {std::pair{48U, 64U},
                                     {45U, 60U},
                                     {60U, 45U},
                                     {27U, 25U},
                                     {1U, 60U},
                                     {60U, 1U}}) {
        const reference::ComplexPlane sites =
            reference::dft2d(whole_noise(3, rows, cols), 1);
        const double count = rows * cols;
        // Parts of variance 1 add up to sites of variance 2 MN (no 1 / MN here); kurtosis and neighbours as
        // independent normal numbers have them, within 4 standard errors.
        double square = 0;
        double fourth = 0;
        double beside = 0;
        double below = 0;
        const auto site = [&](std::size_t r, std::size_t c) {
            return sites(r % rows, c % cols).real() / std::sqrt(2 * count);
        };
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c) {
                ASSERT_NEAR(sites(r, c).imag(), 0, 1e-9);
                const double value = site(r, c);
                square += value * value / count;
                fourth += value * value * value * value / count;
                beside += value * site(r, c + 1) / count;
                below += value * site(r + 1, c) / count;
            }
        const double error = 4 / std::sqrt(count);
        EXPECT_NEAR(square, 1, error * std::sqrt(2)) << rows << 'x' << cols;
        EXPECT_NEAR(fourth, 3, error * std::sqrt(96)) << rows << 'x' << cols;
        // A site alone in its line is its own neighbour.
        EXPECT_NEAR(beside, cols > 1 ? 0 : square, error) << rows << 'x' << cols;
        EXPECT_NEAR(below, rows > 1 ? 0 : square, error) << rows << 'x' << cols;
    }
}

// The columns that are their own mirror images, over seeds: power 2 as everywhere, parts of
// power 1 but where the number is real. 4 standard errors of 2000 draws.
TEST(NoiseSpectrum, HasTheSamePowerAtEveryFrequency) {
    constexpr int kDraws = 2000;
    constexpr std::size_t kRows = 6;
    constexpr std::size_t kCols = 4;
    std::vector<double> re(kRows * kCols);
    std::vector<double> im(kRows * kCols);
    for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
        const reference::ComplexPlane w = whole_noise(seed, kRows, kCols);
        for (std::size_t i = 0; i < w.values.size(); ++i) {
            re[i] += w.values[i].real() * w.values[i].real() / kDraws;
            im[i] += w.values[i].imag() * w.values[i].imag() / kDraws;
        }
    }
    const double error = 4 * std::sqrt(2.0 / kDraws);
    for (std::size_t m = 0; m < kRows; ++m)
        for (std::size_t n = 0; n < kCols; ++n) {
            const bool real = m % (kRows / 2) == 0 && n % (kCols / 2) == 0;
            EXPECT_NEAR(re[m * kCols + n], real ? 2 : 1, real ? 2 * error : error);
            EXPECT_NEAR(im[m * kCols + n], real ? 0 : 1, real ? 0 : error);
        }
}

TEST(ColourNoise, DrawsTheNoiseThatItCouldBeGiven) {
    const auto levels = test::levels_of(test::pyramid_of(test::half_plane_field(), 2));
    SerialExecutor executor;
    for (const auto& [rows, cols] : {std::pair{24U, 30U}, {15U, 25U}}) {
        std::vector<SplitComplexPlane> noise(1, SplitComplexPlane(rows, cols / 2 + 1));
        draw_noise_spectrum({7, 0}, cols, noise[0].view(), executor);
        std::vector<SplitComplexPlane> given(1, SplitComplexPlane(rows, cols / 2 + 1));
        std::vector<SplitComplexPlane> drawn = given;
        const PlaneField field{levels, 0, 24, 24};
        EXPECT_EQ(colour_noise(field, cols, {7, noise}, given, executor),
                  colour_noise(field, cols, {7, {}}, drawn, executor));
        for (std::size_t m = 0; m < rows; ++m)
            for (std::size_t n = 0; n <= cols / 2; ++n) {
                ASSERT_EQ(given[0].view().re(m, n), drawn[0].view().re(m, n));
                ASSERT_EQ(given[0].view().im(m, n), drawn[0].view().im(m, n));
            }
    }
}

TEST(ColourNoise, MakesMeanZeroAndVarianceOneExactly) {
    const auto levels = test::levels_of(test::pyramid_of(test::half_plane_field(), 3));
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        for (const auto& [rows, cols] :
             {std::pair{64U, 64U}, {27U, 45U}, {1U, 60U}, {48U, 1U}, {2U, 3U}}) {
            const Moments moments = moments_of(draw(levels, rows, cols, seed));
            EXPECT_NEAR(moments.mean, 0, 2e-6) << rows << 'x' << cols;
            EXPECT_NEAR(moments.variance, 1, 1e-5) << rows << 'x' << cols;
        }
    }
}

TEST(ColourNoise, LeavesNothingWithoutPower) {
    EXPECT_EQ(draw(test::levels_of({Car2d{}}), 8, 8, 1).values()[5], 0);
    // One site has no frequency but the origin.
    EXPECT_EQ(draw(test::levels_of({test::half_plane_field()}), 1, 1, 1)(0, 0, 0), 0);
}

TEST(ColourNoise, IsTheZeroPhaseRootOfTheDensity) {
    const Car2d field = test::half_plane_field();
    const Image plane = draw(test::levels_of({field}), 24, 30, 5, 8);
    // The same in double by the naive DFT, of noise that is written out.
    reference::ComplexPlane spectrum = whole_noise(5, 24, 30);
    for (std::size_t m = 0; m < 24; ++m) {
        for (std::size_t n = 0; n < 30; ++n) {
            const auto closeness = [](std::size_t k, double size) {
                const double cycles =
                    std::min(static_cast<double>(k), size - static_cast<double>(k));
                return std::max(0.0, 1 - cycles * 8 / size);
            };
            const double E = reference::density(field, reference::frequency(m, 24),
                                                reference::frequency(n, 30)) *
                             (1 - closeness(m, 24) * closeness(n, 30));
            spectrum(m, n) *= std::sqrt(E);
        }
    }
    spectrum = reference::dft2d(std::move(spectrum), 1);
    double squares = 0;
    for (const auto& value : spectrum.values) squares += value.real() * value.real();
    const double scale = std::sqrt(720 / squares);
    for (std::size_t i = 0; i < 720; ++i)
        ASSERT_NEAR(static_cast<double>(plane.values()[i]),
                    scale * spectrum.values[i].real(), 2e-5);
}

// Mean over draws against theory, in standard errors taken from the scatter of the draws.
// 40 lags at 3 sigma (0.3 %): none is expected beyond; one is allowed, none beyond 4.
TEST(ColourNoise, DrawsFieldsOfTheAutocovarianceOfTheDensity) {
    constexpr std::size_t kSide = 48;
    constexpr int kDraws = 100;
    constexpr int kReach = 4;
    const std::vector<Car2d> pyramid = {test::half_plane_field(),
                                        test::quarter_plane_field()};
    const auto levels = test::levels_of(pyramid);
    DoublePlane E =
        reference::density_on_torus(std::span<const Car2d>(pyramid), kSide, kSide);
    E(0, 0) = 0;
    const DoublePlane R = reference::autocovariance_of_density(E);
    std::vector<double> sums((kReach + 1) * (2 * kReach + 1));
    std::vector<double> squares(sums.size());
    for (int draw_number = 0; draw_number < kDraws; ++draw_number) {
        const DoublePlane plane = reference::to_double(
            draw(levels, kSide, kSide, static_cast<std::uint64_t>(draw_number), kSide)
                .plane(0));
        std::size_t i = 0;
        for (int row = 0; row <= kReach; ++row) {
            for (int col = -kReach; col <= kReach; ++col, ++i) {
                const double r = reference::autocovariance(plane, row, col);
                sums[i] += r;
                squares[i] += r * r;
            }
        }
    }
    int beyond = 0;
    std::size_t i = 0;
    for (int row = 0; row <= kReach; ++row) {
        for (int col = -kReach; col <= kReach; ++col, ++i) {
            if (row == 0 && col <= 0) continue;
            const double mean = sums[i] / kDraws;
            const double error =
                std::sqrt((squares[i] / kDraws - mean * mean) / (kDraws - 1));
            const double expected =
                R(static_cast<std::size_t>(row),
                  static_cast<std::size_t>((col + static_cast<int>(kSide)) %
                                           static_cast<int>(kSide))) /
                R(0, 0);
            const double sigmas = std::abs(mean - expected) / error;
            EXPECT_LT(sigmas, 4) << row << ',' << col;
            beyond += sigmas > 3 ? 1 : 0;
        }
    }
    EXPECT_LE(beyond, 1);
}

}  // namespace
}  // namespace sateen
