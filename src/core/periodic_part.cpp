// SPDX-License-Identifier: Apache-2.0
// Periodic plus smooth decomposition. See periodic_part.hpp.
#include "sateen/core/periodic_part.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "sateen/core/fft.hpp"

namespace sateen {
namespace {

/// How many pixels along an axis of n make a border band.
std::size_t band_width(std::size_t n, double share) {
    return std::max(std::size_t{1},
                    static_cast<std::size_t>(share * static_cast<double>(n)));
}

/// The mean of the last w values of a line of n less that of the first w, `step` apart,
/// enlarged by (n - 1) / (n - w): what a ramp jumps from its last value to its first.
float band_jump(const float* line, std::size_t n, std::size_t step, std::size_t w) {
    if (n == w) return 0;
    double difference = 0;
    for (std::size_t k = 0; k < w; ++k)
        difference += static_cast<double>(line[(n - 1 - k) * step]) -
                      static_cast<double>(line[k * step]);
    return static_cast<float>(difference / static_cast<double>(w) *
                              static_cast<double>(n - 1) / static_cast<double>(n - w));
}

/// v: each border pixel gets what its neighbour across the border has more than itself; a
/// corner has two such neighbours.
void border_jumps(PlaneView<const float> u, PlaneView<float> v, double border_share) {
    const std::size_t bottom = u.rows - 1;
    const std::size_t right = u.cols - 1;
    const std::size_t height = band_width(u.rows, border_share);
    const std::size_t width = band_width(u.cols, border_share);
    for (std::size_t c = 0; c < u.cols; ++c) {
        const float jump = band_jump(u.row(0) + c, u.rows, u.stride, height);
        v(0, c) += jump;
        v(bottom, c) -= jump;
    }
    for (std::size_t r = 0; r < u.rows; ++r) {
        const float jump = band_jump(u.row(r), u.cols, 1, width);
        v(r, 0) += jump;
        v(r, right) -= jump;
    }
}

/// 2 cos(2πk / n) - 2 for k = 0 … n - 1, the second difference on a circle, as -4 sin²(πk
/// / n): it does not cancel where it is small.
std::vector<double> second_difference(std::size_t n) {
    std::vector<double> values(n);
    for (std::size_t k = 0; k < n; ++k) {
        const double root =
            std::sin(std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
        values[k] = -4 * root * root;
    }
    return values;
}

//     ŝ(m, n) = v̂(m, n) / (2 cos(2πm/M) + 2 cos(2πn/N) - 4),    ŝ(0, 0) = 0
void solve_poisson(SplitComplexView<float> v, std::size_t cols, Executor& executor) {
    const std::vector<double> by_row = second_difference(v.re.rows);
    const std::vector<double> by_col = second_difference(cols);
    parallel_for(executor, v.re.rows, [&](std::size_t r) {
        for (std::size_t c = 0; c < v.re.cols; ++c) {
            const double laplacian = by_row[r] + by_col[c];
            const auto inverse = static_cast<float>(r + c == 0 ? 0 : 1 / laplacian);
            v.re(r, c) *= inverse;
            v.im(r, c) *= inverse;
        }
    });
}

}  // namespace

Result<void> periodic_part(PlaneView<const float> in, PlaneView<float> out,
                           Executor& executor, double border_share) {
    assert(border_share >= 0 && border_share <= 0.5);
    assert(in.rows == out.rows && in.cols == out.cols);
    SATEEN_TRY(const Fft2d fft, Fft2d::create(in.rows, in.cols));
    Image smooth(1, in.rows, in.cols);
    const PlaneView<float> s = smooth.plane(0);
    border_jumps(in, s, border_share);
    SplitComplexPlane spectrum(in.rows, fft.spectrum_cols());
    fft.forward(s, spectrum.view(), executor);
    solve_poisson(spectrum.view(), in.cols, executor);
    fft.inverse(spectrum.view(), s, executor);
    for (std::size_t r = 0; r < in.rows; ++r) {
        for (std::size_t c = 0; c < in.cols; ++c) out(r, c) = in(r, c) - s(r, c);
    }
    return {};
}

}  // namespace sateen
