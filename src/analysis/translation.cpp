// SPDX-License-Identifier: Apache-2.0
// Correlations behind a marginal curve. See translation.hpp.
#include "sateen/analysis/translation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/core/periodic_part.hpp"

namespace sateen {
namespace {

double curve(const Marginal& marginal, double g) {
    constexpr double kRange = static_cast<double>(Marginal::kRange);
    constexpr double kSteps = static_cast<double>(Marginal::kKnots - 1);
    const double x = (std::clamp(g, -kRange, kRange) + kRange) / (2 * kRange) * kSteps;
    const auto j = std::min(static_cast<std::size_t>(x), Marginal::kKnots - 2);
    const auto low = static_cast<double>(marginal.knots[j]);
    const auto high = static_cast<double>(marginal.knots[j + 1]);
    return low + (x - static_cast<double>(j)) * (high - low);
}

/// S(t) of a half spectrum, as its real part, to R(s) on the torus, and back.
void to_correlation(const Fft2d& fft, SplitComplexView<float> spectrum,
                    PlaneView<float> correlation, Executor& executor) {
    for (std::size_t m = 0; m < spectrum.im.rows; ++m)
        std::fill_n(spectrum.im.row(m), spectrum.im.cols, 0.0F);
    fft.inverse(spectrum, correlation, executor);
}

}  // namespace

// c_n by the trapezium rule over [-8, 8], where the normal density leaves nothing outside; the
// recursion h_{n+1} = (g h_n - √n h_{n-1}) / √(n+1) of the normalised polynomials is stable.
CorrelationMap::CorrelationMap(const Marginal& marginal) {
    constexpr int kPoints = 2000;
    constexpr double kSpan = 8;
    std::array<double, kTerms + 1> root{};
    for (std::size_t n = 0; n <= kTerms; ++n)
        root[n] = std::sqrt(static_cast<double>(n + 1));
    std::array<double, kTerms> c{};
    const double step = 2 * kSpan / kPoints;
    for (int i = 0; i <= kPoints; ++i) {
        const double g = -kSpan + step * i;
        const double weight = step * std::exp(-g * g / 2) /
                              std::sqrt(2 * std::numbers::pi) * curve(marginal, g);
        double previous = 1;
        double present = g;
        for (std::size_t n = 0; n < kTerms; ++n) {
            c[n] += weight * present;
            const double next = (g * present - root[n] * previous) / root[n + 1];
            previous = present;
            present = next;
        }
    }
    double total = 0;
    for (const double value : c) total += value * value;
    for (std::size_t n = 0; n < kTerms; ++n)
        weights_[n] = total > 0 ? c[n] * c[n] / total : (n == 0 ? 1.0 : 0.0);
    tabulate_inverse();
}

// C at equally spaced ρ, read backwards: between two of them C is a straight line to
// C''/8 · (2/kTable)² < 2e-5, since C'' <= kTerms².
void CorrelationMap::tabulate_inverse() {
    lowest_ = forward(-1);
    const auto rho_at = [](std::size_t k) {
        return 2 * static_cast<double>(k) / static_cast<double>(kTable) - 1;
    };
    std::size_t k = 0;
    double low = lowest_;
    double high = forward(rho_at(1));
    for (std::size_t i = 0; i <= kTable; ++i) {
        const double wanted = lowest_ + (1 - lowest_) * static_cast<double>(i) /
                                            static_cast<double>(kTable);
        while (high < wanted && k + 2 <= kTable) {
            ++k;
            low = high;
            high = forward(rho_at(k + 1));
        }
        const double part =
            high > low ? std::clamp((wanted - low) / (high - low), 0.0, 1.0) : 0;
        inverse_[i] = rho_at(k) + part * (rho_at(k + 1) - rho_at(k));
    }
}

double CorrelationMap::forward(double rho) const {
    double sum = 0;
    for (std::size_t n = kTerms; n-- > 0;) sum = (sum + weights_[n]) * rho;
    return sum;
}

double CorrelationMap::inverse(double correlation) const {
    const double x = std::clamp((correlation - lowest_) / (1 - lowest_), 0.0, 1.0) *
                     static_cast<double>(kTable);
    const auto i = std::min(static_cast<std::size_t>(x), kTable - 1);
    return inverse_[i] + (x - static_cast<double>(i)) * (inverse_[i + 1] - inverse_[i]);
}

Result<void> gaussian_behind_curve(PlaneView<const float> plane, const Marginal& marginal,
                                   PlaneView<float> out, Executor& executor) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(plane.rows, plane.cols));
    SATEEN_CHECK(periodic_part(plane, out, executor, kTextureBorderShare));
    SplitComplexPlane transform(fft.rows(), fft.spectrum_cols());
    fft.forward(out, transform.view(), executor);
    const SplitComplexView<float> p = transform.view();
    p.re(0, 0) = 0;
    p.im(0, 0) = 0;

    SplitComplexPlane work(fft.rows(), fft.spectrum_cols());
    const SplitComplexView<float> S = work.view();
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n)
            S.re(m, n) = p.re(m, n) * p.re(m, n) + p.im(m, n) * p.im(m, n);
    to_correlation(fft, S, out, executor);
    const auto variance = static_cast<double>(out(0, 0));
    if (!(variance > 0))
        return Error{Errc::singular, "a constant plane has no correlations"};

    const CorrelationMap map(marginal);
    parallel_for(executor, out.rows, [&](std::size_t r) {
        for (std::size_t c = 0; c < out.cols; ++c)
            out(r, c) = static_cast<float>(
                map.inverse(static_cast<double>(out(r, c)) / variance));
    });
    fft.forward(out, S, executor);

    // The map can leave small negative powers; a spectrum has none, and what is cut off there
    // must not raise the variance.
    double total = 0;
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            S.re(m, n) = std::max(0.0F, S.re(m, n));
            const bool alone = n == 0 || 2 * n == fft.cols();
            total += (alone ? 1 : 2) * static_cast<double>(S.re(m, n));
        }
    const auto sites = static_cast<double>(plane.size());
    const auto unit = static_cast<float>(sites * sites / total);
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            const float power = p.re(m, n) * p.re(m, n) + p.im(m, n) * p.im(m, n);
            const float gain = power > 0 ? std::sqrt(unit * S.re(m, n) / power) : 0.0F;
            p.re(m, n) *= gain;
            p.im(m, n) *= gain;
        }
    fft.inverse(p, out, executor);
    return {};
}

}  // namespace sateen
