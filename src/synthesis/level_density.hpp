// SPDX-License-Identifier: Apache-2.0
// Spectral densities of the fields of one level, row by row.
// Theory: docs/theory/spectral_synthesis.md, docs/theory/car3d.md.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sateen/material/field_model.hpp"
#include "synthesis/hermitian_matrix.hpp"
#include "synthesis/trigonometric_row.hpp"

namespace sateen {

/// The densities of all fields of a level that draw planes [plane, plane + planes), as the
/// matrix of these planes: element (i, j) is row `planes` i + j, Re S_ij for i <= j, Im S_ji
/// for i > j.
class LevelDensity {
  public:
    /// \param planes  1 or 3
    /// \param rows    frequencies 2π m / rows; kept by reference
    LevelDensity(const std::vector<FieldModel>& fields, std::size_t plane,
                 std::size_t planes, const Frequencies& rows, const Frequencies& cols);

    /// out ← out + S(2π m / rows, 2π n / cols) for n = 0 … ⌊cols/2⌋, and the same of the row
    /// at -ω1, which has most of the work in common.
    /// \param out       padded_columns(⌊cols/2⌋ + 1) elements each, all of them written
    /// \param mirrored  as out; null where the row is its own mirror image
    /// \cost  for each coefficient column and frequency 2 multiply-adds an element (Markov
    /// fields: 1); for 3 planes 170 operations more
    void add_rows(std::size_t m, const HermitianRows<float>& out,
                  const HermitianRows<float>& mirrored) const;

  private:
    void add(const FieldModel& field, std::size_t plane);

    struct Single {
        TrigonometricPolynomials<1> denominator;
        float variance = 0;
        bool squared = true;  ///< S = σ²/|P|², else σ²/P
        std::size_t element = 0;
    };
    struct Joint {
        TrigonometricPolynomials<9> Lambda;
        std::array<float, 9> F{};  ///< Σ = F Fᵀ
    };
    std::vector<Single> singles_;
    std::optional<Joint> joint_;
    ColumnTables tables_;
    std::size_t planes_;
    const Frequencies& rows_;
    std::size_t count_;
};

}  // namespace sateen
