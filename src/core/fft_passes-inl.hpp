// SPDX-License-Identifier: Apache-2.0
// Batches of one-dimensional transforms by Stockham passes, in split-complex form.
// Theory: docs/theory/fft.md. Included once per SIMD target.
#if defined(SATEEN_CORE_FFT_PASSES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_CORE_FFT_PASSES_INL_HPP
#undef SATEEN_CORE_FFT_PASSES_INL_HPP
#else
#define SATEEN_CORE_FFT_PASSES_INL_HPP
#endif

#include <cstddef>
#include <utility>

#include "core/fft_butterflies-inl.hpp"
#include "core/fft_plan.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

using detail::FftPass;
using detail::FftPlan1d;
using detail::kBatchLanes;

/// Points of a batch: point i is kBatchLanes floats at re + i · step and at im + i ·
/// step.
template <class T>
struct Points {
    T* re;
    T* im;
    std::size_t step;

    HWY_INLINE Points from(std::size_t point) const {
        return {re + point * step, im + point * step, step};
    }
};

template <std::size_t... J>
HWY_INLINE void load_points(Complexes* x, const float* re, const float* im,
                            std::size_t step, std::index_sequence<J...>) {
    ((x[J] = {hn::LoadU(Lanes(), re + J * step), hn::LoadU(Lanes(), im + J * step)}),
     ...);
}

template <std::size_t... K>
HWY_INLINE void store_points(const Complexes* x, float* re, float* im, std::size_t step,
                             std::index_sequence<K...>) {
    ((hn::StoreU(x[K].re, Lanes(), re + K * step),
      hn::StoreU(x[K].im, Lanes(), im + K * step)),
     ...);
}

/// x[k] *= w_k for k = 1 … R - 1, w interleaved (cos, sin).
template <std::size_t... K>
HWY_INLINE void turn(Complexes* x, const float* w, std::index_sequence<K...>) {
    ((x[K + 1] = mul(x[K + 1], {constant(w[2 * K]), constant(w[2 * K + 1])})), ...);
}

/// `count` butterflies side by side, q = 0 … count - 1; the points of one are `hop`
/// floats apart.
template <std::size_t R, bool kTurned>
HWY_INLINE void run_group(std::size_t count, const float* w, Points<const float> in,
                          std::size_t in_hop, Points<float> out, std::size_t out_hop) {
    for (std::size_t q = 0; q < count; ++q) {
        for (std::size_t lane = 0; lane < kBatchLanes; lane += hn::MaxLanes(Lanes())) {
            Complexes x[R];
            load_points(x, in.re + lane, in.im + lane, in_hop,
                        std::make_index_sequence<R>());
            Butterfly<R>::run(x);
            if constexpr (kTurned) turn(x, w, std::make_index_sequence<R - 1>());
            store_points(x, out.re + lane, out.im + lane, out_hop,
                         std::make_index_sequence<R>());
        }
        in = in.from(1);
        out = out.from(1);
    }
}

// With m = groups, s = stride, j, k = 0 … R - 1:
//     out(q + s (R p + k)) = exp(-2πi p k / (R m)) Σ_j in(q + s (p + m j)) exp(-2πi j k /
//     R)
template <std::size_t R>
HWY_NOINLINE void run_radix(const FftPass& pass, const float* twiddles,
                            Points<const float> in, Points<float> out) {
    const std::size_t m = pass.groups;
    const std::size_t s = pass.stride;
    const std::size_t in_hop = m * s * in.step;
    const std::size_t out_hop = s * out.step;
    const float* w = twiddles + pass.twiddles;
    run_group<R, false>(s, w, in, in_hop, out, out_hop);
    for (std::size_t p = 1; p < m; ++p) {
        in = in.from(s);
        out = out.from(R * s);
        run_group<R, true>(s, w, in, in_hop, out, out_hop);
        w += 2 * (R - 1);
    }
}

HWY_INLINE void run_pass(const FftPass& pass, const float* twiddles,
                         Points<const float> in, Points<float> out) {
    switch (pass.radix) {
        case 2:
            return run_radix<2>(pass, twiddles, in, out);
        case 3:
            return run_radix<3>(pass, twiddles, in, out);
        case 4:
            return run_radix<4>(pass, twiddles, in, out);
        case 5:
            return run_radix<5>(pass, twiddles, in, out);
        default:
            return run_radix<8>(pass, twiddles, in, out);
    }
}

/// The DFT of `in`, passes alternating between `odd` and `even`, the last to `out`.
/// `in` may be `even`, and `in` and `out` may be the same points.
HWY_INLINE void transform(const FftPlan1d& plan, Points<const float> in,
                          Points<float> odd, Points<float> even, Points<float> out) {
    for (std::size_t i = 0; i < plan.passes.size(); ++i) {
        const bool last = i + 1 == plan.passes.size();
        const Points<float> to = last ? out : (i % 2 == 0 ? odd : even);
        run_pass(plan.passes[i], plan.twiddles.data(), in, to);
        in = {to.re, to.im, to.step};
    }
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
