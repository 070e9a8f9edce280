// SPDX-License-Identifier: Apache-2.0
#include "analysis/quality_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sateen::quality {
namespace {

constexpr double kPi = std::numbers::pi;

// Raised cosine in octaves: 1 below `edge`, 0 above 2 edge. √(1 - lowpass²) is its
// partner.
double lowpass_gain(double radius, double edge) {
    if (radius <= edge) return 1;
    if (radius >= 2 * edge) return 0;
    return std::cos(kPi / 2 * std::log2(radius / edge));
}

double highpass_gain(double radius, double edge) {
    const double low = lowpass_gain(radius, edge);
    return std::sqrt(std::max(0.0, 1 - low * low));
}

struct Frequency {
    double radius = 0;
    double angle = 0;
};

Frequency frequency(std::size_t m, std::size_t n, std::size_t rows, std::size_t cols) {
    const double signed_m = m <= rows / 2
                                ? static_cast<double>(m)
                                : static_cast<double>(m) - static_cast<double>(rows);
    const double wy = 2 * kPi * signed_m / static_cast<double>(rows);
    const double wx = 2 * kPi * static_cast<double>(n) / static_cast<double>(cols);
    return {std::hypot(wx, wy), std::atan2(wy, wx)};
}

// out = mask in, or mask (-i) in for the Hilbert pair.
void apply_even(PlaneView<const float> mask, SplitComplexView<const float> in,
                SplitComplexView<float> out) {
    for (std::size_t r = 0; r < mask.rows; ++r) {
        for (std::size_t c = 0; c < mask.cols; ++c) {
            out.re(r, c) = mask(r, c) * in.re(r, c);
            out.im(r, c) = mask(r, c) * in.im(r, c);
        }
    }
}

void apply_odd(PlaneView<const float> mask, SplitComplexView<const float> in,
               SplitComplexView<float> out) {
    for (std::size_t r = 0; r < mask.rows; ++r) {
        for (std::size_t c = 0; c < mask.cols; ++c) {
            out.re(r, c) = mask(r, c) * in.im(r, c);
            out.im(r, c) = -mask(r, c) * in.re(r, c);
        }
    }
}

// The low half of the frequencies, of a spectrum that is zero above; amplitudes are kept.
SplitComplexPlane halve(const SplitComplexPlane& spectrum, std::size_t rows,
                        std::size_t cols) {
    SplitComplexPlane half(rows / 2, cols / 4 + 1);
    const auto from = spectrum.view();
    const auto to = half.view();
    constexpr float kAreaRatio = 0.25F;
    for (std::size_t r = 0; r < half.rows(); ++r) {
        const std::size_t source = r < half.rows() / 2 ? r : r + rows / 2;
        for (std::size_t c = 0; c < half.cols(); ++c) {
            to.re(r, c) = kAreaRatio * from.re(source, c);
            to.im(r, c) = kAreaRatio * from.im(source, c);
        }
    }
    return half;
}

Image inverse_of(const Fft2d& fft, SplitComplexView<float> spectrum) {
    Image out(1, fft.rows(), fft.cols());
    SerialExecutor serial;
    fft.inverse(spectrum, out.plane(0), serial);
    return out;
}

void take_magnitude(PyramidLevel& level) {
    const auto re = level.re.values();
    const auto im = level.im.values();
    const auto magnitude = level.magnitude.values();
    for (std::size_t i = 0; i < magnitude.size(); ++i) {
        magnitude[i] = std::sqrt(re[i] * re[i] + im[i] * im[i]);
    }
}

}  // namespace

std::size_t SteerablePyramid::levels_for(std::size_t rows, std::size_t cols) {
    constexpr std::size_t kCoarsest = 16;
    constexpr std::size_t kMost = 4;
    std::size_t levels = 1;
    while (levels < kMost && (std::min(rows, cols) >> levels) >= kCoarsest) ++levels;
    return levels;
}

// Radial and angular parts are those of [Portilla & Simoncelli 2000, section 2.1]: an
// octave-wide raised cosine and cos³(θ - πk/4), which tile the plane.
// Deviation: the real band is the even filter |cos³| and the imaginary one its Hilbert
// pair, where the paper has them exchanged; magnitudes are the same.
Result<SteerablePyramid> SteerablePyramid::create(std::size_t rows, std::size_t cols,
                                                  std::size_t levels) {
    // Σ_k cos⁶(θ - πk/4) = 5/4 for every θ.
    const double angular_scale = std::sqrt(4.0 / 5.0);
    Image entry(2, rows, cols / 2 + 1);
    for (std::size_t m = 0; m < rows; ++m) {
        for (std::size_t n = 0; n < entry.cols(); ++n) {
            const double radius = frequency(m, n, rows, cols).radius;
            entry(0, m, n) = static_cast<float>(highpass_gain(radius, kPi / 2));
            entry(1, m, n) = static_cast<float>(lowpass_gain(radius, kPi / 2));
        }
    }
    std::vector<Stage> stages;
    for (std::size_t level = 0; level < levels; ++level, rows /= 2, cols /= 2) {
        SATEEN_TRY(Fft2d fft, Fft2d::create(rows, cols));
        const std::size_t half = fft.spectrum_cols();
        Stage stage{std::move(fft), Image(kOrientations, rows, half),
                    Image(kOrientations, rows, half), Image(1, rows, half)};
        for (std::size_t m = 0; m < rows; ++m) {
            for (std::size_t n = 0; n < half; ++n) {
                const auto [radius, angle] = frequency(m, n, rows, cols);
                stage.lowpass(0, m, n) =
                    static_cast<float>(lowpass_gain(radius, kPi / 4));
                const double radial = highpass_gain(radius, kPi / 4) * angular_scale;
                for (std::size_t k = 0; k < kOrientations; ++k) {
                    const double cosine =
                        std::cos(angle - kPi * static_cast<double>(k) / kOrientations);
                    const double gain = radial * std::abs(cosine * cosine * cosine);
                    stage.even(k, m, n) = static_cast<float>(gain);
                    stage.odd(k, m, n) = static_cast<float>(std::copysign(gain, cosine));
                }
            }
        }
        stages.push_back(std::move(stage));
    }
    SATEEN_TRY(Fft2d low_fft, Fft2d::create(rows, cols));
    return SteerablePyramid(std::move(stages), std::move(low_fft), std::move(entry));
}

SteerableBands SteerablePyramid::decompose(const SplitComplexPlane& spectrum) const {
    SteerableBands bands;
    SerialExecutor serial;
    SplitComplexPlane current(spectrum.rows(), spectrum.cols());
    apply_even(entry_.plane(0), spectrum.view(), current.view());
    bands.high = inverse_of(stages_.front().fft, current.view());
    apply_even(entry_.plane(1), spectrum.view(), current.view());

    for (const Stage& stage : stages_) {
        const std::size_t rows = stage.fft.rows();
        const std::size_t cols = stage.fft.cols();
        PyramidLevel level{Image(kOrientations, rows, cols),
                           Image(kOrientations, rows, cols),
                           Image(kOrientations, rows, cols)};
        SplitComplexPlane filtered(rows, stage.fft.spectrum_cols());
        const SplitComplexPlane& input = current;
        for (std::size_t k = 0; k < kOrientations; ++k) {
            apply_even(stage.even.plane(k), input.view(), filtered.view());
            stage.fft.inverse(filtered.view(), level.re.plane(k), serial);
            apply_odd(stage.odd.plane(k), input.view(), filtered.view());
            stage.fft.inverse(filtered.view(), level.im.plane(k), serial);
        }
        take_magnitude(level);
        bands.levels.push_back(std::move(level));
        apply_even(stage.lowpass.plane(0), input.view(), filtered.view());
        current = halve(filtered, rows, cols);
    }
    bands.low = inverse_of(low_fft_, current.view());
    return bands;
}

}  // namespace sateen::quality
