// SPDX-License-Identifier: Apache-2.0
// The pyramid as its definition reads, in double: full two-dimensional sums, zeros
// inserted.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace sateen::reference {

struct DoublePlane {
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::vector<double> values;

    DoublePlane() = default;
    DoublePlane(std::size_t rows_, std::size_t cols_)
        : rows(rows_), cols(cols_), values(rows_ * cols_) {}
    double& operator()(std::size_t r, std::size_t c) { return values[r * cols + c]; }
    double operator()(std::size_t r, std::size_t c) const { return values[r * cols + c]; }
};

/// plane ⊗ (w ⊗ w) on the torus, w = [1 4 6 4 1]/16.
inline DoublePlane filter(const DoublePlane& plane) {
    constexpr std::array<double, 5> kW = {1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16,
                                          1.0 / 16};
    DoublePlane out(plane.rows, plane.cols);
    for (std::size_t r = 0; r < plane.rows; ++r) {
        for (std::size_t c = 0; c < plane.cols; ++c) {
            for (std::size_t a = 0; a < 5; ++a) {
                for (std::size_t b = 0; b < 5; ++b) {
                    out(r, c) += kW[a] * kW[b] *
                                 plane((r + 2 * plane.rows + a - 2) % plane.rows,
                                       (c + 2 * plane.cols + b - 2) % plane.cols);
                }
            }
        }
    }
    return out;
}

inline DoublePlane reduce(const DoublePlane& fine) {
    const DoublePlane filtered = filter(fine);
    DoublePlane coarse(fine.rows / 2, fine.cols / 2);
    for (std::size_t r = 0; r < coarse.rows; ++r) {
        for (std::size_t c = 0; c < coarse.cols; ++c)
            coarse(r, c) = filtered(2 * r, 2 * c);
    }
    return coarse;
}

inline DoublePlane expand(const DoublePlane& coarse) {
    DoublePlane spread(2 * coarse.rows, 2 * coarse.cols);
    for (std::size_t r = 0; r < coarse.rows; ++r) {
        for (std::size_t c = 0; c < coarse.cols; ++c)
            spread(2 * r, 2 * c) = 4 * coarse(r, c);
    }
    return filter(spread);
}

inline std::vector<DoublePlane> decompose(DoublePlane plane, std::size_t levels) {
    std::vector<DoublePlane> bands;
    for (std::size_t k = 0; k + 1 < levels; ++k) {
        DoublePlane coarse = reduce(plane);
        const DoublePlane back = expand(coarse);
        for (std::size_t i = 0; i < plane.values.size(); ++i)
            plane.values[i] -= back.values[i];
        bands.push_back(plane);
        plane = coarse;
    }
    bands.push_back(plane);
    return bands;
}

inline DoublePlane collapse(const std::vector<DoublePlane>& bands) {
    DoublePlane plane = bands.back();
    for (std::size_t k = bands.size() - 1; k-- > 0;) {
        plane = expand(plane);
        for (std::size_t i = 0; i < plane.values.size(); ++i) {
            plane.values[i] += bands[k].values[i];
        }
    }
    return plane;
}

}  // namespace sateen::reference
