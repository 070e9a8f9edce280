// SPDX-License-Identifier: Apache-2.0
// Light from all directions, from an image.
#pragma once

#include <array>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"
#include "sateen/render/mesh.hpp"

namespace sateen {

/// An equirectangular map of radiance: the top row looks along +z, the middle column
/// along +y; columns go around clockwise seen from above, as panoramas do.
class Environment {
  public:
    /// \param map  (3, rows, cols), linear
    /// \error invalid_argument  not 3 bands, no pixels, negative or not finite, or black
    [[nodiscard]] static Result<Environment> create(Image map);

    [[nodiscard]] Vector3 radiance(const Vector3& direction) const;

    struct Sample {
        Vector3 direction{};
        Vector3 radiance{};
        float density = 0;  ///< probability for a unit of solid angle
    };
    /// A direction with density in proportion to the luminance of its pixel.
    /// \param random  uniform in [0, 1)²
    [[nodiscard]] Sample sample(std::array<float, 2> random) const;
    /// The density of sample() at a direction.
    [[nodiscard]] float density(const Vector3& direction) const;

  private:
    Environment() = default;
    [[nodiscard]] std::array<std::size_t, 2> pixel(const Vector3& direction) const;
    [[nodiscard]] float pixel_density(std::size_t row, std::size_t col) const;
    Image map_;
    std::vector<float> rows_;  ///< cumulative shares of the rows
    std::vector<float> cols_;  ///< cumulative shares within each row
};

}  // namespace sateen
