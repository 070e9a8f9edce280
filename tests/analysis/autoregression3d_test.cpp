// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/autoregression3d.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "sateen/analysis/car2d.hpp"
#include "support/fields.hpp"
#include "support/joint_fields.hpp"

namespace sateen {
namespace {

using test::correlated_field;
using test::exact_covariance;
using test::to_image;
using test::views_of;

const std::vector<std::size_t> kAll = {0, 1, 2};
constexpr std::size_t kSide = 40;

CrossAutocovariance covariance_of(const Autoregression3d& field, std::uint64_t seed,
                                  int reach = 4) {
    const Image image = to_image(reference::drawn(field, kSide, kSide, seed));
    SerialExecutor executor;
    return *toroidal_cross_autocovariance(views_of(image), reach, executor);
}

TEST(CrossAutocovariance, IsTheMeanProductForAllSignsOfTheLag) {
    const auto planes = reference::drawn(correlated_field(), 20, 24, 1);
    std::vector<double> mean(3);
    for (std::size_t k = 0; k < 3; ++k)
        for (const double value : planes[k].values) mean[k] += value / (20 * 24);
    SerialExecutor executor;
    const Image image = to_image(planes);
    const auto R = toroidal_cross_autocovariance(views_of(image), 3, executor);
    ASSERT_TRUE(R);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (int row = -3; row <= 3; ++row)
                for (int col = -3; col <= 3; ++col) {
                    double sum = 0;
                    for (int r = 0; r < 20; ++r)
                        for (int c = 0; c < 24; ++c)
                            sum += (planes[i](static_cast<std::size_t>(r),
                                              static_cast<std::size_t>(c)) -
                                    mean[i]) *
                                   (planes[j](
                                        static_cast<std::size_t>((r - row + 20) % 20),
                                        static_cast<std::size_t>((c - col + 24) % 24)) -
                                    mean[j]);
                    EXPECT_NEAR((*R)(i, j, row, col), sum / (20 * 24), 2e-5);
                }
}

TEST(CrossAutocovariance, OfThePyramidHasThePowerOfEveryPlaneAndKeepsCoherence) {
    // Planes 0 and 1 are the same up to a factor: coherent at every frequency and level.
    auto planes = reference::drawn(correlated_field(), 64, 64, 2);
    for (std::size_t i = 0; i < planes[0].values.size(); ++i)
        planes[1].values[i] = -2 * planes[0].values[i];
    const Image image = to_image(planes);
    SerialExecutor executor;
    const auto joint = joint_power_preserving_pyramid(views_of(image), 3, 4, executor);
    ASSERT_TRUE(joint);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto alone = power_preserving_pyramid(image.plane(k), 3, 4, executor);
        ASSERT_TRUE(alone);
        for (std::size_t level = 0; level < 3; ++level)
            for (int row = 0; row <= 4; ++row)
                for (int col = -4; col <= 4; ++col)
                    EXPECT_NEAR((*joint)[level](k, k, row, col),
                                (*alone)[level](row, col),
                                1e-9 * (*alone)[level].variance());
    }
    for (const CrossAutocovariance& R : *joint) {
        const double power = R(0, 0, 0, 0);
        EXPECT_NEAR(R(1, 1, 0, 0), 4 * power, 1e-4 * power);
        for (int row = -4; row <= 4; ++row)
            for (int col = -4; col <= 4; ++col)
                EXPECT_NEAR(R(0, 1, row, col), -2 * R(0, 0, row, col), 1e-4 * power);
    }
}

TEST(Car3d, IsExactForTheCovariancesOfItsField) {
    const Car3d truth = correlated_field();
    const auto estimate = estimate_car3d(
        toroidal_joint_equations(exact_covariance(truth, 4), kAll, truth.neighbourhood),
        {1e-9, 20});
    ASSERT_TRUE(estimate) << estimate.error().message;
    for (std::size_t k = 0; k < truth.A.size(); ++k)
        EXPECT_NEAR(estimate->model.A[k], truth.A[k], 1e-5) << k;
    // Σ̂ = λ / (β(0) + n)
    const double shrinkage = 64.0 * 64 / (64.0 * 64 + 20);
    for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(estimate->model.Sigma[k],
                    static_cast<double>(truth.Sigma[k]) * shrinkage, 1e-5);
}

// Means over draws within 3 of their standard errors, of which one in 370 is beyond: with 36 of
// them none is expected, one is allowed up to 4. The seeds are fixed.
template <class Estimate>
void expect_recovery(const Car3d& truth, const Estimate& estimate) {
    constexpr int kDraws = 16;
    std::vector<double> sum(36);
    std::vector<double> squares(36);
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
        const Autoregression3d model = estimate(toroidal_joint_equations(
            covariance_of(truth, draw), kAll, truth.neighbourhood));
        ASSERT_EQ(model.A.size(), 27U);
        for (std::size_t k = 0; k < 36; ++k) {
            const auto value =
                static_cast<double>(k < 27 ? model.A[k] : model.Sigma[k - 27]);
            sum[k] += value;
            squares[k] += value * value;
        }
    }
    int beyond = 0;
    for (std::size_t k = 0; k < 36; ++k) {
        const double mean = sum[k] / kDraws;
        const double error =
            std::sqrt((squares[k] / kDraws - mean * mean) / (kDraws - 1));
        const auto expected =
            static_cast<double>(k < 27 ? truth.A[k] : truth.Sigma[k - 27]);
        EXPECT_NEAR(mean, expected, 4 * error) << k;
        beyond += std::abs(mean - expected) > 3 * error ? 1 : 0;
    }
    EXPECT_LE(beyond, 1);
}

TEST(Car3d, RecoversKnownCoefficients) {
    expect_recovery(correlated_field(), [](const JointEquations& equations) {
        const auto estimate = estimate_car3d(equations, {1e-6, 12});
        return estimate ? Autoregression3d(estimate->model) : Autoregression3d();
    });
}

TEST(Sar3d, OnAHalfPlaneRecoversKnownCoefficients) {
    expect_recovery(correlated_field(), [](const JointEquations& equations) {
        const auto estimate = estimate_sar3d(equations);
        return estimate ? Autoregression3d(*estimate) : Autoregression3d();
    });
}

TEST(Car3d, EvidenceOfOnePlaneIsThatOfTheTwoDimensionalModel) {
    const CrossAutocovariance R = covariance_of(correlated_field(), 4, 6);
    for (const int order : {1, 3}) {
        const auto offsets = hierarchical_half_plane(order);
        const auto joint = estimate_car3d(toroidal_joint_equations(R, {1}, offsets),
                                          {1e-3, static_cast<double>(kMaxNeighbours)});
        const auto alone = estimate_car2d(toroidal_normal_equations(R.plane(1), offsets));
        ASSERT_TRUE(joint);
        ASSERT_TRUE(alone);
        EXPECT_NEAR(joint->log_evidence, alone->log_evidence,
                    1e-9 * std::abs(alone->log_evidence));
        for (std::size_t k = 0; k < offsets.size(); ++k)
            EXPECT_NEAR(joint->model.A[k], alone->model.a[k], 1e-6);
        EXPECT_NEAR(joint->model.Sigma[0], alone->model.variance, 1e-6);
    }
}

TEST(Car3d, OfCollinearPlanesIsStillAField) {
    auto planes = reference::drawn(correlated_field(), kSide, kSide, 5);
    planes[1] = planes[0];
    planes[2] = planes[0];
    SerialExecutor executor;
    const Image image = to_image(planes);
    const auto R = toroidal_cross_autocovariance(views_of(image), 4, executor);
    ASSERT_TRUE(R);
    const auto estimate =
        estimate_car3d(toroidal_joint_equations(*R, kAll, hierarchical_half_plane(2)));
    ASSERT_TRUE(estimate) << estimate.error().message;
    const JointMoments implied = moments(estimate->model, 128);
    const double scale = std::sqrt(implied.covariance[0] * implied.covariance[4]);
    EXPECT_GT(implied.covariance[1] / scale, 0.999);
    EXPECT_TRUE(
        estimate_sar3d(toroidal_joint_equations(*R, kAll, hierarchical_half_plane(2))));
}

TEST(Car3d, OfAConstantPlaneIsAnErrorAndLeavingItOutHelps) {
    auto planes = reference::drawn(correlated_field(), kSide, kSide, 6);
    for (double& value : planes[1].values) value = 0;
    SerialExecutor executor;
    const Image image = to_image(planes);
    const auto R = toroidal_cross_autocovariance(views_of(image), 2, executor);
    ASSERT_TRUE(R);
    const auto offsets = hierarchical_half_plane(1);
    EXPECT_EQ(estimate_car3d(toroidal_joint_equations(*R, kAll, offsets)).error().code,
              Errc::singular);
    auto two = estimate_car3d(toroidal_joint_equations(*R, {0, 2}, offsets));
    ASSERT_TRUE(two);
    restore_planes(two->model, {0, 2}, 3);
    EXPECT_EQ(two->model.A.size(), 18U);
    EXPECT_EQ(two->model.Sigma[4], 0);
    EXPECT_GT(two->model.Sigma[8], 0);
    EXPECT_EQ(two->model.A[1], 0);
}

TEST(Moments, AreTheCovarianceAndTheSmallestSingularValue) {
    const Car3d field = correlated_field();
    const auto R = reference::covariances(field, 64, 64);
    const JointMoments implied = moments(field, 64);
    for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(implied.covariance[k], R[k](0, 0), 1e-9);
    // One plane with a root: |Λ| is smallest at ω = 0, 1 - .5 - .4.
    const Car3d one{{1, {{0, 1}, {1, 0}}, {0.5F, 0.4F}, {1}}};
    EXPECT_NEAR(moments(one).smallest_singular_value, 0.1, 1e-6);
}

TEST(Moments, CanBeSetToTheVariancesOfTheSample) {
    Car3d field = correlated_field();
    set_variances(field, {2, 0.5, 3}, moments(field));
    const JointMoments implied = moments(field);
    EXPECT_NEAR(implied.covariance[0], 2, 1e-4);
    EXPECT_NEAR(implied.covariance[4], 0.5, 1e-4);
    EXPECT_NEAR(implied.covariance[8], 3, 1e-4);
}

TEST(Sar3d, OnAHalfPlaneEqualsTheCausalModelOnATorus) {
    const auto equations = toroidal_joint_equations(covariance_of(correlated_field(), 8),
                                                    kAll, hierarchical_half_plane(2));
    const auto sar = estimate_sar3d(equations);
    const auto car = estimate_car3d(equations, {1e-9, 10});
    ASSERT_TRUE(sar);
    ASSERT_TRUE(car);
    for (std::size_t k = 0; k < sar->A.size(); ++k)
        EXPECT_NEAR(sar->A[k], car->model.A[k], 1e-5);
}

/// Whittle's deviance, mean_t (ln |S_t| + tr S_t⁻¹ P_t), of a causal field without ln |Λ_t|,
/// whose mean is 0:  ln |Σ| + tr Σ⁻¹ E ê êᵀ,  ê_r = Y_r - Σ_s A_s Y_{r-s} on the torus.
double deviance(const Sar3d& model, const std::vector<reference::DoublePlane>& planes) {
    Eigen::Matrix3d residual = Eigen::Matrix3d::Zero();
    const auto at = [&](std::size_t plane, int r, int c) {
        constexpr int n = static_cast<int>(kSide);
        return planes[plane](static_cast<std::size_t>((r % n + n) % n),
                             static_cast<std::size_t>((c % n + n) % n));
    };
    for (int r = 0; r < static_cast<int>(kSide); ++r)
        for (int c = 0; c < static_cast<int>(kSide); ++c) {
            Eigen::Vector3d e;
            for (std::size_t i = 0; i < 3; ++i) {
                e(static_cast<Eigen::Index>(i)) = at(i, r, c);
                for (std::size_t s = 0; s < model.neighbourhood.size(); ++s)
                    for (std::size_t j = 0; j < 3; ++j)
                        e(static_cast<Eigen::Index>(i)) -=
                            static_cast<double>(model.A[9 * s + 3 * i + j]) *
                            at(j, r - model.neighbourhood[s].row,
                               c - model.neighbourhood[s].col);
            }
            residual += e * e.transpose() / static_cast<double>(kSide * kSide);
        }
    const Eigen::Matrix3d Sigma =
        Eigen::Map<const Eigen::Matrix3f>(model.Sigma.data()).cast<double>();
    return std::log(Sigma.determinant()) + (Sigma.inverse() * residual).trace();
}

TEST(Sar3d, OnAHalfPlaneNoChangeOfAParameterRaisesTheLikelihood) {
    auto planes = reference::drawn(correlated_field(), kSide, kSide, 9);
    for (auto& plane : planes) {
        double mean = 0;
        for (const double value : plane.values) mean += value / (kSide * kSide);
        for (double& value : plane.values) value -= mean;
    }
    const Image image = to_image(planes);
    SerialExecutor executor;
    const auto R = toroidal_cross_autocovariance(views_of(image), 4, executor);
    ASSERT_TRUE(R);
    const auto estimate =
        estimate_sar3d(toroidal_joint_equations(*R, kAll, hierarchical_half_plane(2)));
    ASSERT_TRUE(estimate);
    const double least = deviance(*estimate, planes);
    for (std::size_t k = 0; k < estimate->A.size(); ++k)
        for (const float step : {-0.01F, 0.01F}) {
            Sar3d changed = *estimate;
            changed.A[k] += step;
            EXPECT_GT(deviance(changed, planes), least) << "A " << k;
        }
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j <= i; ++j)
            for (const float factor : {0.98F, 1.02F}) {
                Sar3d changed = *estimate;
                changed.Sigma[3 * i + j] *= factor;
                changed.Sigma[3 * j + i] = changed.Sigma[3 * i + j];
                EXPECT_GT(deviance(changed, planes), least) << "Sigma " << i << j;
            }
}

double correlation(const Autoregression3d& field) {
    const auto R = moments(field).covariance;
    return R[1] / std::sqrt(R[0] * R[4]);
}

TEST(Sar3d, LosesTheCorrelationOfThePlanesWithThePrintedDiagonalCovariance) {
    // Planes with nothing in common but their noise.
    Car3d truth = correlated_field();
    for (std::size_t k = 0; k < truth.A.size(); ++k)
        if (k % 9 % 4 != 0) truth.A[k] = 0;
    const auto equations =
        toroidal_joint_equations(exact_covariance(truth, 4), kAll, truth.neighbourhood);
    const auto full = estimate_sar3d(equations);
    const auto diagonal = estimate_sar3d(equations, true);
    ASSERT_TRUE(full);
    ASSERT_TRUE(diagonal);
    EXPECT_NEAR(correlation(*full), correlation(truth), 1e-4);
    EXPECT_GT(correlation(*full), 0.75);
    EXPECT_LT(std::abs(correlation(*diagonal)), 0.01);
}

TEST(Sar3d, LeastSquaresOnASymmetricNeighbourhoodOverestimatesAsPrinted) {
    // Λ = 1 - .4 cos ω1 - .4 cos ω2: the true coefficients are .2 each.
    std::vector<float> A;
    const std::vector<Offset> four = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t k = 0; k < 9; ++k) A.push_back(k % 4 == 0 ? 0.2F : 0.0F);
    const Sar3d truth{{3, four, A, {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
    const auto equations =
        toroidal_joint_equations(exact_covariance(truth, 2), kAll, four);
    const auto estimate = estimate_sar3d(equations, true);
    ASSERT_TRUE(estimate);
    for (const std::size_t k : {0U, 9U, 18U, 27U})
        EXPECT_NEAR(estimate->A[k], 0.276, 0.003);
    EXPECT_LT(moments(*estimate).smallest_singular_value, 0.12);
    EXPECT_GT(moments(truth).smallest_singular_value, 0.199);
}

}  // namespace
}  // namespace sateen
