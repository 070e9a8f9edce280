// SPDX-License-Identifier: Apache-2.0
// Sampling an equirectangular map. See environment.hpp.
#include "sateen/render/environment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace sateen {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Solid angle of a pixel of a row.
float solid_angle(std::size_t row, std::size_t rows, std::size_t cols) {
    const float step = kPi / static_cast<float>(rows);
    const float top = std::cos(static_cast<float>(row) * step);
    const float bottom = std::cos(static_cast<float>(row + 1) * step);
    return (top - bottom) * 2 * kPi / static_cast<float>(cols);
}

/// Which interval of cumulative shares a number falls into, and where in it.
std::pair<std::size_t, float> pick(const float* begin, std::size_t count, float random) {
    const float* const found = std::upper_bound(begin, begin + count, random);
    const auto index = std::min(static_cast<std::size_t>(found - begin), count - 1);
    const float low = index == 0 ? 0 : begin[index - 1];
    const float width = begin[index] - low;
    return {index, width > 0 ? std::clamp((random - low) / width, 0.0F, 0.99999F) : 0.5F};
}

}  // namespace

Result<Environment> Environment::create(Image map) {
    const auto usable = [](float v) { return std::isfinite(v) && v >= 0; };
    if (map.bands() != 3 || map.empty() ||
        !std::all_of(map.values().begin(), map.values().end(), usable))
        return Error{Errc::invalid_argument,
                     "environment: found " + std::to_string(map.bands()) +
                         " bands, or values that are negative or not finite, expected "
                         "radiance of 3 bands"};
    Environment result;
    const std::size_t rows = map.rows();
    const std::size_t cols = map.cols();
    result.rows_.resize(rows);
    result.cols_.resize(rows * cols);
    double total = 0;
    std::vector<double> row_sums(rows);
    for (std::size_t r = 0; r < rows; ++r) {
        const auto angle = static_cast<double>(solid_angle(r, rows, cols));
        std::vector<double> sums(cols);
        for (std::size_t c = 0; c < cols; ++c) {
            row_sums[r] += angle * static_cast<double>(0.2126F * map(0, r, c) +
                                                       0.7152F * map(1, r, c) +
                                                       0.0722F * map(2, r, c));
            sums[c] = row_sums[r];
        }
        for (std::size_t c = 0; c < cols; ++c)
            result.cols_[r * cols + c] =
                static_cast<float>(row_sums[r] > 0 ? sums[c] / row_sums[r] : 1);
        total += row_sums[r];
        result.rows_[r] = static_cast<float>(total);
    }
    if (!(total > 0))
        return Error{Errc::invalid_argument,
                     "environment: is black, expected light from somewhere"};
    for (std::size_t r = 0; r < rows; ++r)
        result.rows_[r] =
            static_cast<float>(static_cast<double>(result.rows_[r]) / total);
    result.map_ = std::move(map);
    return result;
}

std::array<std::size_t, 2> Environment::pixel(const Vector3& direction) const {
    const float theta = std::acos(std::clamp(direction[2], -1.0F, 1.0F));
    const float phi = std::atan2(direction[0], direction[1]);
    const auto row =
        static_cast<std::size_t>(theta / kPi * static_cast<float>(map_.rows()));
    const auto col = static_cast<std::size_t>((phi + kPi) / (2 * kPi) *
                                              static_cast<float>(map_.cols()));
    return {std::min(row, map_.rows() - 1), std::min(col, map_.cols() - 1)};
}

Vector3 Environment::radiance(const Vector3& direction) const {
    const auto [row, col] = pixel(direction);
    return {map_(0, row, col), map_(1, row, col), map_(2, row, col)};
}

float Environment::pixel_density(std::size_t row, std::size_t col) const {
    const std::size_t cols = map_.cols();
    const float row_share = rows_[row] - (row == 0 ? 0 : rows_[row - 1]);
    const float* const shares = cols_.data() + row * cols;
    const float col_share = shares[col] - (col == 0 ? 0 : shares[col - 1]);
    return row_share * col_share / solid_angle(row, map_.rows(), cols);
}

float Environment::density(const Vector3& direction) const {
    const auto [row, col] = pixel(direction);
    return pixel_density(row, col);
}

Environment::Sample Environment::sample(std::array<float, 2> random) const {
    const auto [row, down] = pick(rows_.data(), map_.rows(), random[0]);
    const auto [col, across] =
        pick(cols_.data() + row * map_.cols(), map_.cols(), random[1]);
    // Uniform in cos θ within the pixel.
    const float step = kPi / static_cast<float>(map_.rows());
    const float top = std::cos(static_cast<float>(row) * step);
    const float bottom = std::cos(static_cast<float>(row + 1) * step);
    const float z = top + down * (bottom - top);
    const float radius = std::sqrt(std::max(0.0F, 1 - z * z));
    const float phi =
        (static_cast<float>(col) + across) * 2 * kPi / static_cast<float>(map_.cols()) -
        kPi;
    return {{radius * std::sin(phi), radius * std::cos(phi), z},
            {map_(0, row, col), map_(1, row, col), map_(2, row, col)},
            pixel_density(row, col)};
}

}  // namespace sateen
