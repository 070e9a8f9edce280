// SPDX-License-Identifier: Apache-2.0
// A wavefront: one row in each SIMD lane, every lane a few columns behind the one above.
// Theory: docs/theory/causal_recursion.md.
#include "synthesis/causal_recursion.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/causal_recursion.cpp"
#include <hwy/aligned_allocator.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Lane i works on row r0 + i, and at step t on column t - i D. In the skewed store
//
//     Z_k(t, i) = Y(r0 + i - k, t - (i - k) D),   k = 0 … max s_1
//
// the neighbour Y_{r-s} of every lane i lies in one vector, Z_{s_1}(t - s_2 - s_1 D). D
// is larger than any -s_2, so that all of them lie in the past. Z_k is Z_0 moved up by k
// lanes; the lanes that come free hold the finished rows above. It is kept beside Z_0,
// not read from there between vectors: a load that straddles fresh stores has to wait for
// the cache.
//
// Blocks of steps go through a store small enough for the first-level cache: rows are
// skewed in, the recursion runs, rows are skewed out.

#ifndef SATEEN_SYNTHESIS_CAUSAL_RECURSION_ONCE
#define SATEEN_SYNTHESIS_CAUSAL_RECURSION_ONCE
namespace sateen {
namespace {

constexpr std::size_t kMaxLanes = 16;
// Not fewer than any history, (kCausalReach + 3) kCausalReach.
constexpr std::ptrdiff_t kBlockSteps = 96;
constexpr std::ptrdiff_t kHaloSlot = kCausalReach;

struct SkewedTap {
    std::ptrdiff_t steps;  // s_2 + s_1 D
    std::ptrdiff_t row;    // s_1
    float a;
};

struct SkewedTaps {
    std::vector<SkewedTap> taps;
    float left = 0;              // the coefficient of (0, 1), which is not among the taps
    std::ptrdiff_t delay = 1;    // D
    std::ptrdiff_t history = 1;  // steps that the taps look back
    std::ptrdiff_t rows_above = 0;  // max s_1
    float sigma = 1;
};

// Rows by their distance from the top of the field, above (negative) and inside; zeros
// for rows that are not there.
struct Rows {
    PlaneView<const float> above;
    PlaneView<float> field;
    const float* zeros;

    [[nodiscard]] const float* read(std::ptrdiff_t r) const {
        if (r >= 0) {
            const auto row = static_cast<std::size_t>(r);
            return row < field.rows ? field.row(row) : zeros;
        }
        const auto up = static_cast<std::size_t>(-r);
        return up <= above.rows ? above.row(above.rows - up) : zeros;
    }
};

}  // namespace
}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, kMaxLanes>;
using Float = hn::Vec<D>;

#if HWY_TARGET == HWY_SCALAR

// Without vectors, site by site.
void draw_field(const SkewedTaps& model, const Rows& rows) {
    const auto cols = static_cast<std::ptrdiff_t>(rows.field.cols);
    const auto height = static_cast<std::ptrdiff_t>(rows.field.rows);
    for (std::ptrdiff_t r = 0; r < height; ++r) {
        float* const row = rows.field.row(static_cast<std::size_t>(r));
        float y = 0;
        for (std::ptrdiff_t c = 0; c < cols; ++c) {
            float sum = model.sigma * row[c];
            for (const SkewedTap& tap : model.taps) {
                const std::ptrdiff_t col = c - (tap.steps - tap.row * model.delay);
                const bool inside = col >= 0 && col < cols;
                sum += tap.a * (inside ? rows.read(r - tap.row)[col] : 0.0F);
            }
            y = sum + model.left * y;
            row[c] = y;
        }
    }
}

#else

// Steps are moved four at a time for four lanes at once, by transposes of 4 x 4.
constexpr std::ptrdiff_t kQuad = 4;

HWY_INLINE void transpose(const float* const* from, float* const* to) {
    const hn::FixedTag<float, 4> d;
    const auto a = hn::LoadU(d, from[0]);
    const auto b = hn::LoadU(d, from[1]);
    const auto c = hn::LoadU(d, from[2]);
    const auto e = hn::LoadU(d, from[3]);
    const auto ac_low = hn::InterleaveLower(d, a, c);
    const auto ac_high = hn::InterleaveUpper(d, a, c);
    const auto be_low = hn::InterleaveLower(d, b, e);
    const auto be_high = hn::InterleaveUpper(d, b, e);
    hn::StoreU(hn::InterleaveLower(d, ac_low, be_low), d, to[0]);
    hn::StoreU(hn::InterleaveUpper(d, ac_low, be_low), d, to[1]);
    hn::StoreU(hn::InterleaveLower(d, ac_high, be_high), d, to[2]);
    hn::StoreU(hn::InterleaveUpper(d, ac_high, be_high), d, to[3]);
}

// A block of steps of one wavefront: `store` points at lane 0 of step `first`.
struct Block {
    float* store;
    std::ptrdiff_t slot;  // floats from step to step
    std::ptrdiff_t first;
    std::ptrdiff_t last;

    [[nodiscard]] float* at(std::ptrdiff_t step, std::ptrdiff_t lane) const {
        return store + (step - first) * slot + lane;
    }
};

// The steps of a block at which all of four lanes are inside the columns.
struct Inside {
    std::ptrdiff_t first;
    std::ptrdiff_t last;
};

HWY_INLINE Inside steps_inside(const Block& block, std::ptrdiff_t lane,
                               std::ptrdiff_t delay, std::ptrdiff_t cols) {
    const std::ptrdiff_t first =
        std::clamp((lane + kQuad - 1) * delay, block.first, block.last);
    const std::ptrdiff_t last = std::clamp(lane * delay + cols, first, block.last);
    return {first, last - (last - first) % kQuad};
}

// Z(t, i) = row r0 + i, column t - i D, for four lanes; zero outside the columns.
void skew_in(const Rows& rows, std::ptrdiff_t r0, std::ptrdiff_t lane,
             std::ptrdiff_t delay, const Block& block) {
    const auto cols = static_cast<std::ptrdiff_t>(rows.field.cols);
    const float* from[kQuad];
    for (std::ptrdiff_t i = 0; i < kQuad; ++i) from[i] = rows.read(r0 + lane + i);
    const auto one_by_one = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        for (std::ptrdiff_t i = 0; i < kQuad; ++i) {
            for (std::ptrdiff_t t = begin; t < end; ++t) {
                const std::ptrdiff_t c = t - (lane + i) * delay;
                *block.at(t, lane + i) = c >= 0 && c < cols ? from[i][c] : 0.0F;
            }
        }
    };
    const Inside inside = steps_inside(block, lane, delay, cols);
    one_by_one(block.first, inside.first);
    for (std::ptrdiff_t t = inside.first; t < inside.last; t += kQuad) {
        const float* source[kQuad];
        float* target[kQuad];
        for (std::ptrdiff_t i = 0; i < kQuad; ++i) {
            source[i] = from[i] + (t - (lane + i) * delay);
            target[i] = block.at(t + i, lane);
        }
        transpose(source, target);
    }
    one_by_one(inside.last, block.last);
}

// Row r0 + i, column t - i D = Z(t, i), for four lanes, where there is such a site.
void skew_out(const Rows& rows, std::size_t r0, std::ptrdiff_t lane, std::ptrdiff_t delay,
              const Block& block) {
    const auto cols = static_cast<std::ptrdiff_t>(rows.field.cols);
    const std::size_t top = r0 + static_cast<std::size_t>(lane);
    const auto present = static_cast<std::ptrdiff_t>(
        std::min(static_cast<std::size_t>(kQuad), rows.field.rows - top));
    const auto row = [&](std::ptrdiff_t i) {
        return rows.field.row(top + static_cast<std::size_t>(i));
    };
    const auto one_by_one = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        for (std::ptrdiff_t i = 0; i < present; ++i) {
            for (std::ptrdiff_t t = begin; t < end; ++t) {
                const std::ptrdiff_t c = t - (lane + i) * delay;
                if (c >= 0 && c < cols) row(i)[c] = *block.at(t, lane + i);
            }
        }
    };
    if (present < kQuad) {
        one_by_one(block.first, block.last);
        return;
    }
    const Inside inside = steps_inside(block, lane, delay, cols);
    one_by_one(block.first, inside.first);
    for (std::ptrdiff_t t = inside.first; t < inside.last; t += kQuad) {
        const float* source[kQuad];
        float* target[kQuad];
        for (std::ptrdiff_t i = 0; i < kQuad; ++i) {
            source[i] = block.at(t + i, lane);
            target[i] = row(i) + (t - (lane + i) * delay);
        }
        transpose(source, target);
    }
    one_by_one(inside.last, block.last);
}

// The recursion of one wavefront.
class Wavefront {
  public:
    Wavefront(const SkewedTaps& model, std::ptrdiff_t cols)
        : model_(model),
          cols_(cols),
          lanes_(static_cast<std::ptrdiff_t>(hn::Lanes(D()))),
          slot_((model.rows_above + 1) * lanes_) {
        for (std::ptrdiff_t k = 0; k < kCausalReach; ++k) {
            for (std::ptrdiff_t i = 0; i < lanes_; ++i) {
                moved_up_[static_cast<std::size_t>(k * lanes_ + i)] =
                    static_cast<std::int32_t>(std::max<std::ptrdiff_t>(0, i - k - 1));
            }
        }
        for (const SkewedTap& tap : model.taps) {
            taps_.push_back({tap.row * lanes_ - tap.steps * slot_, tap.a});
        }
    }

    // Floats of a step.
    [[nodiscard]] std::ptrdiff_t slot() const { return slot_; }

    // Z_k of a step from Z_0 and the rows above.
    HWY_INLINE void store(Float y, float* z, const float* halo) const {
        const D d;
        hn::Store(y, d, z);
        for (std::ptrdiff_t k = 1; k <= model_.rows_above; ++k) {
            const auto from = hn::SetTableIndices(d, moved_up_.data() + (k - 1) * lanes_);
            const Float above = hn::LoadU(d, halo - k);
            const auto free =
                hn::FirstN(d, static_cast<std::size_t>(std::min(k, lanes_)));
            hn::Store(hn::IfThenElse(free, above, hn::TableLookupLanes(y, from)), d,
                      z + k * lanes_);
        }
    }

    // The recursion over a block, in raster order of the neighbours: the left one, which
    // the processor waits for, comes last. A lane left or right of the columns stays
    // zero, since its neighbours may not be.
    void run(const Block& block, const Block& halo) const {
        const D d;
        const Float sigma = hn::Set(d, model_.sigma);
        const Float left = hn::Set(d, model_.left);
        const std::ptrdiff_t all_started = (lanes_ - 1) * model_.delay;
        Float y = hn::Load(d, block.at(block.first - 1, 0));
        for (std::ptrdiff_t t = block.first; t < block.last; ++t) {
            float* const z = block.at(t, 0);
            Float sum = hn::Mul(sigma, hn::Load(d, z));
            for (const Tap& tap : taps_) {
                sum =
                    hn::Add(sum, hn::Mul(hn::Set(d, tap.a), hn::Load(d, z + tap.offset)));
            }
            y = hn::Add(sum, hn::Mul(left, y));
            if (t < all_started || t >= cols_) {
                y = hn::IfThenElseZero(lanes_from(t), y);
                y = hn::IfThenZeroElse(lanes_from(t - cols_), y);
            }
            store(y, z, halo.at(t, 0));
        }
    }

  private:
    struct Tap {
        std::ptrdiff_t offset;  // of the neighbour from Z_0(t)
        float a;
    };

    // The lanes that are at column 0 or further after so many steps.
    HWY_INLINE hn::Mask<D> lanes_from(std::ptrdiff_t steps) const {
        const std::ptrdiff_t count =
            steps < 0 ? 0 : std::min(lanes_, steps / model_.delay + 1);
        return hn::FirstN(D(), static_cast<std::size_t>(count));
    }

    const SkewedTaps& model_;
    std::ptrdiff_t cols_;
    std::ptrdiff_t lanes_;
    std::ptrdiff_t slot_;
    std::vector<Tap> taps_;
    HWY_ALIGN std::array<std::int32_t, kMaxLanes * kCausalReach> moved_up_;
};

std::ptrdiff_t round_up(std::ptrdiff_t value, std::ptrdiff_t multiple) {
    return (value + multiple - 1) / multiple * multiple;
}

void draw_field(const SkewedTaps& model, const Rows& rows) {
    const D d;
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    const auto cols = static_cast<std::ptrdiff_t>(rows.field.cols);
    const auto height = static_cast<std::ptrdiff_t>(rows.field.rows);
    const Wavefront front(model, cols);
    const std::ptrdiff_t slot = front.slot();
    const std::ptrdiff_t history = model.history;
    const std::ptrdiff_t halo_lanes = round_up(model.rows_above, kQuad);

    const auto z_store = hwy::AllocateAligned<float>(
        static_cast<std::size_t>((history + kBlockSteps) * slot) + kMaxLanes);
    // Vectors read the rows above with what follows them.
    std::vector<float> halo_store(
        static_cast<std::size_t>((history + kBlockSteps + 1) * kHaloSlot) + kMaxLanes);
    const auto z_block = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
        return Block{z_store.get() + (first < 0 ? 0 : history * slot), slot, first, last};
    };
    const auto halo_block = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
        return Block{
            halo_store.data() + (first < 0 ? 0 : history * kHaloSlot) + kHaloSlot,
            kHaloSlot, first, last};
    };

    for (std::ptrdiff_t r0 = 0; r0 < height; r0 += lanes) {
        const auto skew_in_above = [&](const Block& halo) {
            for (std::ptrdiff_t lane = -halo_lanes; lane < 0; lane += kQuad) {
                skew_in(rows, r0, lane, model.delay, halo);
            }
        };
        const std::ptrdiff_t active = std::min(lanes, height - r0);
        const std::ptrdiff_t steps = cols + (active - 1) * model.delay;
        const Block z_before = z_block(-history, 0);
        const Block halo_before = halo_block(-history, 0);
        skew_in_above(halo_before);
        for (std::ptrdiff_t t = -history; t < 0; ++t) {
            front.store(hn::Zero(d), z_before.at(t, 0), halo_before.at(t, 0));
        }
        for (std::ptrdiff_t t = 0; t < steps; t += kBlockSteps) {
            const Block z = z_block(t, std::min(steps, t + kBlockSteps));
            const Block halo = halo_block(z.first, z.last);
            skew_in_above(halo);
            for (std::ptrdiff_t lane = 0; lane < lanes; lane += kQuad) {
                skew_in(rows, r0, lane, model.delay, z);
            }
            front.run(z, halo);
            for (std::ptrdiff_t lane = 0; lane < active; lane += kQuad) {
                skew_out(rows, static_cast<std::size_t>(r0), lane, model.delay, z);
            }
            std::copy_n(z_store.get() + kBlockSteps * slot, history * slot,
                        z_store.get());
        }
    }
}

#endif

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(draw_field);

namespace {

Result<SkewedTaps> skew(std::span<const CausalTap> taps, float sigma) {
    SkewedTaps skewed;
    skewed.sigma = sigma;
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
        // One column more than needed: nothing is then looked back to at once but the
        // left neighbour.
        if (tap.row > 0) {
            skewed.delay = std::max<std::ptrdiff_t>(skewed.delay, 2 - tap.col);
        }
        skewed.rows_above = std::max<std::ptrdiff_t>(skewed.rows_above, tap.row);
    }
    for (const CausalTap& tap : taps) {
        const std::ptrdiff_t steps = tap.col + tap.row * skewed.delay;
        skewed.history = std::max(skewed.history, steps);
        if (tap.row == 0 && tap.col == 1) {
            skewed.left += tap.a;
        } else {
            skewed.taps.push_back({steps, tap.row, tap.a});
        }
    }
    std::stable_sort(skewed.taps.begin(), skewed.taps.end(),
                     [](const SkewedTap& a, const SkewedTap& b) {
                         return a.row != b.row ? a.row > b.row : a.steps > b.steps;
                     });
    return skewed;
}

}  // namespace

Result<void> causal_recursion(std::span<const CausalTap> taps, float sigma,
                              PlaneView<const float> above, PlaneView<float> field) {
    if (above.rows != 0 && above.cols != field.cols) {
        return Error{Errc::invalid_argument, "causal recursion: expected rows above of " +
                                                 std::to_string(field.cols) +
                                                 " columns, found " +
                                                 std::to_string(above.cols)};
    }
    SATEEN_TRY(const SkewedTaps model, skew(taps, sigma));
    if (field.size() == 0) return {};
    const std::vector<float> zeros(field.cols);
    HWY_DYNAMIC_DISPATCH(draw_field)(model, Rows{above, field, zeros.data()});
    return {};
}

Result<void> causal_recursion(std::span<const CausalTap> taps, float sigma,
                              PlaneView<float> field) {
    return causal_recursion(taps, sigma, {}, field);
}

}  // namespace sateen
#endif
