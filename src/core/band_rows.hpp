// SPDX-License-Identifier: Apache-2.0
// The row kernels of band_split.hpp and of band modulation, in vectors of any width: the
// same bits at a site wherever it lies in a row. Theory: docs/theory/band_modulation.md.
#pragma once

#include <array>
#include <cstddef>

namespace sateen {

/// line(x) = Σ_j w_j rows[j](x), w = [1 4 6 4 1]/16; of the squares of the rows if asked.
void smooth_rows(const float* const rows[5], bool squared, float* line,
                 std::size_t count);
/// out(x) = Σ_j w_j line(x + j·spacing), x < count. \param rest  none, or takes in - out
void smooth_columns(const float* line, std::size_t spacing, const float* in, float* rest,
                    float* out, std::size_t count);

/// A curve over 8 equally spaced knots: linear between, constant outside. The arrays are as
/// long as the longest vector that looks up in them.
struct KnotTable {
    std::array<float, 16> value{};
    std::array<float, 16> rise{};  ///< to the next knot
    float first = 0;               ///< abscissa of knot 0
    float per_unit = 0;            ///< knots for one unit of the abscissa
};

/// What one row of a band is multiplied by. Absent: null.
///
///     u = h + c_v(v·value_scale) + c_p(½ L(E_p·parent_scale)) + c_f(½ L(E_f·first_scale))
///     band ← gain · P(u) · band,   low ← low + band
///
/// L(2^e (1 + m)) = e + m is the binary logarithm, linear between powers of two, and P its
/// inverse.
struct ModulatedRow {
    float* band = nullptr;
    float* low = nullptr;           ///< v
    const float* field = nullptr;   ///< h
    const float* parent = nullptr;  ///< E_p
    const float* first = nullptr;   ///< E_f
    const KnotTable* of_value = nullptr;
    const KnotTable* of_parent = nullptr;
    const KnotTable* of_first = nullptr;
    float value_scale = 0;
    float parent_scale = 0;
    float first_scale = 0;
    float gain = 1;
};
void modulate_row(const ModulatedRow& row, std::size_t count);

/// Energies are taken above this part of the mean, so that they have a logarithm.
inline constexpr float kEnergyFloor = 1e-3F;

/// out = ½ L(energy·scale + kEnergyFloor)
void log_amplitude_row(const float* energy, float scale, float* out, std::size_t count);

}  // namespace sateen
