// SPDX-License-Identifier: Apache-2.0
// Drawing trials. See modulation_trial.hpp.
#include "analysis/modulation_trial.hpp"

#include <cmath>

#include "sateen/core/fft.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/material/band_modulation.hpp"
#include "sateen/material/smooth_density.hpp"

namespace sateen {
namespace {

/// Of the random phases of the trial: none that a texture uses.
constexpr std::uint32_t kTrialBand = 128;
constexpr std::uint64_t kTrialSeed = 0;

}  // namespace

Result<Image> with_random_phases(const Image& planes, bool together, Executor& executor) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(planes.rows(), planes.cols()));
    Image out(planes.bands(), planes.rows(), planes.cols(), uninitialised);
    SplitComplexPlane noise(fft.rows(), fft.spectrum_cols());
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    for (std::size_t plane = 0; plane < planes.bands(); ++plane) {
        if (plane == 0 || !together) {
            const PlaneView<float> white = out.plane(plane);
            parallel_for(executor, white.rows, [&](std::size_t r) {
                draw_normals({kTrialSeed, kTrialBand + static_cast<std::uint32_t>(plane)},
                             static_cast<std::int32_t>(r), 0, {white.row(r), white.cols});
            });
            fft.forward(white, noise.view(), executor);
        }
        fft.forward(planes.plane(plane), spectrum.view(), executor);
        const SplitComplexView<float> s = spectrum.view();
        const SplitComplexView<float> n = noise.view();
        for (std::size_t k = 0; k < fft.rows(); ++k)
            for (std::size_t l = 0; l < fft.spectrum_cols(); ++l) {
                const float length = std::hypot(n.re(k, l), n.im(k, l));
                const float re = length > 0 ? n.re(k, l) / length : 1.0F;
                const float im = length > 0 ? n.im(k, l) / length : 0.0F;
                const float a = s.re(k, l);
                const float b = s.im(k, l);
                s.re(k, l) = a * re - b * im;
                s.im(k, l) = a * im + b * re;
            }
        fft.inverse(s, out.plane(plane), executor);
    }
    return out;
}

Result<void> draw_trial_field(const SmoothField& field, std::size_t level,
                              PlaneView<float> out, Executor& executor) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(out.rows, out.cols));
    const auto band = static_cast<std::uint32_t>(kTrialBand + 8 + level);
    for (std::size_t r = 0; r < out.rows; ++r)
        draw_normals({kTrialSeed, band}, static_cast<std::int32_t>(r), 0,
                     {out.row(r), out.cols});
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(out, spectrum.view(), executor);
    const auto scale = static_cast<double>(field_spacing(level));
    const Image density = smooth_density(field, out.rows, out.cols, scale, scale);
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            const float root = std::sqrt(density(0, m, n));
            spectrum.view().re(m, n) *= root;
            spectrum.view().im(m, n) *= root;
        }
    fft.inverse(spectrum.view(), out, executor);
    return {};
}

}  // namespace sateen
