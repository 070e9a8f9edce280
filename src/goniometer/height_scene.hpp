// SPDX-License-Identifier: Apache-2.0
// The surface as Embree sees it: one period and as much beside it as rays can reach.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::goniometer {

using Vector = std::array<float, 3>;

inline float dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector normalised(const Vector& v) {
    const float scale = 1 / std::sqrt(dot(v, v));
    return {v[0] * scale, v[1] * scale, v[2] * scale};
}

/// Rays that are traced together.
inline constexpr std::size_t kLanes = 16;

struct alignas(64) Lanes {
    std::array<float, kLanes> x{};
    std::array<float, kLanes> y{};
    std::array<float, kLanes> z{};
};
using LaneMask = std::array<std::int32_t, kLanes>;  ///< -1 where a lane counts, or 0

/// A toroidal height field as a grid of triangles. Texel (r, c) is the vertex
/// ((c + ½) cell_x, -(r + ½) cell_y, height).
class HeightScene {
  public:
    /// \param reach  how far beside the period [0, width) x (-depth, 0] rays get, pixels
    /// \error limit_exceeded  too many vertices for a grid
    [[nodiscard]] static Result<HeightScene> create(const Image& height, float cell_x,
                                                    float cell_y, float reach);

    /// Distance to the first triangle along rays of one direction; infinite for none.
    /// \param mask  lanes that count
    [[nodiscard]] std::array<float, kLanes> distances(const Lanes& origins,
                                                      const Vector& direction,
                                                      const LaneMask& mask) const;
    /// Lanes of `mask` whose ray meets nothing.
    [[nodiscard]] LaneMask unoccluded(const Lanes& origins, const Vector& direction,
                                      const LaneMask& mask) const;

  private:
    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    HeightScene() = default;
    std::unique_ptr<RTCDeviceTy, Release> device_;
    std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace sateen::goniometer
