// SPDX-License-Identifier: Apache-2.0
#include "baselines/tiling_blending.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "sateen/analysis/marginal.hpp"
#include "sateen/analysis/spectral.hpp"
#include "sateen/core/normal.hpp"

namespace sateen::baselines {
namespace {

/// A plane made Gaussian by ranks, and the way back.
struct Ranked {
    std::vector<float> gaussian;
    std::vector<float> sorted;
};

Ranked rank(PlaneView<const float> plane) {
    const std::size_t count = plane.size();
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return plane.data[a] < plane.data[b];
    });
    Ranked ranked{std::vector<float>(count), std::vector<float>(count)};
    for (std::size_t k = 0; k < count; ++k) {
        const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
        ranked.gaussian[order[k]] = static_cast<float>(normal_quantile(share));
        ranked.sorted[k] = plane.data[order[k]];
    }
    return ranked;
}

float value_of(const Ranked& ranked, double gaussian) {
    const double share = std::erfc(-gaussian / std::sqrt(2.0)) / 2;
    const auto last = static_cast<double>(ranked.sorted.size() - 1);
    const double at = std::clamp(share * (last + 1) - 0.5, 0.0, last);
    return ranked.sorted[static_cast<std::size_t>(at + 0.5)];
}

/// The triangle of the grid that holds a point, by vertices and barycentric weights.
struct Corner {
    std::int32_t row;
    std::int32_t col;
    double weight;
};

std::array<Corner, 3> triangle_at(double row, double col, double side) {
    // Skewed so that the triangles are equilateral [Deliot & Heitz 2019].
    const double u = (col - row / std::sqrt(3.0)) / side;
    const double v = 2 / std::sqrt(3.0) * row / side;
    const double u0 = std::floor(u);
    const double v0 = std::floor(v);
    const double fu = u - u0;
    const double fv = v - v0;
    const auto i = static_cast<std::int32_t>(u0);
    const auto j = static_cast<std::int32_t>(v0);
    if (fu + fv < 1) return {{{j, i, 1 - fu - fv}, {j + 1, i, fv}, {j, i + 1, fu}}};
    return {{{j + 1, i + 1, fu + fv - 1}, {j + 1, i, 1 - fu}, {j, i + 1, 1 - fv}}};
}

}  // namespace

Result<Image> tiling_blending(const Image& image, std::size_t rows, std::size_t cols,
                              std::uint64_t seed) {
    const std::vector<Image> images = {image};
    const SpectralTransform spectral = fit_spectral_transform(images, Tone::linear);
    const Image planes = decorrelate(image, spectral);
    const std::size_t d = planes.bands();
    std::vector<Ranked> ranked;
    for (std::size_t k = 0; k < d; ++k) ranked.push_back(rank(planes.plane(k)));

    const double side = static_cast<double>(std::min(image.rows(), image.cols())) / 4;
    const std::array<std::uint32_t, 2> key = {static_cast<std::uint32_t>(seed),
                                              static_cast<std::uint32_t>(seed >> 32U)};
    Image out(d, rows, cols);
    std::vector<double> q(d);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < cols; ++c) {
            const auto corners =
                triangle_at(static_cast<double>(r), static_cast<double>(c), side);
            std::fill(q.begin(), q.end(), 0.0);
            double squares = 0;
            for (const Corner& corner : corners) {
                const auto words =
                    philox4x32_10({static_cast<std::uint32_t>(corner.row),
                                   static_cast<std::uint32_t>(corner.col), 0, 0},
                                  key);
                const std::size_t row = (r + words[0]) % image.rows();
                const std::size_t col = (c + words[1]) % image.cols();
                for (std::size_t k = 0; k < d; ++k)
                    q[k] +=
                        corner.weight *
                        static_cast<double>(ranked[k].gaussian[row * image.cols() + col]);
                squares += corner.weight * corner.weight;
            }
            for (std::size_t band = 0; band < d; ++band)
                out(band, r, c) = spectral.mean[band];
            for (std::size_t k = 0; k < d; ++k) {
                const float y = value_of(ranked[k], q[k] / std::sqrt(squares));
                for (std::size_t band = 0; band < d; ++band)
                    out(band, r, c) += spectral.T[k * d + band] * y;
            }
        }
    return out;
}

}  // namespace sateen::baselines
