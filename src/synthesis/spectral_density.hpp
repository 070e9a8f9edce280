// SPDX-License-Identifier: Apache-2.0
// Spectral densities of fields and of whole pyramids of them: a field is its spectral
// density. Theory: docs/theory/spectral_synthesis.md. Partner: analysis/autocovariance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sateen/core/fft.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/material/field_model.hpp"
#include "sateen/material/material.hpp"
#include "synthesis/hermitian_matrix.hpp"
#include "synthesis/level_density.hpp"

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

/// The planes of a subspace: each alone, or all together where a field draws them so.
[[nodiscard]] std::vector<PlaneField> independent_fields(const Material& material,
                                                         const Subspace& subspace);

/// Rows of the matrices of d planes, of their mirror images, and of the coarser level that they
/// come from.
class DensityScratch {
  public:
    /// \param coarse_count  columns of the coarser level, 0 where none is needed
    DensityScratch(std::size_t planes, std::size_t count, std::size_t coarse_count);
    [[nodiscard]] const HermitianRows<float>& rows() const { return rows_; }
    [[nodiscard]] const HermitianRows<float>& mirrored() const { return mirrored_; }

  private:
    friend class SpectralDensity;
    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    Image values_;
    HermitianRows<float> rows_{};
    HermitianRows<float> mirrored_{};
    Image coarse_values_;
    HermitianRows<float> coarse_{};
    HermitianRows<float> coarse_mirrored_{};
    std::size_t coarse_row_ = kNone;
};

/// The rows 0 … ⌊rows/2⌋ of which the others are mirror images, those that need the same rows
/// of the coarser level together: m and rows/2 - m, whose doubles are mirror images.
[[nodiscard]] std::vector<std::size_t> rows_in_step(std::size_t rows);

/// The spectral density of the collapsed pyramid on the frequencies of a (rows, cols)
/// torus,
///
///     E_k(ω) = S_k(ω) + 4 W²(ω) E_{k+1}(2ω),    W the transfer function of the kernel,
///
/// n = 0 … ⌊cols/2⌋, row by row: the two finest levels, 15 parts in 16 of the work, are never
/// held. Any size; odd ones evaluate the coarser levels at the doubled frequencies.
class SpectralDensity {
  public:
    SpectralDensity(const PlaneField& field, std::size_t rows, std::size_t cols,
                    Executor& executor);
    SpectralDensity(const SpectralDensity&) = delete;
    SpectralDensity& operator=(const SpectralDensity&) = delete;
    ~SpectralDensity() = default;

    /// The row at -ω1.
    [[nodiscard]] std::size_t mirror(std::size_t m) const {
        return m == 0 ? 0 : rows_.size() - m;
    }
    /// body(m, E) for every row, in memory that it may change; mirror(m) right after
    /// m = 0 … ⌊rows/2⌋ on the same thread.
    template <class Body>
    void for_each_row(Executor& executor, const Body& body) const {
        const std::vector<std::size_t> order = rows_in_step(rows_.size());
        const std::size_t ranges = std::min(order.size(), ranges_of(executor));
        parallel_for(executor, ranges, [&](std::size_t range) {
            DensityScratch scratch = this->scratch();
            for (std::size_t i = range * order.size() / ranges;
                 i < (range + 1) * order.size() / ranges; ++i) {
                const std::size_t m = order[i];
                const bool both = mirror(m) != m;
                rows(m, scratch.rows(),
                     both ? scratch.mirrored() : HermitianRows<float>{}, scratch);
                body(m, scratch.rows());
                if (both) body(mirror(m), scratch.mirrored());
            }
        });
    }

  private:
    enum class Coarser { streamed, held };
    SpectralDensity(const PlaneField& field, std::size_t rows, std::size_t cols,
                    Coarser coarser, Executor& executor);
    [[nodiscard]] DensityScratch scratch() const;
    /// Rows m and mirror(m).
    /// \param out       for d planes d² rows of padded_columns(⌊cols/2⌋ + 1), written; element
    ///                  (i, j) of the matrix E is row d i + j, Re E_ij for i ≤ j, Im E_ji for
    ///                  i > j
    /// \param mirrored  as out; null where m is its own mirror image
    void rows(std::size_t m, const HermitianRows<float>& out,
              const HermitianRows<float>& mirrored, DensityScratch& scratch) const;
    struct CoarseRows {
        HermitianRows<const float> direct;
        HermitianRows<const float> mirrored;
    };
    /// The rows of the coarser level that row m comes from.
    [[nodiscard]] CoarseRows coarse_rows(std::size_t m, DensityScratch& scratch) const;
    void start_row(std::size_t m, const HermitianRows<float>& out,
                   DensityScratch& scratch) const;

    Frequencies rows_;
    Frequencies cols_;
    LevelDensity finest_;
    std::size_t planes_;
    std::unique_ptr<SpectralDensity> coarser_;  ///< E_{k+1}; null where there is none
    Image coarse_;  ///< its rows, d², its columns, where they are held
    std::vector<float> row_gain_;
    std::vector<float> col_gain_;
};

/// All rows. \returns  (d², rows, ⌊cols/2⌋ + 1)
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
/// One row of a torus.
void suppress_unmeasured(const PlaneField& field, std::size_t m, std::size_t rows,
                         std::size_t cols, std::span<float> density);

/// The mean of a density over the whole torus: the variance of the field.
[[nodiscard]] double mean_density(PlaneView<const float> density, std::size_t cols);

}  // namespace sateen
