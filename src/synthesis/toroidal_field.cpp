// SPDX-License-Identifier: Apache-2.0
// Zero-phase drawing of a plane on a torus. See toroidal_field.hpp.
#include "synthesis/toroidal_field.hpp"

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "sateen/core/normal.hpp"

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/toroidal_field.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SATEEN_SYNTHESIS_TOROIDAL_FIELD_ONCE
#define SATEEN_SYNTHESIS_TOROIDAL_FIELD_ONCE
namespace sateen {

/// One row of the half spectrum.
struct NoiseSpectrumRow {
    const float* density;
    const float* re;
    const float* im;
    std::size_t count;
};

}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Σ E |ŵ|² along the row.
double power_of_row(const NoiseSpectrumRow& row) {
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    auto sum = hn::Zero(d);
    std::size_t n = 0;
    for (; n + lanes <= row.count; n += lanes) {
        const auto re = hn::LoadU(d, row.re + n);
        const auto im = hn::LoadU(d, row.im + n);
        const auto squared = hn::MulAdd(re, re, hn::Mul(im, im));
        sum = hn::MulAdd(hn::LoadU(d, row.density + n), squared, sum);
    }
    auto total = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
    for (; n < row.count; ++n)
        total += static_cast<double>(row.density[n] *
                                     (row.re[n] * row.re[n] + row.im[n] * row.im[n]));
    return total;
}

// ŷ = scale √E ŵ
void scale_row(const NoiseSpectrumRow& row, float scale, float* re, float* im) {
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t n = 0;
    for (; n + lanes <= row.count; n += lanes) {
        const auto root =
            hn::Mul(hn::Set(d, scale), hn::Sqrt(hn::LoadU(d, row.density + n)));
        hn::StoreU(hn::Mul(root, hn::LoadU(d, row.re + n)), d, re + n);
        hn::StoreU(hn::Mul(root, hn::LoadU(d, row.im + n)), d, im + n);
    }
    for (; n < row.count; ++n) {
        const float root = scale * std::sqrt(row.density[n]);
        re[n] = root * row.re[n];
        im[n] = root * row.im[n];
    }
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(power_of_row);
HWY_EXPORT(scale_row);

/// Σ E |ŵ|² over a row of the whole torus: columns that the half spectrum leaves out
/// mirror those inside.
double whole_power(const NoiseSpectrumRow& row, bool even) {
    const auto power = [&](std::size_t n) {
        return static_cast<double>(row.density[n] *
                                   (row.re[n] * row.re[n] + row.im[n] * row.im[n]));
    };
    double sum = 2 * HWY_DYNAMIC_DISPATCH(power_of_row)(row) - power(0);
    if (even) sum -= power(row.count - 1);
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

//     R(0) = (1/(MN)²) Σ_t E_t |ŵ_t|²     by Parseval, known before ŷ is written
void colour_noise(const PlaneField& field, std::size_t cols,
                  SplitComplexView<const float> noise, SplitComplexView<float> spectrum,
                  Executor& executor) {
    const std::size_t rows = noise.re.rows;
    Image density = spectral_density(field, rows, cols, executor);
    suppress_unmeasured(field, density.plane(0), cols);
    density(0, 0, 0) = 0;
    const auto row = [&](std::size_t m) {
        return NoiseSpectrumRow{density.plane(0).row(m), noise.re.row(m), noise.im.row(m),
                                density.cols()};
    };
    std::vector<double> row_power(rows);
    parallel_for(executor, rows, [&](std::size_t m) {
        row_power[m] = whole_power(row(m), cols % 2 == 0);
    });
    double power = 0;
    for (const double part : row_power) power += part;
    const double sites = static_cast<double>(rows) * static_cast<double>(cols);
    const auto scale = static_cast<float>(power > 0 ? sites / std::sqrt(power) : 0);
    parallel_for(executor, rows, [&](std::size_t m) {
        HWY_DYNAMIC_DISPATCH(scale_row)
        (row(m), scale, spectrum.re.row(m), spectrum.im.row(m));
    });
}

}  // namespace sateen
#endif
