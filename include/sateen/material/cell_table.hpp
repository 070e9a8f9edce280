// SPDX-License-Identifier: Apache-2.0
// The cells of a periodic layer decoded into a table: analysis and synthesis must read the
// same numbers from them. Theory: docs/theory/periodic_layer.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sateen/material/material.hpp"
#include "sateen/material/structure.hpp"

namespace sateen {

/// ⌊x⌋ of |x| < 2⁶³: without SSE 4.1 std::floor is a call, and this is done per pixel.
[[nodiscard]] inline double whole_part(double x) {
    const auto below = static_cast<double>(static_cast<std::int64_t>(x));
    return below > x ? below - 1 : below;
}

/// x = B u and back, in double: windows may be far from the origin.
class LatticeMap {
  public:
    LatticeMap() : LatticeMap({1, 0}, {0, 1}) {}
    LatticeMap(std::array<double, 2> a, std::array<double, 2> b) : a_(a), b_(b) {
        const double det = a[0] * b[1] - a[1] * b[0];
        inverse_ = {b[1] / det, -b[0] / det, -a[1] / det, a[0] / det};
    }
    explicit LatticeMap(const PeriodicLayer& layer)
        : LatticeMap({static_cast<double>(layer.a[0]), static_cast<double>(layer.a[1])},
                     {static_cast<double>(layer.b[0]), static_cast<double>(layer.b[1])}) {
    }

    /// B⁻¹ x
    [[nodiscard]] std::array<double, 2> to_cell(double row, double col) const {
        return {inverse_[0] * row + inverse_[1] * col,
                inverse_[2] * row + inverse_[3] * col};
    }
    [[nodiscard]] const std::array<double, 2>& a() const { return a_; }
    [[nodiscard]] const std::array<double, 2>& b() const { return b_; }

  private:
    std::array<double, 2> a_;
    std::array<double, 2> b_;
    std::array<double, 4> inverse_{};
};

/// m, s and l of up to three planes, sampled twice as finely as the cell, and read linearly
/// between the samples.
class CellTable {
  public:
    static constexpr std::size_t kPlanes = 3;
    static constexpr std::size_t kMixing = 2 * kPlanes;  ///< the first l
    static constexpr std::size_t kValues = kMixing + kPlanes * (kPlanes - 1) / 2;
    static constexpr std::size_t kOversampling = 2;

    using Values = std::array<float, kValues>;

    CellTable(const PeriodicLayer& layer, std::span<const PeriodicCell> cells);

    /// Where l_ij, j < i, is among the values.
    [[nodiscard]] static constexpr std::size_t mixing(std::size_t i, std::size_t j) {
        return kMixing + i * (i - 1) / 2 + j;
    }

    /// m of the planes, then s, then l, at (u, v): any numbers, taken mod 1.
    [[nodiscard]] Values at(double u, double v) const {
        const double r = (u - whole_part(u)) * static_cast<double>(rows_);
        const double c = (v - whole_part(v)) * static_cast<double>(cols_);
        auto row = static_cast<std::size_t>(r);
        auto col = static_cast<std::size_t>(c);
        const auto dr = static_cast<float>(r - static_cast<double>(row));
        const auto dc = static_cast<float>(c - static_cast<double>(col));
        // What rounds up to 1 is 0.
        if (row >= rows_) row = 0;
        if (col >= cols_) col = 0;
        const std::size_t below = row + 1 == rows_ ? 0 : row + 1;
        const std::size_t right = col + 1 == cols_ ? 0 : col + 1;
        const float* top_left = site(row, col);
        const float* top_right = site(row, right);
        const float* bottom_left = site(below, col);
        const float* bottom_right = site(below, right);
        const float w00 = (1 - dr) * (1 - dc);
        const float w01 = (1 - dr) * dc;
        const float w10 = dr * (1 - dc);
        const float w11 = dr * dc;
        Values result;
        for (std::size_t i = 0; i < kValues; ++i)
            result[i] = w00 * top_left[i] + w01 * top_right[i] + w10 * bottom_left[i] +
                        w11 * bottom_right[i];
        return result;
    }
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] std::size_t cols() const { return cols_; }
    /// The values of one sample.
    [[nodiscard]] const float* site(std::size_t row, std::size_t col) const {
        return values_.data() + (row * cols_ + col) * kValues;
    }

  private:
    void fill_means(std::size_t plane, const PeriodicLayer& layer,
                    const PeriodicCell& cell);
    void fill_deviations(std::size_t plane, const PeriodicLayer& layer,
                         const PeriodicCell& cell);
    void fill_mixing(std::size_t plane, const PeriodicLayer& layer,
                     const PeriodicCell& cell);
    /// Sets a value of all samples from a (P, Q) grid, read linearly between its sites.
    template <class Grid>
    void fill_from(std::size_t P, std::size_t Q, std::size_t value, const Grid& grid);

    std::size_t rows_;
    std::size_t cols_;
    std::vector<float> values_;
};

/// The deviation of m(u) + s(u) q(g) + Σ l(u) q(g), u uniform, of every plane of a subspace
/// of a material with a structure: what its pattern and its residual have together.
[[nodiscard]] std::vector<float> plane_deviations(const Structure& structure,
                                                  const Subspace& subspace);

/// c(x)
[[nodiscard]] float apply(const ToneCurve& curve, float x);

}  // namespace sateen
