// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/gmrf2d.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/joint_field.hpp"
#include "sateen/analysis/whittle.hpp"
#include "sateen/material/file.hpp"
#include "support/fields.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

using reference::DoublePlane;

constexpr std::size_t kSide = 48;

Gmrf2d known_field() {
    return {{{0, 1}, {1, 0}, {1, -1}, {1, 1}}, {0.24F, 0.2F, -0.05F, 0.03F}, 0.7F};
}

Autocovariance covariance_of(const DoublePlane& S, int reach) {
    const DoublePlane R = reference::autocovariance_of_density(S);
    Autocovariance out(reach, static_cast<double>(S.values.size()));
    const auto wrap = [](int k, std::size_t n) {
        return static_cast<std::size_t>((k + static_cast<int>(n)) % static_cast<int>(n));
    };
    for (int row = 0; row <= reach; ++row)
        for (int col = -reach; col <= reach; ++col)
            out.at(row, col) = R(wrap(row, S.rows), wrap(col, S.cols));
    return out;
}

/// A spectrum as photographs have them, 1/f³ with two peaks.
DoublePlane photographic_spectrum(std::size_t side) {
    DoublePlane S(side, side);
    for (std::size_t m = 0; m < side; ++m)
        for (std::size_t n = 0; n < side; ++n) {
            const double w1 = 2 * std::sin(reference::frequency(m, side) / 2);
            const double w2 = 2 * std::sin(reference::frequency(n, side) / 2);
            const double peak = std::exp(-40 * (std::pow(std::abs(w1) - 0.9, 2) +
                                                std::pow(std::abs(w2) - 0.4, 2)));
            S(m, n) = 1e-3 + std::pow(w1 * w1 + w2 * w2 + 0.01, -1.5) + 50 * peak;
        }
    return S;
}

DoublePlane density_of(const NaturalGmrf2d& field, std::size_t side) {
    DoublePlane S(side, side);
    for (std::size_t m = 0; m < side; ++m)
        for (std::size_t n = 0; n < side; ++n) {
            double q = field.theta_0;
            for (std::size_t i = 0; i < field.theta.size(); ++i)
                q -= 2 * field.theta[i] *
                     std::cos(reference::frequency(m, side) * field.neighbourhood[i].row +
                              reference::frequency(n, side) * field.neighbourhood[i].col);
            S(m, n) = 1 / q;
        }
    return S;
}

TEST(Gmrf2d, MaximumLikelihoodReproducesTheCovariancesOfItsSupport) {
    for (const int order : {1, 2, 4, 6, 13}) {
        const auto offsets = hierarchical_half_plane(order);
        const Autocovariance R = covariance_of(photographic_spectrum(kSide), 10);
        const auto field = maximise_likelihood(R, offsets, {kSide, kSide});
        ASSERT_TRUE(field) << field.error().message;
        const Autocovariance model = covariance_of(density_of(*field, kSide), 10);
        EXPECT_NEAR(model.variance() / R.variance(), 1, 1e-6) << "order " << order;
        for (const Offset s : offsets)
            EXPECT_NEAR(model(s), R(s), 1e-6 * R.variance()) << "order " << order;
    }
}

// ℓ = ½ mean ln q - ½ (θ_0 R(0) - 2 Σ θ_s R(s)), frequency by frequency.
double log_likelihood(const NaturalGmrf2d& field, const Autocovariance& R) {
    const DoublePlane S = density_of(field, kSide);
    double sum = 0;
    for (const double value : S.values) {
        if (!(value > 0)) return -HUGE_VAL;
        sum -= std::log(value);
    }
    double fit = field.theta_0 * R.variance();
    for (std::size_t i = 0; i < field.theta.size(); ++i)
        fit -= 2 * field.theta[i] * R(field.neighbourhood[i]);
    return (sum / static_cast<double>(S.values.size()) - fit) / 2;
}

TEST(Gmrf2d, NoChangeOfAParameterRaisesTheLikelihood) {
    const Autocovariance R = covariance_of(photographic_spectrum(kSide), 6);
    const auto field = maximise_likelihood(R, hierarchical_half_plane(4), {kSide, kSide});
    ASSERT_TRUE(field);
    const double best = log_likelihood(*field, R);
    for (std::size_t i = 0; i <= field->theta.size(); ++i)
        for (const double step : {1e-4, -1e-4}) {
            NaturalGmrf2d moved = *field;
            (i == 0 ? moved.theta_0 : moved.theta[i - 1]) += step * field->theta_0;
            EXPECT_LT(log_likelihood(moved, R), best);
        }
}

// Mean over independent draws within 3 of its standard errors: of 5 parameters, one in 75
// runs would fail; the seeds are fixed.
template <class Estimate>
void expect_recovery(const Gmrf2d& truth, const Estimate& estimate) {
    const DoublePlane S = reference::density_on_torus(truth, kSide, kSide);
    constexpr int kDraws = 96;
    std::vector<double> sum(5);
    std::vector<double> squares(5);
    for (int draw = 0; draw < kDraws; ++draw) {
        const DoublePlane plane = reference::drawn(S, static_cast<std::uint64_t>(draw));
        const std::vector<double> found =
            estimate(test::direct_autocovariance(plane, 2), truth.neighbourhood);
        ASSERT_EQ(found.size(), 5U);
        for (std::size_t i = 0; i < 5; ++i) {
            sum[i] += found[i];
            squares[i] += found[i] * found[i];
        }
    }
    for (std::size_t i = 0; i < 5; ++i) {
        const double mean = sum[i] / kDraws;
        const double error =
            std::sqrt((squares[i] / kDraws - mean * mean) / (kDraws - 1));
        const auto expected = static_cast<double>(i == 4 ? truth.variance : truth.a[i]);
        EXPECT_NEAR(mean, expected, 3 * error) << "parameter " << i;
    }
}

TEST(Gmrf2d, RecoversKnownCoefficients) {
    expect_recovery(known_field(), [](const Autocovariance& R,
                                      const std::vector<Offset>& neighbourhood) {
        std::vector<double> found;
        const auto field = maximise_likelihood(R, neighbourhood, {kSide, kSide});
        if (!field) return found;
        for (const double theta : field->theta) found.push_back(theta / field->theta_0);
        found.push_back(1 / field->theta_0);
        return found;
    });
}

TEST(Gmrf2d, PseudoLikelihoodRecoversKnownCoefficients) {
    expect_recovery(known_field(), [](const Autocovariance& R,
                                      const std::vector<Offset>& neighbourhood) {
        std::vector<double> found;
        const auto field = maximise_pseudo_likelihood(R, neighbourhood);
        if (!field) return found;
        found.assign(field->a.begin(), field->a.end());
        found.push_back(static_cast<double>(field->variance));
        return found;
    });
}

TEST(Gmrf2d, PseudoLikelihoodIsExactForTheCovariancesOfAMarkovField) {
    const Gmrf2d truth = known_field();
    const Autocovariance R =
        covariance_of(reference::density_on_torus(truth, kSide, kSide), 4);
    const auto field = maximise_pseudo_likelihood(R, truth.neighbourhood);
    ASSERT_TRUE(field);
    for (std::size_t i = 0; i < truth.a.size(); ++i)
        EXPECT_NEAR(field->a[i], truth.a[i], 1e-6);
    EXPECT_NEAR(field->variance, truth.variance, 1e-5);
}

TEST(Gmrf2d, PseudoLikelihoodIsNotPositiveOnPhotographicSpectraAndRepaired) {
    const Autocovariance R = covariance_of(photographic_spectrum(kSide), 6);
    const auto field = maximise_pseudo_likelihood(R, hierarchical_half_plane(4));
    ASSERT_TRUE(field);
    EXPECT_LT(smallest_denominator(*field), 0);
    const Gmrf2d repaired = shrunk(*field, 0.02, R.variance());
    EXPECT_NEAR(smallest_denominator(repaired), 0.02, 1e-6);
    EXPECT_NEAR(field_variance(inverse_covariance(repaired), 256) / R.variance(), 1,
                1e-5);
}

TEST(Gmrf2d, SmallestDenominatorLooksBetweenTheFrequenciesOfAnyGrid) {
    std::mt19937 engine(5);
    for (int trial = 0; trial < 8; ++trial) {
        Gmrf2d field{hierarchical_half_plane(8), {}, 1};
        for (std::size_t i = 0; i < field.neighbourhood.size(); ++i)
            field.a.push_back(static_cast<float>(engine() % 2001) / 10000 - 0.1F);
        double brute = 1;
        constexpr std::size_t kFine = 1500;
        for (std::size_t m = 0; m < kFine; m += 3)
            for (std::size_t n = 0; n <= kFine / 2; n += 3)
                brute = std::min(
                    brute, 1 / reference::density(field, reference::frequency(m, kFine),
                                                  reference::frequency(n, kFine)));
        const double found = smallest_denominator(field);
        EXPECT_LE(found, brute + 1e-9);
        EXPECT_GT(found, brute - 0.01) << "the grid is that close to the minimum";
    }
}

TEST(Gmrf2d, StaysPositiveAndTheSameThroughAFile) {
    const Autocovariance R = covariance_of(photographic_spectrum(96), 12);
    for (const int order : {4, 6, 13}) {
        const auto natural = maximise_likelihood(R, hierarchical_half_plane(order));
        ASSERT_TRUE(natural);
        const Gmrf2d field = to_material(*natural, R.variance());
        EXPECT_GE(smallest_denominator(field), 1e-5);
        EXPECT_NEAR(field_variance(inverse_covariance(field), 256) / R.variance(), 1,
                    1e-5);
        Material m = test::random_material({.bands = 1});
        m.subspaces[0].levels[0].fields[0] = field;
        const auto payload = write_material(m);
        ASSERT_TRUE(payload) << payload.error().message;
        const auto read = read_material(*payload);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_TRUE(read->subspaces[0].levels[0].fields[0] == FieldModel(field));
    }
}

TEST(Gmrf2d, SelectsTheOrderOfTheField) {
    const Gmrf2d truth = known_field();
    const DoublePlane plane =
        reference::drawn(reference::density_on_torus(truth, kSide, kSide), 3);
    const auto field = select_gmrf2d(test::direct_autocovariance(plane, 8), 6);
    ASSERT_TRUE(field);
    EXPECT_EQ(field->neighbourhood.size(), hierarchical_half_plane(2).size());
}

TEST(Gmrf2d, OfAConstantPlaneIsAnError) {
    const Autocovariance R(4, 100);
    EXPECT_EQ(maximise_likelihood(R, hierarchical_half_plane(1)).error().code,
              Errc::singular);
    EXPECT_EQ(maximise_pseudo_likelihood(R, hierarchical_half_plane(1)).error().code,
              Errc::singular);
}

TEST(Gmrf2d, OfOneWaveIsStillAField) {
    Autocovariance R(6, 4096);
    for (int row = 0; row <= 6; ++row)
        for (int col = -6; col <= 6; ++col)
            R.at(row, col) = std::cos(0.7 * row + 1.1 * col);
    const auto natural = maximise_likelihood(R, hierarchical_half_plane(6));
    ASSERT_TRUE(natural);
    const Gmrf2d field = to_material(*natural, 1);
    EXPECT_GE(smallest_denominator(field), 1e-5);
    EXPECT_GT(field.variance, 0);
}

TEST(Whittle, DevianceIsTheMeanOverFrequenciesForBothModels) {
    constexpr int kGrid = 48;
    const DoublePlane P = photographic_spectrum(kSide);
    const Autocovariance R = covariance_of(P, 4);
    const auto expected = [&](const auto& field) {
        const DoublePlane S = reference::density_on_torus(field, kSide, kSide);
        double sum = 0;
        for (std::size_t i = 0; i < S.values.size(); ++i)
            sum += std::log(S.values[i]) + P.values[i] / S.values[i];
        return sum / static_cast<double>(S.values.size());
    };
    const Gmrf2d gmrf = known_field();
    const Car2d car = test::half_plane_field();
    EXPECT_NEAR(whittle_deviance(inverse_covariance(gmrf), R, kGrid) / expected(gmrf), 1,
                1e-9);
    EXPECT_NEAR(whittle_deviance(inverse_covariance(car), R, kGrid) / expected(car), 1,
                1e-9);
}

}  // namespace
}  // namespace sateen
