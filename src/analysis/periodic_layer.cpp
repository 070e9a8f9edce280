// SPDX-License-Identifier: Apache-2.0
// The periodic layer of a texture. See periodic_layer.hpp.
#include "analysis/periodic_layer.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "analysis/fold.hpp"
#include "sateen/analysis/spectral.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {
namespace {

/// Of the variance of the residual: what rounding the coefficients of a cell may add.
constexpr double kNoiseShare = 0.04;
/// A coefficient is shrunk by this many times the variance that the residual gives it.
constexpr double kShrinkage = 4;

double sinc(double x) {
    return x == 0 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

/// c(h) = mean of m e^{-2πi (m u + n v)}, without the blur of the linear splat.
std::vector<std::complex<double>> series_of(PlaneView<const float> cell,
                                            const std::vector<Harmonic>& harmonics) {
    const std::size_t P = cell.rows;
    const std::size_t Q = cell.cols;
    // Row sums for every n first.
    std::vector<std::complex<double>> rows(P * (Q / 2 + 1));
    for (std::size_t r = 0; r < P; ++r)
        for (std::size_t n = 0; n <= Q / 2; ++n)
            for (std::size_t c = 0; c < Q; ++c)
                rows[r * (Q / 2 + 1) + n] +=
                    static_cast<double>(cell(r, c)) *
                    std::polar(1.0, -2 * std::numbers::pi *
                                        static_cast<double>(n * c % Q) /
                                        static_cast<double>(Q));
    std::vector<std::complex<double>> series;
    for (const Harmonic& h : harmonics) {
        std::complex<double> sum = 0;
        for (std::size_t r = 0; r < P; ++r)
            sum += rows[r * (Q / 2 + 1) + static_cast<std::size_t>(h.n)] *
                   std::polar(1.0, -2 * std::numbers::pi * h.m * static_cast<double>(r) /
                                       static_cast<double>(P));
        const double blur =
            sinc(h.m / static_cast<double>(P)) * sinc(h.n / static_cast<double>(Q));
        series.push_back(sum / (blur * blur * static_cast<double>(P * Q)));
    }
    return series;
}

PeriodicCell quantised(PlaneView<const float> cell, double residual_variance,
                       double pixels) {
    PeriodicCell result;
    if (!(residual_variance > 0)) return result;
    const auto harmonics = half_plane_order(cell.rows, cell.cols);
    const auto series = series_of(cell, harmonics);
    const double step = std::sqrt(12 * kNoiseShare * residual_variance /
                                  static_cast<double>(cell.size()));
    result.step = static_cast<float>(step);
    const auto push = [&](double value) {
        result.coefficients.push_back(static_cast<std::int16_t>(std::clamp(
            std::round(value / static_cast<double>(result.step)), -32767.0, 32767.0)));
    };
    std::size_t used = 1;
    for (std::size_t h = 0; h < series.size(); ++h) {
        const double noise = kShrinkage * residual_variance / pixels;
        const double power = std::norm(series[h]);
        const double kept = h == 0 ? 1 : power > noise ? 1 - noise / power : 0;
        push(kept * series[h].real());
        if (h > 0) push(kept * series[h].imag());
        const std::size_t n = result.coefficients.size();
        if (result.coefficients[n - 1] != 0 || (h > 0 && result.coefficients[n - 2] != 0))
            used = n;
    }
    result.coefficients.resize(used);
    return result;
}

struct Moments {
    double mean = 0;
    double variance = 0;
    double pixels = 0;
};

Moments moments_of(std::span<const Image> images, std::size_t plane) {
    Moments moments;
    double sum = 0;
    for (const Image& image : images) {
        const PlaneView<const float> view = image.plane(plane);
        for (std::size_t i = 0; i < view.size(); ++i)
            sum += static_cast<double>(view.data[i]);
        moments.pixels += static_cast<double>(view.size());
    }
    moments.mean = sum / moments.pixels;
    double squares = 0;
    for (const Image& image : images) {
        const PlaneView<const float> view = image.plane(plane);
        for (std::size_t i = 0; i < view.size(); ++i) {
            const double value = static_cast<double>(view.data[i]) - moments.mean;
            squares += value * value;
        }
    }
    moments.variance = squares / moments.pixels;
    return moments;
}

}  // namespace

SeparatedImages separate(std::span<const Image> images, const AlignedLayer& aligned,
                         Tone tone, const SpectralTransform* reference,
                         Executor& executor) {
    const PeriodicLayer& layer = aligned.layer;
    const LatticeMap map(layer);
    // The residual has no mean of its own: a colour transform of it about that of the image.
    const Image cell =
        fold(images, map, aligned.displacements, layer.rows, layer.cols, executor);
    std::vector<Image> rest;
    for (std::size_t k = 0; k < images.size(); ++k)
        rest.push_back(
            subtract_cells(images[k], map, aligned.displacements[k], cell, executor));
    SeparatedImages result;
    result.spectral = fit_spectral_transform(rest, tone);
    for (std::size_t band = 0; band < result.spectral.mean.size(); ++band)
        result.spectral.mean[band] = static_cast<float>(moments_of(images, band).mean);
    if (reference != nullptr) align(result.spectral, *reference);

    for (const Image& image : images)
        result.planes.push_back(decorrelate(image, result.spectral));
    std::vector<PeriodicCell>& cells = result.structure.cells;
    cells = fold_mean_cells(result.planes, aligned, executor);
    result.residuals = residuals_of(result.planes, aligned, cells, executor);
    fold_residual(aligned, cells, result.residuals, executor);
    return result;
}

std::vector<PeriodicCell> fold_mean_cells(std::span<const Image> planes,
                                          const AlignedLayer& aligned,
                                          Executor& executor) {
    const PeriodicLayer& layer = aligned.layer;
    const LatticeMap map(layer);
    const Image cells =
        fold(planes, map, aligned.displacements, layer.rows, layer.cols, executor);
    std::vector<Image> rest;
    for (std::size_t k = 0; k < planes.size(); ++k)
        rest.push_back(
            subtract_cells(planes[k], map, aligned.displacements[k], cells, executor));
    std::vector<PeriodicCell> result;
    for (std::size_t plane = 0; plane < cells.bands(); ++plane) {
        const Moments moments = moments_of(rest, plane);
        result.push_back(quantised(cells.plane(plane), moments.variance, moments.pixels));
    }
    return result;
}

std::vector<Image> residuals_of(std::span<const Image> planes,
                                const AlignedLayer& aligned,
                                const std::vector<PeriodicCell>& cells,
                                Executor& executor) {
    const CellTable table(aligned.layer, cells);
    const LatticeMap map(aligned.layer);
    std::vector<Image> residuals;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        const Image& image = planes[k];
        Image& residual =
            residuals.emplace_back(image.bands(), image.rows(), image.cols());
        parallel_for(executor, image.rows(), [&](std::size_t r) {
            for (std::size_t c = 0; c < image.cols(); ++c) {
                const auto u = phase_at(map, aligned.displacements[k], r, c);
                const auto cell = table.at(u[0], u[1]);
                for (std::size_t plane = 0; plane < image.bands(); ++plane)
                    residual(plane, r, c) = image(plane, r, c) - cell[plane];
            }
        });
    }
    return residuals;
}

}  // namespace sateen
