// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ by tinyobjloader. See mesh.hpp.
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <string>
#include <tuple>

#include "render/vector.hpp"
#include "sateen/render/mesh.hpp"

namespace sateen {
namespace {

Error bad_obj(std::string_view name, const std::string& what) {
    return {Errc::bad_format, std::string(name) + ": " + what};
}

/// Centres the bounding box, scales the farthest point to 1.
void fit(Mesh& mesh) {
    Vector3 low = mesh.position.front();
    Vector3 high = low;
    for (const Vector3& p : mesh.position)
        for (std::size_t i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], p[i]);
            high[i] = std::max(high[i], p[i]);
        }
    const Vector3 centre = vector3::times(vector3::sum(low, high), 0.5F);
    float radius = 0;
    for (Vector3& p : mesh.position) {
        p = vector3::difference(p, centre);
        radius = std::max(radius, vector3::dot(p, p));
    }
    const float scale = radius > 0 ? 1 / std::sqrt(radius) : 1;
    for (Vector3& p : mesh.position) p = vector3::times(p, scale);
}

class Builder {
  public:
    Builder(const tinyobj::attrib_t& attributes, float repeats)
        : attributes_(attributes), repeats_(repeats) {}

    /// The vertex of a corner of a face; false without usable coordinates.
    [[nodiscard]] bool corner(const tinyobj::index_t& index, std::uint32_t& vertex) {
        const auto [found, is_new] = known_.try_emplace(
            {index.vertex_index, index.texcoord_index, index.normal_index},
            static_cast<std::uint32_t>(mesh.position.size()));
        vertex = found->second;
        if (!is_new) return true;
        const auto inside = [](int i, std::size_t size, std::size_t width) {
            return i >= 0 && (static_cast<std::size_t>(i) + 1) * width <= size;
        };
        if (!inside(index.vertex_index, attributes_.vertices.size(), 3) ||
            !inside(index.texcoord_index, attributes_.texcoords.size(), 2))
            return false;
        const auto v = static_cast<std::size_t>(index.vertex_index);
        const auto t = static_cast<std::size_t>(index.texcoord_index);
        // OBJ files have y up.
        mesh.position.push_back({attributes_.vertices[3 * v],
                                 -attributes_.vertices[3 * v + 2],
                                 attributes_.vertices[3 * v + 1]});
        mesh.uv.push_back({repeats_ * attributes_.texcoords[2 * t],
                           repeats_ * attributes_.texcoords[2 * t + 1]});
        if (inside(index.normal_index, attributes_.normals.size(), 3)) {
            const auto n = static_cast<std::size_t>(index.normal_index);
            mesh.normal.push_back(vector3::unit({attributes_.normals[3 * n],
                                                 -attributes_.normals[3 * n + 2],
                                                 attributes_.normals[3 * n + 1]}));
        }
        const auto finite = [](const auto& values) {
            return std::all_of(values.begin(), values.end(),
                               [](float x) { return std::isfinite(x); });
        };
        return finite(mesh.position.back()) && finite(mesh.uv.back()) &&
               (mesh.normal.empty() || finite(mesh.normal.back()));
    }

    Mesh mesh;

  private:
    const tinyobj::attrib_t& attributes_;
    float repeats_;
    std::map<std::tuple<int, int, int>, std::uint32_t> known_;
};

}  // namespace

Result<Mesh> parse_obj(std::string_view text, std::string_view name, float repeats) {
    tinyobj::ObjReader reader;
    bool parsed = false;
    try {
        parsed = reader.ParseFromString(std::string(text), std::string());
    } catch (const std::exception& error) {
        return bad_obj(name, error.what());
    }
    if (!parsed) return bad_obj(name, "is not an OBJ file: " + reader.Error());
    Builder builder(reader.GetAttrib(), repeats);
    for (const tinyobj::shape_t& shape : reader.GetShapes()) {
        const std::vector<tinyobj::index_t>& indices = shape.mesh.indices;
        for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
            std::array<std::uint32_t, 3> triangle{};
            for (std::size_t i = 0; i < 3; ++i)
                if (!builder.corner(indices[k + i], triangle[i]))
                    return bad_obj(name,
                                   "found a face without position or texture "
                                   "coordinates, or with some that are not finite, "
                                   "expected both for every corner");
            builder.mesh.triangles.push_back(triangle);
        }
    }
    Mesh mesh = std::move(builder.mesh);
    if (mesh.triangles.empty())
        return bad_obj(name, "found no face, expected at least one");
    fit(mesh);
    complete_frames(mesh);
    return mesh;
}

}  // namespace sateen
