// SPDX-License-Identifier: Apache-2.0
// Maps of a surface. See surface_maps.hpp.
#include "sateen/goniometer/surface_maps.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace sateen {
namespace {

std::string shape_text(std::size_t bands, std::size_t rows, std::size_t cols) {
    return std::to_string(bands) + " bands of " + std::to_string(cols) + " x " +
           std::to_string(rows);
}

Result<void> check(const char* name, const Image& map, std::size_t bands,
                   const Image& like) {
    if (map.bands() != bands || map.rows() != like.rows() || map.cols() != like.cols() ||
        map.empty())
        return Error{Errc::invalid_argument,
                     std::string("surface, ") + name + ": found " +
                         shape_text(map.bands(), map.rows(), map.cols()) + ", expected " +
                         shape_text(bands, like.rows(), like.cols())};
    const auto finite = [](float v) { return std::isfinite(v); };
    if (!std::all_of(map.values().begin(), map.values().end(), finite))
        return Error{Errc::invalid_argument, std::string("surface, ") + name +
                                                 ": found a value that is not finite"};
    return {};
}

/// Which cells of a row of `from` a cell of a row of `to` takes, and with what weight.
struct Tap {
    std::size_t first = 0;
    std::vector<float> weights;
};

std::vector<Tap> taps(std::size_t from, std::size_t to) {
    const double ratio = static_cast<double>(from) / static_cast<double>(to);
    // Where cells become smaller, the hat of linear interpolation; else the cell's area.
    const double width = std::max(1.0, ratio);
    std::vector<Tap> result(to);
    for (std::size_t i = 0; i < to; ++i) {
        const double centre = (static_cast<double>(i) + 0.5) * ratio;
        const double left = centre - width / 2;
        const auto begin = static_cast<std::int64_t>(std::floor(left));
        const auto end = static_cast<std::int64_t>(std::ceil(left + width));
        const auto modulus = static_cast<std::int64_t>(from);
        result[i].first = static_cast<std::size_t>((begin % modulus + modulus) % modulus);
        for (std::int64_t k = begin; k < end; ++k) {
            const double covered = std::min(static_cast<double>(k + 1), left + width) -
                                   std::max(static_cast<double>(k), left);
            result[i].weights.push_back(
                static_cast<float>(std::max(0.0, covered) / width));
        }
    }
    return result;
}

}  // namespace

Result<void> validate(const SurfaceMaps& surface) {
    SATEEN_CHECK(check("height", surface.height, 1, surface.height));
    SATEEN_CHECK(check("colour", surface.colour, 3, surface.height));
    SATEEN_CHECK(check("roughness", surface.roughness, 1, surface.height));
    if (!surface.normal.empty())
        SATEEN_CHECK(check("normal", surface.normal, 3, surface.height));
    return {};
}

Image normals_of(const Image& height, float cell_x, float cell_y) {
    const std::size_t rows = height.rows();
    const std::size_t cols = height.cols();
    Image normal(3, rows, cols);
    const PlaneView<const float> z = height.plane(0);
    for (std::size_t r = 0; r < rows; ++r) {
        const std::size_t above = (r + rows - 1) % rows;
        const std::size_t below = (r + 1) % rows;
        for (std::size_t c = 0; c < cols; ++c) {
            const float p =
                (z(r, (c + 1) % cols) - z(r, (c + cols - 1) % cols)) / (2 * cell_x);
            const float q = (z(above, c) - z(below, c)) / (2 * cell_y);
            const float scale = 1 / std::sqrt(p * p + q * q + 1);
            normal(0, r, c) = -p * scale;
            normal(1, r, c) = -q * scale;
            normal(2, r, c) = scale;
        }
    }
    return normal;
}

Image resample(const Image& image, std::size_t rows, std::size_t cols) {
    const std::vector<Tap> down = taps(image.rows(), rows);
    const std::vector<Tap> across = taps(image.cols(), cols);
    Image result(image.bands(), rows, cols);
    std::vector<float> line(image.cols());
    for (std::size_t band = 0; band < image.bands(); ++band)
        for (std::size_t r = 0; r < rows; ++r) {
            std::fill(line.begin(), line.end(), 0.0F);
            for (std::size_t k = 0; k < down[r].weights.size(); ++k) {
                const float weight = down[r].weights[k];
                const float* const row =
                    image.plane(band).row((down[r].first + k) % image.rows());
                for (std::size_t c = 0; c < line.size(); ++c) line[c] += weight * row[c];
            }
            for (std::size_t c = 0; c < cols; ++c) {
                float sum = 0;
                for (std::size_t k = 0; k < across[c].weights.size(); ++k)
                    sum +=
                        across[c].weights[k] * line[(across[c].first + k) % line.size()];
                result(band, r, c) = sum;
            }
        }
    return result;
}

}  // namespace sateen
