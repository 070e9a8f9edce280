// SPDX-License-Identifier: Apache-2.0
// Drawing the range map. See surface.hpp.
#include "sateen/synthesis/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

namespace sateen {
namespace {

constexpr std::int64_t kFarthest = std::int64_t{1} << 30U;
constexpr std::size_t kLargestTorus = std::size_t{1} << 20U;

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    return a / b - static_cast<std::int64_t>(a % b != 0 && (a < 0) != (b < 0));
}
std::int64_t floor_mod(std::int64_t a, std::int64_t b) {
    return a - floor_div(a, b) * b;
}

/// A site of the plane: which tile, and where in it.
struct Site {
    std::int64_t i = 0;
    std::int64_t j = 0;
    std::size_t row = 0;
    std::size_t col = 0;
};

Site site_of(const Surface& surface, std::int64_t y, std::int64_t x) {
    const std::int64_t rows = surface.rows;
    const std::int64_t cols = surface.cols;
    const std::int64_t i = floor_div(y, rows);
    const std::int64_t shifted = x - i * surface.shear_px;
    return {i, floor_div(shifted, cols), static_cast<std::size_t>(floor_mod(y, rows)),
            static_cast<std::size_t>(floor_mod(shifted, cols))};
}

float height_at(const Surface& surface, const Site& site, std::uint64_t seed) {
    const std::size_t tile =
        tile_at(static_cast<std::int32_t>(site.i), static_cast<std::int32_t>(site.j),
                seed, surface.tiles.size());
    return surface.height_px(surface.tiles[tile][site.row * surface.cols + site.col]);
}

/// The plane closed to a torus of whole tiles: `tile_rows` rows of tiles further down, the
/// same tiles come back, shifted by `shift` columns of tiles.
struct Closure {
    std::int64_t tile_rows = 1;
    std::int64_t tile_cols = 1;
    std::int64_t shift = 0;

    [[nodiscard]] Site wrapped(Site site) const {
        const std::int64_t turns = floor_div(site.i, tile_rows);
        site.i -= turns * tile_rows;
        site.j = floor_mod(site.j + turns * shift, tile_cols);
        return site;
    }
};

/// Weights of cubic convolution (Keys, a = -1/2) for the samples at -1, 0, 1, 2.
std::array<double, 4> cubic_weights(double t) {
    return {((2 - t) * t - 1) * t / 2, ((3 * t - 5) * t * t + 2) / 2,
            ((4 - 3 * t) * t + 1) * t / 2, (t - 1) * t * t / 2};
}

struct Taps {
    std::int64_t first = 0;
    std::array<double, 4> weights = {};

    explicit Taps(double position)
        : first(static_cast<std::int64_t>(std::floor(position)) - 1),
          weights(cubic_weights(position - std::floor(position))) {}
};

float sampled_height(const Surface& surface, const Closure& closure, double y, double x,
                     std::uint64_t seed) {
    const Taps down(y);
    const Taps right(x);
    double sum = 0;
    for (int k = 0; k < 4; ++k)
        for (int l = 0; l < 4; ++l) {
            const double weight = down.weights[static_cast<std::size_t>(k)] *
                                  right.weights[static_cast<std::size_t>(l)];
            if (weight == 0) continue;
            const Site site = site_of(surface, down.first + k, right.first + l);
            sum += weight *
                   static_cast<double>(height_at(surface, closure.wrapped(site), seed));
        }
    return static_cast<float>(sum);
}

std::int64_t whole_tiles(std::size_t size, std::uint32_t tile) {
    return std::max<std::int64_t>(
        1, std::llround(static_cast<double>(size) / static_cast<double>(tile)));
}

}  // namespace

Result<Image> draw_range(const Surface& surface, const PlaneWindow& window,
                         std::uint64_t seed) {
    const auto beyond = [](std::int64_t first, std::size_t count) {
        return count < 1 || count > static_cast<std::size_t>(kFarthest) ||
               first < -kFarthest || first + static_cast<std::int64_t>(count) > kFarthest;
    };
    if (beyond(window.row, window.rows) || beyond(window.col, window.cols))
        return Error{Errc::invalid_argument,
                     "range map: a window of " + std::to_string(window.cols) + " x " +
                         std::to_string(window.rows) + " at " +
                         std::to_string(window.col) + "," + std::to_string(window.row) +
                         ", expected at least one pixel within 2^30 of the origin"};
    Image out(1, window.rows, window.cols);
    for (std::size_t r = 0; r < window.rows; ++r)
        for (std::size_t c = 0; c < window.cols; ++c)
            out(0, r, c) = height_at(
                surface,
                site_of(surface, std::int64_t{window.row} + static_cast<std::int64_t>(r),
                        std::int64_t{window.col} + static_cast<std::int64_t>(c)),
                seed);
    return out;
}

Result<ToroidalRange> draw_toroidal_range(const Surface& surface, std::size_t rows,
                                          std::size_t cols, std::uint64_t seed) {
    if (rows < 1 || cols < 1 || rows > kLargestTorus || cols > kLargestTorus)
        return Error{Errc::invalid_argument,
                     "range map: a torus of " + std::to_string(cols) + " x " +
                         std::to_string(rows) + ", expected 1 to 2^20 pixels a side"};
    Closure closure;
    closure.tile_rows = whole_tiles(rows, surface.rows);
    closure.tile_cols = whole_tiles(cols, surface.cols);
    // Down all tile rows the lattice has moved by `drift` columns: a whole number of tiles,
    // and a rest that is sheared away.
    const std::int64_t drift = closure.tile_rows * surface.shear_px;
    closure.shift =
        std::llround(static_cast<double>(drift) / static_cast<double>(surface.cols));
    const auto rest =
        static_cast<double>(drift - closure.shift * std::int64_t{surface.cols});
    const auto plane_rows = static_cast<double>(closure.tile_rows * surface.rows);
    const auto plane_cols = static_cast<double>(closure.tile_cols * surface.cols);
    const double y_step = plane_rows / static_cast<double>(rows);
    const double x_step = plane_cols / static_cast<double>(cols);
    const double x_drift = rest / static_cast<double>(rows);

    ToroidalRange out{Image(1, rows, cols),
                      static_cast<std::size_t>(closure.tile_rows),
                      static_cast<std::size_t>(closure.tile_cols),
                      1 / y_step - 1,
                      1 / x_step - 1,
                      -x_drift / x_step};
    for (std::size_t r = 0; r < rows; ++r) {
        const double y = static_cast<double>(r) * y_step;
        for (std::size_t c = 0; c < cols; ++c) {
            const double x =
                static_cast<double>(c) * x_step + static_cast<double>(r) * x_drift;
            out.height_px(0, r, c) = sampled_height(surface, closure, y, x, seed);
        }
    }
    return out;
}

Image normals_of(PlaneView<const float> height_px, Border border, float scale) {
    const std::size_t rows = height_px.rows;
    const std::size_t cols = height_px.cols;
    Image out(3, rows, cols);
    const auto before = [border](std::size_t i, std::size_t n) {
        return i > 0 ? i - 1 : border == Border::wraps ? n - 1 : 0;
    };
    const auto after = [border](std::size_t i, std::size_t n) {
        return i + 1 < n ? i + 1 : border == Border::wraps ? 0 : n - 1;
    };
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            const float p =
                scale * 0.5F *
                (height_px(r, after(c, cols)) - height_px(r, before(c, cols)));
            const float q =
                scale * 0.5F *
                (height_px(before(r, rows), c) - height_px(after(r, rows), c));
            const float length = std::sqrt(p * p + q * q + 1);
            out(0, r, c) = -p / length;
            out(1, r, c) = -q / length;
            out(2, r, c) = 1 / length;
        }
    return out;
}

}  // namespace sateen
