// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of a plane on a torus. See toroidal_field.hpp.
#include "synthesis/toroidal_field.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sateen/core/normal.hpp"
#include "synthesis/hermitian_matrix.hpp"

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/toroidal_field.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// y = √E w along a row.
void colour_row(const float* E, const ComplexRows<const float>& w,
                const ComplexRows<float>& y, std::size_t count) {
    const hn::ScalableTag<float> d;
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) {
        const auto root = hn::Sqrt(hn::LoadU(d, E + n));
        hn::StoreU(hn::Mul(root, hn::LoadU(d, w.re[0] + n)), d, y.re[0] + n);
        hn::StoreU(hn::Mul(root, hn::LoadU(d, w.im[0] + n)), d, y.im[0] + n);
    }
    for (; n < count; ++n) {
        const float root = std::sqrt(E[n]);
        y.re[0][n] = root * w.re[0][n];
        y.im[0][n] = root * w.im[0][n];
    }
}

// Σ |y|² along a row.
double power_of_row(const float* re, const float* im, std::size_t count) {
    const hn::ScalableTag<float> d;
    auto sum = hn::Zero(d);
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) {
        const auto y_re = hn::LoadU(d, re + n);
        const auto y_im = hn::LoadU(d, im + n);
        sum = hn::MulAdd(y_re, y_re, hn::MulAdd(y_im, y_im, sum));
    }
    auto total = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
    for (; n < count; ++n) total += static_cast<double>(re[n] * re[n] + im[n] * im[n]);
    return total;
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(colour_row);
HWY_EXPORT(power_of_row);

/// Σ |y|² over a row of the whole torus: columns that the half spectrum leaves out mirror
/// those inside.
double whole_power(const float* re, const float* im, std::size_t cols) {
    const std::size_t count = cols / 2 + 1;
    const auto power = [&](std::size_t n) {
        return static_cast<double>(re[n] * re[n] + im[n] * im[n]);
    };
    const double sum = 2 * HWY_DYNAMIC_DISPATCH(power_of_row)(re, im, count) - power(0);
    return cols % 2 == 0 ? sum - power(count - 1) : sum;
}

void draw_noise_rows(NoiseField noise, std::size_t first, PlaneView<float> rows) {
    for (std::size_t r = 0; r < rows.rows; ++r)
        draw_normals(noise, static_cast<std::int32_t>(first + r), 0,
                     {rows.row(r), rows.cols});
}

}  // namespace

void draw_noise(std::uint64_t seed, std::uint32_t band, PlaneView<float> out,
                Executor& executor) {
    parallel_for(executor, out.rows, [&](std::size_t r) {
        draw_noise_rows({seed, band}, r, out.window(r, 0, 1, out.cols));
    });
}

void draw_noise_spectrum(std::uint64_t seed, std::uint32_t band, const Fft2d& fft,
                         SplitComplexView<float> spectrum, Executor& executor) {
    fft.for_row_blocks(
        executor, [&](std::size_t first, std::size_t count, Fft2d::Scratch& scratch) {
            const PlaneView<float> rows(scratch.floats(count * fft.cols()), count,
                                        fft.cols());
            draw_noise_rows({seed, band}, first, rows);
            fft.forward_rows(rows, first, spectrum, scratch);
        });
    fft.forward_columns(spectrum, executor);
}

//     R_ii(0) = (1/(MN)²) Σ_t |ŷ_{t,i}|²     by Parseval
std::array<float, kMaxBands> colour_noise(const PlaneField& field, std::size_t cols,
                                          std::span<const SplitComplexPlane> noise,
                                          std::span<SplitComplexPlane> spectra,
                                          Executor& executor) {
    const std::size_t rows = noise[0].rows();
    const std::size_t count = cols / 2 + 1;
    const std::size_t elements = field.planes * field.planes;
    const SpectralDensity density(field, rows, cols, executor);
    std::vector<std::array<double, kMaxBands>> row_power(rows);
    const auto colour = [&](std::size_t m, const HermitianRows<float>& E) {
        density.row(m, E);
        for (std::size_t k = 0; k < elements; ++k) {
            suppress_unmeasured(field, m, rows, cols, {E[k], count});
            if (m == 0) E[k][0] = 0;
        }
        ComplexRows<const float> w;
        ComplexRows<float> y;
        for (std::size_t i = 0; i < field.planes; ++i) {
            w.re[i] = noise[i].view().re.row(m);
            w.im[i] = noise[i].view().im.row(m);
            y.re[i] = spectra[i].view().re.row(m);
            y.im[i] = spectra[i].view().im.row(m);
        }
        if (field.planes == 1)
            HWY_DYNAMIC_DISPATCH(colour_row)(E[0], w, y, count);
        else
            multiply_by_root(readable(E), w, y, count);
        for (std::size_t i = 0; i < field.planes; ++i)
            row_power[m][i] = whole_power(y.re[i], y.im[i], cols);
    };
    for_each_density_row(executor, field.planes, rows, count, colour);
    const double sites = static_cast<double>(rows) * static_cast<double>(cols);
    std::array<float, kMaxBands> gains{};
    for (std::size_t i = 0; i < field.planes; ++i) {
        double power = 0;
        for (const auto& row : row_power) power += row[i];
        if (power > 0) gains[i] = static_cast<float>(sites / std::sqrt(power));
    }
    return gains;
}

}  // namespace sateen
#endif
