// SPDX-License-Identifier: Apache-2.0
// Estimating smooth fields. See smooth_field.hpp.
#include "analysis/smooth_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sateen/core/fft.hpp"

namespace sateen {
namespace {

constexpr std::size_t kScales = SmoothField::kScales;
constexpr std::size_t kWeights = kScales * kScales;
constexpr std::size_t kFurthestLag = 40;
constexpr int kSweeps = 400;

/// exp(-r²/4s²) of every scale.
std::array<double, kScales> bells(std::size_t lag) {
    std::array<double, kScales> values{};
    for (std::size_t k = 0; k < kScales; ++k) {
        const double x = static_cast<double>(lag) / std::ldexp(2.0, static_cast<int>(k));
        values[k] = std::exp(-x * x);
    }
    return values;
}

}  // namespace

CovarianceTable::CovarianceTable(std::size_t rows, std::size_t cols)
    : down(std::min(kFurthestLag, rows / 2)),
      across(std::min(kFurthestLag, cols / 2)),
      values((down + 1) * (across + 1)) {}

// By a transform of the sample with zeros about it.
Result<CovarianceTable> covariances_of(PlaneView<const float> sample,
                                       Executor& executor) {
    CovarianceTable table(sample.rows, sample.cols);
    Image padded(1, fft_size_at_least(sample.rows + table.down),
                 fft_size_at_least(sample.cols + table.across));
    for (std::size_t r = 0; r < sample.rows; ++r)
        std::copy_n(sample.row(r), sample.cols, padded.plane(0).row(r));
    SATEEN_TRY(const Fft2d fft, Fft2d::create(padded.rows(), padded.cols()));
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    const SplitComplexView<float> s = spectrum.view();
    fft.forward(padded.plane(0), s, executor);
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            s.re(m, n) = s.re(m, n) * s.re(m, n) + s.im(m, n) * s.im(m, n);
            s.im(m, n) = 0;
        }
    fft.inverse(s, padded.plane(0), executor);
    for (std::size_t r = 0; r <= table.down; ++r)
        for (std::size_t c = 0; c <= table.across; ++c) {
            const std::size_t mirrored = c == 0 ? 0 : padded.cols() - c;
            const double sum = static_cast<double>(padded(0, r, c)) +
                               static_cast<double>(padded(0, r, mirrored));
            table(r, c) =
                sum / static_cast<double>(2 * (sample.rows - r) * (sample.cols - c));
        }
    return table;
}

SmoothField fit_smooth_field(const CovarianceTable& R) {
    SmoothField field;
    if (!(R(0, 0) > 0)) return field;

    // Normal equations of R/R(0) = Σ w_jk bell_j(r) bell_k(c).
    std::array<double, kWeights * kWeights> G{};
    std::array<double, kWeights> h{};
    for (std::size_t r = 0; r <= R.down; ++r)
        for (std::size_t c = 0; c <= R.across; ++c) {
            const auto of_row = bells(r);
            const auto of_col = bells(c);
            const double weight =
                1 / (1 + std::hypot(static_cast<double>(r), static_cast<double>(c)));
            std::array<double, kWeights> bell{};
            for (std::size_t i = 0; i < kWeights; ++i)
                bell[i] = of_row[i / kScales] * of_col[i % kScales];
            for (std::size_t i = 0; i < kWeights; ++i) {
                h[i] += weight * bell[i] * R(r, c) / R(0, 0);
                for (std::size_t j = 0; j < kWeights; ++j)
                    G[i * kWeights + j] += weight * bell[i] * bell[j];
            }
        }
    std::array<double, kWeights> w{};
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (std::size_t i = 0; i < kWeights; ++i) {
            double gradient = h[i];
            for (std::size_t j = 0; j < kWeights; ++j)
                gradient -= G[i * kWeights + j] * w[j];
            w[i] = std::max(0.0, w[i] + gradient / G[i * kWeights + i]);
        }

    const double largest = *std::ranges::max_element(w);
    if (!(largest > 0)) return field;
    field.deviation = static_cast<float>(std::sqrt(R(0, 0)));
    for (std::size_t i = 0; i < kWeights; ++i)
        field.weights[i] = static_cast<std::uint8_t>(std::lround(255 * w[i] / largest));
    return field;
}

}  // namespace sateen
