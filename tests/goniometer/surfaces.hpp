// SPDX-License-Identifier: Apache-2.0
// Surfaces and helpers for the tests of the goniometer.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "sateen/goniometer/goniometer.hpp"

namespace sateen::test {

inline Image filled(std::size_t bands, std::size_t rows, std::size_t cols, float value) {
    Image image(bands, rows, cols);
    std::fill(image.values().begin(), image.values().end(), value);
    return image;
}

/// Of one grey, heights from `height(x, y)` at texel centres, x and y in pixels of an
/// image of `pixels` a side; y goes up and is negative.
template <class F>
SurfaceMaps grey_surface(std::size_t texels, float pixels, float albedo,
                         const F& height) {
    SurfaceMaps surface{Image(1, texels, texels),
                        {},
                        filled(3, texels, texels, albedo),
                        filled(1, texels, texels, 0.5F)};
    const float cell = pixels / static_cast<float>(texels);
    for (std::size_t r = 0; r < texels; ++r)
        for (std::size_t c = 0; c < texels; ++c)
            surface.height(0, r, c) = height((static_cast<float>(c) + 0.5F) * cell,
                                             -(static_cast<float>(r) + 0.5F) * cell);
    return surface;
}

/// A Lambertian goniometer of direct light.
inline GoniometerOptions lambertian(std::size_t side) {
    GoniometerOptions options;
    options.rows = options.cols = side;
    options.specular = false;
    options.gather_rays = 0;
    return options;
}

/// One image, with one light.
inline Image image_of(const SurfaceMaps& surface, const GoniometerOptions& options,
                      Direction view, Direction light) {
    SerialExecutor executor;
    auto goniometer = Goniometer::create(surface, {light}, options, executor);
    if (!goniometer) {
        ADD_FAILURE() << goniometer.error().message;
        return {};
    }
    Image result;
    const std::size_t first = 0;
    const Result<void> measured = goniometer->measure(
        view, {&first, 1},
        [&](std::size_t, const Image& image) -> Result<void> {
            result = image;
            return {};
        },
        executor, Progress());
    if (!measured) ADD_FAILURE() << measured.error().message;
    return result;
}

}  // namespace sateen::test
