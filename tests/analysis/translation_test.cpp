// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/translation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sateen/core/fft.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

Marginal curve(double (*q)(double)) {
    Marginal marginal;
    for (std::size_t j = 0; j < Marginal::kKnots; ++j)
        marginal.knots.push_back(
            static_cast<float>(q(-3 + 6 * static_cast<double>(j) / 15)));
    return marginal;
}

TEST(CorrelationMap, OfAStraightLineIsTheIdentity) {
    const CorrelationMap map(curve([](double g) { return 0.5 * g; }));
    // Constant beyond ±3, so not quite straight.
    for (double rho = -1; rho <= 1; rho += 0.125) {
        EXPECT_NEAR(map.forward(rho), rho, 2e-3);
        EXPECT_NEAR(map.inverse(rho), rho, 2e-3);
    }
}

double value_of(const Marginal& marginal, double g) {
    const double x = (std::clamp(g, -3.0, 3.0) + 3) / 6 * 15;
    const auto j = std::min(static_cast<std::size_t>(x), std::size_t{14});
    const double fraction = x - static_cast<double>(j);
    return static_cast<double>(marginal.knots[j]) * (1 - fraction) +
           static_cast<double>(marginal.knots[j + 1]) * fraction;
}

/// E q(g) q(g') for normal values of correlation ρ, by quadrature over g and an independent h,
/// with g' = ρ g + √(1-ρ²) h.
double product_mean(const Marginal& marginal, double rho) {
    constexpr int kPoints = 800;
    constexpr double kStep = 16.0 / kPoints;
    double sum = 0;
    for (int i = 0; i <= kPoints; ++i)
        for (int k = 0; k <= kPoints; ++k) {
            const double g = -8 + kStep * i;
            const double h = -8 + kStep * k;
            sum += std::exp(-(g * g + h * h) / 2) * value_of(marginal, g) *
                   value_of(marginal, rho * g + std::sqrt(1 - rho * rho) * h);
        }
    return sum * kStep * kStep / (2 * std::numbers::pi);
}

TEST(CorrelationMap, IsTheDoubleIntegralItStandsFor) {
    const Marginal marginal = curve([](double g) { return std::exp(0.6 * g); });
    const CorrelationMap map(marginal);
    const double squared_mean = product_mean(marginal, 0);
    const double variance = product_mean(marginal, 1) - squared_mean;
    for (const double rho : {-0.9, -0.5, 0.0, 0.3, 0.7, 0.95})
        EXPECT_NEAR(map.forward(rho),
                    (product_mean(marginal, rho) - squared_mean) / variance, 1e-3);
}

TEST(CorrelationMap, InverseUndoesForward) {
    const CorrelationMap map(
        curve([](double g) { return g > 0.5 ? g * g * g : 0.1 * g; }));
    for (double rho = -0.95; rho <= 1; rho += 0.05)
        EXPECT_NEAR(map.inverse(map.forward(rho)), rho, 2e-3);
}

// The truth is a Gaussian field g of known correlation; q(g) is what would be measured. The
// plane found behind the curve must have the correlations of g, which those of q(g) are not.
TEST(GaussianBehindCurve, HasTheCorrelationsOfTheFieldThatWasCurved) {
    constexpr std::size_t kSide = 256;
    const Marginal marginal = curve([](double g) { return std::exp(0.5 * g); });
    Image noise(1, kSide, kSide);
    for (std::size_t r = 0; r < kSide; ++r)
        draw_normals({11, 0}, static_cast<std::int32_t>(r), 0,
                     {noise.plane(0).row(r), kSide});
    // g = (e(c) + e(c+1) + e(c+2)) / √3 on a torus: correlation 2/3, 1/3, 0.
    Image curved(1, kSide, kSide);
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c)
            curved(0, r, c) = std::exp(0.5F *
                                       (noise(0, r, c) + noise(0, r, (c + 1) % kSide) +
                                        noise(0, r, (c + 2) % kSide)) /
                                       std::numbers::sqrt3_v<float>);
    Image found(1, kSide, kSide);
    SerialExecutor executor;
    ASSERT_TRUE(
        gaussian_behind_curve(curved.plane(0), marginal, found.plane(0), executor));
    const auto correlation = [&](std::size_t lag) {
        double sum = 0;
        for (std::size_t r = 0; r < kSide; ++r)
            for (std::size_t c = 0; c < kSide; ++c)
                sum += static_cast<double>(found(0, r, c)) *
                       static_cast<double>(found(0, r, (c + lag) % kSide));
        return sum / (kSide * kSide);
    };
    // The sampling error of a correlation of 65536 sites is about 0.006 here.
    EXPECT_NEAR(correlation(0), 1, 1e-3);
    EXPECT_NEAR(correlation(1), 2.0 / 3, 0.03);
    EXPECT_NEAR(correlation(2), 1.0 / 3, 0.03);
    EXPECT_NEAR(correlation(3), 0, 0.03);
}

TEST(GaussianBehindCurve, RefusesAConstantPlane) {
    Image plane(1, 16, 16);
    SerialExecutor executor;
    const auto result = gaussian_behind_curve(
        plane.plane(0), curve([](double g) { return g; }), plane.plane(0), executor);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::singular);
}

}  // namespace
}  // namespace sateen
