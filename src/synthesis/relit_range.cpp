// SPDX-License-Identifier: Apache-2.0
// The relit range map. See relit_range.hpp.
#include "sateen/synthesis/relit_range.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sateen/core/displacement.hpp"
#include "sateen/synthesis/surface.hpp"

namespace sateen {
namespace {

// As Evaluator.
constexpr int kViewSteps = 32;
constexpr int kBisections = 5;
constexpr float kLeastHeight = 0.1F;
constexpr float kLeastMean = 1e-4F;
/// Rays that move by less over the whole relief go straight down.
constexpr float kLeastPath = 0.01F;
/// Pixels; no relief that is worth the name hides more.
constexpr float kFarthestSeen = 1024;

/// The four pixels around a point of a plane, and their shares.
class Taps {
  public:
    Taps(float row, float col, std::size_t rows, std::size_t cols, bool torus)
        : row_(row, rows, torus), col_(col, cols, torus) {}
    [[nodiscard]] float of(PlaneView<const float> plane) const {
        const float* above = plane.row(row_.first);
        const float* below = plane.row(row_.second);
        return (1 - row_.part) * ((1 - col_.part) * above[col_.first] +
                                  col_.part * above[col_.second]) +
               row_.part *
                   ((1 - col_.part) * below[col_.first] + col_.part * below[col_.second]);
    }

  private:
    struct Axis {
        std::size_t first;
        std::size_t second;
        float part;
        Axis(float position, std::size_t size, bool torus) {
            const float whole = std::floor(position);
            part = position - whole;
            auto at = static_cast<std::ptrdiff_t>(whole);
            const auto n = static_cast<std::ptrdiff_t>(size);
            if (torus) {
                at = (at % n + n) % n;
                first = static_cast<std::size_t>(at);
                second = static_cast<std::size_t>(at + 1 == n ? 0 : at + 1);
            } else {
                first =
                    static_cast<std::size_t>(std::clamp(at, std::ptrdiff_t{0}, n - 1));
                second = static_cast<std::size_t>(
                    std::clamp(at + 1, std::ptrdiff_t{0}, n - 1));
            }
        }
    };
    Axis row_;
    Axis col_;
};

}  // namespace

RelitRange::RelitRange(const Surface& surface, Direction view, Direction light)
    : light_(to_vector(light)) {
    const std::array<float, 3> v = to_vector(view);
    const float slope = 1 / std::max(v[2], kLeastHeight);
    cols_per_z_ = v[0] * slope;
    rows_per_z_ = -v[1] * slope;
    lowest_ = highest_ = surface.height_px(surface.tiles[0][0]);
    for (const auto& tile : surface.tiles) {
        const auto [low, high] = std::minmax_element(tile.begin(), tile.end());
        lowest_ = std::min(lowest_, surface.height_px(*low));
        highest_ = std::max(highest_, surface.height_px(*high));
    }
    const float farthest = std::max({0.0F, -lowest_, highest_});
    const float steepest = std::max(std::abs(cols_per_z_), std::abs(rows_per_z_));
    displaces_ = (highest_ - lowest_) * steepest > kLeastPath;
    // One pixel for the central differences, one for the interpolation.
    margin_ = 2;
    if (displaces_)
        margin_ += static_cast<std::size_t>(
            std::min(kFarthestSeen, std::ceil(farthest * steepest)));
    take_statistics(surface);
}

// Of as many tiles beside each other as there are, as the view sees them.
void RelitRange::take_statistics(const Surface& surface) {
    const auto margin = static_cast<std::int32_t>(margin_);
    const PlaneWindow window = {-margin, -margin, surface.rows + 2 * margin_,
                                surface.cols * surface.tiles.size() + 2 * margin_};
    const Result<Image> height = draw_range(surface, window, 0);
    if (!height) return;
    Image white(1, window.rows, window.cols);
    std::fill(white.values().begin(), white.values().end(), 1.0F);
    SerialExecutor serial;
    Image lit = times(white, *height, false, serial);
    const auto count = static_cast<double>(lit.plane_size());
    double total = 0;
    for (const float value : lit.values()) total += static_cast<double>(value);
    const double lamp = std::max(static_cast<double>(kLeastMean), total / count);
    scale_ = static_cast<float>(1 / lamp) / (1 + surface.ambient);
    floor_ = surface.ambient / (1 + surface.ambient);
    double sum = 0;
    double squares = 0;
    double roots = 0;
    for (float& value : lit.values()) {
        value = scale_ * value + floor_;
        sum += static_cast<double>(value);
        squares += static_cast<double>(value) * static_cast<double>(value);
        roots += std::sqrt(static_cast<double>(value));
    }
    const double mean = std::max(static_cast<double>(kLeastMean), sum / count);
    shape_.square =
        static_cast<float>(std::log(std::max(1.0, squares / count / (mean * mean))));
    const double root = roots / count / std::sqrt(mean);
    shape_.root = root > 0 ? static_cast<float>(std::max(0.0, -8 * std::log(root))) : 0;
}

Image RelitRange::times(const Image& texture, const Image& height_px, bool torus,
                        Executor& executor) const {
    const auto height = height_px.plane(0);
    const std::size_t rows = height.rows;
    const std::size_t cols = height.cols;
    const Image normals =
        normals_of(height, torus ? Border::wraps : Border::repeats_last);
    Image lit(1, rows, cols, uninitialised);
    for (std::size_t i = 0; i < lit.plane_size(); ++i)
        lit.values()[i] = normals.plane(0).data[i] * light_[0] +
                          normals.plane(1).data[i] * light_[1] +
                          normals.plane(2).data[i] * light_[2];
    const std::size_t m = torus ? 0 : margin_;
    Image out(texture.bands(), rows - 2 * m, cols - 2 * m, uninitialised);
    parallel_for(executor, out.rows(), [&](std::size_t r) {
        for (std::size_t c = 0; c < out.cols(); ++c) {
            const auto row = static_cast<float>(r + m);
            const auto col = static_cast<float>(c + m);
            const auto taps_at = [&](float z) {
                return Taps(row + z * rows_per_z_, col + z * cols_per_z_, rows, cols,
                            torus);
            };
            const float z =
                displaces_
                    ? meeting_height([&](float at) { return taps_at(at).of(height); },
                                     lowest_, highest_, kViewSteps, kBisections)
                    : 0;
            const Taps taps = taps_at(z);
            const float s =
                scale_ * std::max(0.0F, taps.of(std::as_const(lit).plane(0))) + floor_;
            for (std::size_t b = 0; b < out.bands(); ++b)
                out(b, r, c) = s * taps.of(texture.plane(b));
        }
    });
    return out;
}

}  // namespace sateen
