// SPDX-License-Identifier: Apache-2.0
// Tessellation and displacement. See displacement.hpp.
#include "sateen/render/displacement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "render/vector.hpp"

namespace sateen {
namespace {

using vector3::cross;
using vector3::difference;
using vector3::dot;
using vector3::sum;
using vector3::times;
using vector3::unit;

using Triangle = std::array<std::uint32_t, 3>;

/// Twice the area of a triangle, on the object and in the texture.
std::pair<float, float> areas(const Mesh& mesh, const Triangle& t) {
    const Vector3 n = cross(difference(mesh.position[t[1]], mesh.position[t[0]]),
                            difference(mesh.position[t[2]], mesh.position[t[0]]));
    const auto& a = mesh.uv[t[0]];
    const auto& b = mesh.uv[t[1]];
    const auto& c = mesh.uv[t[2]];
    return {std::sqrt(dot(n, n)),
            std::abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))};
}

/// The length of a period of the texture at every vertex.
std::vector<float> period_lengths(const Mesh& mesh) {
    std::vector<float> object(mesh.position.size());
    std::vector<float> texture(mesh.position.size());
    for (const Triangle& t : mesh.triangles) {
        const auto [on_object, in_texture] = areas(mesh, t);
        for (const std::uint32_t v : t) {
            object[v] += on_object;
            texture[v] += in_texture;
        }
    }
    for (std::size_t v = 0; v < object.size(); ++v)
        object[v] = texture[v] > 0 ? std::sqrt(object[v] / texture[v]) : 0;
    return object;
}

/// Halves edges. Every triangle falls into as many as it has long edges, plus one.
class Tessellation {
  public:
    explicit Tessellation(const Mesh& mesh)
        : mesh_(mesh), period_(period_lengths(mesh)) {}

    enum class Step { done, halved, too_many };
    /// Halves the edges that are too long; none if that makes too many triangles.
    Step refine(float longest, float detail, std::size_t most) {
        edges_.clear();
        std::size_t triangles = mesh_.triangles.size();
        for (const Triangle& t : mesh_.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k];
                const std::uint32_t b = t[(k + 1) % 3];
                if (!is_long(a, b, longest, detail)) continue;
                edges_.push_back(edge(a, b));
                ++triangles;
            }
        if (edges_.empty()) return Step::done;
        if (triangles > most) return Step::too_many;
        std::sort(edges_.begin(), edges_.end());
        edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
        first_ = static_cast<std::uint32_t>(mesh_.position.size());
        for (const std::uint64_t e : edges_)
            add_middle(static_cast<std::uint32_t>(e >> 32U),
                       static_cast<std::uint32_t>(e & 0xFFFFFFFFU));
        std::vector<Triangle> halves;
        halves.reserve(triangles);
        for (const Triangle& t : mesh_.triangles) split(t, halves);
        mesh_.triangles = std::move(halves);
        return Step::halved;
    }

    Mesh take_mesh() { return std::move(mesh_); }
    [[nodiscard]] const std::vector<float>& period() const { return period_; }

  private:
    static constexpr std::uint32_t kWhole = std::numeric_limits<std::uint32_t>::max();

    static std::uint64_t edge(std::uint32_t a, std::uint32_t b) {
        return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
    }

    [[nodiscard]] bool is_long(std::uint32_t a, std::uint32_t b, float longest,
                               float detail) const {
        const Vector3 d = difference(mesh_.position[b], mesh_.position[a]);
        const float u = mesh_.uv[b][0] - mesh_.uv[a][0];
        const float v = mesh_.uv[b][1] - mesh_.uv[a][1];
        return dot(d, d) > longest * longest && u * u + v * v > detail * detail;
    }

    void add_middle(std::uint32_t a, std::uint32_t b) {
        mesh_.position.push_back(times(sum(mesh_.position[a], mesh_.position[b]), 0.5F));
        const Vector3 normal = unit(sum(mesh_.normal[a], mesh_.normal[b]));
        const Vector3 along = sum(mesh_.tangent[a], mesh_.tangent[b]);
        mesh_.normal.push_back(normal);
        mesh_.tangent.push_back(
            unit(difference(along, times(normal, dot(normal, along)))));
        mesh_.uv.push_back({0.5F * (mesh_.uv[a][0] + mesh_.uv[b][0]),
                            0.5F * (mesh_.uv[a][1] + mesh_.uv[b][1])});
        period_.push_back(0.5F * (period_[a] + period_[b]));
    }

    [[nodiscard]] std::uint32_t middle(std::uint32_t a, std::uint32_t b) const {
        const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge(a, b));
        if (found == edges_.end() || *found != edge(a, b)) return kWhole;
        return first_ + static_cast<std::uint32_t>(found - edges_.begin());
    }

    void split(Triangle t, std::vector<Triangle>& out) const {
        Triangle m = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
        const auto halved = std::count_if(m.begin(), m.end(),
                                          [](std::uint32_t v) { return v != kWhole; });
        if (halved == 0) {
            out.push_back(t);
            return;
        }
        if (halved == 3) {
            out.push_back({t[0], m[0], m[2]});
            out.push_back({m[0], t[1], m[1]});
            out.push_back({m[2], m[1], t[2]});
            out.push_back({m[0], m[1], m[2]});
            return;
        }
        // Turned until the first edge is halved and, of two, the third is not.
        while (m[0] == kWhole || (halved == 2 && m[2] != kWhole)) {
            std::rotate(t.begin(), t.begin() + 1, t.end());
            std::rotate(m.begin(), m.begin() + 1, m.end());
        }
        if (halved == 1) {
            out.push_back({t[0], m[0], t[2]});
            out.push_back({m[0], t[1], t[2]});
            return;
        }
        out.push_back({t[0], m[0], t[2]});
        out.push_back({m[0], m[1], t[2]});
        out.push_back({m[0], t[1], m[1]});
    }

    Mesh mesh_;
    std::vector<float> period_;
    std::vector<std::uint64_t> edges_;  // to be halved, ascending
    std::uint32_t first_ = 0;           // the middle of the first of them
};

float total_area(const Mesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles)
        sum += 0.5 * static_cast<double>(areas(mesh, t).first);
    return static_cast<float>(sum);
}

}  // namespace

Result<DisplacedMesh> displace(const Mesh& mesh, const HeightAt& height,
                               const DisplacementOptions& options, Progress& progress) {
    const std::size_t vertices = mesh.position.size();
    if (mesh.triangles.empty() || mesh.normal.size() != vertices ||
        mesh.tangent.size() != vertices || mesh.uv.size() != vertices)
        return Error{Errc::invalid_argument,
                     "mesh: found no triangles or no frames, expected both"};
    // Halving leaves edges between half of the longest and the longest; triangles of
    // a third of its square fill what is allowed.
    constexpr float kTriangle = 0.3F;
    constexpr float kLonger = 1.2F;
    float longest = std::sqrt(total_area(mesh) /
                              (kTriangle * static_cast<float>(options.max_triangles)));
    Tessellation tessellation(mesh);
    using Step = decltype(tessellation)::Step;
    for (Step step = Step::halved; step != Step::done;) {
        if (progress.cancelled()) return Error{Errc::cancelled, "cancelled"};
        step = tessellation.refine(longest, options.detail, options.max_triangles);
        if (step == Step::too_many) longest *= kLonger;
    }
    DisplacedMesh out;
    out.mesh = tessellation.take_mesh();
    const std::vector<float>& period = tessellation.period();
    for (std::size_t v = 0; v < out.mesh.position.size(); ++v) {
        const auto& uv = out.mesh.uv[v];
        // As wide as the triangles, so that no height is skipped.
        const float width = period[v] > 0 ? longest / period[v] : 1.0F;
        const float rise =
            period[v] * height(uv[0], uv[1], std::clamp(width, options.detail, 1.0F));
        out.mesh.position[v] = sum(out.mesh.position[v], times(out.mesh.normal[v], rise));
        out.highest = std::max(out.highest, rise);
        out.lowest = std::min(out.lowest, rise);
    }
    return out;
}

}  // namespace sateen
