// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10 and Box-Muller in vectors of any width, with the same bits for all of
// them. Theory: docs/theory/noise.md.
#include "sateen/core/normal.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/normal.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SATEEN_CORE_NORMAL_ONCE
#define SATEEN_CORE_NORMAL_ONCE
namespace sateen {
namespace {

// The round keys are set up once a row: loading one costs less than counting it up.
//
// Counters (x, row, band, 0) of a row differ in x alone. It has reached two of the words
// after the first round, and three after the second,
//
//     (·, ·, hi(M0 x) ⊕ k1, lo(M0 x))  and  (hi(p) ⊕ c0, lo(p), lo(M0 x) ⊕ c2, c3),
//
// p = M1 (hi(M0 x) ⊕ k1), with constants c of the row.
struct NoiseRow {
    std::array<std::array<std::uint32_t, 2>, Philox4x32::kRounds> round_key;
    std::uint32_t row;
    std::uint32_t band;
    std::uint32_t c0, c2, c3;
};

}  // namespace
}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D32 = hn::ScalableTag<std::uint32_t>;
using DF = hn::Repartition<float, D32>;
using DI = hn::Repartition<std::int32_t, D32>;
using Word = hn::Vec<D32>;
using Float = hn::Vec<DF>;

// Every operation below is one IEEE operation on each lane, rounded to nearest, or an
// integer one: no fused multiply-add, no approximate reciprocal. That is why the bits do
// not depend on the target.

HWY_INLINE Word set_word(std::uint32_t value) {
    return hn::Set(D32(), value);
}
HWY_INLINE Float set_float(float value) {
    return hn::Set(DF(), value);
}

// c_0 + x (c_1 + x (c_2 + x c_3))
HWY_INLINE Float horner(Float x, const std::array<float, 4>& c) {
    const Float c23 = hn::Add(hn::Mul(x, set_float(c[3])), set_float(c[2]));
    const Float c13 = hn::Add(hn::Mul(x, c23), set_float(c[1]));
    return hn::Add(hn::Mul(x, c13), set_float(c[0]));
}

// c_0 + … + c_6 x⁶ by Estrin's scheme: two multiplications more than Horner's, half the
// latency.
HWY_INLINE Float estrin(Float x, Float x2, const std::array<float, 7>& c) {
    const Float c01 = hn::Add(hn::Mul(x, set_float(c[1])), set_float(c[0]));
    const Float c23 = hn::Add(hn::Mul(x, set_float(c[3])), set_float(c[2]));
    const Float c45 = hn::Add(hn::Mul(x, set_float(c[5])), set_float(c[4]));
    const Float low = hn::Add(hn::Mul(x2, c23), c01);
    const Float high = hn::Add(hn::Mul(x2, set_float(c[6])), c45);
    return hn::Add(hn::Mul(hn::Mul(x2, x2), high), low);
}

struct Words {
    Word w0, w1, w2, w3;
};

// The words of the counters (first + i, row, band, 0) in lanes i.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Words start_philox(const NoiseRow& noise, std::uint32_t first) {
    const auto words =
        philox4x32_10({first, noise.row, noise.band, 0}, noise.round_key[0]);
    return {set_word(words[0]), set_word(words[1]), set_word(words[2]),
            set_word(words[3])};
}
template <int kFirst, int kLast>
HWY_INLINE void philox_rounds(const NoiseRow& /*noise*/, Words& /*words*/) {}
HWY_INLINE Words finish_philox(const Words& words) {
    return words;
}
#else
using D64 = hn::Repartition<std::uint64_t, D32>;

// A round on one counter in each 64-bit lane. A word is the low half of its lane and the
// high half is rubbish: the multiplication reads the low halves only, and its product
// holds the next round's low word in place and the high word beside it.
HWY_INLINE void philox_round(Words& c, Word key0, Word key1) {
    const D32 d32;
    const Word p0 =
        hn::BitCast(d32, hn::MulEven(c.w0, set_word(Philox4x32::kMultiplier[0])));
    const Word p1 =
        hn::BitCast(d32, hn::MulEven(c.w2, set_word(Philox4x32::kMultiplier[1])));
    c = {hn::Xor3(hn::DupOdd(p1), c.w1, key0), p1, hn::Xor3(hn::DupOdd(p0), c.w3, key1),
         p0};
}

// The counters (x, row, band, 0) after two rounds.
HWY_INLINE Words second_round(const NoiseRow& noise, Word x) {
    const D32 d32;
    const Word p0 =
        hn::BitCast(d32, hn::MulEven(x, set_word(Philox4x32::kMultiplier[0])));
    const Word w2 = hn::Xor(hn::DupOdd(p0), set_word(noise.round_key[0][1]));
    const Word p1 =
        hn::BitCast(d32, hn::MulEven(w2, set_word(Philox4x32::kMultiplier[1])));
    return {hn::Xor(hn::DupOdd(p1), set_word(noise.c0)), p1,
            hn::Xor(p0, set_word(noise.c2)), set_word(noise.c3)};
}

// The low halves of `even` and `odd` in alternation.
HWY_INLINE Word interleave(Word even, Word odd) {
    const auto shifted = hn::ShiftLeft<32>(hn::BitCast(D64(), odd));
    return hn::OddEven(hn::BitCast(D32(), shifted), even);
}

// Counters of even lanes, and of odd ones.
struct Counters {
    Words even, odd;
};

// Two rounds on the counters first + i, where lane 2 i holds one of them.
HWY_INLINE Counters start_philox(const NoiseRow& noise, std::uint32_t first) {
    const Word x = hn::Iota(D32(), first);
    return {second_round(noise, x), second_round(noise, hn::Add(x, set_word(1)))};
}

template <int kFirst, int kLast>
HWY_INLINE void philox_rounds(const NoiseRow& noise, Counters& c) {
    for (std::size_t round = kFirst; round < kLast; ++round) {
        const Word key0 = set_word(noise.round_key[round][0]);
        const Word key1 = set_word(noise.round_key[round][1]);
        philox_round(c.even, key0, key1);
        philox_round(c.odd, key0, key1);
    }
}

HWY_INLINE Words finish_philox(const Counters& c) {
    return {interleave(c.even.w0, c.odd.w0), interleave(c.even.w1, c.odd.w1),
            interleave(c.even.w2, c.odd.w2), interleave(c.even.w3, c.odd.w3)};
}
#endif

// √(-2 ln u),  u = (⌊w / 2⌋ + ½) 2^-31 ∈ [2^-32, 1]
//
// ⌊w / 2⌋ + ½ = 2^e (1 + f) with 1 + f ∈ [√½, √2), so that
//     -2 ln u = 2 ((31 - e) ln 2 - ln(1 + f)),   ln(1 + f) = f - f²/2 + f³ P(f)
// with P minimax for f² |error|. ln 2 is split in two parts of which the first, of 9
// bits, makes exact products. The conversion of w rounds to 24 bits: u may be 1, but
// never 0.
HWY_INLINE Float radius(Word w) {
    constexpr std::array<float, 7> kP = {0.33333858847618103F, -0.2500174343585968F,
                                         0.199654221534729F,   -0.16565747559070587F,
                                         0.14876779913902283F, -0.14349184930324554F,
                                         0.08917124569416046F};
    constexpr float kLn2High = 0.693359375F;
    constexpr float kLn2Low = -2.12194440054690583e-4F;
    constexpr std::uint32_t kRootHalfBits = 0x3F3504F3U;  // the float next to √½
    const D32 d32;
    const DI di;
    const DF df;
    const auto integer = hn::BitCast(di, hn::ShiftRight<1>(w));
    const Float u = hn::Add(hn::ConvertTo(df, integer), set_float(0.5F));
    const auto above = hn::Sub(hn::BitCast(d32, u), set_word(kRootHalfBits));
    const auto exponent = hn::ShiftRight<23>(hn::BitCast(di, above));
    const auto mantissa = hn::Sub(hn::BitCast(di, u), hn::ShiftLeft<23>(exponent));
    const Float f = hn::Sub(hn::BitCast(df, mantissa), set_float(1.0F));
    const Float k = hn::Sub(set_float(31.0F), hn::ConvertTo(df, exponent));

    const Float f2 = hn::Mul(f, f);
    const Float tail = hn::Sub(hn::Mul(k, set_float(kLn2Low)),
                               hn::Mul(hn::Mul(f2, f), estrin(f, f2, kP)));
    const Float small = hn::Add(hn::Mul(f2, set_float(0.5F)), tail);
    const Float minus_log = hn::Add(hn::Sub(small, f), hn::Mul(k, set_float(kLn2High)));
    return hn::Sqrt(hn::Add(minus_log, minus_log));
}

struct Pair {
    Float first, second;
};

// (r cos θ, r sin θ),  r of the first word, θ uniform on the circle of the second:
// its top two bits are the signs of the two, the other 30 the angle in the first
// quadrant, θ = π/4 + y with y ∈ [-π/4, π/4), where
//     cos θ = (cos y - sin y) / √2,   sin θ = (cos y + sin y) / √2
// and the polynomials hold the factor 1/√2. Reduction by quadrants would cost a swap
// more.
HWY_INLINE Pair box_muller(Word w_radius, Word w_angle) {
    constexpr float kAngleStep = 3.65729529994141e-10F;  // (π/4) 2^-31
    constexpr std::array<float, 4> kSin = {0.7071067690849304F, -0.11785092204809189F,
                                           0.0058913202956318855F,
                                           -0.00013761839363723993F};
    constexpr std::array<float, 4> kCos = {0.7071067690849304F, -0.35355237126350403F,
                                           0.029454555362462997F,
                                           -0.0009606723324395716F};
    const D32 d32;
    const DF df;
    const Float r = radius(w_radius);
    const auto centred = hn::BitCast(DI(), hn::ShiftLeft<2>(w_angle));
    const Float y = hn::Mul(hn::ConvertTo(df, centred), set_float(kAngleStep));
    const Float y2 = hn::Mul(y, y);
    const Float sine = hn::Mul(y, horner(y2, kSin));
    const Float cosine = horner(y2, kCos);

    const Word sign = set_word(0x80000000U);
    const Word sign_first = hn::And(w_angle, sign);
    const Word sign_second = hn::And(hn::ShiftLeft<1>(w_angle), sign);
    const Float first = hn::Mul(r, hn::Sub(cosine, sine));
    const Float second = hn::Mul(r, hn::Add(cosine, sine));
    return {hn::BitCast(df, hn::Xor(hn::BitCast(d32, first), sign_first)),
            hn::BitCast(df, hn::Xor(hn::BitCast(d32, second), sign_second))};
}

void draw_row(const NoiseRow& noise, std::int32_t col, std::span<float> out) {
    constexpr int kRounds = Philox4x32::kRounds;
    constexpr std::size_t kMaxStep = 4 * HWY_MAX_BYTES / sizeof(float);
    const std::size_t lanes = hn::Lanes(D32());
    const std::size_t step = 4 * lanes;
    // A row that starts or ends inside a step takes its part of a whole one.
    HWY_ALIGN std::array<float, kMaxStep> whole;
    // Shifts of negative numbers round down, as the groups do.
    auto group = static_cast<std::uint32_t>(col >> 2);
    auto skipped = static_cast<std::size_t>(col & 3);
    // The words of a step are made during the step before it: the two chains of dependent
    // operations, each about a hundred cycles long, then overlap. They are written in
    // turns, since a processor does not look ahead over a whole step.
    auto counters = start_philox(noise, group);
    philox_rounds<2, kRounds>(noise, counters);
    for (std::size_t done = 0; done < out.size();) {
        const std::size_t count = std::min(step - skipped, out.size() - done);
        float* const target = out.data() + done;
        const Words words = finish_philox(counters);
        group += static_cast<std::uint32_t>(lanes);
        done += count;
        counters = start_philox(noise, group);
        philox_rounds<2, 4>(noise, counters);
        const Pair n01 = box_muller(words.w0, words.w1);
        philox_rounds<4, 7>(noise, counters);
        const Pair n23 = box_muller(words.w2, words.w3);
        philox_rounds<7, kRounds>(noise, counters);
        hn::StoreInterleaved4(n01.first, n01.second, n23.first, n23.second, DF(),
                              count == step ? target : whole.data());
        if (count != step) std::copy_n(whole.data() + skipped, count, target);
        skipped = 0;
    }
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(draw_row);

void draw_normals(NoiseField field, std::int32_t row, std::int32_t col,
                  std::span<float> out) {
    NoiseRow noise{};
    noise.row = static_cast<std::uint32_t>(row);
    noise.band = field.band;
    std::array<std::uint32_t, 2> key = {static_cast<std::uint32_t>(field.seed),
                                        static_cast<std::uint32_t>(field.seed >> 32)};
    for (auto& round_key : noise.round_key) {
        round_key = key;
        key[0] += Philox4x32::kKeyStep[0];
        key[1] += Philox4x32::kKeyStep[1];
    }
    const auto high = [](std::uint64_t product) {
        return static_cast<std::uint32_t>(product >> 32);
    };
    const std::uint64_t p1 = std::uint64_t{Philox4x32::kMultiplier[1]} * noise.band;
    const std::uint64_t p0 = std::uint64_t{Philox4x32::kMultiplier[0]} *
                             (high(p1) ^ noise.row ^ noise.round_key[0][0]);
    noise.c0 = static_cast<std::uint32_t>(p1) ^ noise.round_key[1][0];
    noise.c2 = high(p0) ^ noise.round_key[1][1];
    noise.c3 = static_cast<std::uint32_t>(p0);
    HWY_DYNAMIC_DISPATCH(draw_row)(noise, col, out);
}

}  // namespace sateen
#endif
