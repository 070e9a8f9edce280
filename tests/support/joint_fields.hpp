// SPDX-License-Identifier: Apache-2.0
// Fields of three planes with known parameters, and their statistics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reference/joint_field.hpp"
#include "sateen/analysis/autocovariance.hpp"

namespace sateen::test {

/// Planes that are correlated (.8 and more) and lead one another.
inline Car3d correlated_field() {
    return {{3,
             {{0, 1}, {1, 0}, {1, -1}},
             {0.4F,  0.1F, 0,     0,    0.35F, 0.1F, 0.05F, 0,     0.3F,
              0.3F,  0,    0.05F, 0.1F, 0.3F,  0,    0,     -0.1F, 0.35F,
              0.05F, 0,    0,     0,    0.1F,  0,    0,     0,     -0.1F},
             {1, 0.8F, 0.6F, 0.8F, 1, 0.7F, 0.6F, 0.7F, 0.8F}}};
}

inline Image to_image(const std::vector<reference::DoublePlane>& planes) {
    Image image(planes.size(), planes[0].rows, planes[0].cols);
    for (std::size_t k = 0; k < planes.size(); ++k)
        for (std::size_t i = 0; i < planes[k].values.size(); ++i)
            image.plane(k).data[i] = static_cast<float>(planes[k].values[i]);
    return image;
}

inline std::vector<PlaneView<const float>> views_of(const Image& image) {
    std::vector<PlaneView<const float>> views;
    for (std::size_t k = 0; k < image.bands(); ++k) views.push_back(image.plane(k));
    return views;
}

inline std::vector<PlaneView<float>> writable_views_of(Image& image) {
    std::vector<PlaneView<float>> views;
    for (std::size_t k = 0; k < image.bands(); ++k) views.push_back(image.plane(k));
    return views;
}

/// What an estimator would see of an endless sample.
inline CrossAutocovariance exact_covariance(const Autoregression3d& field, int reach,
                                            std::size_t side = 64) {
    const auto R = reference::covariances(field, side, side);
    const auto at = [&](std::size_t k, int row, int col) {
        const int n = static_cast<int>(side);
        return R[k](static_cast<std::size_t>((row + n) % n),
                    static_cast<std::size_t>((col + n) % n));
    };
    std::vector<Autocovariance> even;
    std::vector<Autocovariance> odd;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            Autocovariance plus(reach, static_cast<double>(side * side));
            Autocovariance minus = plus;
            for (int row = 0; row <= reach; ++row)
                for (int col = -reach; col <= reach; ++col) {
                    const double there = at(3 * i + j, row, col);
                    const double back = at(3 * i + j, -row, -col);
                    plus.at(row, col) = (there + back) / 2;
                    minus.at(row, col) = (back - there) / 2;
                }
            even.push_back(plus);
            odd.push_back(minus);
        }
    return {3, even, odd};
}

}  // namespace sateen::test
