// SPDX-License-Identifier: Apache-2.0
// Small materials of known fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sateen/material/material.hpp"
#include "support/fields.hpp"

namespace sateen::test {

/// A pyramid whose levels have the field given, with less power the coarser they are.
inline std::vector<Car2d> pyramid_of(const Car2d& field, std::size_t levels) {
    std::vector<Car2d> result;
    for (std::size_t k = 0; k < levels; ++k) {
        Car2d level = field;
        level.variance *= 1 / static_cast<float>(k + 1);
        result.push_back(level);
    }
    return result;
}

/// One plane on all levels.
inline std::vector<Level> levels_of(const std::vector<Car2d>& fields) {
    std::vector<Level> levels;
    for (const Car2d& field : fields) levels.emplace_back().fields.emplace_back(field);
    return levels;
}

/// One band, linear, mean far enough from 0 that nothing is clipped, no curve: the texture
/// is 100 + the field.
inline Subspace plain_subspace(const std::vector<Car2d>& fields) {
    Subspace subspace;
    subspace.spectral = {Tone::linear, {100}, {1}};
    subspace.marginals = {{1, {}}};
    subspace.levels = levels_of(fields);
    return subspace;
}

inline Material plain_material(const std::vector<Car2d>& fields) {
    Material material;
    material.provenance.name = "plain";
    material.sample_rows = 256;
    material.sample_cols = 256;
    material.bands = 1;
    material.subspaces = {plain_subspace(fields)};
    return material;
}

}  // namespace sateen::test
