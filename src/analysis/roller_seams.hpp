// SPDX-License-Identifier: Apache-2.0
// How visible the seams of tiles are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/roller_lattice.hpp"
#include "sateen/core/image.hpp"

namespace sateen {

/// Where neighbours of a tile were no neighbours in the sample: from a pixel to the right, and
/// down, 1 or 0.
struct Seams {
    std::vector<std::uint8_t> right;
    std::vector<std::uint8_t> down;
};

/// Root mean square step across seams over that of all other neighbours in the same direction,
/// of height and of the normals derived from it by central differences.
class SeamRatios {
  public:
    void add(const BasicImage<double>& tile, const TileLattice& lattice,
             const Seams& seams);
    [[nodiscard]] double height() const { return height_.value(); }
    [[nodiscard]] double normals() const { return normals_.value(); }

  private:
    struct Steps {
        double square = 0;
        std::size_t count = 0;
        void add(double squared) {
            square += squared;
            ++count;
        }
        [[nodiscard]] double mean() const {
            return count > 0 ? square / static_cast<double>(count) : 0;
        }
    };
    /// Of one map, across and down.
    struct Map {
        Steps seam[2];
        Steps inside[2];
        [[nodiscard]] double value() const;
    };
    Map height_;
    Map normals_;
};

}  // namespace sateen
