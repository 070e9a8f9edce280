// SPDX-License-Identifier: Apache-2.0
// Spectral densities on a torus. See spectral_density.hpp.
#include "synthesis/spectral_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/spectral_density.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SATEEN_SYNTHESIS_SPECTRAL_DENSITY_ONCE
#define SATEEN_SYNTHESIS_SPECTRAL_DENSITY_ONCE
namespace sateen {

/// Λ(ω) = 1 - Σ a_s e^{-jω·s} along one row of frequencies: a trigonometric polynomial in
/// ω2,
///
///     Re Λ = even_re_0 + Σ_q (even_re_q cos qω2 + odd_im_q sin qω2)
///     Im Λ = even_im_0 + Σ_q (even_im_q cos qω2 - odd_re_q sin qω2)
struct RowPolynomial {
    static constexpr std::size_t kTerms = kMaxReach + 1;
    std::array<float, kTerms> even_re{};
    std::array<float, kTerms> even_im{};
    std::array<float, kTerms> odd_re{};
    std::array<float, kTerms> odd_im{};
    std::size_t terms = 1;
};

/// cos qω2 and sin qω2 for n = 0 … ⌊N/2⌋, a row for each q, padded to whole vectors.
struct ColumnTables {
    Image cosines;
    Image sines;
};

}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

//     S(ω) = σ² / |Λ(ω)|²
void density_row(const RowPolynomial& polynomial, float variance,
                 const ColumnTables& tables, std::size_t count, float* out) {
    const hn::ScalableTag<float> d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t n = 0; n < count; n += lanes) {
        auto re = hn::Set(d, polynomial.even_re[0]);
        auto im = hn::Set(d, polynomial.even_im[0]);
        for (std::size_t q = 1; q < polynomial.terms; ++q) {
            const auto c = hn::LoadU(d, tables.cosines.plane(0).row(q) + n);
            const auto s = hn::LoadU(d, tables.sines.plane(0).row(q) + n);
            re = hn::MulAdd(hn::Set(d, polynomial.even_re[q]), c, re);
            re = hn::MulAdd(hn::Set(d, polynomial.odd_im[q]), s, re);
            im = hn::MulAdd(hn::Set(d, polynomial.even_im[q]), c, im);
            im = hn::NegMulAdd(hn::Set(d, polynomial.odd_re[q]), s, im);
        }
        const auto squared = hn::MulAdd(re, re, hn::Mul(im, im));
        // A pole of the density on the torus would make the field infinite: bounded at
        // the relative rounding error of |Λ|.
        const auto bounded = hn::Max(squared, hn::Set(d, 1e-10F));
        const auto S = hn::Div(hn::Set(d, variance), bounded);
        if (n + lanes <= count) {
            hn::StoreU(S, d, out + n);
        } else {
            HWY_ALIGN std::array<float, HWY_MAX_BYTES / sizeof(float)> rest;
            hn::Store(S, d, rest.data());
            std::copy_n(rest.data(), count - n, out + n);
        }
    }
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(density_row);

double frequency(std::size_t k, std::size_t n) {
    return 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
}

RowPolynomial row_polynomial(const Car2d& field, double omega_1) {
    std::array<std::complex<double>, 2 * kMaxReach + 1> c{};
    c[kMaxReach] = 1;
    std::size_t reach = 0;
    for (std::size_t i = 0; i < field.a.size(); ++i) {
        const Offset s = field.neighbourhood[i];
        c[static_cast<std::size_t>(kMaxReach + s.col)] -=
            static_cast<double>(field.a[i]) * std::polar(1.0, -omega_1 * s.row);
        reach = std::max(reach, static_cast<std::size_t>(std::abs(s.col)));
    }
    RowPolynomial polynomial;
    polynomial.terms = reach + 1;
    polynomial.even_re[0] = static_cast<float>(c[kMaxReach].real());
    polynomial.even_im[0] = static_cast<float>(c[kMaxReach].imag());
    for (std::size_t q = 1; q <= reach; ++q) {
        const std::complex<double> even = c[kMaxReach + q] + c[kMaxReach - q];
        const std::complex<double> odd = c[kMaxReach + q] - c[kMaxReach - q];
        polynomial.even_re[q] = static_cast<float>(even.real());
        polynomial.even_im[q] = static_cast<float>(even.imag());
        polynomial.odd_re[q] = static_cast<float>(odd.real());
        polynomial.odd_im[q] = static_cast<float>(odd.imag());
    }
    return polynomial;
}

ColumnTables column_tables(std::size_t cols) {
    constexpr std::size_t kPadding = 64;
    const std::size_t count = cols / 2 + 1;
    ColumnTables tables{Image(1, RowPolynomial::kTerms, count + kPadding),
                        Image(1, RowPolynomial::kTerms, count + kPadding)};
    for (std::size_t q = 0; q < RowPolynomial::kTerms; ++q)
        for (std::size_t n = 0; n < count; ++n) {
            const double angle = frequency(n * q % cols, cols);
            tables.cosines(0, q, n) = static_cast<float>(std::cos(angle));
            tables.sines(0, q, n) = static_cast<float>(std::sin(angle));
        }
    return tables;
}

void field_density(const FieldModel& model, std::size_t cols, PlaneView<float> out,
                   Executor& executor) {
    const Car2d& field = std::get<Car2d>(model);
    const ColumnTables tables = column_tables(cols);
    parallel_for(executor, out.rows, [&](std::size_t m) {
        HWY_DYNAMIC_DISPATCH(density_row)
        (row_polynomial(field, frequency(m, out.rows)), field.variance, tables, out.cols,
         out.row(m));
    });
}

/// 2 W²(ω) along one axis: the product over both axes is 4 W².
std::vector<float> expansion_gain(std::size_t count, std::size_t size) {
    std::vector<float> gain(count);
    for (std::size_t k = 0; k < count; ++k)
        gain[k] = static_cast<float>(2 * std::pow(std::cos(frequency(k, size) / 2), 8));
    return gain;
}

/// Where on its own grid a coarser level has the frequency 2ω: an even size halves, an
/// odd one stays and is stepped through twice as fast.
struct CoarseAxis {
    std::size_t size;
    std::size_t step;
    explicit CoarseAxis(std::size_t fine)
        : size(fine % 2 == 0 ? fine / 2 : fine), step(fine % 2 == 0 ? 1 : 2) {}
    [[nodiscard]] std::size_t index(std::size_t k) const { return k * step % size; }
};

void add_expanded(PlaneView<const float> coarse, std::size_t cols,
                  PlaneView<float> density, Executor& executor) {
    const CoarseAxis row_axis(density.rows);
    const CoarseAxis col_axis(cols);
    const std::vector<float> row_gain = expansion_gain(density.rows, density.rows);
    const std::vector<float> col_gain = expansion_gain(density.cols, cols);
    parallel_for(executor, density.rows, [&](std::size_t m) {
        const std::size_t row = row_axis.index(m);
        const float* direct = coarse.row(row);
        const float* mirrored = coarse.row((row_axis.size - row) % row_axis.size);
        float* out = density.row(m);
        for (std::size_t n = 0; n < density.cols; ++n) {
            const std::size_t col = col_axis.index(n);
            const float E =
                col < coarse.cols ? direct[col] : mirrored[col_axis.size - col];
            out[n] += row_gain[m] * col_gain[n] * E;
        }
    });
}

}  // namespace

Image spectral_density(const PlaneField& field, std::size_t rows, std::size_t cols,
                       Executor& executor) {
    Image density(1, rows, cols / 2 + 1);
    field_density(field.field(0), cols, density.plane(0), executor);
    if (field.levels.size() > 1) {
        const Image coarse = spectral_density(field.coarser(1), CoarseAxis(rows).size,
                                              CoarseAxis(cols).size, executor);
        add_expanded(coarse.plane(0), cols, density.plane(0), executor);
    }
    return density;
}

void suppress_unmeasured(const PlaneField& field, PlaneView<float> density,
                         std::size_t cols) {
    const auto closeness = [](std::size_t k, std::size_t size, double sample) {
        const auto cycles = static_cast<double>(std::min(k, size - k));
        return std::max(0.0, 1 - cycles * sample / static_cast<double>(size));
    };
    for (std::size_t m = 0; m < density.rows; ++m) {
        const double row = closeness(m, density.rows, field.sample_rows);
        if (row == 0) continue;
        for (std::size_t n = 0; n < density.cols; ++n) {
            const double col = closeness(n, cols, field.sample_cols);
            if (col == 0) break;
            density(m, n) *= static_cast<float>(1 - row * col);
        }
    }
}

double mean_density(PlaneView<const float> density, std::size_t cols) {
    double sum = 0;
    for (std::size_t m = 0; m < density.rows; ++m) {
        const float* row = density.row(m);
        double both = 0;
        for (std::size_t n = 0; n < density.cols; ++n)
            both += static_cast<double>(row[n]);
        sum += 2 * both - static_cast<double>(row[0]);
        if (cols % 2 == 0) sum -= static_cast<double>(row[density.cols - 1]);
    }
    return sum / static_cast<double>(density.rows * cols);
}

}  // namespace sateen
#endif
