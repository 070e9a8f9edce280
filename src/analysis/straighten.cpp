// SPDX-License-Identifier: Apache-2.0
// What of a displacement is affine goes into the basis. See alignment_step.hpp.
#include <array>
#include <cmath>
#include <utility>

#include "analysis/alignment_step.hpp"

namespace sateen {

LatticeMap straighten(const LatticeMap& map, Image& D, Executor& executor) {
    const auto middle_row = static_cast<double>(D.rows() - 1) / 2;
    const auto middle_col = static_cast<double>(D.cols() - 1) / 2;
    std::array<std::array<double, 3>, 2>
        fit{};  // of each axis: along rows, cols, constant
    const auto n = static_cast<double>(D.plane_size());
    const double row_power =
        (static_cast<double>(D.rows()) * static_cast<double>(D.rows()) - 1) / 12 * n;
    const double col_power =
        (static_cast<double>(D.cols()) * static_cast<double>(D.cols()) - 1) / 12 * n;
    for (std::size_t axis = 0; axis < 2; ++axis)
        for (std::size_t r = 0; r < D.rows(); ++r) {
            const float* row = std::as_const(D).plane(axis).row(r);
            double sum = 0;
            double moment = 0;
            for (std::size_t c = 0; c < D.cols(); ++c) {
                sum += static_cast<double>(row[c]);
                moment +=
                    static_cast<double>(row[c]) * (static_cast<double>(c) - middle_col);
            }
            fit[axis][0] += sum * (static_cast<double>(r) - middle_row) / row_power;
            fit[axis][1] += moment / col_power;
            fit[axis][2] += sum / n;
        }
    const double m00 = 1 + fit[0][0];
    const double m01 = fit[0][1];
    const double m10 = fit[1][0];
    const double m11 = 1 + fit[1][1];
    const double det = m00 * m11 - m01 * m10;
    if (!(std::abs(det) > 0.5)) return map;
    const auto solve = [&](double row, double col) {
        return std::array<double, 2>{(m11 * row - m01 * col) / det,
                                     (m00 * col - m10 * row) / det};
    };
    parallel_for(executor, D.rows(), [&](std::size_t r) {
        for (std::size_t c = 0; c < D.cols(); ++c) {
            const double row = static_cast<double>(r) - middle_row;
            const double col = static_cast<double>(c) - middle_col;
            std::array<double, 2> rest{};
            for (std::size_t axis = 0; axis < 2; ++axis)
                rest[axis] = static_cast<double>(D(axis, r, c)) - fit[axis][0] * row -
                             fit[axis][1] * col - fit[axis][2];
            const auto d = solve(rest[0], rest[1]);
            D(0, r, c) = static_cast<float>(d[0]);
            D(1, r, c) = static_cast<float>(d[1]);
        }
    });
    return {solve(map.a()[0], map.a()[1]), solve(map.b()[0], map.b()[1])};
}

}  // namespace sateen
