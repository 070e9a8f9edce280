// SPDX-License-Identifier: Apache-2.0
// Blends of many views and lights at a time, in vectors. Partner: interpolate.cpp.
// Theory: docs/theory/evaluation.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sateen/core/direction_mesh.hpp"
#include "sateen/material/material.hpp"
#include "sateen/material/reflectance.hpp"
#include "sateen/synthesis/interpolate.hpp"

namespace sateen {

/// Points that are handled together; a multiple of the floats in any vector.
inline constexpr std::size_t kBatch = 64;
using BatchLane = std::array<float, kBatch>;

/// A DirectionMesh as vectors read it, a cell in one line of the cache. All numbers are
/// floats: they are below 2^24.
struct DirectionTable {
    enum Word { kRows = 0, kThird = 9, kNeighbour = 10, kVertex = 13, kWords = 16 };
    std::vector<float> cells;
    std::vector<float> starts;
};
[[nodiscard]] DirectionTable direction_table(const DirectionMesh& mesh);

/// What blends are made from; by pair (lights, views), by light and by subspace.
struct BlendTables {
    DirectionTable views;
    DirectionTable lights;
    std::size_t view_count = 0;
    std::vector<std::int32_t> subspace;
    std::vector<EncodedAppearance> encoded;  // empty without a reflectance
    std::vector<float> cosine;               // of the lights, and its cube root
    std::vector<float> cosine_root;
    /// Covariances with all subspaces; mean of the bands and of the luminance Y; Y times
    /// TextureMoments::shape. All that is linear in the weights of a blend.
    enum Column {
        kCovariance = 0,
        kMean = kMaxSubspaces,
        kShape = kMean + 4,
        kRow = kShape + 4
    };
    static_assert(kMaxSubspaces % 4 == 0);
    std::vector<std::array<float, kRow>> rows;
    std::size_t bands = 0;
    bool cosine_included = true;
};

using VectorBatch = std::array<BatchLane, 3>;

/// Views and lights, unit vectors. Lanes up to the next multiple of 16 hold some as well.
struct DirectionBatch {
    std::size_t count = 0;
    VectorBatch view;
    VectorBatch light;
};

/// Weights of three directions each.
struct WeightBatch {
    std::array<std::array<std::int32_t, kBatch>, 3> index;
    VectorBatch weight;
};

/// Blends, as Blend holds one.
struct BlendBatch {
    std::array<std::uint8_t, kBatch> count;
    std::array<std::array<std::uint8_t, Blend::kMost>, kBatch> subspace;
    std::array<std::array<float, Blend::kMost>, kBatch> weight;
    VectorBatch gain;
    VectorBatch offset;
    BatchLane power;
};

/// Factors by which textures are multiplied, as FactorShape.
struct FactorBatch {
    BatchLane square;
    BatchLane root;
};

/// DirectionMesh::interpolate of the first `count` directions.
/// \return false if a walk did not end: some weights are then not finite
[[nodiscard]] bool interpolate_batch(const DirectionTable& table,
                                     const VectorBatch& directions, std::size_t count,
                                     WeightBatch& out);

/// Blends of weighted views and lights.
void blend_batch(const BlendTables& tables, const WeightBatch& views,
                 const WeightBatch& lights, const BatchLane& light_height,
                 const FactorBatch& factors, std::size_t count, BlendBatch& out);

/// The blended textures, (subspaces, side, side, 4), at (u, v) as ShadingPoint has them.
void texture_batch(const float* texels, std::size_t side, const BlendBatch& blends,
                   const BatchLane& u, const BatchLane& v, std::size_t count,
                   VectorBatch& out);

/// value = max(0, offset + gain x^power), x ≥ 0, in place.
void shape_batch(const BlendBatch& blends, std::size_t count, VectorBatch& x);

}  // namespace sateen
