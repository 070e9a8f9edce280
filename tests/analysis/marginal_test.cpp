// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/marginal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "sateen/core/normal.hpp"
#include "synthesis/appearance.hpp"

namespace sateen {
namespace {

double normal_cdf(double g) {
    return 0.5 * std::erfc(-g / std::numbers::sqrt2);
}

/// f of independent standard normal values.
Image plane_of(const std::function<float(float)>& f, std::size_t side = 128,
               std::uint64_t seed = 1) {
    Image image(1, side, side);
    for (std::size_t r = 0; r < side; ++r)
        draw_normals({seed, 0}, static_cast<std::int32_t>(r), 0,
                     {image.plane(0).row(r), side});
    for (float& value : image.values()) value = f(value);
    return image;
}

MarginalDistribution distribution_of(const Image& image) {
    const std::vector<PlaneView<const float>> planes = {image.plane(0)};
    return MarginalDistribution(planes);
}

std::vector<float> gaussianised(const Image& image) {
    Image out(1, image.rows(), image.cols());
    distribution_of(image).gaussianise(image.plane(0), out.plane(0));
    return {out.values().begin(), out.values().end()};
}

/// What the curve makes of standard normal values, in units of its scale: their mean and
/// variance, by the sum over 10^5 quantiles.
struct Moments {
    double mean = 0;
    double variance = 0;
};
Moments moments_of(Marginal marginal) {
    marginal.scale = 1;
    constexpr std::size_t kSamples = 100000;
    Subspace subspace;
    subspace.spectral = {Tone::linear, {0}, {1}};
    subspace.spectral.mean[0] = 100;  // out of the way of the clip at 0
    subspace.marginals = {marginal};
    Image plane(1, 1, kSamples);
    for (std::size_t i = 0; i < kSamples; ++i)
        plane.values()[i] = static_cast<float>(
            normal_quantile((static_cast<double>(i) + 0.5) / kSamples));
    SerialExecutor executor;
    invert_spectral(subspace, plane.view(), executor);
    Moments moments;
    for (const float value : plane.values())
        moments.mean += (static_cast<double>(value) - 100) / kSamples;
    for (const float value : plane.values()) {
        const double centred = static_cast<double>(value) - 100 - moments.mean;
        moments.variance += centred * centred / kSamples;
    }
    return moments;
}

TEST(NormalQuantile, EqualsTabulatedValues) {
    EXPECT_NEAR(normal_quantile(0.5), 0, 1e-15);
    EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
    EXPECT_NEAR(normal_quantile(0.84134474606854293), 1, 1e-12);
    EXPECT_NEAR(normal_quantile(0.0013498980316300933), -3, 1e-12);
    EXPECT_NEAR(normal_quantile(1e-9), -5.997807015008182, 1e-11);
    EXPECT_NEAR(normal_quantile(1e-20), -9.262340089798408, 1e-9);
}

TEST(NormalQuantile, InvertsTheDistributionFunction) {
    for (double g = -6; g <= 6; g += 0.01)
        ASSERT_NEAR(normal_quantile(normal_cdf(g)), g, g > 5 ? 1e-7 : 1e-9) << g;
}

// Kolmogorov-Smirnov at the level of 1 %: sup |F_n - Φ| < 1.63 / √n. Ranks are no
// independent draws: they do far better unless ties are wide.
TEST(Gaussianise, MakesContinuousPlanesNormal) {
    const auto skewed = [](float g) { return std::exp(g); };
    const auto bimodal = [](float g) { return g > 0 ? 3 + 0.1F * g : 0.1F * g; };
    for (const auto& f :
         {std::function<float(float)>(skewed), std::function<float(float)>(bimodal)}) {
        std::vector<float> values = gaussianised(plane_of(f));
        std::ranges::sort(values);
        double furthest = 0;
        const auto n = static_cast<double>(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double F = normal_cdf(static_cast<double>(values[i]));
            furthest = std::max({furthest, std::abs(F - static_cast<double>(i) / n),
                                 std::abs(F - static_cast<double>(i + 1) / n)});
        }
        EXPECT_LT(furthest, 1.63 / std::sqrt(n));
    }
}

TEST(Gaussianise, IsMonotoneAndGivesTiesOneValue) {
    const Image plane = plane_of([](float g) { return std::round(2 * g); });
    const std::vector<float> g = gaussianised(plane);
    for (std::size_t i = 1; i < 2000; ++i) {
        const float before = plane.values()[i - 1];
        const float now = plane.values()[i];
        if (now == before) {
            ASSERT_EQ(g[i], g[i - 1]);
        } else {
            ASSERT_EQ(now > before, g[i] > g[i - 1]);
        }
    }
}

TEST(Gaussianise, HasMeanZeroForEveryContinuousPlane) {
    for (const float power : {1.0F, 3.0F}) {
        double sum = 0;
        for (const float g : gaussianised(
                 plane_of([&](float x) { return std::pow(std::abs(x), power); })))
            sum += static_cast<double>(g);
        EXPECT_NEAR(sum / 16384, 0, 1e-3);
    }
}

TEST(FitCurve, OfAGaussianPlaneIsAStraightLine) {
    const Image plane = plane_of([](float g) { return 7 + 0.3F * g; }, 512);
    const Marginal curve = distribution_of(plane).fit_curve();
    EXPECT_NEAR(static_cast<double>(curve.scale), 0.3, 0.002);
    ASSERT_EQ(curve.knots.size(), Marginal::kKnots);
    // The outermost knots see 0.2 % of the plane, and the clamp beyond ±3.
    for (std::size_t j = 1; j + 1 < Marginal::kKnots; ++j) {
        const double g = -3 + 6 * static_cast<double>(j) / (Marginal::kKnots - 1);
        EXPECT_NEAR(static_cast<double>(curve.knots[j]), g, 0.03) << j;
    }
    EXPECT_NEAR(static_cast<double>(curve.knots.back()), 3, 0.25);
}

TEST(FitCurve, KeepsMeanAndVariance) {
    struct Case {
        std::function<float(float)> f;
        double lost;  ///< share of the variance that 16 knots may lose
    };
    const Case cases[] = {
        {[](float g) { return 2 * g; }, 0.01},
        {[](float g) { return g * g * g / 3; }, 0.08},
        {[](float g) { return std::exp(0.5F * g); }, 0.02},
        {[](float g) { return std::round(2 * g) / 2; }, 0.05},
        {[](float g) { return g > 0.5F ? 1.0F + 0.1F * g : 0.1F * g; }, 0.06},
    };
    for (const Case& c : cases) {
        const MarginalDistribution distribution = distribution_of(plane_of(c.f, 256));
        const Marginal curve = distribution.fit_curve();
        const Moments moments = moments_of(curve);
        EXPECT_NEAR(moments.mean, 0, 0.002);
        EXPECT_LT(moments.variance, 1.01);
        EXPECT_GT(moments.variance, 1 - c.lost);
        EXPECT_TRUE(std::ranges::is_sorted(curve.knots));
    }
}

TEST(FitCurve, IsMonotoneForAnyPlane) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        // Few values, in few clumps, with outliers.
        const Image plane = plane_of(
            [&](float g) {
                const float clump =
                    std::round(g * static_cast<float>(seed % 5)) + 0.001F * g;
                return std::abs(g) > 2 ? 100 * clump : clump;
            },
            2 + seed % 9, seed);
        const auto distribution = distribution_of(plane);
        if (distribution.standard_deviation() == 0) continue;
        const Marginal curve = distribution.fit_curve();
        EXPECT_TRUE(std::ranges::is_sorted(curve.knots)) << seed;
        for (const float knot : curve.knots) EXPECT_TRUE(std::isfinite(knot));
        EXPECT_NEAR(moments_of(curve).mean, 0, 0.01) << seed;
    }
}

TEST(MarginalDistribution, TwoColoursStayTwoColours) {
    Image plane(1, 10, 10);
    for (std::size_t i = 0; i < 30; ++i) plane.values()[i] = 1;
    const auto distribution = distribution_of(plane);
    EXPECT_NEAR(distribution.mean(), 0.3, 1e-7);
    EXPECT_NEAR(distribution.standard_deviation(), std::sqrt(0.21), 1e-7);
    // The mid-ranks of the two groups.
    const auto g = gaussianised(plane);
    EXPECT_FLOAT_EQ(g.front(), static_cast<float>(normal_quantile(0.85)));
    EXPECT_FLOAT_EQ(g.back(), static_cast<float>(normal_quantile(0.35)));
    // A step at Φ⁻¹(0.7) = 0.52, as steep as the knots allow, and flat on both sides.
    const Marginal curve = distribution.fit_curve();
    EXPECT_TRUE(std::ranges::is_sorted(curve.knots));
    const double low = -0.3 / std::sqrt(0.21);
    const double high = 0.7 / std::sqrt(0.21);
    for (const std::size_t j : {0U, 3U, 7U})
        EXPECT_NEAR(static_cast<double>(curve.knots[j]), low, 0.15) << j;
    for (const std::size_t j : {10U, 13U, 15U})
        EXPECT_NEAR(static_cast<double>(curve.knots[j]), high, 0.15) << j;
}

TEST(MarginalDistribution, OfAConstantPlaneHasNoDeviation) {
    Image plane(1, 3, 3);
    for (float& value : plane.values()) value = -2.5F;
    const auto distribution = distribution_of(plane);
    EXPECT_EQ(distribution.mean(), -2.5);
    EXPECT_EQ(distribution.standard_deviation(), 0);
    EXPECT_THAT(gaussianised(plane), testing::Each(0.0F));
    EXPECT_TRUE(distribution.without_curve().knots.empty());
    EXPECT_EQ(distribution.without_curve().scale, 0);
}

TEST(MarginalDistribution, PoolsPlanes) {
    const Image a = plane_of([](float g) { return g; }, 20, 2);
    const Image b = plane_of([](float g) { return 5 + g; }, 10, 3);
    const std::vector<PlaneView<const float>> both = {a.plane(0), b.plane(0)};
    const MarginalDistribution pooled(both);
    const auto mean_a = distribution_of(a).mean();
    const auto mean_b = distribution_of(b).mean();
    EXPECT_NEAR(pooled.mean(), (400 * mean_a + 100 * mean_b) / 500, 1e-9);
}

TEST(MarginalDistribution, MeanAndDeviationAreThoseOfThePlane) {
    const Image plane = plane_of([](float g) { return 0.1F * std::exp(g); });
    const auto distribution = distribution_of(plane);
    double sum = 0;
    double squares = 0;
    for (const float value : plane.values()) {
        sum += static_cast<double>(value);
        squares += static_cast<double>(value) * static_cast<double>(value);
    }
    const double mean = sum / 16384;
    EXPECT_NEAR(distribution.mean(), mean, 1e-12);
    // Bins are 0.2 % wide.
    EXPECT_NEAR(distribution.standard_deviation(),
                std::sqrt(squares / 16384 - mean * mean), 1e-4 * mean);
}

}  // namespace
}  // namespace sateen
