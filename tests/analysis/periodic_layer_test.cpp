// SPDX-License-Identifier: Apache-2.0
// The periodic layer of patterns that are known.
#include "analysis/periodic_layer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "analysis/fold.hpp"
#include "analysis/smooth_field.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/material/cell_table.hpp"
#include "support/patterns.hpp"

namespace sateen {
namespace {

constexpr std::size_t kSide = 256;
constexpr double kTau = 2 * std::numbers::pi;

/// A sinusoidal wave of the columns' positions, in pixels.
double bend(double row) {
    return 2.5 * std::sin(kTau * row / 170);
}

/// A pattern on the lattice (0, 24), (18, 6), bent along the columns, under white noise.
Image bent_pattern(double noise, std::size_t planes) {
    std::mt19937_64 engine(3);
    std::normal_distribution<double> normal;
    Image image(planes, kSide, kSide);
    for (std::size_t plane = 0; plane < planes; ++plane)
        for (std::size_t r = 0; r < kSide; ++r)
            for (std::size_t c = 0; c < kSide; ++c) {
                const double v = static_cast<double>(r) / 18;
                const double x = static_cast<double>(c) + bend(static_cast<double>(r));
                const double u = (x - 6 * v) / 24;
                const double value = std::cos(kTau * u) + 0.7 * std::cos(kTau * v) +
                                     0.4 * std::cos(kTau * (u - v) + 1);
                image(plane, r, c) = static_cast<float>((plane == 0 ? 1.0 : 0.5) * value +
                                                        noise * normal(engine));
            }
    return image;
}

double variance(PlaneView<const float> plane) {
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        sum += static_cast<double>(plane.data[i]);
        squares +=
            static_cast<double>(plane.data[i]) * static_cast<double>(plane.data[i]);
    }
    const auto n = static_cast<double>(plane.size());
    return squares / n - sum / n * (sum / n);
}

TEST(PeriodicLayerFit, TakesTheWholePatternAndLeavesTheNoise) {
    SerialExecutor executor;
    const Image image = bent_pattern(0.5, 1);
    const auto aligned = align_layer(image, executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    const auto cells = fold_mean_cells({&image, 1}, **aligned, executor);
    const Image residual =
        std::move(residuals_of({&image, 1}, **aligned, cells, executor).front());
    // Var of the pattern is (1 + .49 + .16)/2 = .825, of the noise .25.
    EXPECT_NEAR(variance(image.plane(0)), 0.825 + 0.25, 0.02);
    EXPECT_NEAR(variance(residual.plane(0)), 0.25, 0.03);
    // Energy of the pattern, by Parseval over its coefficients, and of the residual add up.
    double energy = 0;
    for (std::size_t k = 1; k < cells[0].coefficients.size(); ++k) {
        const double q = static_cast<double>(cells[0].step) * cells[0].coefficients[k];
        energy += 2 * q * q;
    }
    EXPECT_NEAR(energy + variance(residual.plane(0)), variance(image.plane(0)), 0.03);
}

TEST(PeriodicLayerFit, FollowsTheBend) {
    SerialExecutor executor;
    const auto aligned = align_layer(bent_pattern(0.3, 1), executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    const Image& D = (*aligned)->displacements.front();
    // Up to what is affine of the bend, which went into the basis, and a shift.
    double along = 0;
    double expected = 0;
    double bends = 0;
    for (std::size_t r = 30; r < kSide - 30; ++r) {
        const double row = static_cast<double>(r);
        const double second = static_cast<double>(D(1, r - 30, 128)) -
                              2 * static_cast<double>(D(1, r, 128)) +
                              static_cast<double>(D(1, r + 30, 128));
        const double wanted = bend(row - 30) - 2 * bend(row) + bend(row + 30);
        along += second * wanted;
        expected += wanted * wanted;
        bends += second * second;
    }
    EXPECT_NEAR(along / expected, 1, 0.25);
    EXPECT_GT(along / std::sqrt(expected * bends), 0.9);
}

TEST(PeriodicLayerFit, GivesEveryPlaneItsOwnCell) {
    SerialExecutor executor;
    const Image image = bent_pattern(0.2, 3);
    const auto aligned = align_layer(image, executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    const auto cells = fold_mean_cells({&image, 1}, **aligned, executor);
    ASSERT_EQ(cells.size(), 3U);
    const Image residual =
        std::move(residuals_of({&image, 1}, **aligned, cells, executor).front());
    for (std::size_t plane = 0; plane < 3; ++plane)
        EXPECT_NEAR(variance(residual.plane(plane)), 0.04, 0.02);
}

TEST(PeriodicLayerFit, FindsWhereTheNoiseIs) {
    // Noise where cos 2πu > 0 only: s² is 2 there and 0 elsewhere, before the lower bound.
    SerialExecutor executor;
    Image image = bent_pattern(0, 1);
    std::mt19937_64 engine(4);
    std::normal_distribution<double> normal;
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c) {
            const double v = static_cast<double>(r) / 18;
            const double x = static_cast<double>(c) + bend(static_cast<double>(r));
            if (std::cos(kTau * (x - 6 * v) / 24) > 0)
                image(0, r, c) += static_cast<float>(0.4 * normal(engine));
        }
    const auto aligned = align_layer(image, executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    auto cells = fold_mean_cells({&image, 1}, **aligned, executor);
    auto residual = residuals_of({&image, 1}, **aligned, cells, executor);
    fold_residual(**aligned, cells, residual, executor);
    const auto [low, high] = std::ranges::minmax(cells[0].deviations);
    EXPECT_GT(static_cast<double>(cells[0].deviation_step) * high, 1.25);
    EXPECT_LT(static_cast<double>(cells[0].deviation_step) * low, 0.5);
}

TEST(PeriodicLayerFit, FindsHowColoursVaryTogether) {
    // r_1 = ±r_0 where cos 2πv is positive or negative: uncorrelated over the cell.
    SerialExecutor executor;
    Image image = bent_pattern(0, 2);
    std::mt19937_64 engine(14);
    std::normal_distribution<double> normal;
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c) {
            const double noise = 0.4 * normal(engine);
            const double sign = std::cos(kTau * static_cast<double>(r) / 18) > 0 ? 1 : -1;
            image(0, r, c) += static_cast<float>(noise);
            image(1, r, c) +=
                static_cast<float>(0.5 * sign * noise + 0.05 * normal(engine));
        }
    const auto aligned = align_layer(image, executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    auto cells = fold_mean_cells({&image, 1}, **aligned, executor);
    auto residual = residuals_of({&image, 1}, **aligned, cells, executor);
    const double before = variance(residual[0].plane(1));
    fold_residual(**aligned, cells, residual, executor);
    EXPECT_TRUE(cells[0].mixing.empty());
    ASSERT_FALSE(cells[1].mixing.empty());
    const auto [low, high] = std::ranges::minmax(cells[1].mixing);
    // Read linearly between three sites, ±½ is smeared.
    EXPECT_GT(static_cast<double>(cells[1].mixing_step) * high, 0.2);
    EXPECT_LT(static_cast<double>(cells[1].mixing_step) * low, -0.2);
    EXPECT_LT(variance(residual[0].plane(1)), 0.8 * before);
}

TEST(PeriodicLayerFit, LeavesIndependentColoursAlone) {
    SerialExecutor executor;
    const Image image = bent_pattern(0.5, 3);
    const auto aligned = align_layer(image, executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    auto cells = fold_mean_cells({&image, 1}, **aligned, executor);
    auto residual = residuals_of({&image, 1}, **aligned, cells, executor);
    fold_residual(**aligned, cells, residual, executor);
    for (const PeriodicCell& cell : cells) EXPECT_EQ(cell.mixing_step, 0);
}

Image window_of(const Image& image, std::size_t row, std::size_t col, std::size_t side) {
    Image part(image.bands(), side, side);
    for (std::size_t band = 0; band < image.bands(); ++band)
        for (std::size_t r = 0; r < side; ++r)
            for (std::size_t c = 0; c < side; ++c)
                part(band, r, c) = image(band, row + r, col + c);
    return part;
}

TEST(PeriodicLayerJoin, PhotographsOfOnePatternShareItsCell) {
    SerialExecutor executor;
    const Image whole = bent_pattern(0.5, 2);
    const std::vector<Image> photographs = {
        window_of(whole, 0, 0, 160), window_of(whole, 83, 91, 160), Image(2, 160, 160),
        window_of(whole, 71, 10, 170)};
    std::vector<std::optional<AlignedLayer>> layers;
    for (const Image& photograph : photographs)
        layers.push_back(*align_layer(photograph, executor));
    EXPECT_FALSE(layers[2].has_value());
    const auto joined = join_layers(std::move(layers), photographs, executor);
    ASSERT_TRUE(joined.has_value());
    EXPECT_EQ(joined->photographs, (std::vector<std::size_t>{0, 1, 3}));
    const std::vector<Image> used = {photographs[0], photographs[1], photographs[3]};
    const auto cells = fold_mean_cells(used, *joined, executor);
    const auto residuals = residuals_of(used, *joined, cells, executor);
    for (const Image& residual : residuals) {
        EXPECT_NEAR(variance(residual.plane(0)), 0.25, 0.05);
        EXPECT_NEAR(variance(residual.plane(1)), 0.25, 0.05);
    }
}

TEST(PeriodicLayerJoin, LeavesOutPhotographsOfAnotherPattern) {
    SerialExecutor executor;
    constexpr std::size_t kLarge = 340;
    // The same lattice, another cell; and another lattice.
    const Image tiles = test::photograph_of(test::tiles(), kLarge, kLarge, 1, 0.02, 1);
    Image inverted = tiles;
    for (float& value : inverted.values()) value = 1 - value;
    const std::vector<Image> photographs = {
        tiles, std::move(inverted),
        test::photograph_of(test::brick(), kLarge, kLarge, 1, 0.02, 1)};
    std::vector<Image> first_bands;
    for (const Image& photograph : photographs) {
        Image& band = first_bands.emplace_back(1, kLarge, kLarge);
        std::copy_n(photograph.plane(0).data, band.plane_size(), band.plane(0).data);
    }
    std::vector<std::optional<AlignedLayer>> layers;
    for (const Image& photograph : first_bands) {
        layers.push_back(*align_layer(photograph, executor));
        ASSERT_TRUE(layers.back().has_value());
    }
    layers[0]->periodicity = 1;
    const auto joined = join_layers(std::move(layers), first_bands, executor);
    ASSERT_TRUE(joined.has_value());
    EXPECT_EQ(joined->photographs, std::vector<std::size_t>{0});
}

/// |vector - nearest lattice point|.
double off_lattice(const std::array<float, 2>& vector, const test::Pattern& pattern) {
    if (pattern.b[0] == 0 && pattern.b[1] == 0) {  // stripes: across them alone
        const double turns = static_cast<double>(vector[1]) / pattern.a[1];
        return std::abs(turns - std::round(turns)) * pattern.a[1];
    }
    const LatticeMap map(pattern.a, pattern.b);
    const auto cell =
        map.to_cell(static_cast<double>(vector[0]), static_cast<double>(vector[1]));
    const double k = cell[0] - std::round(cell[0]);
    const double l = cell[1] - std::round(cell[1]);
    return std::hypot(k * pattern.a[0] + l * pattern.b[0],
                      k * pattern.a[1] + l * pattern.b[1]);
}

// The constants of the alignment were set on three photographs; these patterns are none of
// them. What is left of each is the grain, and less than that again of edges.
TEST(PeriodicLayerFit, FollowsPatternsThatItsConstantsWereNotSetOn) {
    SerialExecutor executor;
    for (const test::Pattern& pattern : test::patterns()) {
        const Image photograph = test::photograph_of(pattern, 400, 400, 1.5, 0.03, 2);
        Image plane(1, 400, 400);
        for (std::size_t i = 0; i < plane.plane_size(); ++i)
            plane.plane(0).data[i] = static_cast<float>(
                srgb_encode(static_cast<double>(photograph.plane(0).data[i])));
        const auto aligned = align_layer(plane, executor);
        ASSERT_TRUE(aligned && aligned->has_value()) << pattern.name;
        const PeriodicLayer& layer = (*aligned)->layer;
        EXPECT_LT(off_lattice(layer.a, pattern), 0.25) << pattern.name;
        EXPECT_LT(off_lattice(layer.b, pattern), 0.25) << pattern.name;
        const double area = std::abs(
            static_cast<double>(layer.a[0] * layer.b[1] - layer.a[1] * layer.b[0]));
        const double known =
            std::abs(pattern.a[0] * pattern.b[1] - pattern.a[1] * pattern.b[0]);
        if (known > 0) {
            EXPECT_NEAR(area / known, 1, 0.02) << pattern.name;
        }
        const auto cells = fold_mean_cells({&plane, 1}, **aligned, executor);
        const auto residuals = residuals_of({&plane, 1}, **aligned, cells, executor);
        // Of the first band, see photograph_of().
        const double grain = 1.3 * 0.03;
        EXPECT_LT(variance(residuals[0].plane(0)), 2 * grain * grain) << pattern.name;
    }
}

TEST(PeriodicLayerFit, TheCurvesGiveTheMarginalOfThePlane) {
    SerialExecutor executor;
    Image image = bent_pattern(0.3, 1);
    // Brightness clipped, as in a photograph.
    for (float& value : image.values()) value = std::min(value, 0.6F);
    const auto aligned = align_layer(image, executor);
    ASSERT_TRUE(aligned && aligned->has_value());
    auto cells = fold_mean_cells({&image, 1}, **aligned, executor);
    auto residual = residuals_of({&image, 1}, **aligned, cells, executor);
    fold_residual(**aligned, cells, residual, executor);
    const std::vector<Marginal> marginals = {
        {static_cast<float>(std::sqrt(variance(residual[0].plane(0)))), {}}};
    fit_tone_curves({&image, 1}, (*aligned)->layer, marginals, cells);
    const ToneCurve& curve = cells[0].curve;
    ASSERT_EQ(curve.values.size(), ToneCurve::kKnots);
    EXPECT_TRUE(std::ranges::is_sorted(curve.values));
    EXPECT_LE(curve.values.back(), 0.61F);
    // Draws of the model against pixels of the plane, below and above what is clipped.
    const CellTable table((*aligned)->layer, cells);
    std::mt19937_64 engine(9);
    std::normal_distribution<float> normal(0, marginals[0].scale);
    std::vector<float> drawn;
    for (std::size_t r = 0; r < table.rows(); ++r)
        for (std::size_t c = 0; c < table.cols(); ++c)
            for (int k = 0; k < 20; ++k)
                drawn.push_back(apply(
                    curve, table.site(r, c)[0] +
                               table.site(r, c)[CellTable::kPlanes] * normal(engine)));
    const auto share_below = [](std::span<const float> values, float limit) {
        const auto below =
            std::ranges::count_if(values, [&](float v) { return v < limit; });
        return static_cast<double>(below) / static_cast<double>(values.size());
    };
    for (const float limit : {-1.2F, -0.6F, 0.0F, 0.4F, 0.55F})
        EXPECT_NEAR(share_below(drawn, limit), share_below(image.values(), limit), 0.03)
            << limit;
}

TEST(SmoothFieldFit, FindsTheScalesOfAField) {
    // Sums of bells at random places have the covariance of one scale: s of the field is that
    // of the bells, whose own shape is exp(-r²/2s²).
    SerialExecutor executor;
    std::mt19937_64 engine(8);
    std::normal_distribution<double> normal;
    constexpr std::size_t kN = 160;
    Image white(1, kN + 40, kN + 40);
    for (float& value : white.values()) value = static_cast<float>(normal(engine));
    Image sample(1, kN, kN);
    const double down = 4;
    const double across = 1;
    for (std::size_t r = 0; r < kN; ++r)
        for (std::size_t c = 0; c < kN; ++c) {
            double sum = 0;
            for (int i = -16; i <= 16; ++i)
                for (int j = -4; j <= 4; ++j)
                    sum +=
                        std::exp(-i * i / (2 * down * down) -
                                 j * j / (2 * across * across)) *
                        static_cast<double>(white(0, r + static_cast<std::size_t>(20 + i),
                                                  c + static_cast<std::size_t>(20 + j)));
            sample(0, r, c) = static_cast<float>(sum);
        }
    const SmoothField field =
        fit_smooth_field(*covariances_of(sample.plane(0), executor));
    double total = 0;
    for (const std::uint8_t weight : field.weights) total += weight;
    EXPECT_GT(field.weights[2 * SmoothField::kScales] / total, 0.6);
    EXPECT_NEAR(static_cast<double>(field.deviation),
                std::sqrt(variance(sample.plane(0))), 0.3);
    EXPECT_EQ(fit_smooth_field(*covariances_of(Image(1, 20, 20).plane(0), executor)),
              SmoothField{});
}

}  // namespace
}  // namespace sateen
