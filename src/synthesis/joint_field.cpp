// SPDX-License-Identifier: Apache-2.0
// Planes drawn together on a torus. See joint_field.hpp.
#include "synthesis/joint_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "synthesis/hermitian_matrix.hpp"

namespace sateen {
namespace {

/// Σ |y|² along one row of the whole torus, of which the half spectrum leaves out mirrored
/// columns.
double whole_power(const float* re, const float* im, std::size_t count, bool even) {
    const auto power = [&](std::size_t n) {
        return static_cast<double>(re[n] * re[n] + im[n] * im[n]);
    };
    double sum = 0;
    for (std::size_t n = 0; n < count; ++n) sum += power(n);
    return 2 * sum - power(0) - (even ? power(count - 1) : 0);
}

}  // namespace

void hermitian_root(ImageView<float> density, Executor& executor) {
    parallel_for(executor, density.rows, [&](std::size_t m) {
        hermitian_root(hermitian_rows(density, m), density.cols);
    });
}

//     R_ii(0) = (1/(MN)²) Σ_t |ŷ_t,i|²     by Parseval
void colour_joint_noise(const PlaneField& field, std::size_t cols,
                        std::span<const SplitComplexPlane> noise,
                        std::span<SplitComplexPlane> spectra, Executor& executor) {
    constexpr std::size_t d = 3;
    const std::size_t rows = noise[0].rows();
    Image density = spectral_density(field, rows, cols, executor);
    for (std::size_t k = 0; k < d * d; ++k) {
        suppress_unmeasured(field, density.plane(k), cols);
        density(k, 0, 0) = 0;
    }
    std::vector<std::array<double, d>> row_power(rows);
    parallel_for(executor, rows, [&](std::size_t m) {
        hermitian_root(hermitian_rows(density.view(), m), density.cols());
        ComplexRows y;
        for (std::size_t i = 0; i < d; ++i) {
            // The noise is copied into the rows that the product then replaces.
            const SplitComplexView<const float> w = noise[i].view();
            y.re[i] = spectra[i].view().re.row(m);
            y.im[i] = spectra[i].view().im.row(m);
            if (w.re.row(m) == y.re[i]) continue;
            std::copy_n(w.re.row(m), density.cols(), y.re[i]);
            std::copy_n(w.im.row(m), density.cols(), y.im[i]);
        }
        const Image& root = density;
        multiply_hermitian(hermitian_rows(root.view(), m), {1, 1, 1}, y, y, root.cols());
        for (std::size_t i = 0; i < d; ++i)
            row_power[m][i] =
                whole_power(y.re[i], y.im[i], density.cols(), cols % 2 == 0);
    });
    const double sites = static_cast<double>(rows) * static_cast<double>(cols);
    for (std::size_t i = 0; i < d; ++i) {
        double power = 0;
        for (const auto& row : row_power) power += row[i];
        const auto scale = static_cast<float>(power > 0 ? sites / std::sqrt(power) : 0);
        const SplitComplexView<float> y = spectra[i].view();
        parallel_for(executor, rows, [&](std::size_t m) {
            for (std::size_t n = 0; n < density.cols(); ++n) {
                y.re(m, n) *= scale;
                y.im(m, n) *= scale;
            }
        });
    }
}

}  // namespace sateen
