// SPDX-License-Identifier: Apache-2.0
// Band modulation estimated: nothing where amplitudes vary as Gaussian ones do, and what was
// put in where they do not.
#include "analysis/band_modulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <utility>
#include <vector>

#include "material/modulate.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

constexpr std::size_t kSide = 256;

using Density = std::function<double(double row, double col)>;

/// A Gaussian field of a density over frequencies in cycles per pixel, of variance 1.
Image gaussian(std::uint64_t seed, const Density& density) {
    SerialExecutor executor;
    const Fft2d fft = *Fft2d::create(kSide, kSide);
    Image field(1, kSide, kSide);
    for (std::size_t r = 0; r < kSide; ++r)
        draw_normals({seed, 0}, static_cast<std::int32_t>(r), 0,
                     {field.plane(0).row(r), kSide});
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(field.plane(0), spectrum.view(), executor);
    for (std::size_t m = 0; m < kSide; ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            const double row = static_cast<double>(std::min(m, kSide - m)) / kSide;
            const double col = static_cast<double>(n) / kSide;
            const auto root =
                static_cast<float>(m + n == 0 ? 0 : std::sqrt(density(row, col)));
            spectrum.view().re(m, n) *= root;
            spectrum.view().im(m, n) *= root;
        }
    fft.inverse(spectrum.view(), field.plane(0), executor);
    double squares = 0;
    for (const float value : field.values())
        squares += static_cast<double>(value) * static_cast<double>(value);
    const auto unit = static_cast<float>(std::sqrt(kSide * kSide / squares));
    for (float& value : field.values()) value *= unit;
    return field;
}

double fractal(double row, double col) {
    return 1 / (0.001 + row * row + col * col);
}

ModulationFit fitted(const Image& planes) {
    SerialExecutor executor;
    std::vector<Marginal> marginals;
    for (std::size_t k = 0; k < planes.bands(); ++k) {
        const PlaneView<const float> view = planes.plane(k);
        marginals.push_back(MarginalDistribution({&view, 1}).fit_curve());
    }
    return *fit_band_modulation(planes, marginals, {}, executor);
}

// The excess of a Gaussian field is its sampling error; the largest of these 40 is 0.042, and
// the gate for 256 x 256 pixels is at 0.050.
TEST(BandModulationFit, FindsNothingInGaussianFields) {
    const Density kinds[] = {fractal, [](double, double) { return 1.0; },
                             [](double row, double col) {
                                 return std::exp(-200 * (row * row + 0.1 * col * col));
                             },
                             [](double row, double col) {
                                 const double ring = std::hypot(row, col) - 0.12;
                                 return std::exp(-800 * ring * ring) + 0.01;
                             }};
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        for (const Density& density : kinds)
            for (const bool skewed : {false, true}) {
                Image field = gaussian(seed, density);
                if (skewed)
                    for (float& value : field.values()) value = std::exp(0.6F * value);
                EXPECT_LT(fitted(field).excess, least_excess(kSide * kSide));
            }
}

TEST(BandModulationFit, FindsTheFieldsThatWerePutIn) {
    SerialExecutor executor;
    BandModulation truth;
    for (SmoothField& field : truth.fields) field.deviation = 0.5F;
    SubspaceModulation curves;
    curves.bands.resize(BandModulation::kLevels);
    curves.units = {1};
    // Clumps of about 30 pixels.
    const Image clumps = gaussian(99, [](double row, double col) {
        return std::exp(-6000 * (row * row + col * col));
    });
    Image planes = gaussian(1, fractal);
    modulate_bands(
        truth, curves,
        [&](std::size_t, PlaneView<float> out, Executor&) {
            for (std::size_t i = 0; i < out.size(); ++i)
                out.data[i] = 0.5F * clumps.values()[i];
        },
        Border::wrap, planes.view(), executor);
    const ModulationFit fit = fitted(planes);
    // A variance of 0.25 in every band, less what the windows of the energies smooth away.
    EXPECT_GT(fit.excess, 0.08);
    EXPECT_LT(fit.excess, 0.3);
    // The finer bands may follow the coarsest by their curves, which itself needs a field.
    EXPECT_GT(fit.modulation.fields.fields[3].deviation, 0.2F);
    EXPECT_LT(fit.modulation.fields.fields[3].deviation, 0.8F);
}

TEST(BandModulationFit, FindsFinerBandsThatFollowTheCoarserOnes) {
    SerialExecutor executor;
    SubspaceModulation curves;
    curves.bands.resize(BandModulation::kLevels);
    curves.units = {1};
    Image planes = gaussian(2, fractal);
    ModulatedBand& band = curves.bands[0];
    band.value_scale = 1.0F;
    for (std::size_t j = 0; j < AmplitudeCurve::kKnots; ++j)
        band.of_value.values[j] = static_cast<std::int8_t>(16 * static_cast<int>(j) - 56);
    modulate_bands({}, curves, nullptr, Border::wrap, planes.view(), executor);
    const ModulationFit fit = fitted(planes);
    EXPECT_GT(fit.excess, 0.01);
    // 16 steps a knot were put in, of a coarser field that is not of variance 1, and bands that
    // overlap show less of them.
    const auto& found = fit.modulation.curves.bands[0].of_value.values;
    for (std::size_t j = 2; j < 5; ++j) {
        EXPECT_GT(found[j + 1] - found[j], 3) << j;
        EXPECT_LT(found[j + 1] - found[j], 21) << j;
    }
    for (std::size_t j = 2; j < 6; ++j)
        EXPECT_LT(std::abs(fit.modulation.curves.bands[3].of_value.values[j]), 14) << j;
}

TEST(BandModulationFit, KeepsTheVarianceOfTheBandsAndTheMarginals) {
    SerialExecutor executor;
    const Image planes = gaussian(3, fractal);
    const ModulationFit fit = fitted(planes);
    ASSERT_EQ(fit.modulation.curves.bands.size(), BandModulation::kLevels);
    for (const ModulatedBand& band : fit.modulation.curves.bands)
        EXPECT_NEAR(band.gain, 1, 0.1);
    EXPECT_NEAR(fit.modulation.curves.units[0], 1, 0.1);
    for (std::size_t j = 2; j + 2 < Marginal::kKnots; ++j)
        EXPECT_NEAR(fit.marginals[0].knots[j],
                    -Marginal::kRange + 0.4F * static_cast<float>(j), 0.15F);
}

}  // namespace
}  // namespace sateen
