// SPDX-License-Identifier: Apache-2.0
// The periodic layer of a texture. See periodic_layer.hpp.
#include "analysis/periodic_layer.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "analysis/fold.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/analysis/spectral.hpp"
#include "sateen/material/cell_table.hpp"

namespace sateen {
namespace {

/// Of the variance of the residual: what rounding the coefficients of a cell may add.
constexpr double kNoiseShare = 0.04;
/// A coefficient is shrunk by this many times the variance that the residual gives it.
constexpr double kShrinkage = 4;
/// Samples of g for each site of the cell, in the distribution of m + s q(g).
constexpr std::size_t kQuantiles = 24;
/// Between these quantiles a tone curve has its knots.
constexpr double kOutermost = 0.002;

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

double mean_of(PlaneView<const float> plane) {
    double sum = 0;
    for (std::size_t i = 0; i < plane.size(); ++i)
        sum += static_cast<double>(plane.data[i]);
    return sum / static_cast<double>(plane.size());
}

double variance_of(PlaneView<const float> plane) {
    const double mean = mean_of(plane);
    double squares = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const double value = static_cast<double>(plane.data[i]) - mean;
        squares += value * value;
    }
    return squares / static_cast<double>(plane.size());
}

/// q(g)
double value_of(const Marginal& marginal, double g) {
    const auto scale = static_cast<double>(marginal.scale);
    if (marginal.knots.empty()) return scale * g;
    constexpr auto kRange = static_cast<double>(Marginal::kRange);
    const double t = (std::clamp(g, -kRange, kRange) + kRange) *
                     (static_cast<double>(Marginal::kKnots - 1) / (2 * kRange));
    const auto j = std::min(static_cast<std::size_t>(t), Marginal::kKnots - 2);
    const auto low = static_cast<double>(marginal.knots[j]);
    return scale * (low + (t - static_cast<double>(j)) *
                              (static_cast<double>(marginal.knots[j + 1]) - low));
}

double quantile(const std::vector<float>& sorted, double p) {
    const double x = p * static_cast<double>(sorted.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(x), sorted.size() - 2);
    const auto low = static_cast<double>(sorted[i]);
    return low +
           (x - static_cast<double>(i)) * (static_cast<double>(sorted[i + 1]) - low);
}

/// F(x) of a sorted sample.
double rank(const std::vector<float>& sorted, double x) {
    const auto at = std::ranges::lower_bound(sorted, static_cast<float>(x));
    return static_cast<double>(at - sorted.begin()) / static_cast<double>(sorted.size());
}

std::vector<float> drawn_values(const CellTable& table, std::size_t plane,
                                const Marginal& marginal) {
    std::vector<float> residual;
    for (std::size_t k = 0; k < kQuantiles; ++k)
        residual.push_back(static_cast<float>(value_of(
            marginal, normal_quantile((static_cast<double>(k) + 0.5) / kQuantiles))));
    std::vector<float> values;
    for (std::size_t r = 0; r < table.rows(); ++r)
        for (std::size_t c = 0; c < table.cols(); ++c) {
            const float* site = table.site(r, c);
            for (const float value : residual)
                values.push_back(site[plane] + site[CellTable::kPlanes + plane] * value);
        }
    std::ranges::sort(values);
    return values;
}

ToneCurve curve_between(const std::vector<float>& drawn,
                        const std::vector<float>& wanted) {
    ToneCurve curve;
    const double low = quantile(drawn, kOutermost);
    const double high = quantile(drawn, 1 - kOutermost);
    if (!(high - low > 1e-6)) return curve;
    curve.low = static_cast<float>(low);
    curve.high = static_cast<float>(high);
    for (std::size_t j = 0; j < ToneCurve::kKnots; ++j) {
        const double x = low + (high - low) * static_cast<double>(j) /
                                   static_cast<double>(ToneCurve::kKnots - 1);
        const double p = std::clamp(rank(drawn, x), kOutermost, 1 - kOutermost);
        curve.values.push_back(static_cast<float>(quantile(wanted, p)));
    }
    return curve;
}

}  // namespace

SeparatedImage separate(const Image& image, const AlignedLayer& aligned, Tone tone,
                        const SpectralTransform* reference, Executor& executor) {
    const PeriodicLayer& layer = aligned.layer;
    const LatticeMap map(layer);
    // The residual has no mean of its own: a colour transform of it about that of the image.
    std::vector<Image> rest;
    rest.push_back(subtract_cells(
        image, map, aligned.displacement,
        fold(image, map, aligned.displacement, layer.rows, layer.cols, executor),
        executor));
    SeparatedImage result;
    result.spectral = fit_spectral_transform(rest, tone);
    for (std::size_t band = 0; band < image.bands(); ++band)
        result.spectral.mean[band] = static_cast<float>(mean_of(image.plane(band)));
    if (reference != nullptr) align(result.spectral, *reference);

    result.planes = decorrelate(image, result.spectral);
    std::vector<PeriodicCell>& cells = result.structure.cells;
    cells = fold_mean_cells(result.planes, aligned, executor);
    result.residual = residual_of(result.planes, aligned, cells, executor);
    fold_deviations(aligned, cells, result.residual, executor);
    return result;
}

std::vector<PeriodicCell> fold_mean_cells(const Image& planes,
                                          const AlignedLayer& aligned,
                                          Executor& executor) {
    const PeriodicLayer& layer = aligned.layer;
    const LatticeMap map(layer);
    const Image cells =
        fold(planes, map, aligned.displacement, layer.rows, layer.cols, executor);
    const Image rest = subtract_cells(planes, map, aligned.displacement, cells, executor);
    std::vector<PeriodicCell> result;
    for (std::size_t plane = 0; plane < planes.bands(); ++plane)
        result.push_back(quantised(cells.plane(plane), variance_of(rest.plane(plane)),
                                   static_cast<double>(planes.plane_size())));
    return result;
}

Image residual_of(const Image& planes, const AlignedLayer& aligned,
                  const std::vector<PeriodicCell>& cells, Executor& executor) {
    const CellTable table(aligned.layer, cells);
    const LatticeMap map(aligned.layer);
    Image result(planes.bands(), planes.rows(), planes.cols());
    parallel_for(executor, planes.rows(), [&](std::size_t r) {
        for (std::size_t c = 0; c < planes.cols(); ++c) {
            const auto u = phase_at(map, aligned.displacement, r, c);
            const auto cell = table.at(u[0], u[1]);
            for (std::size_t plane = 0; plane < planes.bands(); ++plane)
                result(plane, r, c) = planes(plane, r, c) - cell[plane];
        }
    });
    return result;
}

void fold_deviations(const AlignedLayer& aligned, std::vector<PeriodicCell>& cells,
                     Image& residual, Executor& executor) {
    const PeriodicLayer& layer = aligned.layer;
    const LatticeMap map(layer);
    const std::size_t P = deviation_side(layer.rows);
    const std::size_t Q = deviation_side(layer.cols);
    Image energy(residual.bands(), residual.rows(), residual.cols());
    for (std::size_t plane = 0; plane < residual.bands(); ++plane) {
        const PlaneView<const float> R = std::as_const(residual).plane(plane);
        const auto mean = static_cast<float>(mean_of(R));
        for (std::size_t i = 0; i < R.size(); ++i) {
            const float value = R.data[i] - mean;
            energy.plane(plane).data[i] = value * value;
        }
    }
    // Sites of the deviations are half a step from the border.
    const Image folded = fold(energy, map, aligned.displacement, P, Q, executor, 0.5);
    for (std::size_t plane = 0; plane < cells.size(); ++plane) {
        double mean = 0;
        for (std::size_t i = 0; i < P * Q; ++i)
            mean += static_cast<double>(folded.plane(plane).data[i]) /
                    static_cast<double>(P * Q);
        if (!(mean > 0)) continue;
        std::vector<double> s;
        for (std::size_t i = 0; i < P * Q; ++i)
            s.push_back(std::sqrt(
                std::max(0.01, static_cast<double>(folded.plane(plane).data[i]) / mean)));
        const double step = *std::ranges::max_element(s) / 255;
        cells[plane].deviation_step = static_cast<float>(step);
        cells[plane].deviations.clear();
        for (const double value : s)
            cells[plane].deviations.push_back(
                static_cast<std::uint8_t>(std::max(1L, std::lround(value / step))));
    }
    const CellTable table(layer, cells);
    parallel_for(executor, residual.rows(), [&](std::size_t r) {
        for (std::size_t c = 0; c < residual.cols(); ++c) {
            const auto u = phase_at(map, aligned.displacement, r, c);
            const auto cell = table.at(u[0], u[1]);
            for (std::size_t plane = 0; plane < residual.bands(); ++plane)
                residual(plane, r, c) /= cell[CellTable::kPlanes + plane];
        }
    });
}

void fit_tone_curves(const Image& planes, const PeriodicLayer& layer,
                     const std::vector<Marginal>& marginals,
                     std::vector<PeriodicCell>& cells) {
    const CellTable table(layer, cells);
    for (std::size_t plane = 0; plane < cells.size(); ++plane) {
        const PlaneView<const float> view = planes.plane(plane);
        std::vector<float> wanted(view.data, view.data + view.size());
        std::ranges::sort(wanted);
        cells[plane].curve =
            curve_between(drawn_values(table, plane, marginals[plane]), wanted);
    }
}

}  // namespace sateen
