// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/spectral.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sateen/core/colour.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

/// y = mean + Σ_i deviation_i axis_i g_i with independent normal g_i.
Image mixture(std::size_t rows, std::size_t cols, std::uint64_t seed,
              std::array<float, 3> deviations) {
    // Unit axes at right angles.
    constexpr float kAxes[3][3] = {
        {0.48F, 0.6F, 0.64F}, {0.8F, -0.6F, 0}, {0.36F, 0.48F, -0.8F}};
    Image noise(3, rows, cols);
    for (std::uint32_t band = 0; band < 3; ++band)
        for (std::size_t r = 0; r < rows; ++r)
            draw_normals({seed, band}, static_cast<std::int32_t>(r), 0,
                         {noise.plane(band).row(r), cols});
    Image image(3, rows, cols);
    for (std::size_t band = 0; band < 3; ++band)
        for (std::size_t i = 0; i < rows * cols; ++i) {
            float value = 0.2F + 0.1F * static_cast<float>(band);
            for (std::size_t axis = 0; axis < 3; ++axis)
                value += deviations[axis] * kAxes[axis][band] * noise.plane(axis).data[i];
            image.plane(band).data[i] = value;
        }
    return image;
}

double covariance(const Image& image, std::size_t a, std::size_t b) {
    const auto n = static_cast<double>(image.plane_size());
    double sum_a = 0;
    double sum_b = 0;
    double products = 0;
    for (std::size_t i = 0; i < image.plane_size(); ++i) {
        const auto x = static_cast<double>(image.plane(a).data[i]);
        const auto y = static_cast<double>(image.plane(b).data[i]);
        sum_a += x;
        sum_b += y;
        products += x * y;
    }
    return products / n - sum_a / n * (sum_b / n);
}

double mean(const Image& image, std::size_t band) {
    double sum = 0;
    for (std::size_t i = 0; i < image.plane_size(); ++i)
        sum += static_cast<double>(image.plane(band).data[i]);
    return sum / static_cast<double>(image.plane_size());
}

double row_product(const SpectralTransform& a, std::size_t i, const SpectralTransform& b,
                   std::size_t j) {
    double sum = 0;
    for (std::size_t k = 0; k < a.mean.size(); ++k)
        sum += static_cast<double>(a.T[i * a.mean.size() + k]) *
               static_cast<double>(b.T[j * a.mean.size() + k]);
    return sum;
}

void expect_orthonormal(const SpectralTransform& transform) {
    for (std::size_t i = 0; i < transform.mean.size(); ++i) {
        for (std::size_t j = 0; j < transform.mean.size(); ++j)
            EXPECT_NEAR(row_product(transform, i, transform, j), i == j ? 1 : 0, 1e-6);
    }
}

TEST(SpectralTransform, IsOrthonormalAndDecorrelates) {
    const std::vector<Image> images = {mixture(64, 80, 1, {0.2F, 0.05F, 0.01F})};
    const auto transform = fit_spectral_transform(images, Tone::linear);
    expect_orthonormal(transform);
    const Image planes = decorrelate(images[0], transform);
    std::array<double, 3> variances{};
    for (std::size_t i = 0; i < 3; ++i) {
        variances[i] = covariance(planes, i, i);
        EXPECT_NEAR(mean(planes, i), 0, 1e-6);
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_NEAR(covariance(planes, i, j), 0, 1e-6 * variances[0]);
    }
    EXPECT_GT(variances[0], variances[1]);
    EXPECT_GT(variances[1], variances[2]);
    // 5120 samples: the standard error of a variance is 2 %.
    EXPECT_NEAR(variances[0], 0.04, 0.04 * 0.06);
    EXPECT_NEAR(variances[2], 1e-4, 1e-4 * 0.06);
}

TEST(SpectralTransform, LargestComponentOfEveryRowIsPositive) {
    const std::vector<Image> images = {mixture(64, 80, 2, {0.2F, 0.05F, 0.01F})};
    const auto transform = fit_spectral_transform(images, Tone::linear);
    for (std::size_t row = 0; row < 3; ++row) {
        float largest = 0;
        for (std::size_t k = 0; k < 3; ++k)
            if (std::abs(transform.T[row * 3 + k]) > std::abs(largest))
                largest = transform.T[row * 3 + k];
        EXPECT_GT(largest, 0);
    }
}

TEST(SpectralTransform, PoolsImagesOfDifferentSize) {
    const std::vector<Image> parts = {mixture(40, 40, 3, {0.2F, 0.05F, 0.01F}),
                                      mixture(20, 10, 4, {0.1F, 0.3F, 0.01F})};
    std::vector<Image> whole = {Image(3, 1, 1800)};
    for (std::size_t band = 0; band < 3; ++band) {
        std::copy_n(parts[0].plane(band).data, 1600, whole[0].plane(band).data);
        std::copy_n(parts[1].plane(band).data, 200, whole[0].plane(band).data + 1600);
    }
    const auto pooled = fit_spectral_transform(parts, Tone::linear);
    const auto expected = fit_spectral_transform(whole, Tone::linear);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_FLOAT_EQ(pooled.T[i], expected.T[i]);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(pooled.mean[i], expected.mean[i]);
}

TEST(SpectralTransform, GreyImagesHaveOneFactor) {
    Image image(3, 16, 16);
    for (std::size_t band = 0; band < 3; ++band)
        draw_normals({5, 0}, 0, 0, {image.plane(band).data, 256});
    const auto transform = fit_spectral_transform(std::vector{image}, Tone::linear);
    expect_orthonormal(transform);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(static_cast<double>(transform.T[k]), 1 / std::sqrt(3.0), 1e-6);
    const Image planes = decorrelate(image, transform);
    EXPECT_NEAR(covariance(planes, 1, 1), 0, 1e-12);
    EXPECT_NEAR(covariance(planes, 2, 2), 0, 1e-12);
}

TEST(SpectralTransform, OneBandIsTheIdentity) {
    Image image(1, 4, 4);
    draw_normals({6, 0}, 0, 0, image.values());
    const auto transform = fit_spectral_transform(std::vector{image}, Tone::linear);
    EXPECT_EQ(transform.T, std::vector<float>{1});
    EXPECT_NEAR(static_cast<double>(transform.mean[0]), mean(image, 0), 1e-6);
}

TEST(SpectralTransform, ConstantImagesStillGiveARotation) {
    Image image(3, 1, 1);
    image.values()[1] = 0.5F;
    const auto transform = fit_spectral_transform(std::vector{image}, Tone::srgb);
    expect_orthonormal(transform);
    EXPECT_EQ(transform.mean, (std::vector<float>{0, 0.5F, 0}));
    EXPECT_EQ(transform.tone, Tone::srgb);
}

TEST(Align, UndoesAnyPermutationAndFlip) {
    const std::vector<Image> images = {mixture(32, 32, 7, {0.2F, 0.05F, 0.01F})};
    const auto reference = fit_spectral_transform(images, Tone::linear);
    constexpr std::array<std::array<std::size_t, 3>, 6> kOrders = {
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (const auto& order : kOrders) {
        for (unsigned flips = 0; flips < 8; ++flips) {
            SpectralTransform shuffled = reference;
            for (std::size_t row = 0; row < 3; ++row) {
                const float sign = (flips >> row & 1U) != 0 ? -1.0F : 1.0F;
                for (std::size_t k = 0; k < 3; ++k)
                    shuffled.T[row * 3 + k] = sign * reference.T[order[row] * 3 + k];
            }
            align(shuffled, reference);
            EXPECT_EQ(shuffled.T, reference.T);
        }
    }
}

TEST(Align, KeepsTheOrderWhereItIsAlreadyBest) {
    const auto a = fit_spectral_transform(
        std::vector{mixture(32, 32, 8, {0.2F, 0.05F, 0.01F})}, Tone::linear);
    auto b = fit_spectral_transform(
        std::vector{mixture(32, 32, 9, {0.18F, 0.07F, 0.01F})}, Tone::linear);
    align(b, a);
    for (std::size_t row = 0; row < 3; ++row)
        EXPECT_GT(row_product(a, row, b, row), 0.9) << row;
}

TEST(ApplyTone, EncodesOrLeavesAlone) {
    Image image(1, 1, 3);
    image.values()[1] = 0.18F;
    image.values()[2] = 2;
    const Image same = apply_tone(image, Tone::linear);
    const Image encoded = apply_tone(image, Tone::srgb);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(same.values()[i], image.values()[i]);
        EXPECT_FLOAT_EQ(encoded.values()[i], srgb_encode(image.values()[i]));
    }
}

}  // namespace
}  // namespace sateen
