// SPDX-License-Identifier: Apache-2.0
// Vectors of blends. See blend_batch.hpp.
#include "synthesis/blend_batch.hpp"

#include <algorithm>

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/blend_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "synthesis/batch_vector-inl.hpp"

#ifndef SATEEN_SYNTHESIS_BLEND_BATCH_ONCE
#define SATEEN_SYNTHESIS_BLEND_BATCH_ONCE
namespace sateen {

// A light far below the lowest measured one is weaker by the ratio of the cosines; one far
// above the only measured one is at most so much stronger.
inline constexpr float kMaxCosineRatio = 4;
// Least and most of H/C of a blend: 1 for lognormal values, 4 where a square root changes
// no contrast, as where all is either black or white.
inline constexpr float kLeastRoot = 0.5F;
inline constexpr float kMostRoot = 2.83F;
inline constexpr float kLeastPower = 0.5F;
// Blends of less than this for C, a contrast of 10^-4, are left alone.
inline constexpr float kUniform = 1e-8F;

// What the nine pairs of a blend add up to.
struct BlendSums {
    BatchLane height;    // cosine of the lights
    BatchLane root;      // its cube root
    BatchLane variance;  // of the luminance
    std::array<BatchLane, 4> encoded;
    std::array<BatchLane, 4> mean;   // of the bands, and the luminance
    std::array<BatchLane, 4> shape;  // weighted by luminance
};

// The nine pairs of every point, light by light.
struct PairBatch {
    std::array<std::array<std::int32_t, kBatch>, Blend::kMost> pair;
    std::array<std::array<std::int32_t, kBatch>, Blend::kMost> subspace;
    std::array<BatchLane, Blend::kMost> weight;
};

}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

// The 3 x 3 products, and those of equal subspaces merged into the first.
HWY_INLINE void multiply(const BlendTables& tables, const WeightBatch& views,
                         const WeightBatch& lights, std::size_t i, PairBatch& out,
                         BlendSums& sums) {
    const DF df;
    const DI di;
    const Int view_count = hn::Set(di, static_cast<std::int32_t>(tables.view_count));
    std::array<Float, Blend::kMost> weight{};
    std::array<Int, Blend::kMost> subspace{};
    Float height = hn::Zero(df);
    Float root = hn::Zero(df);
    for (std::size_t l = 0; l < 3; ++l) {
        const Int light = hn::LoadU(di, lights.index[l].data() + i);
        const Float share = hn::LoadU(df, lights.weight[l].data() + i);
        height =
            hn::MulAdd(share, hn::GatherIndex(df, tables.cosine.data(), light), height);
        root = hn::MulAdd(share, hn::GatherIndex(df, tables.cosine_root.data(), light),
                          root);
        const Int row = hn::Mul(light, view_count);
        for (std::size_t v = 0; v < 3; ++v) {
            const std::size_t at = 3 * l + v;
            const Int pair = hn::Add(row, hn::LoadU(di, views.index[v].data() + i));
            hn::StoreU(pair, di, out.pair[at].data() + i);
            weight[at] = hn::Mul(share, hn::LoadU(df, views.weight[v].data() + i));
            hn::StoreU(weight[at], df, out.weight[at].data() + i);
            subspace[at] = hn::GatherIndex(di, tables.subspace.data(), pair);
            hn::StoreU(subspace[at], di, out.subspace[at].data() + i);
        }
    }
    hn::StoreU(height, df, sums.height.data() + i);
    hn::StoreU(root, df, sums.root.data() + i);
}

HWY_INLINE void merge(std::size_t i, PairBatch& pairs) {
    const DF df;
    const DI di;
    std::array<Float, Blend::kMost> weight{};
    std::array<Int, Blend::kMost> subspace{};
    for (std::size_t p = 0; p < Blend::kMost; ++p) {
        weight[p] = hn::LoadU(df, pairs.weight[p].data() + i);
        subspace[p] = hn::LoadU(di, pairs.subspace[p].data() + i);
        for (std::size_t q = 0; q < p; ++q) {
            const auto equal = hn::RebindMask(df, hn::Eq(subspace[p], subspace[q]));
            weight[q] = hn::Add(weight[q], hn::IfThenElseZero(equal, weight[p]));
            weight[p] = hn::IfThenZeroElse(equal, weight[p]);
        }
    }
    for (std::size_t p = 0; p < Blend::kMost; ++p)
        hn::StoreU(weight[p], df, pairs.weight[p].data() + i);
}

HWY_INLINE void add_appearance(const BlendTables& tables, const PairBatch& pairs,
                               std::size_t i, BlendSums& sums) {
    Four e = no_four();
    for (std::size_t p = 0; p < Blend::kMost; ++p) {
        const auto pair = static_cast<std::size_t>(pairs.pair[p][i]);
        e = add_product(pairs.weight[p][i], load_four(tables.encoded[pair].data()), e);
    }
    std::array<float, 4> value{};
    store(e, value.data());
    for (std::size_t c = 0; c < 4; ++c) sums.encoded[c][i] = value[c];
}

// The subspaces that count.
HWY_INLINE void gather_entries(const PairBatch& pairs, std::size_t i, BlendBatch& out) {
    std::array<std::uint8_t, Blend::kMost> subspace{};
    std::array<float, Blend::kMost> weight{};
    std::size_t count = 0;
    for (std::size_t p = 0; p < Blend::kMost; ++p) {
        const float w = pairs.weight[p][i];
        // Overwritten by the next one that counts.
        subspace[count] = static_cast<std::uint8_t>(pairs.subspace[p][i]);
        weight[count] = w;
        count += w > 0 ? 1 : 0;
        if (count == Blend::kMost) break;
    }
    for (std::size_t p = count; p < Blend::kMost; ++p) weight[p] = 0;
    out.count[i] = static_cast<std::uint8_t>(count);
    out.subspace[i] = subspace;
    out.weight[i] = weight;
}

// Mean, shape and variance of the blend of a point: Σ w_k row_k holds the first two, and
// the covariances with all textures, which the weights are multiplied by once more.
HWY_INLINE void add_moments(const BlendTables& tables, const BlendBatch& blends,
                            std::size_t i, BlendSums& sums) {
    constexpr std::size_t kFours = BlendTables::kRow / 4;
    std::array<Four, kFours> sum;
    for (Four& four : sum) four = no_four();
    for (std::size_t a = 0; a < blends.count[i]; ++a) {
        const float* from = tables.rows[blends.subspace[i][a]].data();
        for (std::size_t j = 0; j < kFours; ++j)
            sum[j] = add_product(blends.weight[i][a], load_four(from + 4 * j), sum[j]);
    }
    std::array<float, BlendTables::kRow> row;
    for (std::size_t j = 0; j < kFours; ++j) store(sum[j], row.data() + 4 * j);
    float variance = 0;
    for (std::size_t a = 0; a < blends.count[i]; ++a)
        variance += blends.weight[i][a] * row[blends.subspace[i][a]];
    sums.variance[i] = variance;
    for (std::size_t c = 0; c < 4; ++c) {
        sums.mean[c][i] = row[BlendTables::kMean + c];
        sums.shape[c][i] = row[BlendTables::kShape + c];
    }
}

// The cosine of the light for that of the interpolated lights: between them it makes good
// for the chord, past them it lets the light set.
HWY_INLINE Float fade(bool cosine_included, Float light_height, Float interpolated) {
    if (!cosine_included) return light_height;
    return hn::Min(set(kMaxCosineRatio),
                   hn::Div(light_height, hn::Max(interpolated, set(1e-3F))));
}

// Mean colour and contrast of these directions in place of the blend's own. Symbols as in
// the theory: C = ln E[t²], h = -8 ln E[√t] of the texture, H with the factor.
HWY_INLINE void finish(const BlendTables& tables, const BlendSums& sums,
                       const BatchLane& light_height, const FactorBatch& factors,
                       std::size_t i, BlendBatch& out) {
    const DF df;
    const auto load = [&](const BatchLane& lane) {
        return hn::LoadU(df, lane.data() + i);
    };
    const Float zero = hn::Zero(df);
    const Float one = set(1);
    const Float least = set(std::numeric_limits<float>::min());
    const Float root = load(sums.root);
    const Float faded = fade(tables.cosine_included, load(light_height),
                             hn::Mul(root, hn::Mul(root, root)));
    const Float own = hn::Max(load(sums.mean[3]), least);
    const Float factor_root = load(factors.root);
    const Float square = hn::Div(hn::Max(load(sums.variance), zero), hn::Mul(own, own));
    const Float of_texture = hn::Log1p(df, square);
    const Float h = hn::MulAdd(hn::Mul(of_texture, of_texture),
                               hn::Div(load(sums.shape[3]), own), of_texture);
    const Float total = hn::Add(of_texture, load(factors.square));
    const auto varies = hn::Gt(total, set(kUniform));
    const Float C = hn::Max(total, set(kUniform));
    const Float H = hn::Min(hn::Max(hn::Add(h, factor_root), hn::Mul(set(kLeastRoot), C)),
                            hn::Mul(set(kMostRoot), C));
    const Float wanted = hn::Max(load(sums.encoded[tables.bands]), zero);
    // ln(1 + contrast²) of t^γ is H/4 at γ = ½, C at 1, and taken for C γ^p.
    constexpr float kLog2 = 0.69314718F;
    const Float p = hn::Mul(hn::Log(df, hn::Div(hn::Mul(set(4), C), H)), set(1 / kLog2));
    const Float asked = hn::Div(hn::Log1p(df, hn::Mul(wanted, wanted)), C);
    Float gamma = power(asked, hn::Div(one, p));
    gamma = hn::Min(hn::Max(gamma, set(kLeastPower)), one);
    gamma = hn::IfThenElse(varies, gamma, one);
    // What is left for the straight line.
    const Float contrast = hn::Sqrt(hn::Expm1(df, hn::Mul(C, power(gamma, p))));
    Float amplify = hn::Min(set(DirectionalInterpolation::kMaxContrastGain),
                            hn::Div(wanted, hn::Max(contrast, least)));
    amplify = hn::IfThenElse(varies, amplify, one);
    // E[t^γ] = exp(-γ (1 - γ)/2 c(γ)), c linear through h at ½ and C at 2.
    const Float slope = hn::Mul(hn::Sub(hn::Div(C, H), one), set(1 / 1.5F));
    const Float curve = hn::Mul(hn::Mul(hn::Mul(set(0.5F), gamma), hn::Sub(one, gamma)),
                                hn::MulAdd(slope, hn::Sub(gamma, set(0.5F)), one));
    hn::StoreU(gamma, df, out.power.data() + i);
    for (std::size_t c = 0; c < tables.bands; ++c) {
        const Float e = hn::Max(load(sums.encoded[c]), zero);
        const Float target = hn::Mul(faded, hn::Mul(e, hn::Mul(e, e)));
        const Float mean = load(sums.mean[c]);
        const Float band = hn::MulAdd(hn::Div(load(sums.shape[c]), own), h, factor_root);
        // 1 / (μ^γ E[(x/μ)^γ])
        const Float scale =
            hn::Exp(df, hn::Sub(hn::Mul(curve, band),
                                hn::Mul(gamma, hn::Log(df, hn::Max(mean, least)))));
        const auto some = hn::Gt(mean, zero);
        hn::StoreU(hn::IfThenElse(some, hn::Mul(hn::Mul(target, amplify), scale), zero),
                   df, out.gain[c].data() + i);
        hn::StoreU(hn::IfThenElse(some, hn::Mul(target, hn::Sub(one, amplify)), target),
                   df, out.offset[c].data() + i);
    }
}

void blend_lanes(const BlendTables& tables, const WeightBatch& views,
                 const WeightBatch& lights, const BatchLane& light_height,
                 const FactorBatch& factors, std::size_t count, BlendBatch& out) {
    const DF df;
    const std::size_t lanes = hn::Lanes(df);
    const std::size_t padded = (count + lanes - 1) / lanes * lanes;
    BlendSums sums;
    PairBatch pairs;
    for (std::size_t i = 0; i < padded; i += lanes)
        multiply(tables, views, lights, i, pairs, sums);
    if (!tables.encoded.empty())
        for (std::size_t i = 0; i < count; ++i) add_appearance(tables, pairs, i, sums);
    for (std::size_t i = 0; i < padded; i += lanes) merge(i, pairs);
    for (std::size_t i = 0; i < count; ++i) gather_entries(pairs, i, out);
    if (tables.encoded.empty()) {
        for (std::size_t i = 0; i < padded; i += lanes) {
            const Float faded =
                fade(tables.cosine_included, hn::LoadU(df, light_height.data() + i),
                     hn::LoadU(df, sums.height.data() + i));
            for (std::size_t c = 0; c < 3; ++c) {
                hn::StoreU(faded, df, out.gain[c].data() + i);
                hn::StoreU(hn::Zero(df), df, out.offset[c].data() + i);
            }
            hn::StoreU(set(1), df, out.power.data() + i);
        }
        return;
    }
    for (std::size_t i = 0; i < count; ++i) add_moments(tables, out, i, sums);
    // Lanes past the last repeat it: they are computed, and nobody looks.
    const auto repeat = [&](BatchLane& lane) {
        for (std::size_t i = count; i < padded; ++i) lane[i] = lane[count - 1];
    };
    for (std::size_t c = 0; c < 4; ++c) {
        repeat(sums.encoded[c]);
        repeat(sums.mean[c]);
        repeat(sums.shape[c]);
    }
    repeat(sums.variance);
    for (std::size_t i = 0; i < padded; i += lanes)
        finish(tables, sums, light_height, factors, i, out);
    for (std::size_t c = tables.bands; c < 3; ++c) {
        out.gain[c] = out.gain[0];
        out.offset[c] = out.offset[0];
    }
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(blend_lanes);

void blend_batch(const BlendTables& tables, const WeightBatch& views,
                 const WeightBatch& lights, const BatchLane& light_height,
                 const FactorBatch& factors, std::size_t count, BlendBatch& out) {
    HWY_DYNAMIC_DISPATCH(blend_lanes)
    (tables, views, lights, light_height, factors, count, out);
}

}  // namespace sateen
#endif
