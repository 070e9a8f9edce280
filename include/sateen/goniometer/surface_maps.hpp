// SPDX-License-Identifier: Apache-2.0
// A surface with known height, normals, colour and roughness, on a torus.
#pragma once

#include <cstddef>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// Maps of one size, toroidal: the surface repeats in rows and in columns. x goes right
/// (columns), y up (minus rows), z out of the surface.
struct SurfaceMaps {
    Image height;  ///< (1, M, N) in pixels of the measured images, any origin
    Image normal;  ///< (3, M, N) unit vectors in place of those of the height; or empty
    Image colour;  ///< (3, M, N) diffuse albedo, linear, 0 to 1
    Image roughness;  ///< (1, M, N) 0 to 1, the square root of GGX's α
};

/// \error invalid_argument  a map is empty, of another size or shape, or not finite
[[nodiscard]] Result<void> validate(const SurfaceMaps& surface);

/// Unit normals of a toroidal height field by central differences.
/// \param height    (1, M, N) in pixels
/// \param cell_x    columns of the measured image that a column of the map is wide
/// \param cell_y    the same of rows
[[nodiscard]] Image normals_of(const Image& height, float cell_x, float cell_y);

/// Every plane at another size: means over the area of each new pixel, toroidal linear
/// interpolation where pixels become smaller.
[[nodiscard]] Image resample(const Image& image, std::size_t rows, std::size_t cols);

}  // namespace sateen
