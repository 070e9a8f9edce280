// SPDX-License-Identifier: Apache-2.0
// Complex numbers in vectors, real and imaginary parts apart. Included once per SIMD target.
#if defined(SATEEN_SYNTHESIS_COMPLEX_VECTOR_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_SYNTHESIS_COMPLEX_VECTOR_INL_HPP
#undef SATEEN_SYNTHESIS_COMPLEX_VECTOR_INL_HPP
#else
#define SATEEN_SYNTHESIS_COMPLEX_VECTOR_INL_HPP
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct Complex {
    hn::Vec<D> re;
    hn::Vec<D> im;
};

/// |a|²
template <class D>
HWY_INLINE hn::Vec<D> squared(const Complex<D>& a) {
    return hn::MulAdd(a.re, a.re, hn::Mul(a.im, a.im));
}

/// sum ← sum + a b
template <class D>
HWY_INLINE void add_product(const Complex<D>& a, const Complex<D>& b, Complex<D>& sum) {
    sum.re = hn::MulAdd(a.re, b.re, hn::NegMulAdd(a.im, b.im, sum.re));
    sum.im = hn::MulAdd(a.re, b.im, hn::MulAdd(a.im, b.re, sum.im));
}

/// sum ← sum + a b̄
template <class D>
HWY_INLINE void add_product_conjugate(const Complex<D>& a, const Complex<D>& b,
                                      Complex<D>& sum) {
    sum.re = hn::MulAdd(a.re, b.re, hn::MulAdd(a.im, b.im, sum.re));
    sum.im = hn::MulAdd(a.im, b.re, hn::NegMulAdd(a.re, b.im, sum.im));
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
