// SPDX-License-Identifier: Apache-2.0
// Weights of directions, a vector of them at a time. See blend_batch.hpp.
#include "synthesis/blend_batch.hpp"

// With static dispatch (WebAssembly) only the compiler's own target is built.
#ifdef SATEEN_STATIC_DISPATCH
#define HWY_COMPILE_ONLY_STATIC
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "synthesis/direction_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "synthesis/batch_vector-inl.hpp"

#ifndef SATEEN_SYNTHESIS_DIRECTION_BATCH_ONCE
#define SATEEN_SYNTHESIS_DIRECTION_BATCH_ONCE
namespace sateen {

// Rounding of weights at the border between two cells, as DirectionMesh has it.
inline constexpr float kOutsideCell = -1e-5F;
// From the square's start one or two steps are usual.
inline constexpr int kMostSteps = 64;

}  // namespace sateen
#endif

HWY_BEFORE_NAMESPACE();
namespace sateen::HWY_NAMESPACE {
namespace {

struct CellCoordinates {
    Int base;
    Float s0, s1, s2;
};

HWY_INLINE Float word(const DirectionTable& table, Int base, int at) {
    return hn::GatherIndex(DF(), table.cells.data() + at, base);
}

HWY_INLINE Float along(const DirectionTable& table, Int base, int row, Float x, Float y,
                       Float z) {
    return hn::MulAdd(x, word(table, base, row),
                      hn::MulAdd(y, word(table, base, row + 1),
                                 hn::Mul(z, word(table, base, row + 2))));
}

// The walk of DirectionMesh::interpolate, all lanes until the last has arrived.
bool interpolate_lanes(const DirectionTable& table, const VectorBatch& directions,
                       std::size_t count, WeightBatch& out) {
    const DF df;
    const DI di;
    constexpr auto kSide = static_cast<float>(DirectionMesh::kStartSide);
    bool arrived = true;
    for (std::size_t i = 0; i < count; i += hn::Lanes(df)) {
        const Float x = hn::LoadU(df, directions[0].data() + i);
        const Float y = hn::LoadU(df, directions[1].data() + i);
        const Float z = hn::LoadU(df, directions[2].data() + i);
        const Float scale =
            hn::Div(set(0.5F * kSide), hn::Add(set(1), hn::Max(z, hn::Zero(df))));
        const auto square = [&](Float v) {
            const Float at = hn::MulAdd(v, scale, set(0.5F * kSide));
            return hn::ConvertTo(di, hn::Clamp(at, hn::Zero(df), set(kSide - 1)));
        };
        const Int start = hn::Add(
            hn::Mul(square(y), hn::Set(di, DirectionMesh::kStartSide)), square(x));
        Float cell = hn::GatherIndex(df, table.starts.data(), start);
        CellCoordinates at{};
        auto inside = hn::Eq(cell, set(-1));
        for (int step = 0; step < kMostSteps; ++step) {
            at.base = hn::ShiftLeft<4>(hn::ConvertTo(di, cell));
            at.s0 = along(table, at.base, DirectionTable::kRows, x, y, z);
            at.s1 = along(table, at.base, DirectionTable::kRows + 3, x, y, z);
            at.s2 = along(table, at.base, DirectionTable::kRows + 6, x, y, z);
            const Float least = hn::Min(at.s0, hn::Min(at.s1, at.s2));
            inside = hn::Ge(least, set(kOutsideCell));
            if (hn::AllTrue(df, inside)) break;
            const Int corner =
                hn::IfThenElse(hn::RebindMask(di, hn::Eq(least, at.s0)), hn::Zero(di),
                               hn::IfThenElse(hn::RebindMask(di, hn::Eq(least, at.s1)),
                                              hn::Set(di, 1), hn::Set(di, 2)));
            const Float next =
                word(table, hn::Add(at.base, corner), DirectionTable::kNeighbour);
            cell = hn::IfThenElse(inside, cell, next);
        }
        arrived = arrived && hn::AllTrue(df, inside);
        const Float s0 = hn::Max(at.s0, hn::Zero(df));
        const Float s1 = hn::Max(at.s1, hn::Zero(df));
        const Float s2 = hn::Mul(hn::Max(at.s2, hn::Zero(df)),
                                 word(table, at.base, DirectionTable::kThird));
        const Float sum = hn::Add(s0, hn::Add(s1, s2));
        const Float whole = hn::Div(set(1), hn::Max(sum, set(1e-30F)));
        const auto some = hn::Gt(sum, hn::Zero(df));
        hn::StoreU(hn::IfThenElse(some, hn::Mul(s0, whole), set(1)), df,
                   out.weight[0].data() + i);
        hn::StoreU(hn::Mul(s1, whole), df, out.weight[1].data() + i);
        hn::StoreU(hn::Mul(s2, whole), df, out.weight[2].data() + i);
        for (int k = 0; k < 3; ++k)
            hn::StoreU(
                hn::ConvertTo(di, word(table, at.base, DirectionTable::kVertex + k)), di,
                out.index[static_cast<std::size_t>(k)].data() + i);
    }
    return arrived;
}

}  // namespace
}  // namespace sateen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sateen {

HWY_EXPORT(interpolate_lanes);

DirectionTable direction_table(const DirectionMesh& mesh) {
    DirectionTable table;
    for (const std::uint16_t start : mesh.starts())
        table.starts.push_back(static_cast<float>(start));
    for (const DirectionCell& cell : mesh.cells()) {
        for (const std::array<float, 3>& row : cell.row)
            table.cells.insert(table.cells.end(), row.begin(), row.end());
        table.cells.push_back(cell.sector ? 0.0F : 1.0F);
        for (const std::uint16_t next : cell.neighbour)
            table.cells.push_back(static_cast<float>(next));
        for (const std::uint16_t vertex : cell.vertex)
            table.cells.push_back(static_cast<float>(vertex));
    }
    return table;
}

bool interpolate_batch(const DirectionTable& table, const VectorBatch& directions,
                       std::size_t count, WeightBatch& out) {
    return HWY_DYNAMIC_DISPATCH(interpolate_lanes)(table, directions, count, out);
}

}  // namespace sateen
#endif
