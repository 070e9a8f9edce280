// SPDX-License-Identifier: Apache-2.0
// Range maps of materials, with random contents, from a seed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

#include "sateen/material/surface.hpp"

namespace sateen::test {

struct RandomSurfaceOptions {
    std::uint64_t seed = 1;
    std::uint32_t rows = 11;
    std::uint32_t cols = 13;
    std::uint32_t shear_px = 0;
    std::size_t tiles = 2;
    std::uint16_t largest_code = 0xFFFF;
};

inline Surface random_surface(const RandomSurfaceOptions& options = {}) {
    std::mt19937_64 engine(options.seed);
    Surface out{options.rows,
                options.cols,
                options.shear_px,
                -1.5F,
                1.0F / 256,
                false,
                0.25F,
                {}};
    out.tiles.resize(options.tiles);
    for (auto& tile : out.tiles)
        for (std::size_t i = 0; i < std::size_t{options.rows} * options.cols; ++i)
            tile.push_back(static_cast<std::uint16_t>(
                engine() % (std::uint64_t{options.largest_code} + 1)));
    return out;
}

}  // namespace sateen::test
