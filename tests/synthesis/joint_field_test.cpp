// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "reference/joint_field.hpp"
#include "support/joint_fields.hpp"
#include "synthesis/hermitian_matrix.hpp"
#include "synthesis/infinite_field.hpp"
#include "synthesis/toroidal_field.hpp"

namespace sateen {
namespace {

using reference::adjoint;
using reference::Matrix3;
using reference::product;

Matrix3 matrix_at(const Image& rows, std::size_t m, std::size_t n) {
    Matrix3 H{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double re = static_cast<double>(rows(3 * i + j, m, n));
            const double im = i == j ? 0 : static_cast<double>(rows(3 * j + i, m, n));
            H[3 * i + j] = {re, im};
            H[3 * j + i] = {re, -im};
        }
    return H;
}

double largest(const Matrix3& H) {
    double value = 0;
    for (const auto& element : H) value = std::max(value, std::abs(element));
    return value;
}

TEST(HermitianRoot, SquaresToTheMatrixAlsoWhereThatIsSingular) {
    constexpr std::size_t kCount = 203;
    std::mt19937 engine(1);
    const auto uniform = [&] { return static_cast<double>(engine() % 2001) / 1000 - 1; };
    Image S(9, 1, kCount);
    for (std::size_t n = 0; n < kCount; ++n) {
        // Rank 0 to 3, sizes over ten decades.
        Matrix3 F{};
        const double size = std::pow(10, -8 + static_cast<double>(n % 11));
        for (std::size_t k = 0; k < 9; ++k)
            if (k % 3 < n % 4) F[k] = size * std::complex<double>(uniform(), uniform());
        const Matrix3 H = product(F, adjoint(F));
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i; j < 3; ++j) {
                S(3 * i + j, 0, n) = static_cast<float>(H[3 * i + j].real());
                if (i != j) S(3 * j + i, 0, n) = static_cast<float>(H[3 * i + j].imag());
            }
    }
    Image X = S;
    hermitian_root(hermitian_rows(X.view(), 0), kCount);
    for (std::size_t n = 0; n < kCount; ++n) {
        const Matrix3 expected = matrix_at(S, 0, n);
        const Matrix3 root = matrix_at(X, 0, n);
        Matrix3 difference = product(root, root);
        for (std::size_t k = 0; k < 9; ++k) difference[k] -= expected[k];
        // Of rank 1 the invariants are rounding errors of the matrix.
        const double tolerance = n % 4 == 1 ? 5e-4 : 1e-5;
        EXPECT_LE(largest(difference), tolerance * largest(expected)) << n;
        for (std::size_t i = 0; i < 3; ++i) EXPECT_GE(X(4 * i, 0, n), 0);
    }
}

Level joint_level(FieldModel field) {
    Level level;
    level.fields.push_back(std::move(field));
    return level;
}

TEST(JointDensity, IsThatOfTheDefinitionOnOneLevelAndOnTwo) {
    const Car3d fine = test::correlated_field();
    Sar3d coarse{{3, {{0, 1}, {0, -1}}, std::vector<float>(18), fine.Sigma}};
    coarse.A[1] = 0.3F;
    coarse.A[12] = -0.2F;
    const std::vector<Level> levels = {joint_level(fine), joint_level(coarse)};
    SerialExecutor executor;
    for (const auto& [rows, cols] :
         {std::pair<std::size_t, std::size_t>{16, 20}, {15, 9}})
        for (const std::size_t count : {1U, 2U}) {
            const PlaneField field{std::span(levels).first(count), 0, 64, 64, 3};
            const Image E = spectral_density(field, rows, cols, executor);
            for (std::size_t m = 0; m < rows; ++m)
                for (std::size_t n = 0; n <= cols / 2; ++n) {
                    const double w1 = reference::frequency(m, rows);
                    const double w2 = reference::frequency(n, cols);
                    Matrix3 expected = reference::density(fine, w1, w2);
                    const double W = reference::kernel_transfer(w1, w2);
                    const Matrix3 below = reference::density(coarse, 2 * w1, 2 * w2);
                    for (std::size_t k = 0; count == 2 && k < 9; ++k)
                        expected[k] += 4 * W * W * below[k];
                    const Matrix3 found = matrix_at(E, m, n);
                    for (std::size_t k = 0; k < 9; ++k)
                        EXPECT_LT(std::abs(found[k] - expected[k]),
                                  2e-5 * largest(expected));
                }
        }
}

TEST(JointDensity, TakesFieldsOfOnePlaneAsADiagonal) {
    const Car2d car{{{0, 1}}, {0.5F}, 2};
    const Gmrf2d gmrf{{{1, 0}}, {0.3F}, 1};
    const std::vector<Level> levels = {Level{{car, gmrf, Car2d{}}}};
    SerialExecutor executor;
    const Image E = spectral_density({levels, 0, 64, 64, 3}, 12, 12, executor);
    for (std::size_t m = 0; m < 12; ++m)
        for (std::size_t n = 0; n <= 6; ++n) {
            const double w1 = reference::frequency(m, 12);
            const double w2 = reference::frequency(n, 12);
            EXPECT_NEAR(static_cast<double>(E(0, m, n)) / reference::density(car, w1, w2),
                        1, 1e-5);
            EXPECT_NEAR(
                static_cast<double>(E(4, m, n)) / reference::density(gmrf, w1, w2), 1,
                1e-5);
            for (const std::size_t k : {1U, 2U, 3U, 5U, 6U, 7U, 8U})
                EXPECT_EQ(E(k, m, n), 0);
        }
}

/// The correlation of two planes at a lag of a torus, both of mean 0 and variance 1.
double correlation(PlaneView<const float> a, PlaneView<const float> b, std::size_t row,
                   std::size_t col) {
    double sum = 0;
    for (std::size_t r = 0; r < a.rows; ++r)
        for (std::size_t c = 0; c < a.cols; ++c)
            sum += static_cast<double>(a(r, c)) *
                   static_cast<double>(
                       b((r + a.rows - row) % a.rows, (c + a.cols - col) % a.cols));
    return sum / static_cast<double>(a.size());
}

double expected_correlation(const Autoregression3d& field, std::size_t i, std::size_t j,
                            std::size_t row, std::size_t col) {
    const auto R = reference::covariances(field, 48, 48);
    return R[3 * i + j](row, col) / std::sqrt(R[4 * i](0, 0) * R[4 * j](0, 0));
}

/// The planes that the noise of a seed draws.
void draw(const PlaneField& field, std::uint64_t seed, const Fft2d& fft, Image& planes) {
    SerialExecutor executor;
    std::vector<SplitComplexPlane> spectra(
        3, SplitComplexPlane(fft.rows(), fft.spectrum_cols()));
    const auto gains = colour_noise(field, fft.cols(), {seed, {}}, spectra, executor);
    for (std::size_t k = 0; k < 3; ++k) {
        fft.inverse(spectra[k].view(), planes.plane(k), executor);
        for (std::size_t i = 0; i < planes.plane_size(); ++i)
            planes.plane(k).data[i] *= gains[k];
    }
}

struct Lag {
    std::size_t i, j, row, col;
};
constexpr Lag kLags[] = {{0, 1, 0, 0}, {1, 2, 0, 0}, {0, 1, 0, 1}, {1, 0, 0, 1},
                         {2, 1, 1, 0}, {0, 0, 2, 0}, {2, 0, 0, 2}};

TEST(JointNoise, HasTheCrossCovariancesOfTheFieldAndVarianceOne) {
    const Car3d car = test::correlated_field();
    const std::vector<Level> levels = {joint_level(car)};
    constexpr std::size_t kSide = 256;
    const PlaneField field{levels, 0, kSide, kSide, 3};
    const Fft2d fft = *Fft2d::create(kSide, kSide);
    Image planes(3, kSide, kSide);
    draw(field, 9, fft, planes);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(correlation(planes.plane(k), planes.plane(k), 0, 0), 1, 1e-4);
    // The standard error of a correlation of 65536 sites of this field is below 0.01.
    for (const Lag& lag : kLags)
        EXPECT_NEAR(
            correlation(planes.plane(lag.i), planes.plane(lag.j), lag.row, lag.col),
            expected_correlation(car, lag.i, lag.j, lag.row, lag.col), 0.03);
}

TEST(JointInfiniteField, HasTheCrossCovariancesOfTheFieldAndItsWindowsAgree) {
    const Car3d car = test::correlated_field();
    const std::vector<Level> levels = {joint_level(car), joint_level(car),
                                       joint_level(car)};
    SerialExecutor executor;
    const auto field = InfiniteField::create({levels, 0, 4096, 4096, 3}, {}, executor);
    ASSERT_TRUE(field) << field.error().message;
    Image whole(3, 300, 300);
    Image part(3, 40, 60);
    ASSERT_TRUE(field->draw(1, 0, -100, -150, test::writable_views_of(whole), executor));
    ASSERT_TRUE(field->draw(1, 0, 20, -30, test::writable_views_of(part), executor));
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t r = 0; r < 40; ++r)
            for (std::size_t c = 0; c < 60; ++c)
                EXPECT_EQ(part(k, r, c), whole(k, 120 + r, 120 + c));
    const Image E = spectral_density({levels, 0, 4096, 4096, 3}, 256, 256, executor);
    const auto cross = [&](std::size_t element) {
        return mean_density(E.plane(element), 256);
    };
    for (const auto& [i, j] :
         {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 2}}) {
        const double expected = cross(3 * i + j) / std::sqrt(cross(4 * i) * cross(4 * j));
        const double found = correlation(whole.plane(i), whole.plane(j), 0, 0) /
                             std::sqrt(correlation(whole.plane(i), whole.plane(i), 0, 0) *
                                       correlation(whole.plane(j), whole.plane(j), 0, 0));
        EXPECT_NEAR(found, expected, 0.04);
    }
}

TEST(JointNoise, BlendedHalfAndHalfKeepsItsContrast) {
    // Two fields of one material, driven by the same noise.
    Car3d first = test::correlated_field();
    Car3d second = first;
    for (float& a : second.A) a *= 0.7F;
    second.Sigma = {1, 0.3F, 0.2F, 0.3F, 1, 0.1F, 0.2F, 0.1F, 1};
    constexpr std::size_t kSide = 128;
    const Fft2d fft = *Fft2d::create(kSide, kSide);
    Image planes(3, kSide, kSide);
    Image blend(3, kSide, kSide);
    for (const Car3d& car : {first, second}) {
        const std::vector<Level> levels = {joint_level(car)};
        draw({levels, 0, kSide, kSide, 3}, 2, fft, planes);
        for (std::size_t i = 0; i < blend.values().size(); ++i)
            blend.values()[i] += planes.values()[i] / 2;
    }
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_GE(correlation(blend.plane(k), blend.plane(k), 0, 0), 0.9);
}

}  // namespace
}  // namespace sateen
