// SPDX-License-Identifier: Apache-2.0
#include "synthesis/appearance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sateen/core/colour.hpp"
#include "sateen/core/normal.hpp"
#include "support/simd_targets.hpp"

namespace sateen {
namespace {

constexpr double kTolerance = 1e-5;

/// A rotation of the bands, curves that rise unevenly, and codes below 0 and above 1.
Subspace coloured(Tone tone) {
    Subspace subspace;
    subspace.spectral.tone = tone;
    subspace.spectral.mean = {0.9F, 0.5F, 0.1F};
    subspace.spectral.T = {0.6F, 0.64F, 0.48F, -0.8F, 0.48F, 0.36F, 0.0F, -0.6F, 0.8F};
    for (int plane = 0; plane < 3; ++plane) {
        Marginal marginal;
        marginal.scale = 0.3F / static_cast<float>(1 + plane);
        float knot = -2;
        for (std::size_t j = 0; plane < 2 && j < Marginal::kKnots; ++j)
            marginal.knots.push_back(knot += j % 3 == 0 ? 0.0F : 0.4F);
        subspace.marginals.push_back(marginal);
    }
    return subspace;
}

Subspace grey() {
    Subspace subspace = coloured(Tone::srgb);
    subspace.spectral.mean = {0.5F};
    subspace.spectral.T = {1};
    subspace.marginals.resize(1);
    return subspace;
}

Image normals(std::size_t bands, std::size_t rows, std::size_t cols) {
    Image image(bands, rows, cols);
    for (std::uint32_t band = 0; band < bands; ++band)
        for (std::size_t r = 0; r < rows; ++r)
            draw_normals({1, band}, static_cast<std::int32_t>(r), 0,
                         {image.plane(band).row(r), cols});
    return image;
}

double curve(const Marginal& marginal, double g) {
    if (marginal.knots.empty()) return static_cast<double>(marginal.scale) * g;
    const double x = (std::clamp(g, -3.0, 3.0) + 3) * 2.5;
    const auto j = std::min(static_cast<std::size_t>(x), Marginal::kKnots - 2);
    const double part = x - static_cast<double>(j);
    return static_cast<double>(marginal.scale) *
           ((1 - part) * static_cast<double>(marginal.knots[j]) +
            part * static_cast<double>(marginal.knots[j + 1]));
}

void expect_inverse(const Subspace& subspace, const Image& g, const Image& v) {
    const std::size_t d = g.bands();
    for (std::size_t r = 0; r < g.rows(); ++r)
        for (std::size_t c = 0; c < g.cols(); ++c)
            for (std::size_t band = 0; band < d; ++band) {
                auto value = static_cast<double>(subspace.spectral.mean[band]);
                for (std::size_t i = 0; i < d; ++i)
                    value +=
                        static_cast<double>(subspace.spectral.T[i * d + band]) *
                        curve(subspace.marginals[i], static_cast<double>(g(i, r, c)));
                value = std::max(value, 0.0);
                if (subspace.spectral.tone == Tone::srgb) value = srgb_decode(value);
                ASSERT_NEAR(static_cast<double>(v(band, r, c)), value, kTolerance);
            }
}

TEST(InvertSpectral, IsCurvesThenTransformThenToneOnEveryTarget) {
    SerialExecutor executor;
    for (const Subspace& subspace :
         {coloured(Tone::srgb), coloured(Tone::linear), grey()}) {
        const std::size_t bands = subspace.marginals.size();
        for (const std::size_t cols : {1U, 7U, 64U, 203U}) {
            const Image g = normals(bands, 5, cols);
            test::for_each_simd_target([&] {
                Image v = g;
                invert_spectral(subspace, v.view(), executor);
                expect_inverse(subspace, g, v);
            });
        }
    }
}

}  // namespace
}  // namespace sateen
