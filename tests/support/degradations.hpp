// SPDX-License-Identifier: Apache-2.0
// Pictures that are wrong in a known way, for trying a measure of similarity.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sateen/core/colour.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"

namespace sateen::test {

inline Image crop(const Image& image, std::size_t row, std::size_t col, std::size_t rows,
                  std::size_t cols) {
    Image out(image.bands(), rows, cols);
    for (std::size_t b = 0; b < image.bands(); ++b) {
        const auto window = image.plane(b).window(row, col, rows, cols);
        for (std::size_t r = 0; r < rows; ++r) {
            std::copy_n(window.row(r), cols, out.plane(b).row(r));
        }
    }
    return out;
}

template <class F>
Image mapped(Image image, F&& f) {
    for (float& v : image.values()) v = f(v);
    return image;
}

inline Image encoded(const Image& linear) {
    return mapped(linear, [](float v) { return srgb_encode(v); });
}

/// Back to linear by way of eight bits, as a file would.
inline Image through_eight_bits(const Image& code_values) {
    return mapped(code_values, [](float v) {
        return srgb_decode(std::round(std::clamp(v, 0.0F, 1.0F) * 255) / 255);
    });
}

inline Image negative(const Image& linear) {
    return through_eight_bits(mapped(encoded(linear), [](float v) { return 1 - v; }));
}

/// Red becomes green, green blue, blue red; a grey image is only made darker.
inline Image wrong_colours(const Image& linear) {
    if (linear.bands() == 1) return mapped(linear, [](float v) { return v / 2; });
    Image out = linear;
    const auto n = static_cast<std::ptrdiff_t>(linear.plane_size());
    std::rotate(out.values().begin(), out.values().end() - n, out.values().end());
    return out;
}

inline Image tinted(const Image& linear) {
    Image out = linear;
    for (std::size_t b = 0; b < out.bands(); ++b) {
        const float gain = b == 0 ? 1.25F : b == 1 ? 1.0F : 0.8F;
        for (std::size_t i = 0; i < out.plane_size(); ++i) {
            out.values()[b * out.plane_size() + i] *= gain;
        }
    }
    return through_eight_bits(encoded(out));
}

/// The same pixels in another order.
inline Image shuffled(const Image& image, std::uint32_t seed) {
    Image out = image;
    const std::size_t n = image.plane_size();
    for (std::size_t i = n - 1; i > 0; --i) {
        const auto word =
            philox4x32_10({static_cast<std::uint32_t>(i), 0, 0, 0}, {seed, 0})[0];
        const std::size_t j = word % (i + 1);
        for (std::size_t b = 0; b < out.bands(); ++b) {
            std::swap(out.values()[b * n + i], out.values()[b * n + j]);
        }
    }
    return out;
}

/// A Gaussian of `sigma` pixels, borders repeated.
inline Image blurred(const Image& image, double sigma) {
    const auto radius = static_cast<std::ptrdiff_t>(std::ceil(3 * sigma));
    std::vector<float> kernel;
    for (std::ptrdiff_t i = -radius; i <= radius; ++i) {
        kernel.push_back(static_cast<float>(
            std::exp(-0.5 * static_cast<double>(i * i) / (sigma * sigma))));
    }
    float total = 0;
    for (float k : kernel) total += k;
    Image out = image;
    for (int pass = 0; pass < 2; ++pass) {
        const Image in = out;
        const auto rows = static_cast<std::ptrdiff_t>(in.rows());
        const auto cols = static_cast<std::ptrdiff_t>(in.cols());
        for (std::size_t b = 0; b < in.bands(); ++b) {
            for (std::ptrdiff_t r = 0; r < rows; ++r) {
                for (std::ptrdiff_t c = 0; c < cols; ++c) {
                    float sum = 0;
                    for (std::ptrdiff_t i = -radius; i <= radius; ++i) {
                        const auto rr = std::clamp(pass == 0 ? r : r + i,
                                                   std::ptrdiff_t{0}, rows - 1);
                        const auto cc = std::clamp(pass == 0 ? c + i : c,
                                                   std::ptrdiff_t{0}, cols - 1);
                        sum += kernel[static_cast<std::size_t>(i + radius)] *
                               in(b, static_cast<std::size_t>(rr),
                                  static_cast<std::size_t>(cc));
                    }
                    out(b, static_cast<std::size_t>(r), static_cast<std::size_t>(c)) =
                        sum / total;
                }
            }
        }
    }
    return out;
}

/// Independent pixels with the mean and the deviation of each plane, as code values.
inline Image white_noise_like(const Image& linear, std::uint64_t seed) {
    Image out = encoded(linear);
    for (std::size_t b = 0; b < out.bands(); ++b) {
        double sum = 0;
        double square = 0;
        const auto plane = out.values().subspan(b * out.plane_size(), out.plane_size());
        for (float v : plane) {
            sum += static_cast<double>(v);
            square += static_cast<double>(v) * static_cast<double>(v);
        }
        const double mean = sum / static_cast<double>(plane.size());
        const double deviation = std::sqrt(
            std::max(0.0, square / static_cast<double>(plane.size()) - mean * mean));
        for (std::size_t r = 0; r < out.rows(); ++r) {
            const auto row = plane.subspan(r * out.cols(), out.cols());
            draw_normals({seed, static_cast<std::uint32_t>(b)},
                         static_cast<std::int32_t>(r), 0, row);
            for (float& v : row)
                v = static_cast<float>(mean + deviation * static_cast<double>(v));
        }
    }
    return through_eight_bits(out);
}

}  // namespace sateen::test
