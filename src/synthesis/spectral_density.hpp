// SPDX-License-Identifier: Apache-2.0
// Spectral densities of fields and of whole pyramids of them: a field is its spectral
// density. Theory: docs/theory/spectral_synthesis.md. Partner: analysis/autocovariance.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/field_model.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// The field of one plane on levels [first, end) of a pyramid; or of `planes` planes from
/// `plane` on, where a field draws them together.
struct PlaneField {
    std::span<const Level> levels;
    std::size_t plane = 0;
    /// Size of the measured sample on the lattice of the finest level here.
    double sample_rows = 0;
    double sample_cols = 0;
    std::size_t planes = 1;

    /// The field that draws the (first) plane.
    [[nodiscard]] const FieldModel& field(std::size_t level) const {
        const auto& fields = levels[level].fields;
        return fields[plane < fields.size() ? plane : 0];
    }
    /// The part of the pyramid from `level` on, as a pyramid of its own.
    [[nodiscard]] PlaneField coarser(std::size_t level) const {
        const double factor = std::ldexp(1.0, static_cast<int>(level));
        return {levels.subspan(level), plane, sample_rows / factor, sample_cols / factor,
                planes};
    }
    [[nodiscard]] PlaneField finer(std::size_t level) const {
        return {levels.first(level), plane, sample_rows, sample_cols, planes};
    }
};

/// The spectral density of the collapsed pyramid on the frequencies of a (rows, cols)
/// torus,
///
///     E_k(ω) = S_k(ω) + 4 W²(ω) E_{k+1}(2ω),    W the transfer function of the kernel,
///
/// n = 0 … ⌊cols/2⌋. Levels drawn independently have exactly this density on average.
/// Any size; odd ones evaluate the coarser levels at the doubled frequencies.
/// \returns  (1, rows, ⌊cols/2⌋ + 1); for d planes (d², …) the Hermitian matrix E: element
///           (i, j) is Re E_ij for i ≤ j, Im E_ji for i > j
/// \cost  about 10 multiply-adds a frequency and level; about 300 for 3 planes
[[nodiscard]] Image spectral_density(const PlaneField& field, std::size_t rows,
                                     std::size_t cols, Executor& executor);

/// Takes away what the sample could not show: wavelengths longer than itself. The
/// sample's own frequencies are multiples of 2π/M and 2π/N, its mean was removed, so the
/// density is 0 at the origin and interpolated from there to the nearest frequencies,
///
///     E(ω) ← E(ω) (1 - Δ(ω1 M/2π) Δ(ω2 N/2π)),    Δ(x) = max(0, 1 - |x|).
///
/// A model extrapolates there: near a unit root, into clouds larger than the sample.
void suppress_unmeasured(const PlaneField& field, PlaneView<float> density,
                         std::size_t cols);

/// The mean of a density over the whole torus: the variance of the field.
[[nodiscard]] double mean_density(PlaneView<const float> density, std::size_t cols);

}  // namespace sateen
