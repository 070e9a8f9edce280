// SPDX-License-Identifier: Apache-2.0
// The pieces of the Roller: the first tile, cut out of a sample, and those interchangeable
// with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/roller_lattice.hpp"
#include "analysis/roller_seams.hpp"
#include "sateen/analysis/integrate.hpp"
#include "sateen/core/image.hpp"

namespace sateen {

/// Height and its forward differences: what is compared, with weights of 1 / variance, and
/// what is cut. The differences are cut as they are, so that the height which they are
/// integrated to continues across every cut.
struct SlopeStack {
    BasicImage<double> z;
    SlopeField slopes;
    double z_weight = 0;
    double slope_weight = 0;

    [[nodiscard]] double error(std::size_t a, std::size_t b) const {
        const double dz = z.values()[a] - z.values()[b];
        const double dp = slopes.plane(0).data[a] - slopes.plane(0).data[b];
        const double dq = slopes.plane(1).data[a] - slopes.plane(1).data[b];
        return z_weight * dz * dz + slope_weight * (dp * dp + dq * dq);
    }
};

struct RolledTile {
    BasicImage<double> z;
    Seams seams;
};

/// A torus cut out of a sample: a cut down the overlap of columns makes every row periodic,
/// a closed one along the overlap of rows, on that torus, every column.
/// \param height  without tilt, larger than the lattice
[[nodiscard]] RolledTile cut_tile(const BasicImage<double>& height,
                                  const TileLattice& lattice);

/// The same torus, beginning where the border that all tiles will share is plain: a pit or a
/// flat there would be seen again in every tile. Left alone where little stands out, as in
/// regular materials.
void begin_at_plain_border(RolledTile& tile, const TileLattice& lattice);

/// Further tiles, from one that is a torus.
class Interchange {
  public:
    Interchange(const RolledTile& tile, const TileLattice& lattice);

    /// The tile again, its inside replaced by the torus shifted to where it fits best.
    [[nodiscard]] RolledTile another();

  private:
    struct Shift {
        std::size_t row = 0;
        std::size_t col = 0;
    };
    [[nodiscard]] std::size_t shifted(std::size_t r, std::size_t c, Shift shift) const {
        return lattice_.site(r + shift.row, c + shift.col);
    }
    [[nodiscard]] bool is_new(Shift shift) const;
    [[nodiscard]] Shift best_shift() const;
    [[nodiscard]] std::vector<double> band_errors() const;
    [[nodiscard]] double share_of(const std::vector<std::uint8_t>& inside, std::size_t r,
                                  std::size_t c) const;
    void equalise_border(BasicImage<double>& out) const;
    [[nodiscard]] Seams seams_of(const std::vector<std::uint8_t>& inside,
                                 Shift shift) const;

    const RolledTile& tile_;
    TileLattice lattice_;
    std::size_t band_;
    SlopeStack stack_;
    BasicImage<double> salience_;
    BasicImage<double> shown_;         ///< how many tiles show a pixel of the torus
    std::vector<double> band_errors_;  ///< of every shift
    std::vector<Shift> taken_;
};

}  // namespace sateen
