// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of a plane on a torus. See toroidal_field.hpp.
#include "synthesis/toroidal_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "synthesis/hermitian_matrix.hpp"
#include "synthesis/noise_bands.hpp"

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

// y = √E w along a row. Returns Σ |y|².
double colour_row(const float* E, const ComplexRows<const float>& w,
                  const ComplexRows<float>& y, std::size_t count) {
    const auto colour = [&](auto d, std::size_t n) HWY_ATTR {
        const auto root = hn::Sqrt(hn::LoadU(d, E + n));
        const auto re = hn::Mul(root, hn::LoadU(d, w.re[0] + n));
        const auto im = hn::Mul(root, hn::LoadU(d, w.im[0] + n));
        hn::StoreU(re, d, y.re[0] + n);
        hn::StoreU(im, d, y.im[0] + n);
        return hn::MulAdd(re, re, hn::Mul(im, im));
    };
    const hn::ScalableTag<float> d;
    const hn::CappedTag<float, 1> one;
    auto sum = hn::Zero(d);
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) sum = hn::Add(sum, colour(d, n));
    auto total = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
    for (; n < count; ++n) total += static_cast<double>(hn::GetLane(colour(one, n)));
    return total;
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

/// Σ |y|² over a row of the whole torus, where `sum` is that of the half spectrum: columns that
/// it leaves out mirror those inside.
double whole_power(double sum, const float* re, const float* im, std::size_t cols) {
    const auto power = [&](std::size_t n) {
        return static_cast<double>(re[n] * re[n] + im[n] * im[n]);
    };
    return 2 * sum - power(0) - (cols % 2 == 0 ? power(cols / 2) : 0);
}

/// Columns that are their own mirror images, 0 and N/2, of rows m and -m share the normals of
/// column 0: those of row m are for column 0, those of row -m for column N/2. Where both rows
/// are one, its real number is for column 0, its imaginary one for column N/2.
void mirror_columns(SplitComplexView<float> w, std::size_t m, std::size_t mirrored,
                    std::size_t cols) {
    const std::size_t last = cols / 2;
    const bool even = cols % 2 == 0;
    if (m == mirrored) {
        constexpr auto kRoot2 = std::numbers::sqrt2_v<float>;
        if (even) {
            w.re(m, last) = kRoot2 * w.im(m, 0);
            w.im(m, last) = 0;
        }
        w.re(m, 0) *= kRoot2;
        w.im(m, 0) = 0;
        return;
    }
    if (even) {
        w.re(m, last) = w.re(mirrored, last) = w.re(mirrored, 0);
        w.im(m, last) = w.im(mirrored, 0);
        w.im(mirrored, last) = -w.im(mirrored, 0);
    }
    w.re(mirrored, 0) = w.re(m, 0);
    w.im(mirrored, 0) = -w.im(m, 0);
}

/// Rows m and -m of ŵ.
void draw_noise_rows(NoiseField noise, std::size_t m, std::size_t cols,
                     SplitComplexView<float> w) {
    const std::size_t mirrored = m == 0 ? 0 : w.re.rows - m;
    const auto draw_row = [&](std::size_t row) {
        const auto number = static_cast<std::int32_t>(row);
        draw_normals(noise, number, 0, {w.re.row(row), (cols + 1) / 2});
        draw_normals(noise, -1 - number, 0, {w.im.row(row), (cols + 1) / 2});
    };
    draw_row(m);
    if (mirrored != m) draw_row(mirrored);
    mirror_columns(w, m, mirrored, cols);
}

}  // namespace

void draw_noise(std::uint64_t seed, std::uint32_t band, PlaneView<float> out,
                Executor& executor) {
    parallel_for(executor, out.rows, [&](std::size_t r) {
        draw_normals({seed, band}, static_cast<std::int32_t>(r), 0,
                     {out.row(r), out.cols});
    });
}

void draw_noise_spectrum(NoiseField noise, std::size_t cols,
                         SplitComplexView<float> spectrum, Executor& executor) {
    parallel_for(executor, spectrum.re.rows / 2 + 1,
                 [&](std::size_t m) { draw_noise_rows(noise, m, cols, spectrum); });
}

//     R_ii(0) = (1/(MN)²) Σ_t |ŷ_{t,i}|²     by Parseval
std::array<float, kMaxBands> colour_noise(const PlaneField& field, std::size_t cols,
                                          const TorusNoise& noise,
                                          std::span<SplitComplexPlane> spectra,
                                          Executor& executor) {
    const std::size_t rows = spectra[0].rows();
    const std::size_t count = cols / 2 + 1;
    const std::size_t elements = field.planes * field.planes;
    const SpectralDensity density(field, rows, cols, executor);
    std::vector<std::array<double, kMaxBands>> row_power(rows);
    const auto noise_of = [&](std::size_t i) {
        const SplitComplexPlane& drawn =
            noise.kept.empty() ? spectra[i] : noise.kept[field.plane + i];
        return drawn.view();
    };
    const auto colour = [&](std::size_t m, const HermitianRows<float>& E) {
        for (std::size_t k = 0; k < elements; ++k) {
            suppress_unmeasured(field, m, rows, cols, {E[k], count});
            if (m == 0) E[k][0] = 0;
        }
        ComplexRows<const float> w;
        ComplexRows<float> y;
        for (std::size_t i = 0; i < field.planes; ++i) {
            if (noise.kept.empty() && 2 * m <= rows)
                draw_noise_rows(
                    {noise.seed, noise_band(static_cast<std::uint32_t>(field.plane + i))},
                    m, cols, spectra[i].view());
            w.re[i] = noise_of(i).re.row(m);
            w.im[i] = noise_of(i).im.row(m);
            y.re[i] = spectra[i].view().re.row(m);
            y.im[i] = spectra[i].view().im.row(m);
        }
        std::array<double, kMaxBands> power{};
        if (field.planes == 1) {
            power[0] = HWY_DYNAMIC_DISPATCH(colour_row)(E[0], w, y, count);
        } else {
            multiply_by_root(readable(E), w, y, count);
            for (std::size_t i = 0; i < field.planes; ++i)
                power[i] = HWY_DYNAMIC_DISPATCH(power_of_row)(y.re[i], y.im[i], count);
        }
        for (std::size_t i = 0; i < field.planes; ++i)
            row_power[m][i] = whole_power(power[i], y.re[i], y.im[i], cols);
    };
    density.for_each_row(executor, colour);
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
