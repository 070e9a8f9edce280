// SPDX-License-Identifier: Apache-2.0
// The spectral density of a smooth field. Theory: docs/theory/periodic_layer.md.
#pragma once

#include <cstddef>

#include "sateen/core/image.hpp"
#include "sateen/material/structure.hpp"

namespace sateen {

/// E(ω) of a smooth field on the half spectrum of a (rows, cols) torus, by the transform of
/// a bell, Σ_r exp(-r²/4s²) e^{-iωr} ≈ 2√π s exp(-s²ω²), exact to 10⁻⁴ for s ≥ 1.
/// \param scale_rows  sites of the torus for one site of the field, as are scale_cols
[[nodiscard]] Image smooth_density(const SmoothField& field, std::size_t rows,
                                   std::size_t cols, double scale_rows,
                                   double scale_cols);

}  // namespace sateen
