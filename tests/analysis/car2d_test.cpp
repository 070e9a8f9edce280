// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/car2d.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <span>
#include <vector>

#include "reference/causal_recursion.hpp"
#include "reference/stationary_field.hpp"
#include "support/fields.hpp"

namespace sateen {
namespace {

using reference::DoublePlane;

std::vector<CausalTap> taps_of(const Car2d& field) {
    std::vector<CausalTap> taps;
    for (std::size_t i = 0; i < field.a.size(); ++i)
        taps.push_back(
            {field.neighbourhood[i].row, field.neighbourhood[i].col, field.a[i]});
    return taps;
}

/// A draw by the recursion from zero, all of it.
DoublePlane recursive_draw(const Car2d& field, std::size_t rows, std::size_t cols,
                           std::uint64_t seed) {
    DoublePlane plane = reference::white_noise(rows, cols, seed);
    const std::vector<CausalTap> taps = taps_of(field);
    reference::causal_recursion<double>(taps, std::sqrt(field.variance),
                                        {plane.values.data(), rows, cols});
    return plane;
}

DoublePlane without_margin(const DoublePlane& plane, std::size_t margin) {
    DoublePlane inner(plane.rows - margin, plane.cols - 2 * margin);
    for (std::size_t r = 0; r < inner.rows; ++r) {
        for (std::size_t c = 0; c < inner.cols; ++c)
            inner(r, c) = plane(r + margin, c + margin);
    }
    return inner;
}

/// â - a in standard errors, of the asymptotic covariance σ² V_xx⁻¹.
std::vector<double> errors_in_sigmas(const Car2d& truth,
                                     const NormalEquations& equations) {
    const auto estimate = estimate_car2d(equations);
    EXPECT_TRUE(estimate);
    const auto eta = static_cast<Eigen::Index>(truth.a.size());
    const Eigen::MatrixXd V_xx =
        Eigen::Map<const Eigen::MatrixXd>(equations.V_xx.data(), eta, eta);
    const Eigen::MatrixXd covariance =
        static_cast<double>(truth.variance) * V_xx.inverse();
    std::vector<double> result;
    for (Eigen::Index i = 0; i < eta; ++i) {
        const auto k = static_cast<std::size_t>(i);
        result.push_back(static_cast<double>(estimate->model.a[k] - truth.a[k]) /
                         std::sqrt(covariance(i, i)));
    }
    // Var λ/n = 2σ⁴/n; σ̂² = λ/β is smaller by the share that β(0) has in β.
    result.push_back(
        (estimate->lambda / equations.sites / static_cast<double>(truth.variance) - 1) /
        std::sqrt(2 / equations.sites));
    return result;
}

/// Of many errors in standard errors: none beyond 4, at most one in 40 beyond 3 (each 0.3 %
/// likely), a root mean square of 1 within 4 standard errors of that.
void expect_standard_normal(const std::vector<double>& errors) {
    double squares = 0;
    std::size_t beyond = 0;
    for (const double error : errors) {
        EXPECT_LT(std::abs(error), 4);
        squares += error * error;
        if (std::abs(error) > 3) ++beyond;
    }
    const auto n = static_cast<double>(errors.size());
    EXPECT_LE(beyond, errors.size() / 40);
    EXPECT_NEAR(std::sqrt(squares / n), 1, 4 / std::sqrt(2 * n));
}

TEST(Car2d, RecoversKnownCoefficientsOfToroidalFields) {
    for (const Car2d& truth : {test::quarter_plane_field(), test::half_plane_field(),
                               test::separable_field(0.9F, 0.8F)}) {
        std::vector<double> errors;
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const DoublePlane field = reference::toroidal_field(truth, 72, 80, seed);
            for (const double error : errors_in_sigmas(
                     truth,
                     toroidal_normal_equations(test::direct_autocovariance(field, 2),
                                               truth.neighbourhood)))
                errors.push_back(error);
        }
        expect_standard_normal(errors);
    }
}

TEST(Car2d, RecoversKnownCoefficientsOfFieldsDrawnByRecursion) {
    for (const Car2d& truth : {test::quarter_plane_field(), test::half_plane_field()}) {
        std::vector<double> errors;
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const Image field = reference::to_image(
                without_margin(recursive_draw(truth, 150, 180, seed), 40));
            for (const double error : errors_in_sigmas(
                     truth,
                     interior_normal_equations(field.plane(0), truth.neighbourhood)))
                errors.push_back(error);
        }
        expect_standard_normal(errors);
    }
}

TEST(Car2d, InteriorEquationsAreDirectSums) {
    const Car2d field = test::half_plane_field();
    const Image image = reference::to_image(recursive_draw(field, 7, 9, 4));
    const NormalEquations equations =
        interior_normal_equations(image.plane(0), field.neighbourhood);
    EXPECT_EQ(equations.sites, 6 * 7);
    const auto y = [&](int r, int c, Offset s) {
        return static_cast<double>(image(0, static_cast<std::size_t>(r - s.row),
                                         static_cast<std::size_t>(c - s.col)));
    };
    const Offset here{0, 0};
    for (std::size_t i = 0; i < 4; ++i) {
        const Offset s = field.neighbourhood[i];
        double V_xy = 0;
        double V_yy = 0;
        for (int r = 1; r < 7; ++r) {
            for (int c = 1; c < 8; ++c) {
                V_xy += y(r, c, s) * y(r, c, here);
                V_yy += y(r, c, here) * y(r, c, here);
            }
        }
        EXPECT_NEAR(equations.V_xy[i], V_xy, 1e-10);
        EXPECT_NEAR(equations.V_yy, V_yy, 1e-10);
        for (std::size_t j = 0; j < 4; ++j) {
            double V_xx = 0;
            for (int r = 1; r < 7; ++r) {
                for (int c = 1; c < 8; ++c)
                    V_xx += y(r, c, s) * y(r, c, field.neighbourhood[j]);
            }
            EXPECT_NEAR(equations.V_xx[i * 4 + j], V_xx, 1e-10);
        }
    }
}

TEST(Car2d, ToroidalEqualsInteriorUpToBorderTerms) {
    // A relative change of order border / area; 6 / 128 with a factor 2 to spare.
    const Car2d truth = test::half_plane_field();
    const DoublePlane field = reference::toroidal_field(truth, 128, 128, 5);
    const NormalEquations torus = toroidal_normal_equations(
        test::direct_autocovariance(field, 2), truth.neighbourhood);
    const Image image = reference::to_image(field);
    const NormalEquations interior =
        interior_normal_equations(image.plane(0), truth.neighbourhood);
    for (std::size_t i = 0; i < torus.V_xx.size(); ++i)
        EXPECT_NEAR(torus.V_xx[i] / torus.V_yy, interior.V_xx[i] / torus.V_yy, 0.1);
    const auto a = estimate_car2d(torus);
    const auto b = estimate_car2d(interior);
    ASSERT_TRUE(a && b);
    for (std::size_t i = 0; i < truth.a.size(); ++i)
        EXPECT_NEAR(static_cast<double>(a->model.a[i]),
                    static_cast<double>(b->model.a[i]), 0.01);
}

TEST(Car2d, PlanesSmallerThanTheNeighbourhoodHaveNoInterior) {
    const Image image(1, 1, 5);
    const auto equations =
        interior_normal_equations(image.plane(0), test::half_plane_field().neighbourhood);
    EXPECT_EQ(equations.sites, 0);
    const auto estimate = estimate_car2d(equations);
    ASSERT_FALSE(estimate);
    EXPECT_EQ(estimate.error().code, Errc::singular);
}

TEST(Car2d, RefusesConstantPlanes) {
    const Image image(1, 8, 8);
    const auto estimate = estimate_car2d(interior_normal_equations(
        image.plane(0), test::half_plane_field().neighbourhood));
    ASSERT_FALSE(estimate);
    EXPECT_EQ(estimate.error().code, Errc::singular);
    EXPECT_EQ(estimate.error().message,
              "a constant plane has no autoregressive model: variance 0.000000 over 42 "
              "sites");
}

/// Feeds every interior site in raster order.
struct Chained {
    RecursiveCar2d recursive;
    double log_density = 0;
};

Chained chain(PlaneView<const float> plane, const NormalEquations& equations,
              const Car2dPrior& prior) {
    Chained result{{equations.neighbourhood, equations.V_yy / equations.sites, prior}};
    int top = 0;
    int left = 0;
    int right = 0;
    for (const Offset s : equations.neighbourhood) {
        top = std::max<int>(top, s.row);
        left = std::max<int>(left, s.col);
        right = std::max<int>(right, -s.col);
    }
    std::vector<double> X;
    for (int r = top; r < static_cast<int>(plane.rows); ++r) {
        for (int c = left; c < static_cast<int>(plane.cols) - right; ++c) {
            X.clear();
            const auto at = [&](Offset s) {
                return static_cast<double>(plane(static_cast<std::size_t>(r - s.row),
                                                 static_cast<std::size_t>(c - s.col)));
            };
            for (const Offset s : equations.neighbourhood) X.push_back(at(s));
            result.log_density += result.recursive.update(X, at({0, 0}));
        }
    }
    return result;
}

TEST(Car2d, EvidenceIsTheSumOfThePredictiveDensities) {
    for (const int order : {1, 2, 4}) {
        for (const double weight : {1e-3, 0.1}) {
            const Car2dPrior prior{weight, 64};
            const Image image =
                reference::to_image(recursive_draw(test::half_plane_field(), 30, 34, 6));
            const auto equations =
                interior_normal_equations(image.plane(0), hierarchical_half_plane(order));
            const auto batch = estimate_car2d(equations, prior);
            ASSERT_TRUE(batch);
            const Chained chained = chain(image.plane(0), equations, prior);
            EXPECT_NEAR(chained.log_density, batch->log_evidence,
                        1e-8 * std::abs(batch->log_evidence));
        }
    }
}

TEST(Car2d, RecursiveEstimateEqualsTheBatch) {
    const Image image =
        reference::to_image(recursive_draw(test::half_plane_field(), 30, 34, 7));
    const auto equations =
        interior_normal_equations(image.plane(0), hierarchical_half_plane(3));
    const auto batch = estimate_car2d(equations);
    ASSERT_TRUE(batch);
    const Car2d recursive = chain(image.plane(0), equations, {}).recursive.model();
    ASSERT_EQ(recursive.neighbourhood, batch->model.neighbourhood);
    for (std::size_t i = 0; i < recursive.a.size(); ++i)
        EXPECT_NEAR(static_cast<double>(recursive.a[i]),
                    static_cast<double>(batch->model.a[i]), 1e-6);
    EXPECT_FLOAT_EQ(recursive.variance, batch->model.variance);
}

TEST(SpectralRadius, CatchesTheUnstableAndPassesTheStable) {
    const Car2d unstable{{{0, 1}, {1, 0}}, {0.51F, 0.51F}, 1};
    EXPECT_NEAR(spectral_radius(unstable), 0.51 / 0.49, 1e-6);
    EXPECT_NEAR(spectral_radius(test::quarter_plane_field()), 0.5, 1e-6);
    EXPECT_NEAR(spectral_radius(test::separable_field(0.9F, 0.9F)), 0.9, 1e-6);
    EXPECT_NEAR(spectral_radius(test::separable_field(0.3F, 0.8F)), 0.8, 1e-6);
    EXPECT_NEAR(spectral_radius({{{2, 0}}, {0.81F}, 1}), 0.9, 1e-6);
    EXPECT_NEAR(spectral_radius({{{0, 3}}, {0.512F}, 1}), 0.8, 1e-6);
    // |C_1(ω)| = |0.5 e^{jω} + 0.6 e^{-jω}| is largest at ω = 0.
    EXPECT_NEAR(spectral_radius({{{1, -1}, {1, 1}}, {0.5F, 0.6F}, 1}), 1.1, 1e-6);
    EXPECT_EQ(spectral_radius({}), 0);
}

TEST(SpectralRadius, PredictsTheGrowthOfTheRecursion) {
    const Car2d unstable{{{0, 1}, {1, 0}}, {0.51F, 0.51F}, 1};
    const DoublePlane field = recursive_draw(unstable, 260, 300, 1);
    const auto deviation = [&](std::size_t first) {
        double sum = 0;
        for (std::size_t r = first; r < first + 10; ++r) {
            for (std::size_t c = 200; c < 300; ++c) sum += field(r, c) * field(r, c);
        }
        return std::sqrt(sum / 1000);
    };
    EXPECT_GT(deviation(190), 4 * deviation(90));
}

TEST(Stabilised, KeepsTheVarianceAndStaysBelowTheRadius) {
    const Car2d unstable{{{0, 1}, {1, 0}, {1, -1}}, {0.51F, 0.4F, 0.15F}, 1};
    ASSERT_GT(spectral_radius(unstable), 1);
    for (const double radius : {0.98, 0.9}) {
        const Car2d stable = stabilised(unstable, 2.5, radius);
        EXPECT_LT(spectral_radius(stable), radius);
        EXPECT_GT(spectral_radius(stable), radius - 1e-3);
        EXPECT_NEAR(model_variance(stable), 2.5, 1e-5);
        EXPECT_EQ(stable.neighbourhood, unstable.neighbourhood);
        // a_s g^(|s1|+|s2|)
        const float g = stable.a[0] / unstable.a[0];
        EXPECT_NEAR(static_cast<double>(stable.a[1] / unstable.a[1]),
                    static_cast<double>(g), 1e-6);
        EXPECT_NEAR(static_cast<double>(stable.a[2] / unstable.a[2]),
                    static_cast<double>(g * g), 1e-6);
    }
}

TEST(ModelVariance, EqualsTheClosedForms) {
    EXPECT_NEAR(model_variance({{{0, 1}}, {0.8F}, 2}), 2 / (1 - 0.64), 1e-6);
    EXPECT_NEAR(model_variance({{{1, 0}}, {-0.7F}, 1}), 1 / (1 - 0.49), 1e-6);
    EXPECT_NEAR(model_variance(test::separable_field(0.7F, 0.8F)),
                1 / ((1 - 0.49) * (1 - 0.64)), 1e-5);
    EXPECT_EQ(model_variance({{}, {}, 3}), 3);
    EXPECT_EQ(model_variance({}), 0);
}

TEST(ModelVariance, IsTheMeanOfTheDensity) {
    for (const std::size_t grid : {16U, 15U, 1U}) {
        for (const Car2d& field : {test::half_plane_field(), test::quarter_plane_field(),
                                   Car2d{{{2, -3}, {1, 4}}, {0.3F, -0.4F}, 1}}) {
            const DoublePlane S = reference::density_on_torus(field, grid, grid);
            double mean = 0;
            for (const double value : S.values)
                mean += value / static_cast<double>(grid * grid);
            EXPECT_NEAR(model_variance(field, grid), mean, 1e-9 * mean);
        }
    }
}

}  // namespace
}  // namespace sateen
