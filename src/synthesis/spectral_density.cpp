// SPDX-License-Identifier: Apache-2.0
// Spectral densities on a torus. See spectral_density.hpp.
#include "synthesis/spectral_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <variant>
#include <vector>

#include "synthesis/trigonometric_row.hpp"

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/spectral_density.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A pole of a density on the torus would make the field infinite: denominators are bounded
// at their rounding error, relative to coefficients of about 1.
constexpr float kSmallestSquare = 1e-10F;
constexpr float kSmallestReal = 1e-6F;
constexpr float kSmallestSquaredDeterminant = 1e-14F;

template <class D>
struct Complex {
    hn::Vec<D> re;
    hn::Vec<D> im;
};

/// a b - c e
template <class D>
HWY_INLINE Complex<D> minor(const Complex<D>& a, const Complex<D>& b, const Complex<D>& c,
                            const Complex<D>& e) {
    const auto re = hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re));
    const auto im = hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im));
    return {hn::MulAdd(c.im, e.im, hn::NegMulAdd(c.re, e.re, re)),
            hn::NegMulAdd(c.im, e.re, hn::NegMulAdd(c.re, e.im, im))};
}

/// Re P at the frequencies from n on.
template <class D>
HWY_INLINE hn::Vec<D> real_part(D d, const RowPolynomial& polynomial,
                                const ColumnTables& tables, std::size_t n) {
    auto re = hn::Set(d, polynomial.even_re[0]);
    for (std::size_t q = 1; q < polynomial.terms; ++q) {
        const auto c = hn::LoadU(d, tables.cosines.plane(0).row(q) + n);
        const auto s = hn::LoadU(d, tables.sines.plane(0).row(q) + n);
        re = hn::MulAdd(hn::Set(d, polynomial.even_re[q]), c, re);
        re = hn::MulAdd(hn::Set(d, polynomial.odd_im[q]), s, re);
    }
    return re;
}

template <class D>
HWY_INLINE Complex<D> evaluate(D d, const RowPolynomial& polynomial,
                               const ColumnTables& tables, std::size_t n) {
    auto im = hn::Set(d, polynomial.even_im[0]);
    for (std::size_t q = 1; q < polynomial.terms; ++q) {
        const auto c = hn::LoadU(d, tables.cosines.plane(0).row(q) + n);
        const auto s = hn::LoadU(d, tables.sines.plane(0).row(q) + n);
        im = hn::MulAdd(hn::Set(d, polynomial.even_im[q]), c, im);
        im = hn::NegMulAdd(hn::Set(d, polynomial.odd_re[q]), s, im);
    }
    return {real_part(d, polynomial, tables, n), im};
}

/// body(tag, n) for whole vectors, then for single frequencies.
template <class Body>
HWY_INLINE void for_each_vector(std::size_t count, const Body& body) {
    const hn::ScalableTag<float> d;
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) body(d, n);
    for (; n < count; ++n) body(hn::CappedTag<float, 1>(), n);
}

//     S(ω) = σ² / |Λ(ω)|²
void autoregressive_row(const RowPolynomial& Lambda, float variance,
                        const ColumnTables& tables, std::size_t count, float* out) {
    for_each_vector(count, [&](auto d, std::size_t n) HWY_ATTR {
        const auto value = evaluate(d, Lambda, tables, n);
        const auto squared = hn::MulAdd(value.re, value.re, hn::Mul(value.im, value.im));
        const auto bounded = hn::Max(squared, hn::Set(d, kSmallestSquare));
        hn::StoreU(hn::Div(hn::Set(d, variance), bounded), d, out + n);
    });
}

//     S(ω) = σ² / (1 - 2 Σ a_s cos ω·s)
void markov_row(const RowPolynomial& denominator, float variance,
                const ColumnTables& tables, std::size_t count, float* out) {
    for_each_vector(count, [&](auto d, std::size_t n) HWY_ATTR {
        const auto bounded =
            hn::Max(real_part(d, denominator, tables, n), hn::Set(d, kSmallestReal));
        hn::StoreU(hn::Div(hn::Set(d, variance), bounded), d, out + n);
    });
}

//     S(ω) = Λ⁻¹ Σ Λ⁻ᴴ = M Mᴴ / |det Λ|²,   M = adj(Λ) F,   Σ = F Fᵀ
//
// which is positive whatever the rounding. Row i, column j of the matrices is element
// 3i + j; of S the upper triangle holds real parts, the lower imaginary ones.
void joint_row(const std::array<RowPolynomial, 9>& Lambda, const std::array<float, 9>& F,
               const ColumnTables& tables, std::size_t count,
               const std::array<float*, 9>& out) {
    for_each_vector(count, [&](auto d, std::size_t n) HWY_ATTR {
        using D = decltype(d);
        Complex<D> L[9];
        for (std::size_t k = 0; k < 9; ++k) L[k] = evaluate(d, Lambda[k], tables, n);
        const Complex<D> adjugate[9] = {
            minor<D>(L[4], L[8], L[5], L[7]), minor<D>(L[2], L[7], L[1], L[8]),
            minor<D>(L[1], L[5], L[2], L[4]), minor<D>(L[5], L[6], L[3], L[8]),
            minor<D>(L[0], L[8], L[2], L[6]), minor<D>(L[2], L[3], L[0], L[5]),
            minor<D>(L[3], L[7], L[4], L[6]), minor<D>(L[1], L[6], L[0], L[7]),
            minor<D>(L[0], L[4], L[1], L[3])};
        auto det_re = hn::Zero(d);
        auto det_im = hn::Zero(d);
        for (std::size_t j = 0; j < 3; ++j) {
            const Complex<D>& a = L[j];
            const Complex<D>& b = adjugate[3 * j];
            det_re = hn::MulAdd(a.re, b.re, hn::NegMulAdd(a.im, b.im, det_re));
            det_im = hn::MulAdd(a.re, b.im, hn::MulAdd(a.im, b.re, det_im));
        }
        const auto squared = hn::MulAdd(det_re, det_re, hn::Mul(det_im, det_im));
        const auto scale = hn::Div(
            hn::Set(d, 1.0F), hn::Max(squared, hn::Set(d, kSmallestSquaredDeterminant)));
        Complex<D> M[9];
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                auto re = hn::Zero(d);
                auto im = hn::Zero(d);
                for (std::size_t k = j; k < 3; ++k) {
                    const auto f = hn::Set(d, F[3 * k + j]);
                    re = hn::MulAdd(adjugate[3 * i + k].re, f, re);
                    im = hn::MulAdd(adjugate[3 * i + k].im, f, im);
                }
                M[3 * i + j] = {re, im};
            }
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i; j < 3; ++j) {
                auto re = hn::Zero(d);
                auto im = hn::Zero(d);
                for (std::size_t k = 0; k < 3; ++k) {
                    const Complex<D>& a = M[3 * i + k];
                    const Complex<D>& b = M[3 * j + k];
                    re = hn::MulAdd(a.re, b.re, hn::MulAdd(a.im, b.im, re));
                    im = hn::MulAdd(a.im, b.re, hn::NegMulAdd(a.re, b.im, im));
                }
                hn::StoreU(hn::Mul(re, scale), d, out[3 * i + j] + n);
                if (i != j) hn::StoreU(hn::Mul(im, scale), d, out[3 * j + i] + n);
            }
    });
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(autoregressive_row);
HWY_EXPORT(markov_row);
HWY_EXPORT(joint_row);

double frequency(std::size_t k, std::size_t n) {
    return 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
}

TrigonometricPolynomial denominator_of(const Car2d& field) {
    TrigonometricPolynomial Lambda(1);
    for (std::size_t i = 0; i < field.a.size(); ++i)
        Lambda.add(field.neighbourhood[i], -static_cast<double>(field.a[i]));
    return Lambda;
}

TrigonometricPolynomial denominator_of(const Gmrf2d& field) {
    TrigonometricPolynomial A(1);
    for (std::size_t i = 0; i < field.a.size(); ++i) {
        const Offset s = field.neighbourhood[i];
        const Offset mirrored{static_cast<std::int8_t>(-s.row),
                              static_cast<std::int8_t>(-s.col)};
        A.add(s, -static_cast<double>(field.a[i]));
        A.add(mirrored, -static_cast<double>(field.a[i]));
    }
    return A;
}

/// Where the densities of one level go: the matrix of the planes of a PlaneField.
struct DensityRows {
    ImageView<float> matrix;
    std::size_t planes = 1;
    const ColumnTables& tables;
    Executor& executor;

    [[nodiscard]] PlaneView<float> element(std::size_t i, std::size_t j) const {
        return matrix.plane(i * planes + j);
    }
    /// body(m, phases) for every row of frequencies
    template <class Body>
    void for_each_row(const Body& body) const {
        parallel_for(executor, matrix.rows, [&](std::size_t m) {
            body(m, RowPhases(frequency(m, matrix.rows)));
        });
    }
};

void write_density(const Car2d& field, std::size_t plane, const DensityRows& rows) {
    const TrigonometricPolynomial Lambda = denominator_of(field);
    const PlaneView<float> out = rows.element(plane, plane);
    rows.for_each_row([&](std::size_t m, const RowPhases& phases) {
        HWY_DYNAMIC_DISPATCH(autoregressive_row)
        (Lambda.row(phases), field.variance, rows.tables, out.cols, out.row(m));
    });
}

void write_density(const Gmrf2d& field, std::size_t plane, const DensityRows& rows) {
    const TrigonometricPolynomial denominator = denominator_of(field);
    const PlaneView<float> out = rows.element(plane, plane);
    rows.for_each_row([&](std::size_t m, const RowPhases& phases) {
        HWY_DYNAMIC_DISPATCH(markov_row)
        (denominator.row(phases), field.variance, rows.tables, out.cols, out.row(m));
    });
}

/// The lower triangular F with F Fᵀ = Σ. Pivots that rounding made negative are 0.
std::array<float, 9> factor_of(const Autoregression3d& field) {
    std::array<double, 9> F{};
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = j; i < 3; ++i) {
            auto rest = static_cast<double>(field.Sigma[3 * i + j]);
            for (std::size_t k = 0; k < j; ++k) rest -= F[3 * i + k] * F[3 * j + k];
            if (i == j)
                F[3 * i + j] = std::sqrt(std::max(rest, 0.0));
            else
                F[3 * i + j] = F[3 * j + j] > 0 ? rest / F[3 * j + j] : 0;
        }
    }
    std::array<float, 9> result{};
    std::transform(F.begin(), F.end(), result.begin(),
                   [](double value) { return static_cast<float>(value); });
    return result;
}

void write_density(const Autoregression3d& field, std::size_t plane,
                   const DensityRows& rows) {
    const std::size_t d = field.planes;
    if (d == 1) {
        write_density(Car2d{field.neighbourhood, field.A, field.Sigma[0]}, plane, rows);
        return;
    }
    std::vector<TrigonometricPolynomial> Lambda;
    for (std::size_t k = 0; k < d * d; ++k) {
        TrigonometricPolynomial& element = Lambda.emplace_back(k % (d + 1) == 0 ? 1 : 0);
        for (std::size_t s = 0; s < field.neighbourhood.size(); ++s)
            element.add(field.neighbourhood[s],
                        -static_cast<double>(field.A[s * d * d + k]));
    }
    const std::array<float, 9> F = factor_of(field);
    rows.for_each_row([&](std::size_t m, const RowPhases& phases) {
        std::array<RowPolynomial, 9> polynomials;
        std::array<float*, 9> out{};
        for (std::size_t k = 0; k < out.size(); ++k) {
            polynomials[k] = Lambda[k].row(phases);
            out[k] = rows.matrix.plane(k).row(m);
        }
        HWY_DYNAMIC_DISPATCH(joint_row)
        (polynomials, F, rows.tables, rows.matrix.cols, out);
    });
}

/// The densities of all fields of the finest level that draw planes of `field`.
void level_density(const PlaneField& field, std::size_t cols, ImageView<float> matrix,
                   Executor& executor) {
    const ColumnTables tables(cols);
    const DensityRows rows{matrix, field.planes, tables, executor};
    std::size_t plane = 0;
    for (const FieldModel& model : field.levels.front().fields) {
        if (plane >= field.plane && plane < field.plane + field.planes)
            std::visit(
                [&](const auto& f) { write_density(f, plane - field.plane, rows); },
                model);
        plane += planes_of(model);
    }
}

/// 2 W²(ω) along one axis: the product over both axes is 4 W².
std::vector<float> expansion_gain(std::size_t count, std::size_t size) {
    std::vector<float> gain(count);
    for (std::size_t k = 0; k < count; ++k) {
        const double squared = (1 + std::cos(frequency(k, size))) / 2;  // cos² ω/2
        gain[k] = static_cast<float>(2 * squared * squared * squared * squared);
    }
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

/// \param mirror_sign  +1 for an element with E(-ω) = E(ω), -1 for one with E(-ω) = -E(ω)
void add_expanded(PlaneView<const float> coarse, float mirror_sign, std::size_t cols,
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
        const auto add = [gain = row_gain[m], &col_gain, out](std::size_t n, float E) {
            out[n] += gain * col_gain[n] * E;
        };
        if (col_axis.step == 1) {
            // The coarse row forwards, backwards by symmetry, and its first column again:
            // runs that the compiler vectorises.
            for (std::size_t n = 0; n < coarse.cols; ++n) add(n, direct[n]);
            for (std::size_t n = coarse.cols; n < col_axis.size; ++n)
                add(n, mirror_sign * mirrored[col_axis.size - n]);
            add(col_axis.size, direct[0]);
            return;
        }
        for (std::size_t n = 0; n < density.cols; ++n) {
            const std::size_t col = col_axis.index(n);
            add(n, col < coarse.cols ? direct[col]
                                     : mirror_sign * mirrored[col_axis.size - col]);
        }
    });
}

}  // namespace

Image spectral_density(const PlaneField& field, std::size_t rows, std::size_t cols,
                       Executor& executor) {
    const std::size_t d = field.planes;
    // Fields of single planes leave the elements between them 0.
    Image density = d == 1 ? Image(1, rows, cols / 2 + 1, uninitialised)
                           : Image(d * d, rows, cols / 2 + 1);
    level_density(field, cols, density.view(), executor);
    if (field.levels.size() > 1) {
        const Image coarse = spectral_density(field.coarser(1), CoarseAxis(rows).size,
                                              CoarseAxis(cols).size, executor);
        for (std::size_t i = 0; i < d; ++i)
            for (std::size_t j = 0; j < d; ++j)
                add_expanded(coarse.plane(i * d + j), i > j ? -1.0F : 1.0F, cols,
                             density.plane(i * d + j), executor);
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
