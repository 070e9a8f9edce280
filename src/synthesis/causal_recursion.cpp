// SPDX-License-Identifier: Apache-2.0
// The recursion along a row, unrolled by look-ahead until it vectorises.
// Theory: docs/theory/causal_recursion.md.
#include "synthesis/causal_recursion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/causal_recursion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// With A(z) = 1 - Σ_k a_{(0,k)} z^k, z a step to the left, a row is
//
//     Y = X / A(z),    X_r = σ e_r + Σ_{s_1 > 0} a_s Y_{r-s}
//
// X is a sum over finished rows. A(z) A(-z) is even, A_1(z²). Doubled five times,
//
//     1 / A(z) = [A(-z) A_1(-z²)] [A_2(-z⁴) A_3(-z⁸)] A_4(-z¹⁶) / A_5(z³²)
//
// leaves two sums over sites of the row before, and a last one that looks 32 sites or
// more back in its own row: none of the four waits for its neighbours.

#ifndef SATEEN_SYNTHESIS_CAUSAL_RECURSION_ONCE
#define SATEEN_SYNTHESIS_CAUSAL_RECURSION_ONCE
namespace sateen {
namespace {

// Sites worked on at a time, and how far the last sum looks back.
constexpr std::size_t kBlock = 32;

}  // namespace
}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
// Two vectors fit into a block.
using D = hn::CappedTag<float, kBlock / 2>;
using Float = hn::Vec<D>;

using Sum = CausalRecursion::Sum;

// One rounding an operation. Short sums have a constant number of terms, which saves the
// loop over them.
template <std::size_t kCount>
HWY_INLINE void draw_sum(const Sum& sum, std::size_t width) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    const Sum::Term* const terms = sum.terms.data();
    const std::size_t count = kCount != 0 ? kCount : sum.terms.size();
    const float* const from = sum.from;
    float* const to = sum.to;
    const Float scale = hn::Set(d, sum.scale);
    for (std::size_t x = 0; x < width; x += 2 * lanes) {
        Float y0 = hn::Mul(scale, hn::Load(d, from + x));
        Float y1 = hn::Mul(scale, hn::Load(d, from + x + lanes));
        for (std::size_t i = 0; i < count; ++i) {
            const Float a = hn::Set(d, terms[i].a);
            y0 = hn::Add(y0, hn::Mul(a, hn::LoadU(d, terms[i].from + x)));
            y1 = hn::Add(y1, hn::Mul(a, hn::LoadU(d, terms[i].from + x + lanes)));
        }
        hn::Store(y0, d, to + x);
        hn::Store(y1, d, to + x + lanes);
    }
}

void draw_sums(std::span<const Sum> sums, std::size_t width) {
    for (const Sum& sum : sums) {
        switch (sum.terms.size()) {
            case 1:
                draw_sum<1>(sum, width);
                break;
            case 2:
                draw_sum<2>(sum, width);
                break;
            case 3:
                draw_sum<3>(sum, width);
                break;
            default:
                draw_sum<0>(sum, width);
        }
    }
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(draw_sums);

namespace {

constexpr std::size_t kAlignment = 64 / sizeof(float);

std::size_t round_up(std::size_t value, std::size_t multiple) {
    return (value + multiple - 1) / multiple * multiple;
}

// A model that grows this fast is refused by its callers; here it may not be undefined.
float narrow(double value) {
    constexpr auto kLargest = static_cast<double>(std::numeric_limits<float>::max());
    return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

// Coefficients of z^0, z^1, …
using Polynomial = std::vector<double>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
    Polynomial result(a.size() + b.size() - 1);
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
    }
    return result;
}

// P(-z)
Polynomial mirrored(Polynomial p) {
    for (std::size_t k = 1; k < p.size(); k += 2) p[k] = -p[k];
    return p;
}

// Q(z) with Q(z²) = P(z) P(-z)
Polynomial doubled(const Polynomial& p) {
    const Polynomial even = product(p, mirrored(p));
    Polynomial result;
    for (std::size_t k = 0; k < even.size(); k += 2) result.push_back(even[k]);
    return result;
}

// P(z²)
Polynomial spread(const Polynomial& p) {
    Polynomial result(2 * p.size() - 1);
    for (std::size_t k = 0; k < p.size(); ++k) result[2 * k] = p[k];
    return result;
}

}  // namespace

// Rows begin and end with zeros as far as any sum looks.
void CausalRecursion::allocate(std::size_t rows, std::size_t reach) {
    width_ = round_up(cols_, kBlock);
    const std::size_t stride = round_up(reach + width_ + kCausalReach, kAlignment);
    memory_.resize((rows + 3) * stride + kAlignment);
    const std::size_t past =
        reinterpret_cast<std::uintptr_t>(memory_.data()) / sizeof(float) % kAlignment;
    float* row = memory_.data() + (kAlignment - past) + reach;
    const auto next = [&] { return std::exchange(row, row + stride); };
    noise_ = next();
    for (float*& work : work_) work = next();
    while (rows_.size() < rows) rows_.push_back(next());
}

// The sums that divide by A(z).
void CausalRecursion::add_row_sums(std::span<const CausalTap> taps) {
    Polynomial a = {1};
    for (const CausalTap& tap : taps) {
        if (tap.row != 0) continue;
        const auto power = static_cast<std::size_t>(tap.col);
        a.resize(std::max(a.size(), power + 1));
        a[power] -= static_cast<double>(tap.a);
    }
    if (a.size() == 1) return;

    // Smaller coefficients change no sum, and as denormals would slow it down.
    constexpr double kNegligible = 0x1p-40;
    const auto add_terms = [&](Sum& sum, const float* row, const Polynomial& p,
                               std::size_t distance) {
        for (std::size_t k = p.size() - 1; k > 0; --k) {
            if (std::abs(p[k]) <= kNegligible) continue;
            sum.terms.push_back({row - k * distance, narrow(p[k])});
            if (distance == kBlock)
                feedback_.push_back(static_cast<std::ptrdiff_t>(k * distance));
        }
    };
    for (std::size_t distance = 1; distance < kBlock / 2; distance *= 4) {
        const float* const from = sums_.back().to;
        Sum& sum = sums_.emplace_back();
        sum.from = from;
        sum.to = from == work_[0] ? work_[1] : work_[0];
        const Polynomial next = doubled(a);
        add_terms(sum, from, product(mirrored(a), spread(mirrored(next))), distance);
        a = doubled(next);
    }
    const float* const from = sums_.back().to;
    Sum& sum = sums_.emplace_back();
    sum.from = from;
    add_terms(sum, from, mirrored(a), kBlock / 2);
    a = doubled(a);
    for (double& coefficient : a) coefficient = -coefficient;
    add_terms(sum, rows_[0], a, kBlock);
}

Result<CausalRecursion> CausalRecursion::create(std::span<const CausalTap> taps,
                                                float sigma, std::size_t cols) {
    CausalRecursion result;
    result.cols_ = cols;
    int rows_above = 0;
    int left = 1;
    for (const CausalTap& tap : taps) {
        const bool causal = tap.row > 0 || (tap.row == 0 && tap.col > 0);
        const bool near = tap.row <= kCausalReach && tap.col <= kCausalReach &&
                          tap.col >= -kCausalReach;
        if (!causal || !near) {
            return Error{
                Errc::invalid_argument,
                "causal recursion: expected taps of the causal half plane, at most " +
                    std::to_string(kCausalReach) + " away, found (" +
                    std::to_string(tap.row) + ", " + std::to_string(tap.col) + ")"};
        }
        rows_above = std::max(rows_above, tap.row);
        if (tap.row > 0) {
            result.above_.push_back(tap);
        } else {
            left = std::max(left, tap.col);
        }
    }
    std::stable_sort(result.above_.begin(), result.above_.end(),
                     [](const CausalTap& a, const CausalTap& b) {
                         return a.row != b.row ? a.row > b.row : a.col > b.col;
                     });
    result.allocate(static_cast<std::size_t>(rows_above) + 1,
                    static_cast<std::size_t>(left) * kBlock);
    Sum& first = result.sums_.emplace_back();
    first.scale = sigma;
    first.from = result.noise_;
    first.to = result.work_[0];
    for (const CausalTap& tap : result.above_) first.terms.push_back({nullptr, tap.a});
    result.add_row_sums(taps);
    return result;
}

std::span<const float> CausalRecursion::next_row() {
    std::rotate(rows_.begin(), rows_.end() - 1, rows_.end());
    for (std::size_t i = 0; i < above_.size(); ++i) {
        sums_.front().terms[i].from =
            rows_[static_cast<std::size_t>(above_[i].row)] - above_[i].col;
    }
    float* const y = rows_[0];
    Sum& last = sums_.back();
    last.to = y;
    const std::size_t first_own = last.terms.size() - feedback_.size();
    for (std::size_t i = 0; i < feedback_.size(); ++i) {
        last.terms[first_own + i].from = y - feedback_[i];
    }
    HWY_DYNAMIC_DISPATCH(draw_sums)(sums_, width_);
    std::fill(y + cols_, y + width_, 0.0F);
    return {y, cols_};
}

Result<void> causal_recursion(std::span<const CausalTap> taps, float sigma,
                              PlaneView<float> field) {
    SATEEN_TRY(CausalRecursion recursion,
               CausalRecursion::create(taps, sigma, field.cols));
    for (std::size_t r = 0; r < field.rows; ++r) {
        std::copy_n(field.row(r), field.cols, recursion.noise().data());
        std::copy_n(recursion.next_row().data(), field.cols, field.row(r));
    }
    return {};
}

}  // namespace sateen
#endif
