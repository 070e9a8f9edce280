// SPDX-License-Identifier: Apache-2.0
#include "analysis/quality_parts.hpp"
#include "sateen/core/colour.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>
#include <string>

namespace sateen::quality {
namespace {

std::vector<float> luminance(const Image& linear) {
    const std::size_t n = linear.plane_size();
    const auto v = linear.values();
    if (linear.bands() == 1) return {v.begin(), v.end()};
    std::vector<float> y(n);
    const auto& weights = kRelativeXyzOfLinearSrgb[1];
    const auto red = static_cast<float>(weights[0]);
    const auto green = static_cast<float>(weights[1]);
    const auto blue = static_cast<float>(weights[2]);
    for (std::size_t i = 0; i < n; ++i) {
        y[i] = red * v[i] + green * v[n + i] + blue * v[2 * n + i];
    }
    return y;
}

constexpr std::size_t kDirections = 16;

// Points of a Fibonacci lattice on the upper half sphere.
std::array<std::array<float, 3>, kDirections> directions() {
    std::array<std::array<float, 3>, kDirections> points{};
    for (std::size_t i = 0; i < kDirections; ++i) {
        const double z = (static_cast<double>(i) + 0.5) / kDirections;
        const double phi =
            2 * std::numbers::pi * std::numbers::phi * static_cast<double>(i);
        const double radius = std::sqrt(1 - z * z);
        points[i] = {static_cast<float>(radius * std::cos(phi)),
                     static_cast<float>(radius * std::sin(phi)), static_cast<float>(z)};
    }
    return points;
}

// Quantiles from a histogram: with bins finer than what is visible, sorting buys nothing.
constexpr float kBinsPerUnit = 4;
constexpr float kRange = 256;
constexpr std::size_t kBins = 2048;
constexpr std::size_t kQuantiles = 64;

void read_quantiles(const std::vector<std::uint32_t>& histogram, std::size_t total,
                    std::span<double> quantiles) {
    std::size_t bin = 0;
    double below = 0;
    for (std::size_t q = 0; q < quantiles.size(); ++q) {
        const double target = (static_cast<double>(q) + 0.5) /
                              static_cast<double>(quantiles.size()) *
                              static_cast<double>(total);
        while (bin + 1 < kBins && below + histogram[bin] < target)
            below += histogram[bin++];
        const double within =
            histogram[bin] > 0 ? (target - below) / histogram[bin] : 0.5;
        quantiles[q] =
            (static_cast<double>(bin) + within) / static_cast<double>(kBinsPerUnit) -
            static_cast<double>(kRange);
    }
}

}  // namespace

Result<void> check_image(const Image& image, const char* role) {
    const std::string name = role;
    if (image.bands() != 1 && image.bands() != 3) {
        return Error{Errc::invalid_argument, name + ": " + std::to_string(image.bands()) +
                                                 " bands, expected 1 or 3"};
    }
    constexpr std::size_t kMin = 32;
    if (image.rows() < kMin || image.cols() < kMin) {
        return Error{Errc::invalid_argument,
                     name + ": " + std::to_string(image.cols()) + "x" +
                         std::to_string(image.rows()) + " pixels, expected at least " +
                         std::to_string(kMin) + "x" + std::to_string(kMin)};
    }
    for (float v : image.values()) {
        if (!std::isfinite(v)) {
            return Error{Errc::invalid_argument,
                         name + ": holds a value that is not finite"};
        }
    }
    return {};
}

float choose_exposure(const Image& linear) {
    std::vector<float> y = luminance(linear);
    const auto white =
        y.begin() + static_cast<std::ptrdiff_t>((y.size() - 1) * 995 / 1000);
    std::nth_element(y.begin(), white, y.end());
    // Pictures meant for a display are taken as they are; anything brighter, or too dark
    // for Lab to be more than its straight line, is brought to mid range first.
    constexpr float kBrightest = 1.05F;
    constexpr float kDarkest = 0.01F;
    constexpr float kTarget = 0.5F;
    if (*white > kBrightest || (*white<kDarkest&& * white> 0)) return kTarget / *white;
    return 1;
}

Image to_lab(const Image& linear, float exposure) {
    Image lab(3, linear.rows(), linear.cols());
    const std::size_t n = linear.plane_size();
    std::vector<float> exposed(linear.values().begin(), linear.values().end());
    for (float& v : exposed) v *= exposure;
    const std::span<const float> in = exposed;
    const std::span<float> out = lab.values();
    if (linear.bands() == 1) {
        lightness_from_linear(in, out.first(n));
    } else {
        lab_from_linear_srgb(in.first(n), in.subspan(n, n), in.subspan(2 * n, n),
                             out.first(n), out.subspan(n, n), out.subspan(2 * n, n));
    }
    return lab;
}

ColourBasis estimate_basis(const Image& linear) {
    ColourBasis basis;
    basis.exposure = choose_exposure(linear);
    const Image lab = to_lab(linear, basis.exposure);
    const auto n = static_cast<double>(lab.plane_size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t r = 0; r < lab.rows(); ++r) {
        for (std::size_t c = 0; c < lab.cols(); ++c) {
            const Eigen::Vector3d x =
                Eigen::Vector3f(lab(0, r, c), lab(1, r, c), lab(2, r, c)).cast<double>();
            mean += x;
            covariance += x * x.transpose();
        }
    }
    mean /= n;
    covariance = covariance / n - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    double total = 0;
    for (std::size_t p = 0; p < kPlanes; ++p) {
        const auto column = static_cast<Eigen::Index>(kPlanes - 1 - p);
        const auto k = static_cast<Eigen::Index>(p);
        basis.mean[p] = static_cast<float>(mean[k]);
        for (std::size_t i = 0; i < 3; ++i) {
            basis.axes[p][i] = static_cast<float>(
                solver.eigenvectors()(static_cast<Eigen::Index>(i), column));
        }
        basis.deviation[p] = std::sqrt(std::max(0.0, solver.eigenvalues()[column]));
        basis.weight[p] = basis.deviation[p] > 2 * kInvisible ? basis.deviation[p] : 0;
        total += basis.weight[p];
    }
    if (total == 0) {
        basis.weight = {1, 0, 0};
        return basis;
    }
    for (double& w : basis.weight) w /= total;
    return basis;
}

Image to_planes(const Image& linear, const ColourBasis& basis) {
    Image planes = to_lab(linear, basis.exposure);
    const std::size_t n = planes.plane_size();
    const auto v = planes.values();
    for (std::size_t i = 0; i < n; ++i) {
        const std::array<float, 3> x = {v[i] - basis.mean[0], v[n + i] - basis.mean[1],
                                        v[2 * n + i] - basis.mean[2]};
        for (std::size_t p = 0; p < kPlanes; ++p) {
            const auto& a = basis.axes[p];
            v[p * n + i] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
        }
    }
    return planes;
}

Image to_lightness(const Image& linear, float exposure) {
    Image lightness(1, linear.rows(), linear.cols());
    std::vector<float> y = luminance(linear);
    for (float& v : y) v *= exposure;
    lightness_from_linear(y, lightness.values());
    return lightness;
}

void add_colour(ImageView<const float> planes, std::size_t row, std::size_t col,
                std::size_t rows, std::size_t cols, Features& features) {
    // Light falls off over any photograph: a shift of the mean is judged against what is
    // just visible side by side, and axis by axis, since light moves lightness and wrong
    // colours move the others; the shape of the distribution is judged more strictly.
    constexpr double kMeanFloor = 1;
    constexpr double kShapeFloor = 0.3;
    for (std::size_t p = 0; p < kPlanes; ++p) {
        const auto window = planes.plane(p).window(row, col, rows, cols);
        double sum = 0;
        for (std::size_t r = 0; r < rows; ++r) {
            const float* x = window.row(r);
            sum += std::accumulate(x, x + cols, 0.0);
        }
        features.begin_group(0.5 / kPlanes, kMeanFloor);
        features.add(sum / static_cast<double>(rows * cols));
    }
    // √3 undoes the mean square of a direction cosine.
    const double scale = std::sqrt(3.0);
    std::array<double, kQuantiles> quantiles{};
    std::vector<std::uint32_t> histogram(kBins);
    for (const auto& d : directions()) {
        std::fill(histogram.begin(), histogram.end(), 0);
        for (std::size_t r = row; r < row + rows; ++r) {
            const float* p0 = planes.plane(0).row(r) + col;
            const float* p1 = planes.plane(1).row(r) + col;
            const float* p2 = planes.plane(2).row(r) + col;
            for (std::size_t c = 0; c < cols; ++c) {
                const float x = d[0] * p0[c] + d[1] * p1[c] + d[2] * p2[c];
                const float bin =
                    std::clamp((x + kRange) * kBinsPerUnit, 0.0F, float{kBins - 1});
                ++histogram[static_cast<std::size_t>(bin)];
            }
        }
        read_quantiles(histogram, rows * cols, quantiles);
        const double mean =
            std::accumulate(quantiles.begin(), quantiles.end(), 0.0) / kQuantiles;
        features.begin_group(0.5 / kDirections, kShapeFloor);
        for (double q : quantiles) features.add(scale * (q - mean));
    }
}

}  // namespace sateen::quality
