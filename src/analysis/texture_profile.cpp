// SPDX-License-Identifier: Apache-2.0
#include "sateen/analysis/texture_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/quality_parts.hpp"
#include "sateen/core/fft.hpp"

namespace sateen {
namespace {

using quality::SpectrumGrid;

// Bits of an image beyond the largest size the transforms take are left out on all sides.
PlaneView<const float> centre(PlaneView<const float> plane) {
    const std::size_t rows = fft_size_at_most(plane.rows, 2);
    const std::size_t cols = fft_size_at_most(plane.cols, 2);
    return plane.window((plane.rows - rows) / 2, (plane.cols - cols) / 2, rows, cols);
}

void add_histograms(const Image& lab, TextureProfile& profile) {
    constexpr std::array<float, 3> kLeast = {0, -TextureProfile::kAxisRange,
                                             -TextureProfile::kAxisRange};
    constexpr std::array<float, 3> kRange = {100, 2 * TextureProfile::kAxisRange,
                                             2 * TextureProfile::kAxisRange};
    const double share = 1 / static_cast<double>(lab.plane_size());
    for (std::size_t b = 0; b < 3; ++b) {
        for (std::size_t i = 0; i < lab.plane_size(); ++i) {
            const float t = (lab.plane(b).data[i] - kLeast[b]) / kRange[b];
            const float bin = std::clamp(t * float{TextureProfile::kBins}, 0.0F,
                                         float{TextureProfile::kBins - 1});
            profile.histogram[b][static_cast<std::size_t>(bin)] += share;
        }
    }
}

/// Power density by bin of the half spectrum.
Image density_of(const SplitComplexPlane& spectrum, double energy) {
    Image density(1, spectrum.rows(), spectrum.cols());
    const auto view = spectrum.view();
    for (std::size_t m = 0; m < spectrum.rows(); ++m) {
        for (std::size_t n = 0; n < spectrum.cols(); ++n) {
            const auto re = static_cast<double>(view.re(m, n));
            const auto im = static_cast<double>(view.im(m, n));
            density(0, m, n) = static_cast<float>((re * re + im * im) / energy);
        }
    }
    return density;
}

void add_radial(const Image& density, std::size_t cols, TextureProfile& profile) {
    constexpr double kRingsPerOctave = 10;
    const std::size_t rows = density.rows();
    const double lowest = 2.0 / static_cast<double>(std::min(rows, cols));
    const auto rings =
        static_cast<std::size_t>(std::ceil(kRingsPerOctave * std::log2(0.5 / lowest)));
    std::vector<double> sum(rings);
    std::vector<double> count(rings);
    for (std::size_t m = 0; m < rows; ++m) {
        const auto whole = static_cast<double>(rows);
        const double fy = static_cast<double>(std::min(m, rows - m)) / whole;
        for (std::size_t n = 0; n < density.cols(); ++n) {
            const double fx = static_cast<double>(n) / static_cast<double>(cols);
            const double radius = std::hypot(fx, fy);
            if (radius < lowest || radius >= 0.5) continue;
            const auto ring = std::min(
                rings - 1,
                static_cast<std::size_t>(kRingsPerOctave * std::log2(radius / lowest)));
            sum[ring] += static_cast<double>(density(0, m, n));
            count[ring] += 1;
        }
    }
    for (std::size_t ring = 0; ring < rings; ++ring) {
        if (count[ring] == 0) continue;
        profile.frequency.push_back(
            lowest * std::exp2((static_cast<double>(ring) + 0.5) / kRingsPerOctave));
        profile.power.push_back(sum[ring] / count[ring]);
    }
}

// The picture of the spectrum, each of its pixels the mean of the bins that fall into it.
Image picture_of(const Image& density, std::size_t cols) {
    constexpr std::size_t kSide = 256;
    const std::size_t rows = density.rows();
    const std::size_t side = std::min({kSide, rows, cols});
    std::vector<double> sum(side * side);
    std::vector<double> count(side * side);
    for (std::size_t m = 0; m < rows; ++m) {
        const std::size_t r = (m + rows / 2) % rows * side / rows;
        for (std::size_t n = 0; n < cols; ++n) {
            const bool mirrored = n >= density.cols();
            const double value = static_cast<double>(
                mirrored ? density(0, (rows - m) % rows, cols - n) : density(0, m, n));
            const std::size_t c = (n + cols / 2) % cols * side / cols;
            sum[r * side + c] += value;
            count[r * side + c] += 1;
        }
    }
    constexpr double kQuiet = 1e-3;
    Image picture(1, side, side);
    for (std::size_t i = 0; i < sum.size(); ++i) {
        picture.values()[i] =
            static_cast<float>(std::log10(sum[i] / std::max(count[i], 1.0) + kQuiet));
    }
    return picture;
}

void add_autocovariance(const Image& density, const SpectrumGrid& grid, const Fft2d& fft,
                        TextureProfile& profile) {
    SplitComplexPlane power(fft.rows(), fft.spectrum_cols());
    for (std::size_t m = 0; m < fft.rows(); ++m) {
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            power.view().re(m, n) = density(0, m, n);
        }
    }
    Image covariance(1, fft.rows(), fft.cols());
    SerialExecutor serial;
    fft.inverse(power.view(), covariance.plane(0), serial);
    const double variance = std::max(static_cast<double>(covariance(0, 0, 0)), 1e-12);
    constexpr std::size_t kLongest = 128;
    for (std::size_t lag = 0; lag <= std::min(kLongest, fft.cols() / 4); ++lag) {
        profile.along_cols.push_back(static_cast<double>(covariance(0, 0, lag)) /
                                     variance * grid.across.energy /
                                     grid.across.overlap(lag));
    }
    for (std::size_t lag = 0; lag <= std::min(kLongest, fft.rows() / 4); ++lag) {
        profile.along_rows.push_back(static_cast<double>(covariance(0, lag, 0)) /
                                     variance * grid.down.energy /
                                     grid.down.overlap(lag));
    }
}

}  // namespace

Result<TextureProfile> texture_profile(const Image& image) {
    SATEEN_CHECK(quality::check_image(image, "image"));
    TextureProfile profile;
    const Image lab = quality::to_lab(image, quality::choose_exposure(image));
    add_histograms(lab, profile);
    const auto lightness = centre(lab.plane(0));
    SATEEN_TRY(const Fft2d fft, Fft2d::create(lightness.rows, lightness.cols));
    const SpectrumGrid grid(lightness.rows, lightness.cols);
    const Image density = density_of(quality::tapered_spectrum(lightness, grid, fft),
                                     grid.down.energy * grid.across.energy);
    add_radial(density, lightness.cols, profile);
    profile.spectrum = picture_of(density, lightness.cols);
    add_autocovariance(density, grid, fft, profile);
    return profile;
}

}  // namespace sateen
