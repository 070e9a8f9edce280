// SPDX-License-Identifier: Apache-2.0
// Discrete Fourier transforms of 2, 3, 4, 5 and 8 points in registers, one transform a
// lane. Included once per SIMD target.
#if defined(SATEEN_CORE_FFT_BUTTERFLIES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_CORE_FFT_BUTTERFLIES_INL_HPP
#undef SATEEN_CORE_FFT_BUTTERFLIES_INL_HPP
#else
#define SATEEN_CORE_FFT_BUTTERFLIES_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "core/fft_plan.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// As many lanes as the target has, at most a batch.
using Lanes = hn::CappedTag<float, detail::kBatchLanes>;
using Reals = hn::Vec<Lanes>;

struct Complexes {
    Reals re;
    Reals im;
};

HWY_INLINE Reals constant(float value) {
    return hn::Set(Lanes(), value);
}
HWY_INLINE Complexes add(Complexes a, Complexes b) {
    return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE Complexes sub(Complexes a, Complexes b) {
    return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
/// a + i b
HWY_INLINE Complexes add_i(Complexes a, Complexes b) {
    return {hn::Sub(a.re, b.im), hn::Add(a.im, b.re)};
}
/// a - i b
HWY_INLINE Complexes sub_i(Complexes a, Complexes b) {
    return {hn::Add(a.re, b.im), hn::Sub(a.im, b.re)};
}
HWY_INLINE Complexes scale(Reals s, Complexes a) {
    return {hn::Mul(s, a.re), hn::Mul(s, a.im)};
}
/// s a + b
HWY_INLINE Complexes mul_add(Reals s, Complexes a, Complexes b) {
    return {hn::MulAdd(s, a.re, b.re), hn::MulAdd(s, a.im, b.im)};
}
/// b - s a
HWY_INLINE Complexes neg_mul_add(Reals s, Complexes a, Complexes b) {
    return {hn::NegMulAdd(s, a.re, b.re), hn::NegMulAdd(s, a.im, b.im)};
}
HWY_INLINE Complexes mul(Complexes a, Complexes w) {
    return {hn::NegMulAdd(a.im, w.im, hn::Mul(a.re, w.re)),
            hn::MulAdd(a.im, w.re, hn::Mul(a.re, w.im))};
}

/// Replaces x by its DFT of R points, in natural order.
template <std::size_t R>
struct Butterfly;

template <>
struct Butterfly<2> {
    static HWY_INLINE void run(Complexes* x) {
        const Complexes t = x[1];
        x[1] = sub(x[0], t);
        x[0] = add(x[0], t);
    }
};

template <>
struct Butterfly<3> {
    static HWY_INLINE void run(Complexes* x) {
        const Complexes sum = add(x[1], x[2]);
        const Complexes odd = scale(constant(0.866025403784438647F), sub(x[1], x[2]));
        const Complexes even = mul_add(constant(-0.5F), sum, x[0]);
        x[0] = add(x[0], sum);
        x[1] = sub_i(even, odd);
        x[2] = add_i(even, odd);
    }
};

template <>
struct Butterfly<4> {
    static HWY_INLINE void run(Complexes* x) {
        const Complexes a = add(x[0], x[2]);
        const Complexes b = sub(x[0], x[2]);
        const Complexes c = add(x[1], x[3]);
        const Complexes d = sub(x[1], x[3]);
        x[0] = add(a, c);
        x[1] = sub_i(b, d);
        x[2] = sub(a, c);
        x[3] = add_i(b, d);
    }
};

// With a± = x1 ± x4, b± = x2 ± x3, c_j = cos(2πj/5), s_j = sin(2πj/5):
//     X_1, X_4 = x0 + c_1 a+ + c_2 b+  ∓ i (s_1 a- + s_2 b-)
//     X_2, X_3 = x0 + c_2 a+ + c_1 b+  ∓ i (s_2 a- - s_1 b-)
template <>
struct Butterfly<5> {
    static HWY_INLINE void run(Complexes* x) {
        const Reals c1 = constant(0.309016994374947424F);
        const Reals c2 = constant(-0.809016994374947424F);
        const Reals s1 = constant(0.951056516295153572F);
        const Reals s2 = constant(0.587785252292473129F);
        const Complexes a_sum = add(x[1], x[4]);
        const Complexes a_dif = sub(x[1], x[4]);
        const Complexes b_sum = add(x[2], x[3]);
        const Complexes b_dif = sub(x[2], x[3]);
        const Complexes even1 = mul_add(c1, a_sum, mul_add(c2, b_sum, x[0]));
        const Complexes even2 = mul_add(c2, a_sum, mul_add(c1, b_sum, x[0]));
        const Complexes odd1 = mul_add(s1, a_dif, scale(s2, b_dif));
        const Complexes odd2 = sub(scale(s2, a_dif), scale(s1, b_dif));
        x[0] = add(x[0], add(a_sum, b_sum));
        x[1] = sub_i(even1, odd1);
        x[2] = sub_i(even2, odd2);
        x[3] = add_i(even2, odd2);
        x[4] = add_i(even1, odd1);
    }
};

// Even and odd points by 4, then the odd half turned by w_8^k = (√½ (1 - i))^k.
template <>
struct Butterfly<8> {
    static HWY_INLINE void run(Complexes* x) {
        const Reals root = constant(0.707106781186547524F);
        Complexes even[4] = {x[0], x[2], x[4], x[6]};
        Complexes odd[4] = {x[1], x[3], x[5], x[7]};
        Butterfly<4>::run(even);
        Butterfly<4>::run(odd);
        const Complexes odd1 = {hn::Add(odd[1].re, odd[1].im),
                                hn::Sub(odd[1].im, odd[1].re)};
        const Complexes odd3 = {hn::Sub(odd[3].im, odd[3].re),
                                hn::Add(odd[3].re, odd[3].im)};
        x[0] = add(even[0], odd[0]);
        x[4] = sub(even[0], odd[0]);
        x[1] = mul_add(root, odd1, even[1]);
        x[5] = neg_mul_add(root, odd1, even[1]);
        x[2] = sub_i(even[2], odd[2]);
        x[6] = add_i(even[2], odd[2]);
        x[3] = {hn::MulAdd(root, odd3.re, even[3].re),
                hn::NegMulAdd(root, odd3.im, even[3].im)};
        x[7] = {hn::NegMulAdd(root, odd3.re, even[3].re),
                hn::MulAdd(root, odd3.im, even[3].im)};
    }
};

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
