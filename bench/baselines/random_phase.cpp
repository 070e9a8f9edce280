// SPDX-License-Identifier: Apache-2.0
#include "baselines/random_phase.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sateen/core/fft.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/core/periodic_part.hpp"

namespace sateen::baselines {
namespace {

double mean_of(PlaneView<const float> plane) {
    double sum = 0;
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c)
            sum += static_cast<double>(plane(r, c));
    }
    return sum / static_cast<double>(plane.size());
}

// The periodic component of the centre of a plane, less its mean.
Result<Image> periodic_centre(PlaneView<const float> plane, std::size_t rows,
                              std::size_t cols) {
    const auto window =
        plane.window((plane.rows - rows) / 2, (plane.cols - cols) / 2, rows, cols);
    Image out(1, rows, cols);
    SerialExecutor serial;
    SATEEN_CHECK(periodic_part(window, out.plane(0), serial));
    const auto mean = static_cast<float>(mean_of(out.plane(0)));
    for (float& v : out.values()) v -= mean;
    return out;
}

}  // namespace

Result<Image> random_phase(const Image& image, std::size_t rows, std::size_t cols,
                           std::uint64_t seed) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(rows, cols));
    const std::size_t spot_rows = fft_size_at_most(std::min(rows, image.rows()));
    const std::size_t spot_cols = fft_size_at_most(std::min(cols, image.cols()));
    const auto gain = static_cast<float>(std::sqrt(
        static_cast<double>(rows * cols) / static_cast<double>(spot_rows * spot_cols)));
    SerialExecutor serial;

    Image noise(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        draw_normals({seed, 0}, static_cast<std::int32_t>(r), 0,
                     {noise.plane(0).row(r), cols});
    }
    SplitComplexPlane phase(rows, fft.spectrum_cols());
    fft.forward(noise.plane(0), phase.view(), serial);

    Image out(image.bands(), rows, cols);
    for (std::size_t b = 0; b < image.bands(); ++b) {
        SATEEN_TRY(const Image spot,
                   periodic_centre(image.plane(b), spot_rows, spot_cols));
        Image padded(1, rows, cols);
        for (std::size_t r = 0; r < spot_rows; ++r) {
            for (std::size_t c = 0; c < spot_cols; ++c)
                padded(0, r, c) = gain * spot(0, r, c);
        }
        SplitComplexPlane spectrum(rows, fft.spectrum_cols());
        fft.forward(padded.plane(0), spectrum.view(), serial);
        const auto y = spectrum.view();
        const auto e = phase.view();
        for (std::size_t m = 0; m < rows; ++m) {
            for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
                const float length = std::max(std::hypot(e.re(m, n), e.im(m, n)), 1e-20F);
                const float re = e.re(m, n) / length;
                const float im = e.im(m, n) / length;
                const float y_re = y.re(m, n);
                y.re(m, n) = y_re * re - y.im(m, n) * im;
                y.im(m, n) = y_re * im + y.im(m, n) * re;
            }
        }
        fft.inverse(y, out.plane(b), serial);
        const auto mean = static_cast<float>(mean_of(image.plane(b)));
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < cols; ++c) out(b, r, c) += mean;
        }
    }
    return out;
}

}  // namespace sateen::baselines
