// SPDX-License-Identifier: Apache-2.0
// Sizes too large for the definition, against FFTW in double.
#include <fftw3.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <utility>
#include <vector>

#include "sateen/core/fft.hpp"

namespace sateen {
namespace {

TEST(Fft2d, EqualsFftwAtLargeSizes) {
    SerialExecutor executor;
    for (const auto& [rows, cols] : {std::pair<std::size_t, std::size_t>{512, 512},
                                     {1024, 1024},
                                     {800, 800},
                                     {768, 1280},
                                     {2048, 512},
                                     {675, 1215},
                                     {1, 65536},
                                     {16384, 3}}) {
        Image image(1, rows, cols);
        std::mt19937 engine(static_cast<unsigned>(rows * cols));
        std::normal_distribution<float> normal;
        for (float& value : image.values()) value = normal(engine);
        const std::size_t half = cols / 2 + 1;
        std::vector<double> in(image.values().begin(), image.values().end());
        std::vector<std::complex<double>> expected(rows * half);
        auto* out = reinterpret_cast<fftw_complex*>(expected.data());
        fftw_plan plan =
            fftw_plan_dft_r2c_2d(static_cast<int>(rows), static_cast<int>(cols),
                                 in.data(), out, FFTW_ESTIMATE);
        fftw_execute(plan);
        fftw_destroy_plan(plan);

        const Fft2d fft = *Fft2d::create(rows, cols);
        SplitComplexPlane spectrum(rows, half);
        fft.forward(image.plane(0), spectrum.view(), executor);
        double error = 0;
        double norm = 0;
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < half; ++c) {
                const std::complex<double> value(expected[r * half + c]);
                const std::complex<double> found(
                    static_cast<double>(spectrum.view().re(r, c)),
                    static_cast<double>(spectrum.view().im(r, c)));
                error += std::norm(found - value);
                norm += std::norm(value);
            }
        }
        EXPECT_LT(std::sqrt(error / norm), 1e-6) << rows << " x " << cols;

        Image back(1, rows, cols);
        fft.inverse(spectrum.view(), back.plane(0), executor);
        error = 0;
        for (std::size_t i = 0; i < in.size(); ++i) {
            error += std::pow(static_cast<double>(back.values()[i]) - in[i], 2);
        }
        EXPECT_LT(std::sqrt(error / static_cast<double>(in.size())), 1e-6)
            << rows << " x " << cols;
    }
}

}  // namespace
}  // namespace sateen
