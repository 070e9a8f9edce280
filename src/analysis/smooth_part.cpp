// SPDX-License-Identifier: Apache-2.0
// Wide blurs by cosine series. See smooth_part.hpp.
#include "analysis/smooth_part.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sateen {
namespace {

/// Cosines whose gain is less than this are left out.
constexpr double kSmallestGain = 1e-3;

/// Orthonormal cosines as rows, and the gain of the blur of each.
struct CosineSeries {
    Image basis;
    std::vector<float> gain;

    CosineSeries(std::size_t n, double sigma) {
        const double unit = std::numbers::pi / static_cast<double>(n);
        const double furthest = std::sqrt(-2 * std::log(kSmallestGain)) / (sigma * unit);
        const std::size_t count = std::min(n, static_cast<std::size_t>(furthest) + 1);
        basis = Image(1, count, n);
        for (std::size_t k = 0; k < count; ++k) {
            const double omega = unit * static_cast<double>(k);
            gain.push_back(
                static_cast<float>(std::exp(-sigma * sigma * omega * omega / 2)));
            const double norm = std::sqrt((k == 0 ? 1.0 : 2.0) / static_cast<double>(n));
            for (std::size_t x = 0; x < n; ++x)
                basis(0, k, x) = static_cast<float>(
                    norm * std::cos(omega * (static_cast<double>(x) + 0.5)));
        }
    }
    [[nodiscard]] std::size_t count() const { return gain.size(); }
};

}  // namespace

void subtract_smooth_part(PlaneView<const float> in, double sigma, PlaneView<float> out,
                          Executor& executor) {
    const CosineSeries down(in.rows, sigma);
    const CosineSeries across(in.cols, sigma);
    const PlaneView<const float> row_basis = down.basis.plane(0);
    const PlaneView<const float> col_basis = across.basis.plane(0);

    // Coefficients: along the rows of the plane, then along its columns.
    Image along(1, in.rows, across.count());
    parallel_for(executor, in.rows, [&](std::size_t r) {
        for (std::size_t k = 0; k < across.count(); ++k) {
            float sum = 0;
            for (std::size_t c = 0; c < in.cols; ++c) sum += in(r, c) * col_basis(k, c);
            along(0, r, k) = sum;
        }
    });
    Image coefficients(1, down.count(), across.count());
    parallel_for(executor, down.count(), [&](std::size_t j) {
        float* sums = coefficients.plane(0).row(j);
        for (std::size_t r = 0; r < in.rows; ++r)
            for (std::size_t k = 0; k < across.count(); ++k)
                sums[k] += row_basis(j, r) * along(0, r, k);
        for (std::size_t k = 0; k < across.count(); ++k)
            sums[k] *= down.gain[j] * across.gain[k];
    });
    parallel_for(executor, in.rows, [&](std::size_t r) {
        std::vector<float> sums(across.count());
        for (std::size_t j = 0; j < down.count(); ++j)
            for (std::size_t k = 0; k < across.count(); ++k)
                sums[k] += row_basis(j, r) * coefficients(0, j, k);
        std::vector<float> smooth(in.cols);
        for (std::size_t k = 0; k < across.count(); ++k)
            for (std::size_t c = 0; c < in.cols; ++c)
                smooth[c] += sums[k] * col_basis(k, c);
        for (std::size_t c = 0; c < in.cols; ++c) out(r, c) = in(r, c) - smooth[c];
    });
}

}  // namespace sateen
