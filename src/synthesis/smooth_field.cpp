// SPDX-License-Identifier: Apache-2.0
// Smooth fields. See smooth_field.hpp.
#include "synthesis/smooth_field.hpp"

#include <algorithm>
#include <cmath>
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

std::size_t wrapped(std::int32_t k, std::size_t n) {
    const auto period = static_cast<std::int32_t>(n);
    const std::int32_t rest = k % period;
    return static_cast<std::size_t>(rest < 0 ? rest + period : rest);
}

}  // namespace

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
