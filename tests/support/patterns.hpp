// SPDX-License-Identifier: Apache-2.0
// Patterns that repeat, made in code, with the lattice that each has. Linear, in colour.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "sateen/core/colour.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"

namespace sateen::test {

using Colour = std::array<double, 3>;  ///< encoded, 0 … 1

/// A pattern: the colour of a point, and the vectors (row, column) that repeat it.
struct Pattern {
    std::string name;
    std::array<double, 2> a;
    std::array<double, 2> b;
    std::function<Colour(double row, double col)> colour;
};

/// A number in [0, 1) for an index of two parts.
inline double hash_unit(std::int64_t i, std::int64_t j, std::uint32_t salt) {
    const auto words = philox4x32_10(
        {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), salt, 0}, {77, 5});
    return static_cast<double>(words[0]) * 0x1p-32;
}

namespace detail {

inline double fraction(double x) {
    return x - std::floor(x);
}
/// 0 below, 1 above, over a pixel or so.
inline double step(double x, double width) {
    return 0.5 + 0.5 * std::tanh(x / width);
}
inline Colour mixed(const Colour& a, const Colour& b, double share) {
    Colour result{};
    for (std::size_t i = 0; i < 3; ++i) result[i] = a[i] + share * (b[i] - a[i]);
    return result;
}

}  // namespace detail

/// Running bond: bricks of 48 x 22 with joints of 4. \param spread  of their shades
inline Pattern brick(double spread = 0) {
    constexpr double kRow = 26;
    constexpr double kCol = 52;
    return {"brick", {kRow, kCol / 2}, {0, kCol}, [=](double row, double col) {
                const double i = std::floor(row / kRow);
                const double x = col / kCol - i / 2;
                const double j = std::floor(x);
                const double down = std::abs(row / kRow - i - 0.5) * kRow;
                const double across = std::abs(x - j - 0.5) * kCol;
                const double inside =
                    detail::step(11 - down, 0.7) * detail::step(24 - across, 0.7);
                const double shade =
                    1 + spread * (2 * hash_unit(static_cast<std::int64_t>(i),
                                                static_cast<std::int64_t>(j), 1) -
                                  1);
                return detail::mixed({0.72, 0.7, 0.66},
                                     {0.55 * shade, 0.25 * shade, 0.18 * shade}, inside);
            }};
}

/// Stockinette: columns of V-shaped stitches.
inline Pattern knit() {
    constexpr double kRow = 14.5;
    constexpr double kCol = 19.3;
    return {"knit", {kRow, 0}, {0, kCol}, [=](double row, double col) {
                const double x = detail::fraction(col / kCol) - 0.5;
                const double y = row / kRow + 1.4 * std::abs(x);
                const double along = 0.5 + 0.5 * std::cos(2 * std::numbers::pi * y);
                const double thick = std::cos(std::numbers::pi * x) *
                                     std::abs(std::sin(2 * std::numbers::pi * x));
                const double light = 0.15 + 0.6 * std::sqrt(along) * (0.3 + thick);
                return Colour{0.3 * light, 0.55 * light, 0.9 * light};
            }};
}

/// 2/2 twill: warp over two wefts, one further each row. Threads 5.6 apart.
inline Pattern twill() {
    constexpr double kThread = 5.6;
    return {"twill", {kThread, kThread}, {0, 4 * kThread}, [=](double row, double col) {
                const double i = std::floor(row / kThread);
                const double j = std::floor(col / kThread);
                const auto lift = static_cast<std::int64_t>(j - i);
                const bool warp = ((lift % 4) + 4) % 4 < 2;
                const double across = warp ? detail::fraction(col / kThread)
                                           : detail::fraction(row / kThread);
                const double light = 0.4 + 0.6 * std::sin(std::numbers::pi * across);
                return warp ? Colour{0.25 * light, 0.35 * light, 0.6 * light}
                            : Colour{0.8 * light, 0.8 * light, 0.75 * light};
            }};
}

/// Houndstooth: a 2/2 twill of four dark and four light threads each way.
inline Pattern houndstooth() {
    constexpr double kThread = 4.3;
    return {
        "houndstooth", {8 * kThread, 0}, {0, 8 * kThread}, [=](double row, double col) {
            const auto i = static_cast<std::int64_t>(std::floor(row / kThread));
            const auto j = static_cast<std::int64_t>(std::floor(col / kThread));
            const bool warp = (((j - i) % 4) + 4) % 4 < 2;
            const std::int64_t thread = warp ? j : i;
            const bool dark = ((thread % 8) + 8) % 8 < 4;
            const double across = detail::fraction((warp ? col : row) / kThread) - 0.5;
            const double light = 1 - 1.2 * across * across;
            const double grey = dark ? 0.15 : 0.85;
            return Colour{grey * light, grey * light, 0.95 * grey * light};
        }};
}

/// Glazed square tiles of 40 with joints of 3.
inline Pattern tiles() {
    constexpr double kSide = 43;
    return {"tiles", {kSide, 0}, {0, kSide}, [=](double row, double col) {
                const double y = detail::fraction(row / kSide) - 0.5;
                const double x = detail::fraction(col / kSide) - 0.5;
                const double edge = kSide * (0.5 - std::max(std::abs(x), std::abs(y)));
                const double inside = detail::step(edge - 1.5, 0.6);
                const double bevel = 0.12 * std::exp(-(edge - 1.5) / 2.5) * (x + y);
                return detail::mixed({0.35, 0.34, 0.32},
                                     {0.8 + bevel, 0.85 + bevel, 0.82 + bevel}, inside);
            }};
}

/// Corrugated sheet: ribs of 17.7, of the same look along them.
inline Pattern corrugation() {
    constexpr double kPeriod = 17.7;
    return {"corrugation", {0, kPeriod}, {0, 0}, [=](double, double col) {
                const double slope = std::cos(2 * std::numbers::pi * col / kPeriod);
                const double light = 0.45 + 0.25 * slope + 0.1 * slope * slope;
                return Colour{light, light, 1.05 * light};
            }};
}

/// Hexagons of the width 31 with joints.
inline Pattern hexagons() {
    constexpr double kWidth = 31;
    const double kRow = kWidth * std::sqrt(0.75);
    return {"hexagons", {0, kWidth}, {kRow, kWidth / 2}, [=](double row, double col) {
                // The two nearest centres of the hexagonal lattice: the joint is where they
                // are equally far.
                double nearest = 1e9;
                double second = 1e9;
                const double i0 = std::round(row / kRow);
                for (double i = i0 - 1; i <= i0 + 1; ++i) {
                    const double j0 = std::round(col / kWidth - i / 2);
                    for (double j = j0 - 1; j <= j0 + 1; ++j) {
                        const double distance =
                            std::hypot(row - i * kRow, col - (j + i / 2) * kWidth);
                        second = std::min(second, std::max(nearest, distance));
                        nearest = std::min(nearest, distance);
                    }
                }
                const double inside = detail::step(second - nearest - 3, 0.8);
                return detail::mixed({0.2, 0.18, 0.15}, {0.75, 0.6, 0.42}, inside);
            }};
}

namespace detail {

/// Cells about points scattered one to a square: how much further away the second nearest is
/// than the nearest, and a number of the nearest.
struct ScatteredCell {
    double edge = 0;  ///< 0 on the border of two cells
    double number = 0;
};
inline ScatteredCell scattered_cell(double row, double col, double spacing) {
    double nearest = 1e9;
    double second = 1e9;
    ScatteredCell cell;
    const auto i0 = static_cast<std::int64_t>(std::floor(row / spacing));
    const auto j0 = static_cast<std::int64_t>(std::floor(col / spacing));
    for (std::int64_t i = i0 - 2; i <= i0 + 2; ++i)
        for (std::int64_t j = j0 - 2; j <= j0 + 2; ++j) {
            const double y = (static_cast<double>(i) + hash_unit(i, j, 2)) * spacing;
            const double x = (static_cast<double>(j) + hash_unit(i, j, 3)) * spacing;
            const double distance = std::hypot(row - y, col - x);
            second = std::min(second, std::max(nearest, distance));
            if (distance >= nearest) continue;
            nearest = distance;
            cell.number = hash_unit(i, j, 4);
        }
    cell.edge = second - nearest;
    return cell;
}

}  // namespace detail

/// Pebbles of many shades in dark gaps: no lattice repeats them.
inline Pattern pebbles() {
    return {"pebbles", {}, {}, [](double row, double col) {
                const auto cell = detail::scattered_cell(row, col, 26);
                const double inside = detail::step(cell.edge - 3, 1.5);
                const double shade = 0.35 + 0.55 * cell.number;
                return detail::mixed({0.13, 0.12, 0.1},
                                     {0.95 * shade, 0.88 * shade, 0.78 * shade}, inside);
            }};
}

/// Cracks in dry ground: no lattice either.
inline Pattern cracks() {
    return {"cracks", {}, {}, [](double row, double col) {
                const auto cell = detail::scattered_cell(row, col, 64);
                const double inside = detail::step(cell.edge - 2.5, 0.8);
                return detail::mixed({0.2, 0.16, 0.13}, {0.68, 0.6, 0.5}, inside);
            }};
}

inline std::vector<Pattern> patterns() {
    return {brick(), knit(), twill(), houndstooth(), tiles(), corrugation(), hexagons()};
}

/// A photograph of a pattern: pixels of 3 x 3 samples, bent by a slow wave of `bend` pixels,
/// under grain of the deviation `grain`.
inline Image photograph_of(const Pattern& pattern, std::size_t rows, std::size_t cols,
                           double bend, double grain, std::uint64_t seed) {
    Image image(3, rows, cols);
    std::vector<float> noise(cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::uint32_t band = 0; band < 3; ++band) {
            draw_normals({seed, band}, static_cast<std::int32_t>(r), 0, noise);
            for (std::size_t c = 0; c < cols; ++c) image(band, r, c) = noise[c];
        }
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            Colour sum{};
            for (int i = -1; i <= 1; ++i)
                for (int j = -1; j <= 1; ++j) {
                    const double y = static_cast<double>(r) + i / 3.0;
                    const double x = static_cast<double>(c) + j / 3.0;
                    const Colour colour =
                        pattern.colour(y + bend * std::sin(x / 47 + y / 83),
                                       x + bend * std::cos(y / 53 - x / 101));
                    for (std::size_t band = 0; band < 3; ++band)
                        sum[band] += colour[band] / 9;
                }
            // Grain of the surface: common to the bands, and a little of each.
            const double common = static_cast<double>(image(0, r, c));
            for (std::size_t band = 0; band < 3; ++band)
                image(band, r, c) = static_cast<float>(
                    srgb_decode(sum[band] + grain * common +
                                0.3 * grain * static_cast<double>(image(band, r, c))));
        }
    return image;
}

}  // namespace sateen::test
