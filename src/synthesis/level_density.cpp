// SPDX-License-Identifier: Apache-2.0
// Spectral densities of the fields of one level. See level_density.hpp.
#include "synthesis/level_density.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/level_density.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "synthesis/complex_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

// A pole of a density on the torus would make the field infinite: denominators are bounded
// at their rounding error, relative to coefficients of about 1.
constexpr float kSmallestSquare = 1e-10F;
constexpr float kSmallestReal = 1e-6F;
constexpr float kSmallestSquaredDeterminant = 1e-14F;

using DF = hn::ScalableTag<float>;
using C = Complex<DF>;

/// a b - c e
HWY_INLINE C minor(const C& a, const C& b, const C& c, const C& e) {
    const auto re = hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re));
    const auto im = hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im));
    return {hn::MulAdd(c.im, e.im, hn::NegMulAdd(c.re, e.re, re)),
            hn::NegMulAdd(c.im, e.re, hn::NegMulAdd(c.re, e.im, im))};
}

/// Polynomials `first` to first + kCount - 1 at the frequencies from n on, of a row in P and of
/// its mirror image, the row at -ω1, in Q: with the sums over q
///
///     A = Σ even_re cos,  B = Σ odd_im sin,  C = Σ even_im cos,  D = Σ odd_re sin
///
/// P = (A + B) + j (C - D) and Q = (A - B) - j (C + D). kReal leaves out C and D.
template <std::size_t kCount, bool kReal, std::size_t K>
HWY_INLINE void evaluate(const RowPolynomials<K>& polynomials, const ColumnTables& tables,
                         std::size_t n, std::size_t first, C* P, C* Q) {
    const DF d;
    hn::Vec<DF> A[kCount], B[kCount], C_[kCount], D[kCount];
    for (std::size_t k = 0; k < kCount; ++k) {
        A[k] = hn::Set(d, polynomials.term[0].even_re[first + k]);
        C_[k] = hn::Set(d, polynomials.term[0].even_im[first + k]);
        B[k] = D[k] = hn::Zero(d);
    }
    for (std::size_t q = 1; q < polynomials.terms; ++q) {
        const auto& term = polynomials.term[q];
        const auto c = hn::LoadU(d, tables.cosines.plane(0).row(q) + n);
        const auto s = hn::LoadU(d, tables.sines.plane(0).row(q) + n);
        for (std::size_t k = 0; k < kCount; ++k) {
            A[k] = hn::MulAdd(hn::Set(d, term.even_re[first + k]), c, A[k]);
            B[k] = hn::MulAdd(hn::Set(d, term.odd_im[first + k]), s, B[k]);
            if (kReal) continue;
            C_[k] = hn::MulAdd(hn::Set(d, term.even_im[first + k]), c, C_[k]);
            D[k] = hn::MulAdd(hn::Set(d, term.odd_re[first + k]), s, D[k]);
        }
    }
    for (std::size_t k = 0; k < kCount; ++k) {
        P[first + k] = {hn::Add(A[k], B[k]), hn::Sub(C_[k], D[k])};
        Q[first + k] = {hn::Sub(A[k], B[k]), hn::Neg(hn::Add(C_[k], D[k]))};
    }
}

HWY_INLINE void add_to(float* out, hn::Vec<DF> value) {
    const DF d;
    hn::StoreU(hn::Add(hn::LoadU(d, out), value), d, out);
}

//     S(ω) = σ² / |P(ω)|²    or    σ² / P(ω), P real
template <bool kSquared>
void add_single(const RowPolynomials<1>& polynomial, float variance,
                const ColumnTables& tables, std::size_t count, float* out,
                float* mirrored) {
    const DF d;
    const auto density = [&](const C& P) HWY_ATTR {
        const auto bounded = kSquared
                                 ? hn::Max(squared<DF>(P), hn::Set(d, kSmallestSquare))
                                 : hn::Max(P.re, hn::Set(d, kSmallestReal));
        return hn::Div(hn::Set(d, variance), bounded);
    };
    for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
        C P;
        C Q;
        evaluate<1, !kSquared>(polynomial, tables, n, 0, &P, &Q);
        add_to(out + n, density(P));
        if (mirrored != nullptr) add_to(mirrored + n, density(Q));
    }
}

//     S(ω) = Λ⁻¹ Σ Λ⁻ᴴ = M Mᴴ / |det Λ|²,   M = adj(Λ) F,   Σ = F Fᵀ
//
// which is positive whatever the rounding. Row i, column j of the matrices is element
// 3i + j.
HWY_INLINE void add_joint_density(const C (&L)[9], const std::array<float, 9>& F,
                                  std::size_t n, const HermitianRows<float>& out) {
    const DF d;
    const C adjugate[9] = {minor(L[4], L[8], L[5], L[7]), minor(L[2], L[7], L[1], L[8]),
                           minor(L[1], L[5], L[2], L[4]), minor(L[5], L[6], L[3], L[8]),
                           minor(L[0], L[8], L[2], L[6]), minor(L[2], L[3], L[0], L[5]),
                           minor(L[3], L[7], L[4], L[6]), minor(L[1], L[6], L[0], L[7]),
                           minor(L[0], L[4], L[1], L[3])};
    C determinant = {hn::Zero(d), hn::Zero(d)};
    for (std::size_t j = 0; j < 3; ++j)
        add_product<DF>(L[j], adjugate[3 * j], determinant);
    const auto scale = hn::Div(
        hn::Set(d, 1.0F),
        hn::Max(squared<DF>(determinant), hn::Set(d, kSmallestSquaredDeterminant)));
    C M[9];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const auto last = hn::Set(d, F[6 + j]);
            auto re = hn::Mul(adjugate[3 * i + 2].re, last);
            auto im = hn::Mul(adjugate[3 * i + 2].im, last);
            for (std::size_t k = j; k < 2; ++k) {
                const auto f = hn::Set(d, F[3 * k + j]);
                re = hn::MulAdd(adjugate[3 * i + k].re, f, re);
                im = hn::MulAdd(adjugate[3 * i + k].im, f, im);
            }
            M[3 * i + j] = {re, im};
        }
    for (std::size_t i = 0; i < 3; ++i) {
        auto diagonal = squared<DF>(M[3 * i]);
        for (std::size_t k = 1; k < 3; ++k)
            diagonal = hn::Add(diagonal, squared<DF>(M[3 * i + k]));
        float* at = out[4 * i] + n;
        hn::StoreU(hn::MulAdd(diagonal, scale, hn::LoadU(d, at)), d, at);
        for (std::size_t j = i + 1; j < 3; ++j) {
            C element = {hn::Zero(d), hn::Zero(d)};
            for (std::size_t k = 0; k < 3; ++k)
                add_product_conjugate<DF>(M[3 * i + k], M[3 * j + k], element);
            float* re = out[3 * i + j] + n;
            float* im = out[3 * j + i] + n;
            hn::StoreU(hn::MulAdd(element.re, scale, hn::LoadU(d, re)), d, re);
            hn::StoreU(hn::MulAdd(element.im, scale, hn::LoadU(d, im)), d, im);
        }
    }
}

void add_joint(const RowPolynomials<9>& Lambda, const std::array<float, 9>& F,
               const ColumnTables& tables, std::size_t count,
               const HermitianRows<float>& out, const HermitianRows<float>& mirrored) {
    for (std::size_t n = 0; n < count; n += hn::Lanes(DF())) {
        C P[9];
        C Q[9];
        // A row of the matrix at a time: the sums of all would not fit the registers.
        for (std::size_t i = 0; i < 9; i += 3)
            evaluate<3, false>(Lambda, tables, n, i, P, Q);
        add_joint_density(P, F, n, out);
        if (mirrored[0] != nullptr) add_joint_density(Q, F, n, mirrored);
    }
}

void add_autoregressive(const RowPolynomials<1>& Lambda, float variance,
                        const ColumnTables& tables, std::size_t count, float* out,
                        float* mirrored) {
    add_single<true>(Lambda, variance, tables, count, out, mirrored);
}

void add_markov(const RowPolynomials<1>& denominator, float variance,
                const ColumnTables& tables, std::size_t count, float* out,
                float* mirrored) {
    add_single<false>(denominator, variance, tables, count, out, mirrored);
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(add_autoregressive);
HWY_EXPORT(add_markov);
HWY_EXPORT(add_joint);

Offset mirrored(Offset s) {
    return {static_cast<std::int8_t>(-s.row), static_cast<std::int8_t>(-s.col)};
}

/// 1 - Σ a_s e^{-jω·s}, and for a Markov field the mirrored terms as well.
TrigonometricPolynomials<1> denominator_of(const std::vector<Offset>& neighbourhood,
                                           const std::vector<float>& a, bool symmetric) {
    TrigonometricPolynomials<1> P;
    P.add({0, 0}, {1});
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double coefficient = -static_cast<double>(a[i]);
        P.add(neighbourhood[i], {coefficient});
        if (symmetric) P.add(mirrored(neighbourhood[i]), {coefficient});
    }
    return P;
}

TrigonometricPolynomials<9> denominator_of(const Autoregression3d& field) {
    TrigonometricPolynomials<9> Lambda;
    Lambda.add({0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    for (std::size_t s = 0; s < field.neighbourhood.size(); ++s) {
        std::array<double, 9> coefficients{};
        for (std::size_t k = 0; k < 9; ++k)
            coefficients[k] = -static_cast<double>(field.A[9 * s + k]);
        Lambda.add(field.neighbourhood[s], coefficients);
    }
    return Lambda;
}

/// The lower triangular F with F Fᵀ = Σ. Pivots that rounding made negative are 0.
std::array<float, 9> factor_of(const std::vector<float>& Sigma) {
    std::array<double, 9> F{};
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = j; i < 3; ++i) {
            auto rest = static_cast<double>(Sigma[3 * i + j]);
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

}  // namespace

LevelDensity::LevelDensity(const std::vector<FieldModel>& fields, std::size_t plane,
                           std::size_t planes, const Frequencies& rows,
                           const Frequencies& cols)
    : tables_(cols), planes_(planes), rows_(rows), count_(cols.size() / 2 + 1) {
    std::size_t first = 0;
    for (const FieldModel& field : fields) {
        if (first >= plane && first < plane + planes) add(field, first - plane);
        first += planes_of(field);
    }
}

void LevelDensity::add(const FieldModel& field, std::size_t plane) {
    const std::size_t element = plane * (planes_ + 1);
    const auto add_one = [&](const std::vector<Offset>& offsets,
                             const std::vector<float>& a, float variance, bool squared) {
        singles_.push_back(
            {denominator_of(offsets, a, !squared), variance, squared, element});
    };
    std::visit(
        [&](const auto& model) {
            using Model = std::decay_t<decltype(model)>;
            if constexpr (!is_joint<Model>)
                add_one(model.neighbourhood, model.a, model.variance,
                        !std::is_same_v<Model, Gmrf2d>);
            else if (model.planes == 1)
                add_one(model.neighbourhood, model.A, model.Sigma[0], true);
            else
                joint_ = Joint{denominator_of(model), factor_of(model.Sigma)};
        },
        field);
}

void LevelDensity::add_rows(std::size_t m, const HermitianRows<float>& out,
                            const HermitianRows<float>& mirrored) const {
    const RowPhases phases(rows_, m);
    for (const Single& single : singles_) {
        const auto run = single.squared ? HWY_DYNAMIC_DISPATCH(add_autoregressive)
                                        : HWY_DYNAMIC_DISPATCH(add_markov);
        run(single.denominator.row(phases), single.variance, tables_, count_,
            out[single.element], mirrored[single.element]);
    }
    if (!joint_) return;
    HWY_DYNAMIC_DISPATCH(add_joint)
    (joint_->Lambda.row(phases), joint_->F, tables_, count_, out, mirrored);
}

}  // namespace sateen
#endif
