// SPDX-License-Identifier: Apache-2.0
// From drawn planes to reflectance, in vectors of any width. See appearance.hpp.
#include "synthesis/appearance.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/appearance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SATEEN_SYNTHESIS_APPEARANCE_ONCE
#define SATEEN_SYNTHESIS_APPEARANCE_ONCE
namespace sateen {

/// q(g) of one plane, in plane units: the value between each knot and the next, and the rise.
struct Curve {
    std::array<float, Marginal::kKnots> middle{};
    std::array<float, Marginal::kKnots> rise{};
    float scale = 0;
    bool straight = true;
};

struct SpectralInverse {
    std::array<Curve, kMaxBands> curves;
    std::array<std::array<float, kMaxBands>, kMaxBands> T{};
    std::array<float, kMaxBands> mean{};
    Tone tone = Tone::linear;
};

/// The same columns of every plane.
template <class T>
using BandPointers = std::array<T*, kMaxBands>;

}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using DI = hn::Repartition<std::int32_t, DF>;
using Float = hn::Vec<DF>;

HWY_INLINE Float set_float(float value) {
    return hn::Set(DF(), value);
}

using Knots = std::array<float, Marginal::kKnots>;

// knots[j]. Where registers hold all 16 of them, or half, a permutation is several times
// faster than reading memory at every lane's own address.
HWY_INLINE Float look_up(const Knots& knots, hn::Vec<DI> j) {
    const DF df;
#if HWY_CAP_GE512
    return hn::TableLookupLanes(hn::LoadU(df, knots.data()), hn::IndicesFromVec(df, j));
#elif HWY_CAP_GE256
    const DI di;
    const auto half = hn::IndicesFromVec(df, hn::And(j, hn::Set(di, 7)));
    const Float low = hn::TableLookupLanes(hn::LoadU(df, knots.data()), half);
    const Float high = hn::TableLookupLanes(hn::LoadU(df, knots.data() + 8), half);
    return hn::IfThenElse(hn::RebindMask(df, hn::Gt(j, hn::Set(di, 7))), high, low);
#else
    return hn::GatherIndex(df, knots.data(), j);
#endif
}

// Linear between the knots at -3 … 3, constant outside.
HWY_INLINE Float apply(const Curve& curve, Float g) {
    if (curve.straight) return hn::Mul(set_float(curve.scale), g);
    // In steps between knots, from the middle of the first: rounding to a whole number finds
    // the segment, and a number beyond 2^23 holds that in its last bits.
    constexpr float kSteps = Marginal::kKnots - 1;
    constexpr float kWhole = 12582912.0F;  // 1.5 2^23
    const DI di;
    const Float x = hn::MulAdd(g, set_float(kSteps / (2 * Marginal::kRange)),
                               set_float((kSteps - 1) / 2));
    const Float inside = hn::Clamp(x, set_float(-0.5F), set_float(kSteps - 0.5F));
    const Float whole = hn::Add(inside, set_float(kWhole));
    const Float part = hn::Sub(inside, hn::Sub(whole, set_float(kWhole)));
    const auto j = hn::And(hn::BitCast(di, whole), hn::Set(di, Marginal::kKnots - 1));
    return hn::MulAdd(part, look_up(curve.rise, j), look_up(curve.middle, j));
}

// t^2.4 of normal positive numbers, to 4 units in the last place.
//
// The bits of a float are nearly its logarithm, so that z = kBits - bits / 5, read as a
// float, is t^(-1/5) within 3 %; to a multiple of 2^9, which a sum beyond 2^23 rounds to. With
// u = t z⁵ near 1,
//     t^2.4 = t³ (z³ u^(-3/5)) = (t z)³ u^(-3/5)
// and u^(-3/5) is minimax in u - 1 on the range that u has (relative error 1.4e-7).
HWY_INLINE Float power_2_4(Float t) {
    constexpr std::int32_t kBits = 0x4C2B4000;
    constexpr float kWhole = 12582912.0F;            // 1.5 2^23, whose bits …
    constexpr std::int32_t kWholeBits = 0x4B400000;  // … end in 0 where the sum is added
    constexpr std::array<float, 6> kP = {1.0000001415468072F,  -0.6000005808141897F,
                                         0.4798936108358336F,  -0.4158132367342438F,
                                         0.38619533141379553F, -0.35885437430277234F};
    const DF df;
    const DI di;
    const Float bits = hn::ConvertTo(df, hn::BitCast(di, t));
    const Float fifth = hn::MulAdd(bits, set_float(0.2F / 512), set_float(kWhole));
    const auto bits_of_z = hn::Sub(
        hn::Set(di, kBits),
        hn::ShiftLeft<9>(hn::Sub(hn::BitCast(di, fifth), hn::Set(di, kWholeBits))));
    const Float z = hn::BitCast(df, bits_of_z);
    const Float tz = hn::Mul(t, z);
    const Float z2 = hn::Mul(z, z);
    const Float h = hn::MulSub(tz, hn::Mul(z2, z2), set_float(1));
    Float power = set_float(kP.back());
    for (std::size_t i = kP.size() - 1; i-- > 0;)
        power = hn::MulAdd(power, h, set_float(kP[i]));
    return hn::Mul(hn::Mul(tz, hn::Mul(tz, tz)), power);
}

// srgb_decode of codes that are not negative.
HWY_INLINE Float decode(Float code) {
    const Float line = hn::Mul(code, set_float(1 / 12.92F));
    const Float t = hn::MulAdd(code, set_float(1 / 1.055F), set_float(0.055F / 1.055F));
    return hn::IfThenElse(hn::Le(code, set_float(0.04045F)), line, power_2_4(t));
}

// One vector of every plane, in place.
template <std::size_t kBands>
HWY_INLINE void invert_step(const SpectralInverse& inverse,
                            const BandPointers<const float>& from,
                            const BandPointers<float>& to) {
    const DF df;
    const auto q = [&](std::size_t i) HWY_ATTR {
        return apply(inverse.curves[i], hn::LoadU(df, from[i]));
    };
    const Float q0 = q(0);
    const Float q1 = kBands > 1 ? q(1) : hn::Zero(df);
    const Float q2 = kBands > 2 ? q(2) : hn::Zero(df);
    for (std::size_t band = 0; band < kBands; ++band) {
        const auto T = [&](std::size_t i)
                           HWY_ATTR { return set_float(inverse.T[i][band]); };
        Float v = hn::MulAdd(T(0), q0, set_float(inverse.mean[band]));
        if (kBands > 1) v = hn::MulAdd(T(1), q1, v);
        if (kBands > 2) v = hn::MulAdd(T(2), q2, v);
        v = hn::Max(v, hn::Zero(df));
        hn::StoreU(inverse.tone == Tone::srgb ? decode(v) : v, df, to[band]);
    }
}

template <std::size_t kBands>
void invert_bands(const SpectralInverse& inverse, BandPointers<const float> from,
                  BandPointers<float> to, std::size_t count) {
    const std::size_t lanes = hn::Lanes(DF());
    std::size_t c = 0;
    for (; c + lanes <= count; c += lanes) {
        invert_step<kBands>(inverse, from, to);
        for (std::size_t band = 0; band < kBands; ++band) {
            from[band] += lanes;
            to[band] += lanes;
        }
    }
    if (c == count) return;
    // The last pixels in a vector of their own, filled up with zeros.
    using Piece = std::array<float, HWY_MAX_BYTES / sizeof(float)>;
    std::array<Piece, kBands> pieces{};
    BandPointers<float> piece{};
    for (std::size_t band = 0; band < kBands; ++band) {
        piece[band] = pieces[band].data();
        std::copy_n(from[band], count - c, piece[band]);
        from[band] = piece[band];
    }
    invert_step<kBands>(inverse, from, piece);
    for (std::size_t band = 0; band < kBands; ++band)
        std::copy_n(piece[band], count - c, to[band]);
}

void invert_row(const SpectralInverse& inverse, std::size_t bands,
                const BandPointers<const float>& from, const BandPointers<float>& to,
                std::size_t count) {
    if (bands == 1)
        invert_bands<1>(inverse, from, to, count);
    else
        invert_bands<kMaxBands>(inverse, from, to, count);
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {
namespace {

HWY_EXPORT(invert_row);

Curve curve_of(const Marginal& marginal) {
    Curve curve;
    curve.scale = marginal.scale;
    curve.straight = marginal.knots.empty();
    if (curve.straight) return curve;
    for (std::size_t j = 0; j + 1 < Marginal::kKnots; ++j) {
        const float from = marginal.knots[j] * marginal.scale;
        const float to = marginal.knots[j + 1] * marginal.scale;
        curve.middle[j] = 0.5F * (from + to);
        curve.rise[j] = to - from;
    }
    return curve;
}

SpectralInverse inverse_of(const Subspace& subspace, std::size_t bands) {
    SpectralInverse inverse;
    inverse.tone = subspace.spectral.tone;
    for (std::size_t i = 0; i < bands; ++i) {
        inverse.curves[i] = curve_of(subspace.marginals[i]);
        inverse.mean[i] = subspace.spectral.mean[i];
        for (std::size_t band = 0; band < bands; ++band)
            inverse.T[i][band] = subspace.spectral.T[i * bands + band];
    }
    return inverse;
}

}  // namespace

void invert_spectral(const Subspace& subspace, ImageView<const float> fields,
                     std::span<const PlaneView<float>> out, Executor& executor) {
    const SpectralInverse inverse = inverse_of(subspace, fields.bands);
    parallel_for(executor, fields.rows, [&](std::size_t r) {
        BandPointers<const float> from{};
        BandPointers<float> to{};
        for (std::size_t band = 0; band < fields.bands; ++band) {
            from[band] = fields.plane(band).row(r);
            to[band] = out[band].row(r);
        }
        HWY_DYNAMIC_DISPATCH(invert_row)(inverse, fields.bands, from, to, fields.cols);
    });
}

void invert_spectral(const Subspace& subspace, ImageView<float> planes,
                     Executor& executor) {
    std::array<PlaneView<float>, kMaxBands> out;
    for (std::size_t band = 0; band < planes.bands; ++band)
        out[band] = planes.plane(band);
    invert_spectral(subspace, planes, std::span(out).first(planes.bands), executor);
}

}  // namespace sateen
#endif
