// SPDX-License-Identifier: Apache-2.0
// One diffuse bounce. See interreflection.hpp.
#include "goniometer/interreflection.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sateen::goniometer {
namespace {

std::vector<Vector> fibonacci_sphere(std::size_t count) {
    std::vector<Vector> directions(count);
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
    for (std::size_t k = 0; k < count; ++k) {
        const double z =
            1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
        const double radius = std::sqrt(1 - z * z);
        const double phi = turn * static_cast<double>(k);
        directions[k] = {static_cast<float>(radius * std::cos(phi)),
                         static_cast<float>(radius * std::sin(phi)),
                         static_cast<float>(z)};
    }
    return directions;
}

}  // namespace

Interreflection::Interreflection(const Tracer& tracer, std::size_t rows, std::size_t cols,
                                 float width, float depth, std::size_t directions,
                                 Executor& executor)
    : rows_(rows), cols_(cols) {
    std::vector<float> x(rows * cols);
    std::vector<float> y(rows * cols);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            x[r * cols + c] =
                (static_cast<float>(c) + 0.5F) * width / static_cast<float>(cols);
            y[r * cols + c] =
                -(static_cast<float>(r) + 0.5F) * depth / static_cast<float>(rows);
        }
    centres_ = tracer.trace(x, y, {}, executor);
    const std::vector<Vector> sphere = fibonacci_sphere(directions);
    links_.resize(centres_.blocks.size());
    begins_.resize(centres_.blocks.size());
    parallel_for(executor, centres_.blocks.size(), [&](std::size_t b) {
        const Hits::Block& block = centres_.blocks[b];
        std::array<std::vector<Link>, kLanes> found;
        for (const Vector& direction : sphere) {
            LaneMask facing{};
            std::array<float, kLanes> cosine{};
            std::int32_t any = 0;
            for (std::size_t i = 0; i < kLanes; ++i) {
                cosine[i] = block.normal.x[i] * direction[0] +
                            block.normal.y[i] * direction[1] +
                            block.normal.z[i] * direction[2];
                facing[i] = cosine[i] > 0 ? block.met[i] : 0;
                any |= facing[i];
            }
            if (any == 0) continue;
            const std::array<float, kLanes> t =
                tracer.free_path(block, direction, facing);
            for (std::size_t i = 0; i < kLanes; ++i) {
                if (facing[i] == 0 || !std::isfinite(t[i])) continue;
                const float at_x = tracer.wrap_x(block.point.x[i] + t[i] * direction[0]);
                const float at_y = tracer.wrap_y(block.point.y[i] + t[i] * direction[1]);
                const auto col =
                    static_cast<std::size_t>(at_x / width * static_cast<float>(cols));
                const auto row =
                    static_cast<std::size_t>(-at_y / depth * static_cast<float>(rows));
                found[i].push_back(
                    {static_cast<std::uint32_t>(std::min(row, rows - 1) * cols +
                                                std::min(col, cols - 1)),
                     4 * cosine[i] / static_cast<float>(directions)});
            }
        }
        for (std::size_t i = 0; i < kLanes; ++i) {
            begins_[b][i] = static_cast<std::uint32_t>(links_[b].size());
            links_[b].insert(links_[b].end(), found[i].begin(), found[i].end());
        }
        begins_[b][kLanes] = static_cast<std::uint32_t>(links_[b].size());
    });
}

Image Interreflection::gather(const Tracer& tracer, const Vector& light,
                              bool shadows) const {
    const Layer matt{false, 0};
    Image scattered(3, rows_, cols_);
    const std::size_t plane = rows_ * cols_;
    for (std::size_t b = 0; b < centres_.blocks.size(); ++b) {
        const Hits::Block& block = centres_.blocks[b];
        const Reflected value =
            reflect(block, matt, {0, 0, 1}, light, tracer.lit(block, light, shadows));
        for (std::size_t band = 0; band < 3; ++band)
            for (std::size_t i = 0; i < kLanes && b * kLanes + i < plane; ++i)
                scattered.values()[band * plane + b * kLanes + i] = value[band][i];
    }
    Image gathered(3, rows_, cols_);
    for (std::size_t p = 0; p < plane; ++p) {
        const std::size_t b = p / kLanes;
        for (std::uint32_t k = begins_[b][p % kLanes]; k < begins_[b][p % kLanes + 1];
             ++k) {
            const Link& link = links_[b][k];
            for (std::size_t band = 0; band < 3; ++band)
                gathered.values()[band * plane + p] +=
                    link.weight * scattered.values()[band * plane + link.pixel];
        }
    }
    return gathered;
}

}  // namespace sateen::goniometer
