// SPDX-License-Identifier: Apache-2.0
// Windows out of the middle of an image.
#pragma once

#include <algorithm>
#include <cassert>
#include <utility>

#include "sateen/core/image.hpp"

namespace sateen {

/// The (rows, cols) pixels in the middle; the image itself where that is all of it.
[[nodiscard]] inline Image middle_window(Image image, std::size_t rows,
                                         std::size_t cols) {
    assert(rows <= image.rows() && cols <= image.cols());
    if (rows == image.rows() && cols == image.cols()) return image;
    const std::size_t top = (image.rows() - rows) / 2;
    const std::size_t left = (image.cols() - cols) / 2;
    Image result(image.bands(), rows, cols, uninitialised);
    for (std::size_t band = 0; band < image.bands(); ++band)
        for (std::size_t r = 0; r < rows; ++r)
            std::copy_n(std::as_const(image).plane(band).row(top + r) + left, cols,
                        result.plane(band).row(r));
    return result;
}

}  // namespace sateen
