// SPDX-License-Identifier: Apache-2.0
// Yarns seen from above: what of bent tubes is uppermost at every texel of a torus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sateen::goniometer {

/// A point of a yarn's axis, in units of the width of the torus; y goes down.
struct AxisPoint {
    float x = 0;
    float y = 0;
    float z = 0;
};

/// What is uppermost at a texel.
struct Uppermost {
    float z = -1e9F;
    float along = 0;   ///< length of the axis from its beginning
    float across = 0;  ///< -1 to 1 from the left to the right edge
    std::int32_t yarn = -1;
};

class TubeCanvas {
  public:
    explicit TubeCanvas(std::size_t side) : side_(side), texels_(side * side) {}

    /// Draws a tube of elliptic cross-section along straight pieces of axis.
    /// \param flatness  height over width of the cross-section
    void draw(std::int32_t yarn, std::span<const AxisPoint> axis, float radius,
              float flatness);

    [[nodiscard]] std::size_t side() const { return side_; }
    [[nodiscard]] const Uppermost& at(std::size_t row, std::size_t col) const {
        return texels_[row * side_ + col];
    }

  private:
    void stamp(std::int32_t yarn, const AxisPoint& centre, float direction_x,
               float direction_y, float along, float radius, float flatness);
    std::size_t side_;
    std::vector<Uppermost> texels_;
};

}  // namespace sateen::goniometer
