// SPDX-License-Identifier: Apache-2.0
// Theory: docs/theory/pyramid.md.
#include "core/pyramid_rows.hpp"

#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/pyramid_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/vector_row-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A vector, or one value at the end of a row.
using Full = hn::ScalableTag<float>;
using One = hn::CappedTag<float, 1>;

// The kernel, as it falls on a site that stays and on sites of either parity that come
// back (gain 2). Rows and columns, vectors and ends use the same operations in the same
// order, so that a site has the same bits wherever it lies in a window.
template <class D, class V>
HWY_INLINE V reduced(D d, V a, V b, V c, V e, V f) {
    const V outer = hn::Mul(hn::Add(a, f), hn::Set(d, 0.0625F));
    const V inner = hn::Mul(hn::Add(b, e), hn::Set(d, 0.25F));
    return hn::Add(outer, hn::Add(inner, hn::Mul(c, hn::Set(d, 0.375F))));
}
template <class D, class V>
HWY_INLINE V expanded_even(D d, V a, V b, V c) {
    return hn::Add(hn::Mul(hn::Add(a, c), hn::Set(d, 0.125F)),
                   hn::Mul(b, hn::Set(d, 0.75F)));
}
template <class D, class V>
HWY_INLINE V expanded_odd(D d, V b, V c) {
    return hn::Mul(hn::Add(b, c), hn::Set(d, 0.5F));
}

template <class V>
HWY_INLINE V updated(V old, V value, Update update) {
    if (update == Update::assign) return value;
    return update == Update::add ? hn::Add(old, value) : hn::Sub(old, value);
}

void reduce_rows(const float* const rows[5], float* line, std::size_t count) {
    for_row(count, [&](auto d, std::size_t x) HWY_ATTR {
        hn::StoreU(reduced(d, hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[1] + x),
                           hn::LoadU(d, rows[2] + x), hn::LoadU(d, rows[3] + x),
                           hn::LoadU(d, rows[4] + x)),
                   d, line + x);
    });
}

template <class D>
HWY_INLINE void reduce_columns_at(D d, const float* line, float* coarse, std::size_t j) {
    hn::Vec<D> a, b, c, e, f, unused;
    hn::LoadInterleaved2(d, line + 2 * j, a, b);
    hn::LoadInterleaved2(d, line + 2 * j + 2, c, e);
    hn::LoadInterleaved2(d, line + 2 * j + 4, f, unused);
    hn::StoreU(reduced(d, a, b, c, e, f), d, coarse + j);
}

void reduce_columns(const float* line, float* coarse, std::size_t count) {
    const std::size_t lanes = hn::Lanes(Full());
    std::size_t j = 0;
    for (; j + lanes <= count; j += lanes) reduce_columns_at(Full(), line, coarse, j);
    const One d;
    for (; j < count; ++j) {
        const float* const at = line + 2 * j;
        hn::StoreU(
            reduced(d, hn::LoadU(d, at), hn::LoadU(d, at + 1), hn::LoadU(d, at + 2),
                    hn::LoadU(d, at + 3), hn::LoadU(d, at + 4)),
            d, coarse + j);
    }
}

void expand_rows(const float* above, const float* here, const float* below, bool odd,
                 float* line, std::size_t count) {
    for_row(count, [&](auto d, std::size_t j) HWY_ATTR {
        const auto b = hn::LoadU(d, here + j);
        const auto c = hn::LoadU(d, below + j);
        const auto sum =
            odd ? expanded_odd(d, b, c) : expanded_even(d, hn::LoadU(d, above + j), b, c);
        hn::StoreU(sum, d, line + j);
    });
}

// One fine site: even ones have three coarse ones from `at`, odd ones two.
HWY_INLINE void expand_site(const float* at, bool odd, float* fine, Update update) {
    const One d;
    const auto a = hn::LoadU(d, at);
    const auto b = hn::LoadU(d, at + 1);
    const auto value =
        odd ? expanded_odd(d, a, b) : expanded_even(d, a, b, hn::LoadU(d, at + 2));
    hn::StoreU(updated(hn::LoadU(d, fine), value, update), d, fine);
}

void expand_columns(const float* line, bool starts_odd, float* fine, std::size_t count,
                    Update update) {
    if (starts_odd && count > 0) {
        expand_site(line, true, fine, update);
        ++fine;
        --count;
    }
    const Full d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t k = 0;
    for (; 2 * (k + lanes) <= count; k += lanes) {
        const auto b = hn::LoadU(d, line + k + 1);
        const auto c = hn::LoadU(d, line + k + 2);
        const auto even = expanded_even(d, hn::LoadU(d, line + k), b, c);
        const auto odd = expanded_odd(d, b, c);
        hn::Vec<Full> old_even = even;
        hn::Vec<Full> old_odd = odd;
        if (update != Update::assign) {
            hn::LoadInterleaved2(d, fine + 2 * k, old_even, old_odd);
        }
        hn::StoreInterleaved2(updated(old_even, even, update),
                              updated(old_odd, odd, update), d, fine + 2 * k);
    }
    for (std::size_t x = 2 * k; x < count; ++x) {
        expand_site(line + x / 2 + x % 2, x % 2 == 1, fine + x, update);
    }
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(reduce_rows);
HWY_EXPORT(reduce_columns);
HWY_EXPORT(expand_rows);
HWY_EXPORT(expand_columns);

void reduce_rows(const float* const rows[5], float* line, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(reduce_rows)(rows, line, count);
}

void reduce_columns(const float* line, float* coarse, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(reduce_columns)(line, coarse, count);
}

void expand_rows(const float* above, const float* here, const float* below, bool odd,
                 float* line, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(expand_rows)(above, here, below, odd, line, count);
}

void expand_columns(const float* line, bool starts_odd, float* fine, std::size_t count,
                    Update update) {
    HWY_DYNAMIC_DISPATCH(expand_columns)(line, starts_odd, fine, count, update);
}

}  // namespace sateen
#endif
