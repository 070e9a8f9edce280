// SPDX-License-Identifier: Apache-2.0
// Band split and modulation by their definitions, in double, pixel by pixel.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sateen/core/band_split.hpp"
#include "sateen/material/band_modulation.hpp"

namespace sateen::reference {

struct Plane {
    std::int64_t rows = 0;
    std::int64_t cols = 0;
    std::vector<double> values;
    Plane(std::int64_t r, std::int64_t c)
        : rows(r), cols(c), values(static_cast<std::size_t>(r * c)) {}
    double& operator()(std::int64_t r, std::int64_t c) {
        return values[static_cast<std::size_t>(r * cols + c)];
    }
    double operator()(std::int64_t r, std::int64_t c) const {
        return values[static_cast<std::size_t>(r * cols + c)];
    }
};

inline Plane plane_of(PlaneView<const float> view) {
    Plane out(static_cast<std::int64_t>(view.rows), static_cast<std::int64_t>(view.cols));
    for (std::size_t r = 0; r < view.rows; ++r)
        for (std::size_t c = 0; c < view.cols; ++c)
            out(static_cast<std::int64_t>(r), static_cast<std::int64_t>(c)) =
                static_cast<double>(view(r, c));
    return out;
}

inline double beyond(const Plane& p, std::int64_t r, std::int64_t c, Border border) {
    const auto site = [border](std::int64_t k, std::int64_t n) {
        while (k < 0 || k >= n) {
            if (border == Border::wrap)
                k += k < 0 ? n : -n;
            else
                k = k < 0 ? -1 - k : 2 * n - 1 - k;
        }
        return k;
    };
    return p(site(r, p.rows), site(c, p.cols));
}

inline Plane smoothed(const Plane& p, std::int64_t spacing, Border border) {
    constexpr std::array<double, 5> w = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0,
                                         1 / 16.0};
    Plane out(p.rows, p.cols);
    for (std::int64_t r = 0; r < p.rows; ++r)
        for (std::int64_t c = 0; c < p.cols; ++c)
            for (std::int64_t i = -2; i <= 2; ++i)
                for (std::int64_t j = -2; j <= 2; ++j)
                    out(r, c) += w[static_cast<std::size_t>(i + 2)] *
                                 w[static_cast<std::size_t>(j + 2)] *
                                 beyond(p, r + i * spacing, c + j * spacing, border);
    return out;
}

inline Plane energy_of(const Plane& band, std::size_t level, Border border) {
    Plane squares = band;
    for (double& value : squares.values) value *= value;
    const std::int64_t spacing = std::int64_t{1} << level;
    return smoothed(smoothed(squares, level == 0 ? 1 : spacing / 2, border), spacing,
                    border);
}

/// L: e + m of 2^e (1 + m).
inline double linear_log2(double x) {
    int e = 0;
    const double m = std::frexp(x, &e);
    return e - 1 + (2 * m - 1);
}
inline double linear_exp2(double u) {
    const double e = std::floor(u);
    return std::ldexp(1 + (u - e), static_cast<int>(e));
}

inline double curve_at(const AmplitudeCurve& curve, double low, double high, double x) {
    const double t = std::fmin(std::fmax((x - low) / (high - low) * 7, 0.0), 7.0);
    const auto j = static_cast<std::size_t>(std::fmin(t, 6.0));
    const double a = curve.values[j] / 32.0;
    const double b = curve.values[j + 1] / 32.0;
    return a + (t - static_cast<double>(j)) * (b - a);
}

/// \param field  h(level, row, col)
inline std::vector<Plane> modulated(
    std::vector<Plane> planes, const SubspaceModulation& modulation,
    const std::function<double(std::size_t, std::int64_t, std::int64_t)>& field,
    Border border) {
    constexpr std::size_t kLevels = BandModulation::kLevels;
    std::vector<Plane> first;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        std::vector<Plane> bands;
        Plane low = planes[k];
        for (std::size_t level = 0; level < kLevels; ++level) {
            const Plane next = smoothed(low, std::int64_t{1} << level, border);
            Plane band = low;
            for (std::size_t i = 0; i < band.values.size(); ++i)
                band.values[i] -= next.values[i];
            bands.push_back(band);
            low = next;
        }
        std::vector<Plane> energies(kLevels, low);
        for (std::size_t level = kLevels; level-- > 0;) {
            const ModulatedBand& how = modulation.bands[k * kLevels + level];
            const auto amplitude = [](const Plane& E, double scale, std::int64_t r,
                                      std::int64_t c) {
                return linear_log2(E(r, c) * scale + 1e-3) / 2;
            };
            for (std::int64_t r = 0; r < low.rows; ++r)
                for (std::int64_t c = 0; c < low.cols; ++c) {
                    double u = k == 0 ? field(level, r, c) : 0;
                    u += curve_at(how.of_value, -2.5, 2.5,
                                  low(r, c) * static_cast<double>(how.value_scale));
                    if (level + 1 < kLevels)
                        u += curve_at(
                            how.of_parent, -2.5, 1.5,
                            amplitude(energies[level + 1],
                                      static_cast<double>(
                                          modulation.bands[k * kLevels + level + 1]
                                              .energy_scale),
                                      r, c));
                    if (k > 0)
                        u += curve_at(how.of_first, -2.5, 1.5,
                                      amplitude(first[level],
                                                static_cast<double>(
                                                    modulation.bands[level].energy_scale),
                                                r, c));
                    bands[level](r, c) *= static_cast<double>(how.gain) * linear_exp2(u);
                }
            for (std::size_t i = 0; i < low.values.size(); ++i)
                low.values[i] += bands[level].values[i];
            energies[level] = energy_of(bands[level], level, border);
        }
        if (k == 0) first = energies;
        for (std::size_t i = 0; i < low.values.size(); ++i)
            planes[k].values[i] =
                low.values[i] * static_cast<double>(modulation.units[k]);
    }
    return planes;
}

}  // namespace sateen::reference
