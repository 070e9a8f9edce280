// SPDX-License-Identifier: Apache-2.0
// Primary and shadow rays by Embree, 16 samples of a pixel at a time. See renderer.hpp.
#include "sateen/render/renderer.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "render/vector.hpp"
#include "sateen/core/normal.hpp"

namespace sateen {
namespace {

using vector3::cross;
using vector3::difference;
using vector3::dot;
using vector3::sum;
using vector3::times;
using vector3::unit;

constexpr std::size_t kGrid = 4;
constexpr std::size_t kSamples = kGrid * kGrid;
/// Which part of the environment's rows a sample of the pixel takes: a magic square, so
/// that the part goes neither with the row nor with the column of the sample, along which
/// the normal turns.
constexpr std::array<std::size_t, kSamples> kStratum = {15, 2, 1, 12, 4, 9,  10, 7,
                                                        8,  5, 6, 11, 3, 14, 13, 0};
/// Points that are shaded at a time, about.
constexpr std::size_t kShadedTogether = 1024;

struct ReleaseEmbree {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

/// The mesh as Embree sees it.
class Geometry {
  public:
    [[nodiscard]] static Result<Geometry> create(const Mesh& mesh) {
        Geometry result;
        result.device_.reset(rtcNewDevice(nullptr));
        if (!result.device_) return Error{Errc::unsupported, "Embree: no device"};
        result.scene_.reset(rtcNewScene(result.device_.get()));
        // Rays through an edge must not pass between its triangles.
        rtcSetSceneFlags(result.scene_.get(), RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry =
            rtcNewGeometry(result.device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        void* const vertices = rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector3),
            mesh.position.size());
        void* const indices =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), mesh.triangles.size());
        if (vertices == nullptr || indices == nullptr) {
            rtcReleaseGeometry(geometry);
            return Error{Errc::limit_exceeded, "mesh: not enough memory"};
        }
        std::copy(mesh.position.begin(), mesh.position.end(),
                  static_cast<Vector3*>(vertices));
        std::copy(mesh.triangles.begin(), mesh.triangles.end(),
                  static_cast<std::array<std::uint32_t, 3>*>(indices));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(result.scene_.get(), geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(result.scene_.get());
        return result;
    }

    void intersect(RTCRayHit16& rays) const {
        alignas(64) std::array<int, kSamples> valid;
        valid.fill(-1);
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcIntersect16(valid.data(), scene_.get(), &context, &rays);
    }

    /// Of rays with a mark, clears the marks of those that hit something.
    void occlude(std::array<int, kSamples>& marks, RTCRay16& rays) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcOccluded16(marks.data(), scene_.get(), &context, &rays);
        for (std::size_t i = 0; i < kSamples; ++i)
            if (rays.tfar[i] < 0) marks[i] = 0;
    }

  private:
    Geometry() = default;
    std::unique_ptr<RTCDeviceTy, ReleaseEmbree> device_;
    std::unique_ptr<RTCSceneTy, ReleaseEmbree> scene_;
};

struct Camera {
    Vector3 eye;
    Vector3 right;
    Vector3 up;
    Vector3 ahead;
    float half_height = 0;  ///< of the picture, at distance 1
    float half_width = 0;
};

Camera camera_of(const RenderOptions& options) {
    const Vector3 out = to_vector(options.view);
    Camera camera;
    camera.ahead = times(out, -1);
    // Towards the pole; seen from the pole itself, +y.
    const float theta = options.view.theta;
    const float phi = theta == 0 ? -std::numbers::pi_v<float> / 2 : options.view.phi;
    camera.up = {-std::cos(theta) * std::cos(phi), -std::cos(theta) * std::sin(phi),
                 std::sin(theta)};
    camera.right = cross(camera.ahead, camera.up);
    const float half = std::tan(options.field_of_view / 2);
    const auto rows = static_cast<float>(options.rows);
    const auto cols = static_cast<float>(options.cols);
    camera.half_height = half * std::max(1.0F, rows / cols);
    camera.half_width = half * std::max(1.0F, cols / rows);
    constexpr float kRoom = 1.06F;
    camera.eye = times(out, kRoom / std::sin(options.field_of_view / 2));
    return camera;
}

/// The frame of a hit.
struct Frame {
    Vector3 point{};
    Vector3 normal{};
    Vector3 tangent{};
    Vector3 bitangent{};
    float u = 0;
    float v = 0;

    [[nodiscard]] Vector3 local(const Vector3& direction) const {
        return {dot(direction, tangent), dot(direction, bitangent),
                dot(direction, normal)};
    }
};

Frame frame_at(const Mesh& mesh, std::uint32_t triangle, float b, float c,
               const Vector3& point, const Vector3& face, const Vector3& to_eye) {
    const auto& corners = mesh.triangles[triangle];
    const auto blend = [&](const std::vector<Vector3>& values) {
        return sum(
            sum(times(values[corners[0]], 1 - b - c), times(values[corners[1]], b)),
            times(values[corners[2]], c));
    };
    Frame frame;
    frame.point = point;
    frame.normal = unit(blend(mesh.normal));
    const Vector3 along = blend(mesh.tangent);
    frame.tangent =
        unit(difference(along, times(frame.normal, dot(frame.normal, along))));
    frame.bitangent = cross(frame.normal, frame.tangent);
    // The back of a cloth is cloth as well. Which side is seen is told by the triangle: at a
    // rim the normal between its corners may lean away already.
    if (dot(face, to_eye) * dot(face, frame.normal) < 0) {
        frame.normal = times(frame.normal, -1);
        frame.tangent = times(frame.tangent, -1);
    }
    const auto& uv = mesh.uv;
    frame.u =
        (1 - b - c) * uv[corners[0]][0] + b * uv[corners[1]][0] + c * uv[corners[2]][0];
    frame.v =
        (1 - b - c) * uv[corners[0]][1] + b * uv[corners[1]][1] + c * uv[corners[2]][1];
    return frame;
}

/// Points that wait to be shaded, with what each counts for and in which column.
struct Pending {
    std::vector<LitPoint> points;
    std::vector<Vector3> weights;
    std::vector<std::size_t> cols;
    std::vector<Vector3> values;
};

/// What the 16 samples of a pixel hit.
struct Hits {
    std::array<int, kSamples> valid{};  ///< -1 where something was
    std::array<Frame, kSamples> frames;
    std::array<Vector3, kSamples> views;  ///< in the frame
};

class Picture {
  public:
    Picture(const Scene& scene, const Geometry& geometry, const ShadePoints& shade,
            const RenderOptions& options)
        : scene_(scene),
          geometry_(geometry),
          shade_(shade),
          options_(options),
          camera_(camera_of(options)) {
        for (const DistantLight& light : scene.lights)
            lights_.push_back(to_vector(light.direction));
    }

    void row(std::size_t r, Image& image) const {
        Pending pending;
        std::vector<Vector3> colours(options_.cols);
        for (std::size_t c = 0; c < options_.cols; ++c) {
            colours[c] = pixel(r, c, pending);
            if (pending.points.size() >= kShadedTogether || c + 1 == options_.cols)
                shade(pending, colours);
        }
        for (std::size_t c = 0; c < options_.cols; ++c)
            for (std::size_t band = 0; band < 3; ++band)
                image(band, r, c) = colours[c][band] / kSamples;
    }

  private:
    [[nodiscard]] Vector3 ray_direction(std::size_t r, std::size_t c,
                                        std::size_t sample) const {
        const auto place = [](std::size_t cell, std::size_t part, std::size_t count) {
            return 2 *
                       (static_cast<float>(cell) +
                        (static_cast<float>(part) + 0.5F) / kGrid) /
                       static_cast<float>(count) -
                   1;
        };
        const float x = camera_.half_width * place(c, sample % kGrid, options_.cols);
        const float y = -camera_.half_height * place(r, sample / kGrid, options_.rows);
        return unit(
            sum(camera_.ahead, sum(times(camera_.right, x), times(camera_.up, y))));
    }

    [[nodiscard]] Vector3 background(const Vector3& direction) const {
        if (scene_.environment != nullptr) return scene_.environment->radiance(direction);
        const float height =
            dot(direction, camera_.up) / (2 * camera_.half_height) + 0.5F;
        const float t = std::clamp(height, 0.0F, 1.0F);
        return sum(times(scene_.background_bottom, 1 - t),
                   times(scene_.background_top, t));
    }

    void shade(Pending& pending, std::vector<Vector3>& colours) const {
        pending.values.resize(pending.points.size());
        if (!pending.points.empty()) shade_(pending.points, pending.values);
        for (std::size_t k = 0; k < pending.values.size(); ++k)
            for (std::size_t band = 0; band < 3; ++band)
                colours[pending.cols[k]][band] +=
                    pending.weights[k][band] * pending.values[k][band];
        pending.points.clear();
        pending.weights.clear();
        pending.cols.clear();
    }

    /// One light a sample, where nothing hides it.
    void add_light(const Hits& hits, const std::array<Vector3, kSamples>& lights,
                   const std::array<Vector3, kSamples>& weights, std::size_t col,
                   Pending& pending) const {
        alignas(64) std::array<int, kSamples> marks = hits.valid;
        std::array<Vector3, kSamples> local;
        RTCRay16 rays{};
        for (std::size_t i = 0; i < kSamples; ++i) {
            if (marks[i] == 0) continue;
            const Frame& frame = hits.frames[i];
            local[i] = frame.local(lights[i]);
            const float strength = weights[i][0] + weights[i][1] + weights[i][2];
            if (local[i][2] <= 0 || !(strength > 0)) {
                marks[i] = 0;
                continue;
            }
            const Vector3 from =
                sum(frame.point, times(frame.normal, scene_.shadow_lift));
            rays.org_x[i] = from[0];
            rays.org_y[i] = from[1];
            rays.org_z[i] = from[2];
            rays.dir_x[i] = lights[i][0];
            rays.dir_y[i] = lights[i][1];
            rays.dir_z[i] = lights[i][2];
            rays.tfar[i] = std::numeric_limits<float>::infinity();
            rays.mask[i] = 0xFFFFFFFFU;
        }
        geometry_.occlude(marks, rays);
        for (std::size_t i = 0; i < kSamples; ++i) {
            if (marks[i] == 0) continue;
            const Frame& frame = hits.frames[i];
            pending.points.push_back({frame.u, frame.v, hits.views[i], local[i]});
            pending.weights.push_back(weights[i]);
            pending.cols.push_back(col);
        }
    }

    /// Σ value L / (π p n) over n directions: the radiance that the environment causes.
    void add_environment(const Hits& hits, std::size_t site, std::size_t col,
                         Pending& pending) const {
        const std::size_t n = options_.environment_samples;
        for (std::size_t k = 0; k < n; ++k) {
            std::array<Vector3, kSamples> lights{};
            std::array<Vector3, kSamples> weights{};
            for (std::size_t i = 0; i < kSamples; ++i) {
                if (hits.valid[i] == 0) continue;
                const Environment::Sample from = environment_sample(site, i, k);
                if (!(from.density > 0)) continue;
                lights[i] = from.direction;
                weights[i] =
                    times(from.radiance, 1 / (std::numbers::pi_v<float> * from.density *
                                              static_cast<float>(n)));
            }
            add_light(hits, lights, weights, col, pending);
        }
    }

    /// Direction j of the N that the samples of a pixel share: the Fibonacci lattice
    /// (j / N, j φ mod 1), φ the golden section, which leaves no part of the map out, moved
    /// as a whole by a random vector of the pixel so that no two err alike.
    [[nodiscard]] Environment::Sample environment_sample(std::size_t site,
                                                         std::size_t sample,
                                                         std::size_t k) const {
        constexpr double kGoldenSection = 0.618033988749894848;
        const std::size_t n = options_.environment_samples;
        const auto words =
            philox4x32_10({static_cast<std::uint32_t>(site), 0, 0, 0xE7U},
                          {static_cast<std::uint32_t>(options_.seed),
                           static_cast<std::uint32_t>(options_.seed >> 32)});
        const auto moved = [](double at, std::uint32_t word) {
            const double sum = at + static_cast<double>(word) * 0x1p-32;
            return std::min(static_cast<float>(sum - std::floor(sum)), 1 - 0x1p-24F);
        };
        const auto j = static_cast<double>(kStratum[sample] * n + k);
        return scene_.environment->sample(
            {moved(j / static_cast<double>(kSamples * n), words[0]),
             moved(j * kGoldenSection, words[1])});
    }

    /// What is seen past the object; what is seen of it is left pending.
    [[nodiscard]] Vector3 pixel(std::size_t r, std::size_t c, Pending& pending) const {
        RTCRayHit16 rays{};
        std::array<Vector3, kSamples> directions;
        for (std::size_t i = 0; i < kSamples; ++i) {
            directions[i] = ray_direction(r, c, i);
            rays.ray.org_x[i] = camera_.eye[0];
            rays.ray.org_y[i] = camera_.eye[1];
            rays.ray.org_z[i] = camera_.eye[2];
            rays.ray.dir_x[i] = directions[i][0];
            rays.ray.dir_y[i] = directions[i][1];
            rays.ray.dir_z[i] = directions[i][2];
            rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
            rays.ray.mask[i] = 0xFFFFFFFFU;
            rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        geometry_.intersect(rays);
        Vector3 past{};
        Hits hits;
        bool any = false;
        for (std::size_t i = 0; i < kSamples; ++i) {
            if (rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
                past = sum(past, background(directions[i]));
                continue;
            }
            any = true;
            const Vector3 to_eye = times(directions[i], -1);
            hits.valid[i] = -1;
            hits.frames[i] =
                frame_at(*scene_.mesh, rays.hit.primID[i], rays.hit.u[i], rays.hit.v[i],
                         sum(camera_.eye, times(directions[i], rays.ray.tfar[i])),
                         {rays.hit.Ng_x[i], rays.hit.Ng_y[i], rays.hit.Ng_z[i]}, to_eye);
            Vector3 view = hits.frames[i].local(to_eye);
            view[2] = std::max(view[2], 1e-3F);
            hits.views[i] = unit(view);
        }
        if (!any) return past;
        for (std::size_t k = 0; k < lights_.size(); ++k) {
            std::array<Vector3, kSamples> lights;
            std::array<Vector3, kSamples> weights;
            lights.fill(lights_[k]);
            weights.fill(times({1, 1, 1}, scene_.lights[k].strength));
            add_light(hits, lights, weights, c, pending);
        }
        if (scene_.environment != nullptr)
            add_environment(hits, r * options_.cols + c, c, pending);
        return past;
    }

    const Scene& scene_;
    const Geometry& geometry_;
    const ShadePoints& shade_;
    const RenderOptions& options_;
    Camera camera_;
    std::vector<Vector3> lights_;
};

}  // namespace

Result<Image> render(const Scene& scene, const ShadePoints& shade,
                     const RenderOptions& options, Executor& executor,
                     Progress& progress) {
    if (scene.mesh == nullptr || scene.mesh->triangles.empty() ||
        scene.mesh->tangent.size() != scene.mesh->position.size())
        return Error{Errc::invalid_argument,
                     "mesh: found no triangles or no tangents, expected both"};
    constexpr std::size_t kMaxSide = 16384;
    if (options.rows == 0 || options.cols == 0 || options.rows > kMaxSide ||
        options.cols > kMaxSide)
        return Error{Errc::invalid_argument,
                     "size: found " + std::to_string(options.cols) + " x " +
                         std::to_string(options.rows) + ", expected 1 to 16384 a side"};
    SATEEN_TRY(const Geometry geometry, Geometry::create(*scene.mesh));
    Image image(3, options.rows, options.cols);
    const Picture picture(scene, geometry, shade, options);
    std::atomic<std::size_t> done = 0;
    parallel_for(executor, options.rows, [&](std::size_t r) {
        if (progress.cancelled()) return;
        picture.row(r, image);
        progress.report(static_cast<double>(++done), static_cast<double>(options.rows));
    });
    if (progress.cancelled()) return Error{Errc::cancelled, "cancelled"};
    return image;
}

}  // namespace sateen
