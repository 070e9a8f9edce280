// SPDX-License-Identifier: Apache-2.0
// Theory: docs/theory/band_modulation.md.
#include "core/band_rows.hpp"

#include <cstdint>

#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/band_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/vector_row-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Without fused multiply-add, so that a site has the same bits wherever it lies and on every
// target.

template <class D, class V>
HWY_INLINE V binomial(D d, V a, V b, V c, V e, V f) {
    const V outer = hn::Mul(hn::Add(a, f), hn::Set(d, 0.0625F));
    const V inner = hn::Mul(hn::Add(b, e), hn::Set(d, 0.25F));
    return hn::Add(outer, hn::Add(inner, hn::Mul(c, hn::Set(d, 0.375F))));
}

void smooth_rows(const float* const rows[5], bool squared, float* line,
                 std::size_t count) {
    if (squared) {
        for_row(count, [&](auto d, std::size_t x) HWY_ATTR {
            const auto square = [&](std::size_t j) HWY_ATTR {
                const auto v = hn::LoadU(d, rows[j] + x);
                return hn::Mul(v, v);
            };
            hn::StoreU(binomial(d, square(0), square(1), square(2), square(3), square(4)),
                       d, line + x);
        });
        return;
    }
    for_row(count, [&](auto d, std::size_t x) HWY_ATTR {
        const auto at = [&](std::size_t j) HWY_ATTR { return hn::LoadU(d, rows[j] + x); };
        hn::StoreU(binomial(d, at(0), at(1), at(2), at(3), at(4)), d, line + x);
    });
}

void smooth_columns(const float* line, std::size_t spacing, const float* in, float* rest,
                    float* out, std::size_t count) {
    for_row(count, [&](auto d, std::size_t x) HWY_ATTR {
        const auto at = [&](std::size_t j)
                            HWY_ATTR { return hn::LoadU(d, line + x + j * spacing); };
        const auto smooth = binomial(d, at(0), at(1), at(2), at(3), at(4));
        if (rest != nullptr)
            hn::StoreU(hn::Sub(hn::LoadU(d, in + x), smooth), d, rest + x);
        hn::StoreU(smooth, d, out + x);
    });
}

constexpr float kOneBits = 8388608.0F;  // 2^23: of the exponent's last place
constexpr float kBias = 127.0F;
// Amplitudes from 2^-6 to 2^6.
constexpr float kFurthestOctave = 6.0F;

template <class D, class V>
HWY_INLINE V half_log2(D d, V energy) {
    const hn::RebindToSigned<D> di;
    const V bits = hn::ConvertTo(d, hn::BitCast(di, energy));
    return hn::Mul(hn::Sub(hn::Mul(bits, hn::Set(d, 1 / kOneBits)), hn::Set(d, kBias)),
                   hn::Set(d, 0.5F));
}

template <class D, class V>
HWY_INLINE V exp2_of(D d, V u) {
    const hn::RebindToSigned<D> di;
    const V octaves =
        hn::Clamp(u, hn::Set(d, -kFurthestOctave), hn::Set(d, kFurthestOctave));
    const V bits = hn::Mul(hn::Add(octaves, hn::Set(d, kBias)), hn::Set(d, kOneBits));
    return hn::BitCast(d, hn::ConvertTo(di, bits));
}

template <class D, class V>
HWY_INLINE V curve_at(D d, const KnotTable& table, V x) {
    const hn::RebindToSigned<D> di;
    const V t = hn::Clamp(
        hn::Mul(hn::Sub(x, hn::Set(d, table.first)), hn::Set(d, table.per_unit)),
        hn::Zero(d), hn::Set(d, 7.0F));
    const auto j = hn::Min(hn::ConvertTo(di, t), hn::Set(di, 6));
    const V part = hn::Sub(t, hn::ConvertTo(d, j));
#if HWY_CAP_GE256
    // Where a register holds all knots, a permutation is several times faster than reading
    // memory at every lane's own address.
    if constexpr (hn::MaxLanes(D()) >= 8) {
        const auto at = hn::IndicesFromVec(d, j);
        return hn::Add(
            hn::TableLookupLanes(hn::LoadU(d, table.value.data()), at),
            hn::Mul(part, hn::TableLookupLanes(hn::LoadU(d, table.rise.data()), at)));
    }
#endif
    const V value = hn::GatherIndex(d, table.value.data(), j);
    const V rise = hn::GatherIndex(d, table.rise.data(), j);
    return hn::Add(value, hn::Mul(part, rise));
}

void modulate_row(const ModulatedRow& row, std::size_t count) {
    for_row(count, [&](auto d, std::size_t x) HWY_ATTR {
        const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
        const auto low = hn::LoadU(d, row.low + x);
        auto u = row.field != nullptr ? hn::LoadU(d, row.field + x) : hn::Zero(d);
        if (row.of_value != nullptr)
            u = hn::Add(u,
                        curve_at(d, *row.of_value, hn::Mul(low, set(row.value_scale))));
        const auto energy_curve = [&](const KnotTable& table, const float* energy,
                                      float scale) HWY_ATTR {
            const auto e =
                hn::Add(hn::Mul(hn::LoadU(d, energy + x), set(scale)), set(kEnergyFloor));
            return curve_at(d, table, half_log2(d, e));
        };
        if (row.parent != nullptr)
            u = hn::Add(u, energy_curve(*row.of_parent, row.parent, row.parent_scale));
        if (row.first != nullptr)
            u = hn::Add(u, energy_curve(*row.of_first, row.first, row.first_scale));
        const auto band =
            hn::Mul(hn::Mul(exp2_of(d, u), set(row.gain)), hn::LoadU(d, row.band + x));
        hn::StoreU(band, d, row.band + x);
        hn::StoreU(hn::Add(low, band), d, row.low + x);
    });
}

void log_amplitude_row(const float* energy, float scale, float* out, std::size_t count) {
    for_row(count, [&](auto d, std::size_t x) HWY_ATTR {
        const auto e = hn::Add(hn::Mul(hn::LoadU(d, energy + x), hn::Set(d, scale)),
                               hn::Set(d, kEnergyFloor));
        hn::StoreU(half_log2(d, e), d, out + x);
    });
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(smooth_rows);
HWY_EXPORT(smooth_columns);
HWY_EXPORT(modulate_row);
HWY_EXPORT(log_amplitude_row);

void smooth_rows(const float* const rows[5], bool squared, float* line,
                 std::size_t count) {
    HWY_DYNAMIC_DISPATCH(smooth_rows)(rows, squared, line, count);
}

void smooth_columns(const float* line, std::size_t spacing, const float* in, float* rest,
                    float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(smooth_columns)(line, spacing, in, rest, out, count);
}

void modulate_row(const ModulatedRow& row, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(modulate_row)(row, count);
}

void log_amplitude_row(const float* energy, float scale, float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(log_amplitude_row)(energy, scale, out, count);
}

}  // namespace sateen
#endif
