// SPDX-License-Identifier: Apache-2.0
// Linear sRGB to CIE Lab in vectors of any width, and colour differences.
// Scalar reference: the inline functions of colour.hpp.
#include "sateen/core/colour.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/colour.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using DI = hn::Repartition<std::int32_t, DF>;
using Float = hn::Vec<DF>;

HWY_INLINE Float set_float(double value) {
    return hn::Set(DF(), static_cast<float>(value));
}

// t^(1/3) of normal positive numbers, to 3 units in the last place.
//
// One third of the bits of a float is nearly one third of its logarithm, so that
// z = kBits - bits / 3, read as a float, is t^(-1/3) within 3.5 %. With u = t z³ near 1,
//     t^(1/3) = t z² u^(-2/3)
// and u^(-2/3) is minimax in u - 1 on the range that u has (relative error 1.5e-8).
HWY_INLINE Float cube_root(Float t) {
    constexpr std::int32_t kBits = 0x54A25000;
    constexpr std::array<double, 6> kP = {1.0000000143004752,  -0.6666664417574282,
                                          0.5555311182551179,  -0.49392644996010885,
                                          0.45891256833880767, -0.41669377882637237};
    const DI di;
    const DF df;
    const Float bits = hn::ConvertTo(df, hn::BitCast(di, t));
    const auto third = hn::ConvertTo(di, hn::Mul(bits, set_float(1.0 / 3.0)));
    const Float z = hn::BitCast(df, hn::Sub(hn::Set(di, kBits), third));
    const Float y = hn::Mul(hn::Mul(t, z), z);
    const Float h = hn::MulSub(y, z, set_float(1.0));
    Float power = set_float(kP.back());
    for (std::size_t i = kP.size() - 1; i-- > 0;) {
        power = hn::MulAdd(power, h, set_float(kP[i]));
    }
    return hn::Mul(y, power);
}

// f of colour.hpp.
HWY_INLINE Float lab_function(Float t) {
    const Float line =
        hn::MulAdd(t, set_float(kLabSlope / 116.0), set_float(16.0 / 116.0));
    return hn::IfThenElse(hn::Gt(t, set_float(kLabThreshold)), cube_root(t), line);
}

HWY_INLINE Float lightness(Float fy) {
    return hn::MulSub(fy, set_float(116.0), set_float(16.0));
}

HWY_INLINE void lab_step(const float* HWY_RESTRICT red, const float* HWY_RESTRICT green,
                         const float* HWY_RESTRICT blue, float* HWY_RESTRICT L,
                         float* HWY_RESTRICT a, float* HWY_RESTRICT b) {
    const DF df;
    const Float r = hn::LoadU(df, red);
    const Float g = hn::LoadU(df, green);
    const Float l = hn::LoadU(df, blue);
    const auto f = [&](const std::array<double, 3>& row) HWY_ATTR {
        const Float rg = hn::MulAdd(g, set_float(row[1]), hn::Mul(r, set_float(row[0])));
        return lab_function(hn::MulAdd(l, set_float(row[2]), rg));
    };
    const Float fx = f(kRelativeXyzOfLinearSrgb[0]);
    const Float fy = f(kRelativeXyzOfLinearSrgb[1]);
    const Float fz = f(kRelativeXyzOfLinearSrgb[2]);
    hn::StoreU(lightness(fy), df, L);
    hn::StoreU(hn::Mul(hn::Sub(fx, fy), set_float(500.0)), df, a);
    hn::StoreU(hn::Mul(hn::Sub(fy, fz), set_float(200.0)), df, b);
}

constexpr std::size_t kMaxLanes = HWY_MAX_BYTES / sizeof(float);
using Piece = std::array<float, kMaxLanes>;

void lab_planes(const float* red, const float* green, const float* blue, float* L,
                float* a, float* b, std::size_t count) {
    const std::size_t lanes = hn::Lanes(DF());
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        lab_step(red + i, green + i, blue + i, L + i, a + i, b + i);
    }
    if (i == count) return;
    // The last pixels in a step of their own, filled up with black.
    std::array<Piece, 3> in = {};
    std::array<Piece, 3> out;
    std::copy(red + i, red + count, in[0].begin());
    std::copy(green + i, green + count, in[1].begin());
    std::copy(blue + i, blue + count, in[2].begin());
    lab_step(in[0].data(), in[1].data(), in[2].data(), out[0].data(), out[1].data(),
             out[2].data());
    std::copy_n(out[0].begin(), count - i, L + i);
    std::copy_n(out[1].begin(), count - i, a + i);
    std::copy_n(out[2].begin(), count - i, b + i);
}

void lightness_plane(const float* Y, float* L, std::size_t count) {
    const DF df;
    const std::size_t lanes = hn::Lanes(df);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        hn::StoreU(lightness(lab_function(hn::LoadU(df, Y + i))), df, L + i);
    }
    if (i == count) return;
    Piece piece = {};
    std::copy(Y + i, Y + count, piece.begin());
    hn::StoreU(lightness(lab_function(hn::LoadU(df, piece.data()))), df, piece.data());
    std::copy_n(piece.begin(), count - i, L + i);
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(lab_planes);
HWY_EXPORT(lightness_plane);

void lab_from_linear_srgb(std::span<const float> red, std::span<const float> green,
                          std::span<const float> blue, std::span<float> L,
                          std::span<float> a, std::span<float> b) {
    assert(green.size() == red.size() && blue.size() == red.size());
    assert(L.size() == red.size() && a.size() == red.size() && b.size() == red.size());
    HWY_DYNAMIC_DISPATCH(lab_planes)
    (red.data(), green.data(), blue.data(), L.data(), a.data(), b.data(), red.size());
}

void lightness_from_linear(std::span<const float> Y, std::span<float> L) {
    assert(L.size() == Y.size());
    HWY_DYNAMIC_DISPATCH(lightness_plane)(Y.data(), L.data(), Y.size());
}

double delta_e_76(const Lab& first, const Lab& second) {
    const double dL = first.L - second.L;
    return std::hypot(dL, first.a - second.a, first.b - second.b);
}

// Equation numbers of [Sharma, Wu & Dalal 2005]. Hues in degrees, in [0, 360).
double delta_e_2000(const Lab& first, const Lab& second) {
    constexpr double kDegree = std::numbers::pi / 180.0;
    const auto pow7_share = [](double chroma) {
        const double c7 = std::pow(chroma, 7);
        constexpr double k25To7 = 6103515625.0;
        return std::sqrt(c7 / (c7 + k25To7));
    };
    const auto hue = [](double a, double b) {
        if (a == 0 && b == 0) return 0.0;
        const double h = std::atan2(b, a) / kDegree;
        return h < 0 ? h + 360.0 : h;
    };
    // (2)-(7): a is stretched where colours are nearly grey.
    const double mean_chroma =
        (std::hypot(first.a, first.b) + std::hypot(second.a, second.b)) / 2.0;
    const double stretch = 1.0 + 0.5 * (1.0 - pow7_share(mean_chroma));
    const double a1 = stretch * first.a;
    const double a2 = stretch * second.a;
    const double C1 = std::hypot(a1, first.b);
    const double C2 = std::hypot(a2, second.b);
    const double h1 = hue(a1, first.b);
    const double h2 = hue(a2, second.b);

    // (8)-(11): differences, hues the short way round.
    const bool grey = C1 * C2 == 0;
    double dh = grey ? 0.0 : h2 - h1;
    if (dh > 180.0) dh -= 360.0;
    if (dh < -180.0) dh += 360.0;
    const double dL = second.L - first.L;
    const double dC = C2 - C1;
    const double dH = 2.0 * std::sqrt(C1 * C2) * std::sin(dh / 2.0 * kDegree);

    // (12)-(14): means; that of the hues lies between them the short way round.
    const double L = (first.L + second.L) / 2.0;
    const double C = (C1 + C2) / 2.0;
    double h = h1 + h2;
    if (!grey) {
        if (std::abs(h1 - h2) > 180.0) h += h < 360.0 ? 360.0 : -360.0;
        h /= 2.0;
    }

    // (15)-(22)
    const auto cosine = [](double degrees) { return std::cos(degrees * kDegree); };
    const double T = 1.0 - 0.17 * cosine(h - 30.0) + 0.24 * cosine(2.0 * h) +
                     0.32 * cosine(3.0 * h + 6.0) - 0.20 * cosine(4.0 * h - 63.0);
    const double L50 = (L - 50.0) * (L - 50.0);
    const double S_L = 1.0 + 0.015 * L50 / std::sqrt(20.0 + L50);
    const double S_C = 1.0 + 0.045 * C;
    const double S_H = 1.0 + 0.015 * C * T;
    const double turn = (h - 275.0) / 25.0;
    const double rotation = 60.0 * kDegree * std::exp(-turn * turn);
    const double R_T = -2.0 * pow7_share(C) * std::sin(rotation);
    const double l = dL / S_L;
    const double c = dC / S_C;
    const double hh = dH / S_H;
    return std::sqrt(l * l + c * c + hh * hh + R_T * c * hh);
}

}  // namespace sateen
#endif
