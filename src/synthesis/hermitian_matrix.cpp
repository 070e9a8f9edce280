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

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct Complex {
    hn::Vec<D> re;
    hn::Vec<D> im;
};

/// A cyclic sweep of Jacobi's method squares the off-diagonal elements, once they are small;
/// four sweeps do for single precision from any start, planes that are nearly uncorrelated
/// need fewer.
constexpr int kSweeps = 4;
/// Of trace 1: elements of 1e-7 change the root by no more than its rounding.
constexpr float kConverged = 1e-14F;

/// One matrix a lane: H = V diag(λ) Vᴴ, the upper triangle of H.
template <class D>
struct Eigen3 {
    hn::Vec<D> diagonal[3];
    Complex<D> upper[3];  ///< (0,1), (0,2), (1,2)
    Complex<D> V[9];
};

/// a ← c (a - w b), b ← c (b + w̄ a): the columns p and q of a matrix after the rotation.
template <class D>
HWY_INLINE void rotate(hn::Vec<D> c, const Complex<D>& w, Complex<D>& a, Complex<D>& b) {
    const Complex<D> old = a;
    a = {hn::Mul(c, hn::MulAdd(w.im, b.im, hn::NegMulAdd(w.re, b.re, a.re))),
         hn::Mul(c, hn::NegMulAdd(w.im, b.re, hn::NegMulAdd(w.re, b.im, a.im)))};
    b = {hn::Mul(c, hn::MulAdd(w.im, old.im, hn::MulAdd(w.re, old.re, b.re))),
         hn::Mul(c, hn::NegMulAdd(w.im, old.re, hn::MulAdd(w.re, old.im, b.im)))};
}

// Annihilates the element (p, q), h, by the unitary [c  c w̄; -c w  c] of columns p and q:
//
//     x = (H_qq - H_pp)/2    w = h̄ sgn x / (|x| + √(x² + |h|²))    c = 1/√(1 + |w|²)
//
//     H_pp ← H_pp - w h    H_qq ← H_qq + w h        (w h is real)
//
// Unitary whatever w is, so an element whose square underflows does no harm.
// `rp` and `rq` are the elements of the third row in columns p and q.
template <class D>
HWY_INLINE void annihilate(D d, std::size_t p, std::size_t q, Complex<D>& h,
                           Complex<D>& rp, Complex<D>& rq, Eigen3<D>& H) {
    const auto one = hn::Set(d, 1.0F);
    const auto squared = hn::MulAdd(h.re, h.re, hn::Mul(h.im, h.im));
    const auto x = hn::Mul(hn::Set(d, 0.5F), hn::Sub(H.diagonal[q], H.diagonal[p]));
    const auto length = hn::Add(hn::Abs(x), hn::Sqrt(hn::MulAdd(x, x, squared)));
    const auto factor =
        hn::CopySign(hn::Div(one, hn::Max(length, hn::Set(d, 1e-15F))), x);
    const Complex<D> w = {hn::Mul(factor, h.re), hn::Neg(hn::Mul(factor, h.im))};
    const auto shift = hn::Mul(factor, squared);
    const auto c =
        hn::Div(one, hn::Sqrt(hn::MulAdd(w.re, w.re, hn::MulAdd(w.im, w.im, one))));
    H.diagonal[p] = hn::Sub(H.diagonal[p], shift);
    H.diagonal[q] = hn::Add(H.diagonal[q], shift);
    h = {hn::Zero(d), hn::Zero(d)};
    rotate<D>(c, w, rp, rq);
    for (std::size_t k = 0; k < 3; ++k) rotate<D>(c, w, H.V[3 * k + p], H.V[3 * k + q]);
}

template <class D>
HWY_INLINE bool is_diagonal(D d, const Eigen3<D>& H) {
    auto sum = hn::Zero(d);
    for (std::size_t k = 0; k < 3; ++k) {
        sum = hn::MulAdd(H.upper[k].re, H.upper[k].re, sum);
        sum = hn::MulAdd(H.upper[k].im, H.upper[k].im, sum);
    }
    return hn::AllTrue(d, hn::Lt(sum, hn::Set(d, kConverged)));
}

template <class D>
HWY_INLINE Complex<D> conjugate(const Complex<D>& z) {
    return {z.re, hn::Neg(z.im)};
}

template <class D>
HWY_INLINE void sweep(D d, Eigen3<D>& H) {
    Complex<D>& h01 = H.upper[0];
    Complex<D>& h02 = H.upper[1];
    Complex<D>& h12 = H.upper[2];
    // Third rows: H_20 = conj H_02, H_21 = conj H_12; H_10 and H_12; H_01 and H_02.
    Complex<D> h20 = conjugate<D>(h02);
    Complex<D> h21 = conjugate<D>(h12);
    annihilate(d, 0, 1, h01, h20, h21, H);
    h02 = conjugate<D>(h20);
    h12 = conjugate<D>(h21);
    Complex<D> h10 = conjugate<D>(h01);
    annihilate(d, 0, 2, h02, h10, h12, H);
    h01 = conjugate<D>(h10);
    annihilate(d, 1, 2, h12, h01, h02, H);
}

template <class D>
HWY_INLINE void root_of_vector(D d, const HermitianRows<float>& rows, std::size_t n) {
    const auto trace =
        hn::Add(hn::LoadU(d, rows[0] + n),
                hn::Add(hn::LoadU(d, rows[4] + n), hn::LoadU(d, rows[8] + n)));
    const auto none = hn::Lt(trace, hn::Set(d, 1e-30F));
    const auto unit = hn::IfThenZeroElse(none, hn::Div(hn::Set(d, 1.0F), trace));
    const auto load = [&](std::size_t k)
                          HWY_ATTR { return hn::Mul(unit, hn::LoadU(d, rows[k] + n)); };
    Eigen3<D> H;
    for (std::size_t i = 0; i < 3; ++i) H.diagonal[i] = load(4 * i);
    H.upper[0] = {load(1), load(3)};
    H.upper[1] = {load(2), load(6)};
    H.upper[2] = {load(5), load(7)};
    for (std::size_t k = 0; k < 9; ++k)
        H.V[k] = {hn::Set(d, k % 4 == 0 ? 1.0F : 0.0F), hn::Zero(d)};
    for (int k = 0; k < kSweeps && !is_diagonal(d, H); ++k) sweep(d, H);
    const auto size = hn::IfThenZeroElse(none, trace);
    hn::Vec<D> root[3];
    for (std::size_t k = 0; k < 3; ++k)
        root[k] = hn::Sqrt(hn::Mul(size, hn::Max(H.diagonal[k], hn::Zero(d))));
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            auto re = hn::Zero(d);
            auto im = hn::Zero(d);
            for (std::size_t k = 0; k < 3; ++k) {
                const Complex<D>& a = H.V[3 * i + k];
                const Complex<D>& b = H.V[3 * j + k];
                const auto a_re = hn::Mul(a.re, root[k]);
                const auto a_im = hn::Mul(a.im, root[k]);
                re = hn::MulAdd(a_re, b.re, hn::MulAdd(a_im, b.im, re));
                im = hn::MulAdd(a_im, b.re, hn::NegMulAdd(a_re, b.im, im));
            }
            hn::StoreU(re, d, rows[3 * i + j] + n);
            if (i != j) hn::StoreU(im, d, rows[3 * j + i] + n);
        }
}

template <class D>
HWY_INLINE void multiply_vector(D d, const HermitianRows<const float>& X,
                                const std::array<float, 3>& gains, const ComplexRows& w,
                                const ComplexRows& y, std::size_t n) {
    Complex<D> in[3];
    for (std::size_t j = 0; j < 3; ++j)
        in[j] = {hn::LoadU(d, w.re[j] + n), hn::LoadU(d, w.im[j] + n)};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto diagonal = hn::LoadU(d, X[4 * i] + n);
        auto re = hn::Mul(diagonal, in[i].re);
        auto im = hn::Mul(diagonal, in[i].im);
        for (std::size_t j = 0; j < 3; ++j) {
            if (j == i) continue;
            const auto a = hn::LoadU(d, X[i < j ? 3 * i + j : 3 * j + i] + n);
            const auto imaginary = hn::LoadU(d, X[i < j ? 3 * j + i : 3 * i + j] + n);
            const auto b = i < j ? imaginary : hn::Neg(imaginary);
            re = hn::NegMulAdd(b, in[j].im, hn::MulAdd(a, in[j].re, re));
            im = hn::MulAdd(b, in[j].re, hn::MulAdd(a, in[j].im, im));
        }
        const auto gain = hn::Set(d, gains[i]);
        hn::StoreU(hn::Mul(gain, re), d, y.re[i] + n);
        hn::StoreU(hn::Mul(gain, im), d, y.im[i] + n);
    }
}

void root_rows(const HermitianRows<float>& rows, std::size_t count) {
    const hn::ScalableTag<float> d;
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d)) root_of_vector(d, rows, n);
    for (; n < count; ++n) root_of_vector(hn::CappedTag<float, 1>(), rows, n);
}

void multiply_rows(const HermitianRows<const float>& X, const std::array<float, 3>& gains,
                   const ComplexRows& w, const ComplexRows& y, std::size_t count) {
    const hn::ScalableTag<float> d;
    std::size_t n = 0;
    for (; n + hn::Lanes(d) <= count; n += hn::Lanes(d))
        multiply_vector(d, X, gains, w, y, n);
    for (; n < count; ++n) multiply_vector(hn::CappedTag<float, 1>(), X, gains, w, y, n);
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(root_rows);
HWY_EXPORT(multiply_rows);

void hermitian_root(const HermitianRows<float>& S, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(root_rows)(S, count);
}

void multiply_hermitian(const HermitianRows<const float>& X,
                        const std::array<float, 3>& gains, const ComplexRows& w,
                        const ComplexRows& y, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(multiply_rows)(X, gains, w, y, count);
}

}  // namespace sateen
#endif
