// SPDX-License-Identifier: Apache-2.0
// Rows as vectors and what is left over. Included once per SIMD target.
#if defined(SATEEN_CORE_VECTOR_ROW_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef SATEEN_CORE_VECTOR_ROW_INL_HPP
#undef SATEEN_CORE_VECTOR_ROW_INL_HPP
#else
#define SATEEN_CORE_VECTOR_ROW_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {

/// step(d, x) for whole vectors from x = 0 on, then for single values; the tag d says which, so
/// that both take the same operations in the same order.
template <class Step>
HWY_INLINE void for_row(std::size_t count, const Step& step) {
    const hwy::HWY_NAMESPACE::ScalableTag<float> full;
    const hwy::HWY_NAMESPACE::CappedTag<float, 1> one;
    const std::size_t lanes = hwy::HWY_NAMESPACE::Lanes(full);
    std::size_t x = 0;
    for (; x + lanes <= count; x += lanes) step(full, x);
    for (; x < count; ++x) step(one, x);
}

}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
