// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of a plane on a torus. See toroidal_field.hpp.
#include "synthesis/toroidal_field.hpp"

#include <cmath>
#include <span>
#include <vector>

#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

/// Σ over the whole torus of E |ŵ|² along one row of the half spectrum, as colour_row
/// leaves it.
double colour_row(const float* E, const float* noise_re, const float* noise_im,
                  std::size_t count, bool even, float* re, float* im) {
    for (std::size_t n = 0; n < count; ++n) {
        const float root = std::sqrt(E[n]);
        re[n] = root * noise_re[n];
        im[n] = root * noise_im[n];
    }
    const auto power = [&](std::size_t n) {
        return static_cast<double>(re[n] * re[n] + im[n] * im[n]);
    };
    double sum = 0;
    for (std::size_t n = 0; n < count; ++n) sum += power(n);
    sum = 2 * sum - power(0);
    if (even) sum -= power(count - 1);
    return sum;
}

}  // namespace

void draw_noise(std::uint64_t seed, std::uint32_t band, PlaneView<float> out,
                Executor& executor) {
    parallel_for(executor, out.rows, [&](std::size_t r) {
        draw_normals({seed, band}, static_cast<std::int32_t>(r), 0,
                     std::span<float>(out.row(r), out.cols));
    });
}

//     R(0) = (1/(MN)²) Σ_t |ŷ_t|²     by Parseval: the scale that makes it 1 costs no
//     pass
void colour_noise(const PlaneField& field, std::size_t cols,
                  SplitComplexView<const float> noise, SplitComplexView<float> spectrum,
                  Executor& executor) {
    const std::size_t rows = noise.re.rows;
    Image density = spectral_density(field, rows, cols, executor);
    suppress_unmeasured(field, density.plane(0), cols);
    density(0, 0, 0) = 0;
    std::vector<double> row_power(rows);
    parallel_for(executor, rows, [&](std::size_t m) {
        row_power[m] = colour_row(density.plane(0).row(m), noise.re.row(m),
                                  noise.im.row(m), density.cols(), cols % 2 == 0,
                                  spectrum.re.row(m), spectrum.im.row(m));
    });
    double power = 0;
    for (const double row : row_power) power += row;
    const double sites = static_cast<double>(rows) * static_cast<double>(cols);
    const double scale = power > 0 ? sites / std::sqrt(power) : 0;
    parallel_for(executor, rows, [&](std::size_t m) {
        for (std::size_t n = 0; n < density.cols(); ++n) {
            spectrum.re(m, n) *= static_cast<float>(scale);
            spectrum.im(m, n) *= static_cast<float>(scale);
        }
    });
}

}  // namespace sateen
