// SPDX-License-Identifier: Apache-2.0
// Textures made from a seed, linear, in colour.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "sateen/core/colour.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"

namespace sateen::test {

/// Opaque discs of random colour, place and size, each hiding what is below: edges, hence
/// far from Gaussian.
inline Image discs(std::size_t rows, std::size_t cols, std::uint32_t seed) {
    Image image(3, rows, cols);
    constexpr double kLargest = 9;
    const auto count =
        static_cast<std::uint32_t>(static_cast<double>(rows * cols) / 12.0) + 400;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto words = philox4x32_10({i, 0, 0, 0}, {seed, 0});
        const auto more = philox4x32_10({i, 1, 0, 0}, {seed, 0});
        const auto unit = [](std::uint32_t word) {
            return static_cast<double>(word) * 0x1p-32;
        };
        const double row =
            unit(words[0]) * (static_cast<double>(rows) + 2 * kLargest) - kLargest;
        const double col =
            unit(words[1]) * (static_cast<double>(cols) + 2 * kLargest) - kLargest;
        const double radius = 2 + (kLargest - 2) * unit(words[2]) * unit(words[2]);
        const double shade = 0.25 + 0.5 * unit(words[3]);
        const std::array<double, 3> code = {shade + 0.15 * unit(more[0]), 0.9 * shade,
                                            0.7 * shade + 0.1 * unit(more[1])};
        const auto first = [](double x) {
            return static_cast<std::size_t>(std::max(0.0, std::ceil(x)));
        };
        const auto end = [](double x, std::size_t side) {
            return static_cast<std::size_t>(
                std::clamp(std::floor(x) + 1, 0.0, static_cast<double>(side)));
        };
        for (std::size_t r = first(row - radius); r < end(row + radius, rows); ++r) {
            for (std::size_t c = first(col - radius); c < end(col + radius, cols); ++c) {
                if (std::hypot(static_cast<double>(r) - row,
                               static_cast<double>(c) - col) > radius)
                    continue;
                for (std::size_t b = 0; b < 3; ++b) {
                    image(b, r, c) = static_cast<float>(srgb_decode(code[b]));
                }
            }
        }
    }
    return image;
}

/// A plain weave of threads `period` pixels wide under a little grain.
inline Image weave(std::size_t rows, std::size_t cols, double period,
                   std::uint64_t seed) {
    Image image(3, rows, cols);
    constexpr double kTau = 2 * std::numbers::pi;
    for (std::size_t r = 0; r < rows; ++r) {
        std::array<Image, 3> grain = {Image(1, 1, cols), Image(1, 1, cols),
                                      Image(1, 1, cols)};
        for (std::uint32_t b = 0; b < 3; ++b) {
            draw_normals({seed, b}, static_cast<std::int32_t>(r), 0, grain[b].values());
        }
        for (std::size_t c = 0; c < cols; ++c) {
            const double warp = std::sin(kTau * static_cast<double>(c) / period);
            const double weft = std::sin(kTau * static_cast<double>(r) / period);
            const double over = std::max(warp, weft);
            const std::array<double, 3> code = {
                0.55 + 0.15 * over, 0.45 + 0.12 * over,
                0.35 + 0.2 * (warp > weft ? warp : 0.3 * weft)};
            for (std::size_t b = 0; b < 3; ++b) {
                image(b, r, c) = static_cast<float>(
                    srgb_decode(code[b] + 0.03 * static_cast<double>(grain[b](0, 0, c))));
            }
        }
    }
    return image;
}

/// Grey of lightness `mean` + `deviation` N(0, 1), independent pixels.
inline Image grey_noise(std::size_t rows, std::size_t cols, double mean, double deviation,
                        std::uint64_t seed) {
    Image image(1, rows, cols);
    for (std::size_t r = 0; r < rows; ++r) {
        draw_normals({seed, 0}, static_cast<std::int32_t>(r), 0,
                     {image.plane(0).row(r), cols});
    }
    for (float& v : image.values()) {
        const double f = (mean + deviation * static_cast<double>(v) + 16) / 116;
        v = static_cast<float>(f * f * f);
    }
    return image;
}

}  // namespace sateen::test
