// SPDX-License-Identifier: Apache-2.0
// Vectors of points and of colours for the batches of blends. Included once per SIMD target.
#if defined(SATEEN_SYNTHESIS_BATCH_VECTOR_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_SYNTHESIS_BATCH_VECTOR_INL_HPP
#undef SATEEN_SYNTHESIS_BATCH_VECTOR_INL_HPP
#else
#define SATEEN_SYNTHESIS_BATCH_VECTOR_INL_HPP
#endif

#include <hwy/highway.h>

#include <array>
#include <limits>

#include "synthesis/blend_batch.hpp"

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kBatch>;
using DI = hn::RebindToSigned<DF>;
using Float = hn::Vec<DF>;
using Int = hn::Vec<DI>;

HWY_INLINE Float set(float value) {
    return hn::Set(DF(), value);
}

// x^exponent, 0 for x = 0.
HWY_INLINE Float power(Float x, Float exponent) {
    const DF df;
    const Float positive = hn::Max(x, set(std::numeric_limits<float>::min()));
    const Float value = hn::Exp(df, hn::Mul(exponent, hn::Log(df, positive)));
    return hn::IfThenElse(hn::Gt(x, hn::Zero(df)), value, hn::Zero(df));
}

// Four floats; vectors have room for them but on the scalar target.
#if HWY_TARGET == HWY_SCALAR
struct Four {
    std::array<float, 4> value;
};
HWY_INLINE Four no_four() {
    return {{0, 0, 0, 0}};
}
HWY_INLINE Four load_four(const float* from) {
    return {{from[0], from[1], from[2], from[3]}};
}
HWY_INLINE void store(const Four& four, float* to) {
    for (std::size_t c = 0; c < 4; ++c) to[c] = four.value[c];
}
HWY_INLINE Four add_product(float factor, const Four& a, Four sum) {
    for (std::size_t c = 0; c < 4; ++c) sum.value[c] += factor * a.value[c];
    return sum;
}
#else
using FourTag = hn::FixedTag<float, 4>;
using Four = hn::Vec<FourTag>;
HWY_INLINE Four no_four() {
    return hn::Zero(FourTag());
}
HWY_INLINE Four load_four(const float* from) {
    return hn::LoadU(FourTag(), from);
}
HWY_INLINE void store(const Four& four, float* to) {
    hn::StoreU(four, FourTag(), to);
}
HWY_INLINE Four add_product(float factor, const Four& a, const Four& sum) {
    return hn::MulAdd(hn::Set(FourTag(), factor), a, sum);
}
#endif

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
