// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "analysis/quality_parts.hpp"
#include "sateen/core/periodic_part.hpp"

namespace sateen::quality {
namespace {

double signed_frequency(std::size_t k, std::size_t n) {
    const auto whole = static_cast<double>(n);
    return (k <= n / 2 ? static_cast<double>(k) : static_cast<double>(k) - whole) / whole;
}

}  // namespace

Result<SplitComplexPlane> periodic_spectrum(PlaneView<const float> plane,
                                            const Fft2d& fft) {
    Image periodic(1, plane.rows, plane.cols);
    SerialExecutor serial;
    SATEEN_CHECK(periodic_part(plane, periodic.plane(0), serial));
    SplitComplexPlane spectrum(plane.rows, fft.spectrum_cols());
    fft.forward(periodic.plane(0), spectrum.view(), serial);
    return spectrum;
}

Taper::Taper(std::size_t length) : gain(length) {
    const std::size_t edge = length / 4;
    for (std::size_t i = 0; i < length; ++i) {
        const std::size_t from_end = std::min(i, length - 1 - i);
        const double phase = std::numbers::pi * (static_cast<double>(from_end) + 0.5) /
                             static_cast<double>(edge);
        gain[i] =
            from_end < edge ? static_cast<float>(0.5 - 0.5 * std::cos(phase)) : 1.0F;
        energy += static_cast<double>(gain[i]) * static_cast<double>(gain[i]);
    }
}

double Taper::overlap(std::size_t lag) const {
    double sum = 0;
    for (std::size_t i = 0; i < gain.size(); ++i) {
        sum += static_cast<double>(gain[i]) *
               static_cast<double>(gain[(i + lag) % gain.size()]);
    }
    return sum;
}

SplitComplexPlane tapered_spectrum(PlaneView<const float> plane, const SpectrumGrid& grid,
                                   const Fft2d& fft) {
    const Taper& down = grid.down;
    const Taper& across = grid.across;
    double sum = 0;
    double total = 0;
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c) {
            const double w =
                static_cast<double>(down.gain[r]) * static_cast<double>(across.gain[c]);
            sum += w * static_cast<double>(plane(r, c));
            total += w;
        }
    }
    const auto mean = static_cast<float>(sum / total);
    Image tapered(1, plane.rows, plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c) {
            tapered(0, r, c) = down.gain[r] * across.gain[c] * (plane(r, c) - mean);
        }
    }
    SplitComplexPlane spectrum(plane.rows, fft.spectrum_cols());
    SerialExecutor serial;
    fft.forward(tapered.plane(0), spectrum.view(), serial);
    return spectrum;
}

SpectrumGrid::SpectrumGrid(std::size_t rows, std::size_t cols)
    : down(rows), across(cols), cell(rows * (cols / 2 + 1), kNoCell) {
    constexpr double kRingsPerOctave = 2;
    const double lowest = 3.0 / static_cast<double>(std::min(rows, cols));
    rings =
        static_cast<std::size_t>(std::ceil(kRingsPerOctave * std::log2(0.5 / lowest)));
    bins.resize(rings * kSectors);
    for (std::size_t m = 0; m < rows; ++m) {
        const double fy = signed_frequency(m, rows);
        for (std::size_t n = 0; n < cols / 2 + 1; ++n) {
            const double fx = static_cast<double>(n) / static_cast<double>(cols);
            const double radius = std::hypot(fx, fy);
            if (radius < lowest) continue;
            const auto ring =
                static_cast<std::size_t>(kRingsPerOctave * std::log2(radius / lowest));
            // Sectors are centred on the axes, where weaves have their power.
            const double half_turns = std::atan2(fy, fx) / std::numbers::pi + 0.5;
            const std::size_t sector =
                static_cast<std::size_t>(half_turns * kSectors + 0.5) % kSectors;
            const std::size_t index = std::min(ring, rings - 1) * kSectors + sector;
            cell[m * (cols / 2 + 1) + n] = static_cast<std::uint16_t>(index);
            bins[index] += 1;
        }
    }
}

void add_power(const SplitComplexPlane& spectrum, const SpectrumGrid& grid, double weight,
               Features& features) {
    // A tenth more or less contrast is hard to see.
    constexpr double kFloorNepers = 0.1;
    const auto view = spectrum.view();
    std::vector<double> power(grid.bins.size());
    for (std::size_t m = 0; m < spectrum.rows(); ++m) {
        const std::uint16_t* cell = grid.cell.data() + m * spectrum.cols();
        for (std::size_t n = 0; n < spectrum.cols(); ++n) {
            if (cell[n] == SpectrumGrid::kNoCell) continue;
            power[cell[n]] += static_cast<double>(view.re(m, n) * view.re(m, n) +
                                                  view.im(m, n) * view.im(m, n));
        }
    }
    // White noise of variance v has E|ŷ|² = v Σ taper² in every bin.
    const double energy = grid.down.energy * grid.across.energy;
    for (std::size_t ring = 0; ring < grid.rings; ++ring) {
        features.begin_group(weight / static_cast<double>(grid.rings), kFloorNepers);
        for (std::size_t s = 0; s < SpectrumGrid::kSectors; ++s) {
            const std::size_t i = ring * SpectrumGrid::kSectors + s;
            const double density = power[i] / (std::max(grid.bins[i], 1.0) * energy);
            features.add(0.5 * std::log(density + kInvisible * kInvisible));
        }
    }
}

// Lags grow in octaves, so that the few short ones, which decide how a grain looks, weigh
// as much as the many long ones, which decide a pattern. Contrast is left to the power.
void add_autocovariance(const SplitComplexPlane& spectrum, const SpectrumGrid& grid,
                        const Fft2d& fft, double weight, Features& features) {
    constexpr double kFloor = 0.02;
    const std::size_t M = fft.rows();
    const std::size_t N = fft.cols();
    SplitComplexPlane power(M, fft.spectrum_cols());
    const auto from = spectrum.view();
    const auto to = power.view();
    for (std::size_t m = 0; m < M; ++m) {
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            to.re(m, n) = from.re(m, n) * from.re(m, n) + from.im(m, n) * from.im(m, n);
        }
    }
    Image covariance(1, M, N);
    SerialExecutor serial;
    fft.inverse(to, covariance.plane(0), serial);

    const std::size_t longest = std::min(M, N) / 4;
    std::vector<double> down_overlap(longest + 1);
    std::vector<double> across_overlap(longest + 1);
    for (std::size_t lag = 0; lag <= longest; ++lag) {
        down_overlap[lag] = grid.down.overlap(lag);
        across_overlap[lag] = grid.across.overlap(lag);
    }
    const double variance = static_cast<double>(covariance(0, 0, 0)) /
                                (grid.down.energy * grid.across.energy) +
                            kInvisible * kInvisible;

    std::size_t annuli = 0;
    for (std::size_t inner = 1; inner <= longest; inner *= 2) ++annuli;
    std::size_t inner = 1;
    for (std::size_t a = 0; a < annuli; ++a, inner *= 2) {
        const std::size_t outer = std::min(2 * inner, longest + 1);
        features.begin_group(weight / static_cast<double>(annuli), kFloor);
        // The other half plane holds the same numbers.
        for (std::size_t r = 0; r < outer; ++r) {
            for (std::size_t k = 0; k < 2 * outer - 1; ++k) {
                const bool left = k < outer - 1;
                const std::size_t c = left ? outer - 1 - k : k - (outer - 1);
                const std::size_t radius_sq = r * r + c * c;
                if (r == 0 && left) continue;
                if (radius_sq < inner * inner || radius_sq >= outer * outer) continue;
                features.add(static_cast<double>(covariance(0, r, left ? N - c : c)) /
                             (down_overlap[r] * across_overlap[c] * variance));
            }
        }
    }
}

}  // namespace sateen::quality
