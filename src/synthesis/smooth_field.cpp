// SPDX-License-Identifier: Apache-2.0
// Smooth fields. See smooth_field.hpp.
#include "synthesis/smooth_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sateen/core/fft.hpp"
#include "synthesis/toroidal_field.hpp"

namespace sateen {
namespace {

/// Tori up to this size are drawn at once.
constexpr std::size_t kWholeSites = std::size_t{1} << 20U;
/// Holds the kernel of the widest bell, which has died out at 4 of its deviations.
constexpr std::size_t kBlock = 256;

/// 2√π s exp(-s²ω²) at every frequency of an axis, a row for every scale.
std::vector<std::vector<double>> bells(std::size_t count, std::size_t n, double scale) {
    std::vector<std::vector<double>> result(SmoothField::kScales);
    for (std::size_t k = 0; k < result.size(); ++k) {
        const double s = scale * std::ldexp(1.0, static_cast<int>(k));
        for (std::size_t m = 0; m < count; ++m) {
            const double turn =
                static_cast<double>(std::min(m, n - m)) / static_cast<double>(n);
            const double omega = 2 * std::numbers::pi * turn;
            result[k].push_back(2 * std::sqrt(std::numbers::pi) * s *
                                std::exp(-s * s * omega * omega));
        }
    }
    return result;
}

std::size_t wrapped(std::int32_t k, std::size_t n) {
    const auto period = static_cast<std::int32_t>(n);
    const std::int32_t rest = k % period;
    return static_cast<std::size_t>(rest < 0 ? rest + period : rest);
}

}  // namespace

Image smooth_density(const SmoothField& field, std::size_t rows, std::size_t cols,
                     double scale_rows, double scale_cols) {
    constexpr std::size_t kScales = SmoothField::kScales;
    Image density(1, rows, cols / 2 + 1);
    double total = 0;
    for (const std::uint8_t weight : field.weights) total += weight;
    if (!(total > 0)) return density;
    const double unit = static_cast<double>(field.deviation) *
                        static_cast<double>(field.deviation) / total;
    const auto down = bells(rows, rows, scale_rows);
    const auto across = bells(density.cols(), cols, scale_cols);
    for (std::size_t m = 0; m < rows; ++m) {
        double of_row[kScales] = {};
        for (std::size_t j = 0; j < kScales; ++j)
            for (std::size_t k = 0; k < kScales; ++k)
                of_row[k] += unit * field.weights[j * kScales + k] * down[j][m];
        for (std::size_t n = 0; n < density.cols(); ++n) {
            double sum = 0;
            for (std::size_t k = 0; k < kScales; ++k) sum += of_row[k] * across[k][n];
            density(0, m, n) = static_cast<float>(sum);
        }
    }
    return density;
}

Result<SmoothLattice> SmoothLattice::create(const SmoothField& field, NoiseField noise,
                                            Period period, double scale_rows,
                                            double scale_cols, Executor& executor) {
    SmoothLattice result;
    result.noise_ = noise;
    result.period_ = period;
    const auto rows = static_cast<std::size_t>(period.rows);
    const auto cols = static_cast<std::size_t>(period.cols);
    if (rows == 0 || rows * cols > kWholeSites) {
        const Image density =
            smooth_density(field, kBlock, kBlock, scale_rows, scale_cols);
        SATEEN_TRY(result.blocks_,
                   OverlapSave::create(density.view(), kBlock, std::nullopt, executor));
        return result;
    }
    SATEEN_TRY(const Fft2d fft, Fft2d::create(rows, cols));
    result.whole_ = Image(1, rows, cols);
    draw_noise(noise.seed, noise.band, result.whole_.plane(0), executor);
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(result.whole_.plane(0), spectrum.view(), executor);
    const Image density = smooth_density(field, rows, cols, scale_rows, scale_cols);
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            const float root = std::sqrt(density(0, m, n));
            spectrum.view().re(m, n) *= root;
            spectrum.view().im(m, n) *= root;
        }
    fft.inverse(spectrum.view(), result.whole_.plane(0), executor);
    return result;
}

void SmoothLattice::draw(std::int32_t row, std::int32_t col, PlaneView<float> out,
                         Executor& executor) const {
    if (blocks_) {
        blocks_->draw({&noise_, 1}, period_, row, col, {&out, 1}, executor);
        return;
    }
    for (std::size_t r = 0; r < out.rows; ++r)
        for (std::size_t c = 0; c < out.cols; ++c)
            out(r, c) =
                whole_(0, wrapped(row + static_cast<std::int32_t>(r), whole_.rows()),
                       wrapped(col + static_cast<std::int32_t>(c), whole_.cols()));
}

}  // namespace sateen
