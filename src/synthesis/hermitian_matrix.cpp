// SPDX-License-Identifier: Apache-2.0
// Rows of Hermitian 3 × 3 matrices. See hermitian_matrix.hpp.
#include "synthesis/hermitian_matrix.hpp"

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/hermitian_matrix.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/vector_row-inl.hpp"
#include "synthesis/complex_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

/// One matrix a lane.
template <class D>
struct Hermitian3 {
    hn::Vec<D> diagonal[3];
    Complex<D> upper[3];  ///< (0,1), (0,2), (1,2)
};

template <class D, class T>
HWY_INLINE Hermitian3<D> load(D d, const HermitianRows<T>& rows, std::size_t n) {
    const auto at = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, rows[k] + n); };
    return {{at(0), at(4), at(8)}, {{at(1), at(3)}, {at(2), at(6)}, {at(5), at(7)}}};
}

template <class D>
HWY_INLINE void store(D d, const Hermitian3<D>& H, const HermitianRows<float>& rows,
                      std::size_t n) {
    constexpr std::size_t kRe[3] = {1, 2, 5};
    constexpr std::size_t kIm[3] = {3, 6, 7};
    for (std::size_t k = 0; k < 3; ++k) {
        hn::StoreU(H.diagonal[k], d, rows[4 * k] + n);
        hn::StoreU(H.upper[k].re, d, rows[kRe[k]] + n);
        hn::StoreU(H.upper[k].im, d, rows[kIm[k]] + n);
    }
}

/// a b - c x: an element of the adjugate; rounded once less than products would be.
template <class D>
HWY_INLINE Complex<D> cofactor(const Complex<D>& a, const Complex<D>& b,
                               const Complex<D>& c, hn::Vec<D> x) {
    return {hn::MulAdd(a.re, b.re, hn::Neg(hn::MulAdd(a.im, b.im, hn::Mul(c.re, x)))),
            hn::MulAdd(a.im, b.re, hn::NegMulAdd(c.im, x, hn::Mul(a.re, b.im)))};
}

template <class D>
HWY_INLINE Complex<D> conjugate(const Complex<D>& z) {
    return {z.re, hn::Neg(z.im)};
}

// Divisions and roots of whole vectors take longer than all the rest: reciprocals are
// approximated, to 12 bits or more, and where that is too little improved by a step of Newton's
// method.

/// √q to 12 bits.
template <class D>
HWY_INLINE hn::Vec<D> rough_sqrt(D d, hn::Vec<D> q) {
    return hn::Mul(q, hn::ApproximateReciprocalSqrt(hn::Max(q, hn::Set(d, 1e-20F))));
}

/// 1/√q for q > 0.
template <class D>
HWY_INLINE hn::Vec<D> reciprocal_sqrt(D d, hn::Vec<D> q) {
    const auto r = hn::ApproximateReciprocalSqrt(q);
    const auto half = hn::Mul(hn::Mul(hn::Set(d, 0.5F), q), r);
    return hn::MulAdd(r, hn::NegMulAdd(half, r, hn::Set(d, 0.5F)), r);
}

/// 1/c for c > 0.
template <class D>
HWY_INLINE hn::Vec<D> reciprocal(D d, hn::Vec<D> c) {
    const auto r = hn::ApproximateReciprocal(c);
    return hn::MulAdd(r, hn::NegMulAdd(c, r, hn::Set(d, 1.0F)), r);
}

/// Below this of the squared trace the second invariant of a matrix is rounding.
constexpr float kSmallestInvariant = 1e-7F;

// X = S^{1/2} from the invariants of both. Of S, scaled to a trace I1 near 1: the sum I2 of
// its principal minors and I3 = det S, both from the adjugate A,
//
//     I2 = tr A,    I3 = (A11 A22 - |A12|²) / S00
//
// which loses half as many digits as the determinant. Of X: i3 = √I3, and i1, i2 solve
//
//     i1² = I1 + 2 i2,    i2² = I2 + 2 i3 i1
//
// of which two fixed-point steps from √2 + (√3 - √2) √27 i3, right for three and for two
// equal eigenvalues, leave an error of 5e-4 and a step of Newton's method 1e-7. By the
// theorem of Cayley and Hamilton
//
//     X = (i2 S + (I2 + i1 i3) 1 - A) / (i1 i2 - i3)
//
// The chain from S to i2 is long and has few operations, so it runs over a piece of the row
// by itself: many vectors are then on their way at a time.

/// Frequencies of a piece.
constexpr std::size_t kPiece = 64;

/// Of a piece: what the equations of i1 and i2 need, or X = a S + b 1 + g (I2 1 - A).
struct Invariants {
    HWY_ALIGN float unit[kPiece];  ///< 1/tr S, nearly
    HWY_ALIGN float I1[kPiece];
    HWY_ALIGN float I2[kPiece];
    HWY_ALIGN float I3_S00[kPiece];
    HWY_ALIGN float S00[kPiece];
};
struct RootFactors {
    HWY_ALIGN float a[kPiece];
    HWY_ALIGN float b[kPiece];
    HWY_ALIGN float g[kPiece];
};

/// The adjugate of S, diagonal and upper triangle.
template <class D>
HWY_INLINE Hermitian3<D> adjugate(D d, const Hermitian3<D>& S) {
    const auto minor = [&](std::size_t i, std::size_t j, const Complex<D>& h) HWY_ATTR {
        const auto rest =
            hn::NegMulAdd(h.re, h.re, hn::Mul(S.diagonal[i], S.diagonal[j]));
        return hn::Max(hn::NegMulAdd(h.im, h.im, rest), hn::Zero(d));
    };
    const Complex<D>(&b)[3] = S.upper;
    return {{minor(1, 2, b[2]), minor(0, 2, b[1]), minor(0, 1, b[0])},
            {cofactor<D>(b[1], conjugate<D>(b[2]), b[0], S.diagonal[2]),
             cofactor<D>(b[0], b[2], b[1], S.diagonal[1]),
             cofactor<D>(b[1], conjugate<D>(b[0]), b[2], S.diagonal[0])}};
}

template <class D>
HWY_INLINE void find_invariants(D d, const Hermitian3<D>& S, std::size_t at,
                                Invariants& out) {
    const Hermitian3<D> A = adjugate(d, S);
    const auto trace = hn::Add(S.diagonal[0], hn::Add(S.diagonal[1], S.diagonal[2]));
    const auto unit = hn::ApproximateReciprocal(hn::Max(trace, hn::Set(d, 1e-20F)));
    const auto scaled = [&](hn::Vec<D> x) HWY_ATTR { return hn::Mul(unit, x); };
    const auto I2 = hn::Add(A.diagonal[0], hn::Add(A.diagonal[1], A.diagonal[2]));
    const auto re = scaled(A.upper[2].re);
    const auto im = scaled(A.upper[2].im);
    const auto rest =
        hn::NegMulAdd(re, re, hn::Mul(scaled(A.diagonal[1]), scaled(A.diagonal[2])));
    const auto I3_S00 = hn::Max(hn::NegMulAdd(im, im, rest), hn::Zero(d));
    hn::Store(unit, d, out.unit + at);
    hn::Store(hn::Max(scaled(trace), hn::Set(d, 0.5F)), d, out.I1 + at);
    hn::Store(scaled(scaled(I2)), d, out.I2 + at);
    hn::Store(scaled(scaled(I3_S00)), d, out.I3_S00 + at);
    hn::Store(scaled(S.diagonal[0]), d, out.S00 + at);
}

template <class D>
HWY_INLINE void find_factors(D d, const Invariants& in, std::size_t at,
                             RootFactors& out) {
    const auto two = hn::Set(d, 2.0F);
    const auto I1 = hn::Load(d, in.I1 + at);
    const auto I2 = hn::Load(d, in.I2 + at);
    const auto I3_S00 = hn::Load(d, in.I3_S00 + at);
    const auto product = hn::Mul(I3_S00, hn::Load(d, in.S00 + at));
    const auto i3 =
        hn::Mul(I3_S00, reciprocal_sqrt(d, hn::Max(product, hn::Set(d, 1e-30F))));
    const auto twice_i3 = hn::Add(i3, i3);
    auto i1 = hn::MulAdd(hn::Set(d, 1.6515F), i3, hn::Set(d, 1.41421F));
    for (int step = 0; step < 2; ++step)
        i1 = rough_sqrt(d,
                        hn::MulAdd(two, rough_sqrt(d, hn::MulAdd(twice_i3, i1, I2)), I1));
    const auto q = hn::Max(hn::MulAdd(twice_i3, i1, I2), hn::Set(d, 1e-20F));
    const auto x = hn::Mul(q, reciprocal_sqrt(d, q));
    const auto excess = hn::NegMulAdd(two, x, hn::MulSub(i1, i1, I1));
    const auto slope = hn::Mul(two, hn::MulSub(i1, x, i3));
    i1 = hn::NegMulAdd(hn::Mul(x, hn::ApproximateReciprocal(slope)), excess, i1);
    const auto i2_squared =
        hn::Max(hn::MulAdd(twice_i3, i1, I2), hn::Set(d, kSmallestInvariant));
    const auto i2 = hn::Mul(i2_squared, reciprocal_sqrt(d, i2_squared));
    // Back to the size of S.
    const auto unit = hn::Load(d, in.unit + at);
    const auto scale =
        hn::Mul(reciprocal_sqrt(d, unit), reciprocal(d, hn::MulSub(i1, i2, i3)));
    const auto unit_scale = hn::Mul(unit, scale);
    hn::Store(hn::Mul(i2, unit_scale), d, out.a + at);
    hn::Store(hn::Mul(scale, hn::Mul(i1, i3)), d, out.b + at);
    hn::Store(hn::Mul(unit, unit_scale), d, out.g + at);
}

template <class D>
HWY_INLINE Hermitian3<D> root(D d, const Hermitian3<D>& S, const RootFactors& factors,
                              std::size_t at) {
    const Hermitian3<D> A = adjugate(d, S);
    const auto a = hn::Load(d, factors.a + at);
    const auto b = hn::Load(d, factors.b + at);
    const auto g = hn::Load(d, factors.g + at);
    const auto element = [&](hn::Vec<D> s, hn::Vec<D> adjoint)
                             HWY_ATTR { return hn::MulSub(a, s, hn::Mul(g, adjoint)); };
    Hermitian3<D> X;
    for (std::size_t k = 0; k < 3; ++k) {
        // I2 - A00 = A11 + A22: zero rows stay zero.
        const auto others = hn::Add(A.diagonal[(k + 1) % 3], A.diagonal[(k + 2) % 3]);
        X.diagonal[k] = hn::MulAdd(a, S.diagonal[k], hn::MulAdd(g, others, b));
        X.upper[k] = {element(S.upper[k].re, A.upper[k].re),
                      element(S.upper[k].im, A.upper[k].im)};
    }
    return X;
}

/// y_i = Σ_j X_ij w_j
template <class D>
HWY_INLINE void multiply(D d, const Hermitian3<D>& X, const ComplexRows<const float>& w,
                         const ComplexRows<float>& y, std::size_t n) {
    Complex<D> in[3];
    Complex<D> out[3];
    for (std::size_t i = 0; i < 3; ++i) {
        in[i] = {hn::LoadU(d, w.re[i] + n), hn::LoadU(d, w.im[i] + n)};
        out[i] = {hn::Mul(X.diagonal[i], in[i].re), hn::Mul(X.diagonal[i], in[i].im)};
    }
    constexpr std::size_t kRow[3] = {0, 0, 1};
    constexpr std::size_t kCol[3] = {1, 2, 2};
    for (std::size_t k = 0; k < 3; ++k) {
        add_product<D>(X.upper[k], in[kCol[k]], out[kRow[k]]);
        add_product_conjugate<D>(in[kRow[k]], X.upper[k], out[kCol[k]]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        hn::StoreU(out[i].re, d, y.re[i] + n);
        hn::StoreU(out[i].im, d, y.im[i] + n);
    }
}

/// take(d, n, X) with the roots at the frequencies from n on.
template <class T, class Take>
HWY_INLINE void for_each_root(const HermitianRows<T>& S, std::size_t count,
                              const Take& take) {
    Invariants invariants;
    RootFactors factors;
    for (std::size_t first = 0; first < count; first += kPiece) {
        const std::size_t piece = std::min(kPiece, count - first);
        for_row(piece, [&](auto d, std::size_t at) HWY_ATTR {
            find_invariants(d, load(d, S, first + at), at, invariants);
        });
        for_row(piece, [&](auto d, std::size_t at)
                           HWY_ATTR { find_factors(d, invariants, at, factors); });
        for_row(piece, [&](auto d, std::size_t at) HWY_ATTR {
            take(d, first + at, root(d, load(d, S, first + at), factors, at));
        });
    }
}

void root_rows(const HermitianRows<float>& rows, std::size_t count) {
    for_each_root(rows, count, [&](auto d, std::size_t n, const auto& X) HWY_ATTR {
        store(d, X, rows, n);
    });
}

void multiply_root_rows(const HermitianRows<const float>& S,
                        const ComplexRows<const float>& w, const ComplexRows<float>& y,
                        std::size_t count) {
    for_each_root(S, count, [&](auto d, std::size_t n, const auto& X) HWY_ATTR {
        multiply(d, X, w, y, n);
    });
}

void multiply_rows(const HermitianRows<const float>& X, const std::array<float, 3>& gains,
                   const ComplexRows<const float>& w, const ComplexRows<float>& y,
                   std::size_t count) {
    for_row(count, [&](auto d, std::size_t n) HWY_ATTR {
        multiply(d, load(d, X, n), w, y, n);
        for (std::size_t i = 0; i < 3; ++i)
            for (float* row : {y.re[i] + n, y.im[i] + n})
                hn::StoreU(hn::Mul(hn::Set(d, gains[i]), hn::LoadU(d, row)), d, row);
    });
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(root_rows);
HWY_EXPORT(multiply_root_rows);
HWY_EXPORT(multiply_rows);

void hermitian_root(const HermitianRows<float>& S, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(root_rows)(S, count);
}

void multiply_by_root(const HermitianRows<const float>& S,
                      const ComplexRows<const float>& w, const ComplexRows<float>& y,
                      std::size_t count) {
    HWY_DYNAMIC_DISPATCH(multiply_root_rows)(S, w, y, count);
}

void multiply_hermitian(const HermitianRows<const float>& X,
                        const std::array<float, 3>& gains,
                        const ComplexRows<const float>& w, const ComplexRows<float>& y,
                        std::size_t count) {
    HWY_DYNAMIC_DISPATCH(multiply_rows)(X, gains, w, y, count);
}

}  // namespace sateen
#endif
