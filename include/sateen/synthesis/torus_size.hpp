// SPDX-License-Identifier: Apache-2.0
// Tori on which the lattice of a material closes. Theory: docs/theory/periodic_layer.md.
#pragma once

#include <cstddef>

#include "sateen/material/material.hpp"

namespace sateen {

struct TorusSize {
    std::size_t rows = 0;
    std::size_t cols = 0;
    /// ‖B' B⁻¹ - I‖, B' the nearest lattice that closes on the torus: how much the pattern is
    /// stretched where it is most. 0 for a material without a pattern.
    double strain = 0;
};

/// The strain of a tileable texture of a size.
[[nodiscard]] TorusSize torus_of(const Material& material, std::size_t rows,
                                 std::size_t cols);

/// Of the sizes that differ by at most an eighth, and 256 pixels, the one with the least strain + 0.02 times
/// the relative change.
[[nodiscard]] TorusSize best_torus(const Material& material, std::size_t rows,
                                   std::size_t cols);

}  // namespace sateen
