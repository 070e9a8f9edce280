// SPDX-License-Identifier: Apache-2.0
// Draw from known parameters, estimate, compare: analysis against synthesis.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "reference/stationary_field.hpp"
#include "sateen/analysis/analyse.hpp"
#include "sateen/analysis/car2d.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "support/materials.hpp"
#include "support/synthetic_measurement.hpp"
#include "support/threaded_executor.hpp"

namespace sateen {
namespace {

Image draw(const Material& material, const SynthesisOptions& options) {
    test::ThreadedExecutor executor(2);
    Progress progress;
    auto image = synthesise(material, 0, options, executor, progress);
    EXPECT_TRUE(image);
    return image ? std::move(*image) : Image();
}

/// Mean of the products of values `row`, `col` apart, of values less 100, inside.
double product_mean(const Image& image, int row, int col) {
    double sum = 0;
    std::size_t count = 0;
    const auto cols = static_cast<int>(image.cols());
    for (int r = row; r < static_cast<int>(image.rows()); ++r) {
        for (int c = std::max(0, col); c < std::min(cols, cols + col); ++c, ++count)
            sum += static_cast<double>(image(0, static_cast<std::size_t>(r),
                                             static_cast<std::size_t>(c)) -
                                       100) *
                   static_cast<double>(image(0, static_cast<std::size_t>(r - row),
                                             static_cast<std::size_t>(c - col)) -
                                       100);
    }
    return sum / static_cast<double>(count);
}

// 3 standard errors: a level of 0.3 % for each of 12 coefficients.
TEST(Closure, CoefficientsOfDrawnTexturesAreThoseOfTheMaterial) {
    SerialExecutor executor;
    for (const Car2d& truth : {test::quarter_plane_field(), test::half_plane_field()}) {
        const Material material = test::plain_material({truth});
        for (SynthesisOptions options :
             {SynthesisOptions{.rows = 480, .cols = 512, .tileable = true, .seed = 3},
              SynthesisOptions{.rows = 480, .cols = 512, .recursive = true, .seed = 4}}) {
            Image texture = draw(material, options);
            for (float& value : texture.values()) value -= 100;
            const auto equations =
                interior_normal_equations(texture.plane(0), truth.neighbourhood);
            const auto estimate = estimate_car2d(equations);
            ASSERT_TRUE(estimate);
            const auto eta = static_cast<Eigen::Index>(truth.a.size());
            const Eigen::MatrixXd inverse =
                Eigen::Map<const Eigen::MatrixXd>(equations.V_xx.data(), eta, eta)
                    .inverse();
            for (Eigen::Index i = 0; i < eta; ++i) {
                const auto k = static_cast<std::size_t>(i);
                const double error = std::sqrt(
                    static_cast<double>(estimate->model.variance) * inverse(i, i));
                EXPECT_LT(
                    std::abs(static_cast<double>(estimate->model.a[k] - truth.a[k])),
                    3 * error)
                    << k;
            }
        }
    }
}

// The sample has 230 000 sites and a correlation length of some 10: autocorrelations at
// 1.5 % of the variance, and the fit on top.
TEST(Closure, ATextureOfATextureHasItsAutocovariance) {
    const auto pyramid = test::pyramid_of(test::half_plane_field(), 4);
    Material material = test::plain_material(pyramid);
    material.sample_rows = material.sample_cols = 480;
    const Image sample = draw(material, {.rows = 480, .cols = 480, .tileable = true});
    test::ThreadedExecutor executor(2);
    Progress progress;
    const auto analysis =
        analyse(test::SyntheticMeasurement({sample}), {.levels = 4, .tone = Tone::linear},
                executor, progress);
    ASSERT_TRUE(analysis);
    const auto R = reference::autocovariance_of_density(
        reference::density_on_torus(std::span<const Car2d>(pyramid), 160, 160));
    for (const bool tileable : {true, false}) {
        const Image texture =
            draw(analysis->material,
                 {.rows = 960, .cols = 960, .tileable = tileable, .seed = 9});
        for (int row = 0; row <= 12; row += 3) {
            for (int col = -12; col <= 12; col += 3)
                EXPECT_NEAR(product_mean(texture, row, col),
                            R(static_cast<std::size_t>(row),
                              static_cast<std::size_t>((col + 160) % 160)) /
                                R(0, 0),
                            0.05)
                    << row << ',' << col << (tileable ? " torus" : " plane");
        }
    }
}

TEST(Closure, ToriThatOneTransformCannotDrawHaveNoSeam) {
    // More than 4 M sites: strips, not standardised.
    const Material material =
        test::plain_material(test::pyramid_of(test::half_plane_field(), 4));
    for (const auto& [rows, cols] : {std::pair{2052U, 2056U}, {2051U, 2053U}}) {
        const Image image =
            draw(material, {.rows = rows, .cols = cols, .tileable = true});
        double seam = 0;
        double inside = 0;
        for (std::size_t c = 0; c < cols; ++c) {
            seam += std::abs(static_cast<double>(image(0, rows - 1, c)) -
                             static_cast<double>(image(0, 0, c)));
            for (std::size_t r = 0; r < 50; ++r)
                inside += std::abs(static_cast<double>(image(0, r, c)) -
                                   static_cast<double>(image(0, r + 1, c))) /
                          50;
        }
        EXPECT_NEAR(seam / inside, 1, 0.1);
        EXPECT_NEAR(product_mean(image, 0, 0), 1, 0.05);
    }
}

}  // namespace
}  // namespace sateen
