// SPDX-License-Identifier: Apache-2.0
// Embree behind two calls. See height_scene.hpp.
#include "goniometer/height_scene.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace sateen::goniometer {
namespace {

constexpr std::int64_t kMaxGridSide = 32767;
constexpr std::int64_t kMaxVertices = std::int64_t{1} << 27;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Cells beyond the period on each side.
std::int64_t border(float reach, float cell) {
    return static_cast<std::int64_t>(std::ceil(reach / cell)) + 2;
}

std::size_t wrapped(std::int64_t index, std::size_t size) {
    const auto n = static_cast<std::int64_t>(size);
    return static_cast<std::size_t>((index % n + n) % n);
}

/// Rays of one direction from the given origins.
void fill(RTCRay16& rays, const Lanes& origins, const Vector& direction) {
    for (std::size_t i = 0; i < kLanes; ++i) {
        rays.org_x[i] = origins.x[i];
        rays.org_y[i] = origins.y[i];
        rays.org_z[i] = origins.z[i];
        rays.tnear[i] = 0;
        rays.dir_x[i] = direction[0];
        rays.dir_y[i] = direction[1];
        rays.dir_z[i] = direction[2];
        rays.time[i] = 0;
        rays.tfar[i] = kInfinity;
        rays.mask[i] = 0xFFFFFFFFU;
        rays.id[i] = 0;
        rays.flags[i] = 0;
    }
}

RTCIntersectContext coherent_context() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}

}  // namespace

Result<HeightScene> HeightScene::create(const Image& height, float cell_x, float cell_y,
                                        float reach) {
    const std::int64_t left = border(reach, cell_x);
    const std::int64_t top = border(reach, cell_y);
    const std::int64_t cols = static_cast<std::int64_t>(height.cols()) + 2 * left;
    const std::int64_t rows = static_cast<std::int64_t>(height.rows()) + 2 * top;
    if (cols > kMaxGridSide || rows > kMaxGridSide || cols * rows > kMaxVertices)
        return Error{Errc::limit_exceeded,
                     "surface: with what grazing rays meet beside it, it has " +
                         std::to_string(cols) + " x " + std::to_string(rows) +
                         " vertices, expected at most 32767 a side and 2^27 in all"};
    HeightScene result;
    // "threads=1" would limit oneTBB in the whole process.
    result.device_.reset(rtcNewDevice(nullptr));
    if (!result.device_) return Error{Errc::unsupported, "Embree: no device"};
    result.scene_.reset(rtcNewScene(result.device_.get()));
    rtcSetSceneFlags(result.scene_.get(), RTC_SCENE_FLAG_ROBUST);

    const RTCGeometry geometry =
        rtcNewGeometry(result.device_.get(), RTC_GEOMETRY_TYPE_GRID);
    auto* const grid = static_cast<RTCGrid*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
    auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
        static_cast<std::size_t>(rows * cols)));
    if (grid == nullptr || vertex == nullptr) {
        rtcReleaseGeometry(geometry);
        return Error{Errc::limit_exceeded, "surface: not enough memory for its grid"};
    }
    grid->startVertexID = 0;
    grid->stride = static_cast<unsigned>(cols);
    grid->width = static_cast<std::uint16_t>(cols);
    grid->height = static_cast<std::uint16_t>(rows);
    for (std::int64_t r = -top; r < rows - top; ++r) {
        const float* const row = height.plane(0).row(wrapped(r, height.rows()));
        for (std::int64_t c = -left; c < cols - left; ++c) {
            *vertex++ = (static_cast<float>(c) + 0.5F) * cell_x;
            *vertex++ = -(static_cast<float>(r) + 0.5F) * cell_y;
            *vertex++ = row[wrapped(c, height.cols())];
        }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(result.scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(result.scene_.get());
    if (rtcGetDeviceError(result.device_.get()) != RTC_ERROR_NONE)
        return Error{Errc::limit_exceeded, "Embree: cannot build the surface"};
    return result;
}

std::array<float, kLanes> HeightScene::distances(const Lanes& origins,
                                                 const Vector& direction,
                                                 const LaneMask& mask) const {
    RTCRayHit16 rays;
    fill(rays.ray, origins, direction);
    for (std::size_t i = 0; i < kLanes; ++i) {
        rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    alignas(64) const LaneMask valid = mask;
    RTCIntersectContext context = coherent_context();
    rtcIntersect16(valid.data(), scene_.get(), &context, &rays);
    std::array<float, kLanes> result{};
    for (std::size_t i = 0; i < kLanes; ++i) result[i] = rays.ray.tfar[i];
    return result;
}

LaneMask HeightScene::unoccluded(const Lanes& origins, const Vector& direction,
                                 const LaneMask& mask) const {
    RTCRay16 rays;
    fill(rays, origins, direction);
    alignas(64) const LaneMask valid = mask;
    RTCIntersectContext context = coherent_context();
    rtcOccluded16(valid.data(), scene_.get(), &context, &rays);
    LaneMask free{};
    // Embree sets tfar of an occluded ray to minus infinity.
    for (std::size_t i = 0; i < kLanes; ++i)
        free[i] = mask[i] != 0 && rays.tfar[i] > 0 ? -1 : 0;
    return free;
}

}  // namespace sateen::goniometer
