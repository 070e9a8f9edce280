// SPDX-License-Identifier: Apache-2.0
// De-lighting. See delight.hpp.
#include "sateen/analysis/delight.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "sateen/core/displacement.hpp"

namespace sateen {
namespace {

// Views lower than this are followed as if they had this height, as the evaluation does.
constexpr float kLeastHeight = 0.1F;
constexpr int kMostSteps = 32;
constexpr int kBisections = 4;
// Of the mean: turned away from the lamp, or nearly.
constexpr double kDark = 0.15;

/// Bilinear in a plane that repeats its last pixels.
float bilinear(PlaneView<const float> plane, float row, float col) {
    const auto last_row = static_cast<float>(plane.rows - 1);
    const auto last_col = static_cast<float>(plane.cols - 1);
    row = std::clamp(row, 0.0F, last_row);
    col = std::clamp(col, 0.0F, last_col);
    const auto r0 = static_cast<std::size_t>(row);
    const auto c0 = static_cast<std::size_t>(col);
    const std::size_t r1 = std::min(r0 + 1, plane.rows - 1);
    const std::size_t c1 = std::min(c0 + 1, plane.cols - 1);
    const float y = row - static_cast<float>(r0);
    const float x = col - static_cast<float>(c0);
    return (1 - y) * ((1 - x) * plane(r0, c0) + x * plane(r0, c1)) +
           y * ((1 - x) * plane(r1, c0) + x * plane(r1, c1));
}

/// Where the rays of one view meet the surface.
class Sight {
  public:
    Sight(PlaneView<const float> height, Direction view) : height_(height) {
        const std::array<float, 3> v = to_vector(view);
        const float slope = 1 / std::max(v[2], kLeastHeight);
        cols_per_z_ = v[0] * slope;
        rows_per_z_ = -v[1] * slope;
        const auto [low, high] =
            std::minmax_element(height.data, height.data + height.size());
        lowest_ = *low;
        highest_ = *high;
        // Steps of a pixel pass over nothing that shows.
        const float path = (highest_ - lowest_) * std::hypot(cols_per_z_, rows_per_z_);
        steps_ = static_cast<int>(
            std::clamp(std::ceil(path), 1.0F, static_cast<float>(kMostSteps)));
        displaces_ = path > kLeastPath;
    }

    /// Row and column of what pixel (r, c) shows.
    [[nodiscard]] std::array<float, 2> seen(std::size_t r, std::size_t c) const {
        const auto row = static_cast<float>(r);
        const auto col = static_cast<float>(c);
        if (!displaces_) return {row, col};
        const float z = meeting_height(
            [&](float at) {
                return bilinear(height_, row + at * rows_per_z_, col + at * cols_per_z_);
            },
            lowest_, highest_, steps_, kBisections);
        return {row + z * rows_per_z_, col + z * cols_per_z_};
    }

  private:
    static constexpr float kLeastPath = 0.05F;  // pixels
    PlaneView<const float> height_;
    float cols_per_z_ = 0;
    float rows_per_z_ = 0;
    float lowest_ = 0;
    float highest_ = 0;
    int steps_ = 1;
    bool displaces_ = false;
};

float luminance(const Image& image, std::size_t i) {
    if (image.bands() == 1) return image.values()[i];
    return 0.2126F * image.plane(0).data[i] + 0.7152F * image.plane(1).data[i] +
           0.0722F * image.plane(2).data[i];
}

double mean_of(PlaneView<const float> plane) {
    double sum = 0;
    for (std::size_t i = 0; i < plane.size(); ++i)
        sum += static_cast<double>(plane.data[i]);
    return sum / static_cast<double>(plane.size());
}

}  // namespace

Image shading_seen(const RangeMap& surface, Direction view, Direction light) {
    const Image& normals = surface.normals;
    const std::array<float, 3> l = to_vector(light);
    // n·l is linear in n: interpolated as one plane.
    Image lit(1, normals.rows(), normals.cols(), uninitialised);
    for (std::size_t i = 0; i < lit.plane_size(); ++i)
        lit.values()[i] = std::max(0.0F, normals.plane(0).data[i] * l[0] +
                                             normals.plane(1).data[i] * l[1] +
                                             normals.plane(2).data[i] * l[2]);
    const Sight sight(surface.height_px.plane(0), view);
    Image shading(1, normals.rows(), normals.cols(), uninitialised);
    for (std::size_t r = 0; r < shading.rows(); ++r)
        for (std::size_t c = 0; c < shading.cols(); ++c) {
            const auto [row, col] = sight.seen(r, c);
            shading(0, r, c) = bilinear(lit.plane(0), row, col);
        }
    const auto mean = static_cast<float>(mean_of(shading.plane(0)));
    for (float& s : shading.values()) s = mean > 0 ? s / mean : 1;
    return shading;
}

Image with_ambient(Image shading, float ambient) {
    for (float& s : shading.values()) s = (s + ambient) / (1 + ambient);
    return shading;
}

Image divide_by_shading(Image image, const Image& shading) {
    assert(image.plane_size() == shading.plane_size());
    constexpr float kSquare = kShadingFloor * kShadingFloor;
    for (std::size_t band = 0; band < image.bands(); ++band) {
        const auto plane = image.plane(band);
        const double mean = mean_of(plane);
        const float pull = kSquare * static_cast<float>(mean);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            const float s = shading.values()[i];
            plane.data[i] = (s * plane.data[i] + pull) / (s * s + kSquare);
        }
        const double divided = mean_of(plane);
        const auto scale = static_cast<float>(divided > 0 ? mean / divided : 1);
        for (std::size_t i = 0; i < plane.size(); ++i) plane.data[i] *= scale;
    }
    return image;
}

void ExplainedContrast::add(const Image& image, const Image& of_surface, double weight) {
    assert(image.plane_size() == of_surface.plane_size());
    double n = 0;
    double x = 0;
    double y = 0;
    double xx = 0;
    double yy = 0;
    double xy = 0;
    double in_dark = 0;
    double dark_x = 0;
    double dark_y = 0;
    for (std::size_t r = 0; r < image.rows(); r += 2)
        for (std::size_t c = 0; c < image.cols(); c += 2) {
            const std::size_t i = r * image.cols() + c;
            const auto value = static_cast<double>(luminance(image, i));
            const auto s = static_cast<double>(of_surface.values()[i]);
            n += 1;
            x += s;
            y += value;
            xx += s * s;
            yy += value * value;
            xy += s * value;
            if (s >= kDark) continue;
            in_dark += 1;
            dark_x += s;
            dark_y += value;
        }
    const double variance_x = xx / n - x / n * (x / n);
    const double variance_y = yy / n - y / n * (y / n);
    const double covariance = xy / n - x / n * (y / n);
    if (!(variance_y > 0) || !(y > 0)) return;
    const double contrast = weight * variance_y / (y / n * (y / n));
    total += contrast;
    dark += weight * in_dark / n;
    dark_image += weight * dark_y / n / (y / n);
    dark_shading += weight * dark_x / n;
    // Bright where the surface is turned away explains nothing.
    if (variance_x > 0 && covariance > 0)
        explained += contrast * covariance * covariance / (variance_x * variance_y);
}

void ExplainedContrast::add(const ExplainedContrast& other) {
    explained += other.explained;
    total += other.total;
    dark += other.dark;
    dark_image += other.dark_image;
    dark_shading += other.dark_shading;
}

float ExplainedContrast::ambient() const {
    if (!(dark > 0)) return 0;
    const double seen = dark_image / dark;
    const double lit = dark_shading / dark;
    if (seen <= lit) return 0;
    constexpr auto kMost = static_cast<double>(kMaxAmbient);
    return static_cast<float>(seen < 1 ? std::min(kMost, (seen - lit) / (1 - seen))
                                       : kMost);
}

}  // namespace sateen
