// SPDX-License-Identifier: Apache-2.0
// Surfaces with known height and normals, and pictures of them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "sateen/analysis/integrate.hpp"
#include "sateen/core/direction.hpp"
#include "support/synthetic_measurement.hpp"

namespace sateen::test {

struct Relief {
    BasicImage<double> height;  ///< pixels
    SlopeField slopes;          ///< analytic
    Image normals;
};

inline Image normals_of_slopes(const SlopeField& slopes) {
    Image out(3, slopes.rows(), slopes.cols());
    for (std::size_t i = 0; i < slopes.plane_size(); ++i) {
        const double p = slopes.plane(0).data[i];
        const double q = slopes.plane(1).data[i];
        const double w = std::sqrt(1 + p * p + q * q);
        out.plane(0).data[i] = static_cast<float>(-p / w);
        out.plane(1).data[i] = static_cast<float>(-q / w);
        out.plane(2).data[i] = static_cast<float>(1 / w);
    }
    return out;
}

/// A sum of cosines of whole periods on the torus, up to `largest` periods a side, of a
/// given largest slope.
inline Relief cosine_relief(std::size_t rows, std::size_t cols, int largest, double slope,
                            unsigned seed, int waves = 6) {
    std::mt19937 engine(seed);
    const auto whole = [&](int low, int high) {
        return low + static_cast<int>(engine() % static_cast<unsigned>(high - low + 1));
    };
    Relief out{BasicImage<double>(1, rows, cols), SlopeField(2, rows, cols), {}};
    for (int wave = 0; wave < waves; ++wave) {
        const double m = whole(-largest, largest);
        const double n = whole(wave == 0 ? 1 : 0, largest);
        const double phase = static_cast<double>(engine()) / 4294967296.0 * 6.28;
        const double wy = 2 * std::numbers::pi * m / static_cast<double>(rows);
        const double wx = 2 * std::numbers::pi * n / static_cast<double>(cols);
        const double omega = std::hypot(wx, wy);
        if (omega == 0) continue;
        const double amplitude = slope / waves / omega;
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c) {
                const double angle =
                    wy * static_cast<double>(r) + wx * static_cast<double>(c) + phase;
                out.height(0, r, c) += amplitude * std::cos(angle);
                out.slopes(0, r, c) -= amplitude * wx * std::sin(angle);
                out.slopes(1, r, c) += amplitude * wy * std::sin(angle);
            }
    }
    out.normals = normals_of_slopes(out.slopes);
    return out;
}

/// Lights on rings of 15 to 75 degrees, as in UBO2003 without the pole.
inline std::vector<Direction> ring_lights(int rings = 5, int per_ring = 8) {
    std::vector<Direction> out;
    for (int ring = 1; ring <= rings; ++ring)
        for (int k = 0; k < per_ring; ++k)
            out.push_back(direction_from_degrees(
                15 * static_cast<float>(ring),
                360 * static_cast<float>(k) / static_cast<float>(per_ring) +
                    7 * static_cast<float>(ring)));
    return out;
}

struct Gloss {
    double strength = 0;
    double exponent = 60;
};

/// albedo · max(0, n · l), plus Blinn's highlight for the viewer above.
inline Image picture(const Image& normals, const Image& albedo, Direction light,
                     Gloss gloss = {}) {
    const auto l = to_vector(light);
    const float length = std::sqrt(l[0] * l[0] + l[1] * l[1] + (l[2] + 1) * (l[2] + 1));
    Image out(albedo.bands(), normals.rows(), normals.cols());
    for (std::size_t i = 0; i < normals.plane_size(); ++i) {
        const std::array<float, 3> n = {
            normals.plane(0).data[i], normals.plane(1).data[i], normals.plane(2).data[i]};
        const float shading = std::max(0.0F, n[0] * l[0] + n[1] * l[1] + n[2] * l[2]);
        const float half =
            std::max(0.0F, n[0] * l[0] + n[1] * l[1] + n[2] * (l[2] + 1)) / length;
        const auto highlight = static_cast<float>(
            gloss.strength * std::pow(static_cast<double>(half), gloss.exponent));
        for (std::size_t band = 0; band < albedo.bands(); ++band)
            out.plane(band).data[i] =
                albedo.plane(band).data[i] * shading + (shading > 0 ? highlight : 0);
    }
    return out;
}

/// Albedo between 0.2 and 0.8, of its own in every pixel and band.
inline Image mottled_albedo(std::size_t bands, std::size_t rows, std::size_t cols,
                            unsigned seed) {
    std::mt19937 engine(seed);
    Image out(bands, rows, cols);
    for (float& v : out.values())
        v = 0.2F + 0.6F * static_cast<float>(engine()) / 4294967296.0F;
    return out;
}

inline SyntheticMeasurement measurement_of(const Relief& relief, const Image& albedo,
                                           const std::vector<Direction>& lights,
                                           Gloss gloss = {}) {
    std::vector<Image> images;
    for (const Direction light : lights)
        images.push_back(picture(relief.normals, albedo, light, gloss));
    return {{Direction{}}, lights, std::move(images)};
}

/// Mean angle between two fields of unit normals, in degrees.
inline double mean_angle(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.plane_size(); ++i) {
        double dot = 0;
        for (std::size_t band = 0; band < 3; ++band)
            dot += static_cast<double>(a.plane(band).data[i]) *
                   static_cast<double>(b.plane(band).data[i]);
        sum += std::acos(std::min(1.0, std::max(-1.0, dot)));
    }
    return sum / static_cast<double>(a.plane_size()) * 180 / std::numbers::pi;
}

template <class T, class U>
double correlation(const BasicImage<T>& a, const BasicImage<U>& b) {
    const auto n = static_cast<double>(a.plane_size());
    double sums[5] = {};
    for (std::size_t i = 0; i < a.plane_size(); ++i) {
        const auto x = static_cast<double>(a.values()[i]);
        const auto y = static_cast<double>(b.values()[i]);
        sums[0] += x;
        sums[1] += y;
        sums[2] += x * x;
        sums[3] += y * y;
        sums[4] += x * y;
    }
    const double xx = sums[2] - sums[0] * sums[0] / n;
    const double yy = sums[3] - sums[1] * sums[1] / n;
    return (sums[4] - sums[0] * sums[1] / n) / std::sqrt(xx * yy);
}

}  // namespace sateen::test
