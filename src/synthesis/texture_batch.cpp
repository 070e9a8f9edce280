// SPDX-License-Identifier: Apache-2.0
// Blended textures, a vector of points at a time. See blend_batch.hpp.
#include "synthesis/blend_batch.hpp"

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/texture_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "synthesis/batch_vector-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

// Where a coordinate, in turns, lies between two texels: the first, the second, and how far.
struct Axis {
    Int first, second;
    Float part;
};

HWY_INLINE Axis axis_at(Float turns, std::size_t side) {
    const DF df;
    const DI di;
    const auto count = static_cast<std::int32_t>(side);
    const Float rest = hn::Sub(turns, hn::Floor(turns));
    const Float x = hn::MulAdd(rest, set(static_cast<float>(side)), set(0.5F));
    const Int next = hn::Min(hn::ConvertTo(di, x), hn::Set(di, count));  // 0 … side
    const Int last = hn::Set(di, count - 1);
    const Int first = hn::Sub(next, hn::Set(di, 1));
    return {hn::IfThenElse(hn::Lt(first, hn::Zero(di)), last, first),
            hn::IfThenElse(hn::Gt(next, last), hn::Zero(di), next),
            hn::Sub(x, hn::ConvertTo(df, next))};
}

void texture_lanes(const float* texels, std::size_t side, const BlendBatch& blends,
                   const BatchLane& u, const BatchLane& v, std::size_t count,
                   VectorBatch& out) {
    const DF df;
    const DI di;
    std::array<std::array<std::int32_t, kBatch>, 4> taps;
    std::array<BatchLane, 4> shares;
    const Int stride = hn::Set(di, static_cast<std::int32_t>(side));
    for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
        const Axis col = axis_at(hn::LoadU(df, u.data() + i), side);
        const Axis row = axis_at(hn::Neg(hn::LoadU(df, v.data() + i)), side);
        const Int above = hn::Mul(row.first, stride);
        const Int below = hn::Mul(row.second, stride);
        const Float left = hn::Sub(set(1), col.part);
        const Float up = hn::Sub(set(1), row.part);
        const auto store = [&](std::size_t k, Int at, Float share) {
            hn::StoreU(hn::ShiftLeft<2>(at), di, taps[k].data() + i);
            hn::StoreU(share, df, shares[k].data() + i);
        };
        store(0, hn::Add(above, col.first), hn::Mul(up, left));
        store(1, hn::Add(above, col.second), hn::Mul(up, col.part));
        store(2, hn::Add(below, col.first), hn::Mul(row.part, left));
        store(3, hn::Add(below, col.second), hn::Mul(row.part, col.part));
    }
    for (std::size_t i = 0; i < count; ++i) {
        std::array<Four, 4> sum;
        for (Four& four : sum) four = no_four();
        for (std::size_t a = 0; a < blends.count[i]; ++a) {
            const float* texture = texels + blends.subspace[i][a] * side * side * 4;
            for (std::size_t k = 0; k < 4; ++k)
                sum[k] = add_product(blends.weight[i][a], load_four(texture + taps[k][i]),
                                     sum[k]);
        }
        Four colour = no_four();
        for (std::size_t k = 0; k < 4; ++k)
            colour = add_product(shares[k][i], sum[k], colour);
        std::array<float, 4> value{};
        store(colour, value.data());
        for (std::size_t c = 0; c < 3; ++c) out[c][i] = value[c];
    }
}

void shape_lanes(const BlendBatch& blends, std::size_t count, VectorBatch& x) {
    const DF df;
    for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
        const Float exponent = hn::LoadU(df, blends.power.data() + i);
        const bool straight = hn::AllTrue(df, hn::Eq(exponent, set(1)));
        for (std::size_t c = 0; c < 3; ++c) {
            Float value = hn::LoadU(df, x[c].data() + i);
            if (!straight)
                value = hn::IfThenElse(hn::Eq(exponent, set(1)), value,
                                       power(value, exponent));
            value = hn::MulAdd(hn::LoadU(df, blends.gain[c].data() + i), value,
                               hn::LoadU(df, blends.offset[c].data() + i));
            hn::StoreU(hn::Max(value, hn::Zero(df)), df, x[c].data() + i);
        }
    }
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(texture_lanes);
HWY_EXPORT(shape_lanes);

void texture_batch(const float* texels, std::size_t side, const BlendBatch& blends,
                   const BatchLane& u, const BatchLane& v, std::size_t count,
                   VectorBatch& out) {
    HWY_DYNAMIC_DISPATCH(texture_lanes)(texels, side, blends, u, v, count, out);
}

void shape_batch(const BlendBatch& blends, std::size_t count, VectorBatch& x) {
    HWY_DYNAMIC_DISPATCH(shape_lanes)(blends, count, x);
}

}  // namespace sateen
#endif
