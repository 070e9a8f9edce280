// SPDX-License-Identifier: Apache-2.0
// A material as JSON. See describe.hpp.
#include "describe.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "material/message.hpp"
#include "sateen/core/direction_mesh.hpp"
#include "sateen/material/cell_table.hpp"
#include "sateen/synthesis/interpolate.hpp"

namespace sateen::wasm {
namespace {

/// Writes members and elements; the caller opens and closes what holds them.
class Json {
  public:
    void open(char bracket) {
        add_bare(std::string_view(&bracket, 1));
        first_ = true;
    }
    void close(char bracket) {
        out_ += bracket;
        first_ = false;
    }
    void key(std::string_view name) {
        string(name);
        out_ += ':';
        first_ = true;
    }
    /// Texts of a valid material are UTF-8 without control characters.
    void string(std::string_view text) {
        add_bare("\"");
        for (const char c : text) {
            if (c == '"' || c == '\\') out_ += '\\';
            out_ += c;
        }
        out_ += '"';
    }
    template <class Number>
    void number(Number value) {
        if constexpr (std::is_floating_point_v<Number>)
            add_bare(text(value));
        else
            add_bare(std::to_string(value));
    }
    void literal(std::string_view word) { add_bare(word); }
    void numbers(const std::vector<float>& values) {
        open('[');
        for (const float value : values) number(value);
        close(']');
    }
    [[nodiscard]] std::string take() { return std::move(out_); }

  private:
    void add_bare(std::string_view text) {
        if (!first_) out_ += ',';
        first_ = false;
        out_ += text;
    }
    std::string out_;
    bool first_ = true;
};

void add_directions(Json& json, std::string_view name,
                    const std::vector<Direction>& directions) {
    json.key(name);
    json.open('[');
    for (const Direction& d : directions) json.numbers({d.theta, d.phi});
    json.close(']');
}

void add_index(Json& json, const Material& material) {
    std::vector<int> table(material.lights.size() * material.views.size(), -1);
    for (const IndexEntry& entry : material.index)
        table[entry.light * material.views.size() + entry.view] = entry.subspace;
    json.key("index");
    json.open('[');
    for (const int subspace : table) json.number(subspace);
    json.close(']');
}

void add_curve(Json& json, const ToneCurve& curve) {
    json.open('{');
    json.key("low");
    json.number(curve.low);
    json.key("high");
    json.number(curve.high);
    json.key("values");
    json.numbers(curve.values);
    json.close('}');
}

void add_subspace(Json& json, const Subspace& subspace) {
    json.open('{');
    json.key("members");
    json.number(subspace.members);
    json.key("view");
    json.number(subspace.view);
    json.key("light");
    json.number(subspace.light);
    json.key("tone");
    json.string(subspace.spectral.tone == Tone::srgb ? "srgb" : "linear");
    json.key("mean");
    json.numbers(subspace.spectral.mean);
    json.key("T");
    json.numbers(subspace.spectral.T);
    json.key("scale");
    json.open('[');
    for (const Marginal& marginal : subspace.marginals) json.number(marginal.scale);
    json.close(']');
    json.key("knots");
    json.open('[');
    for (const Marginal& marginal : subspace.marginals) json.numbers(marginal.knots);
    json.close(']');
    json.key("curves");
    json.open('[');
    if (subspace.structure)
        for (const PeriodicCell& cell : subspace.structure->cells)
            add_curve(json, cell.curve);
    json.close(']');
    json.close('}');
}

void add_pattern(Json& json, const PeriodicLayer& layer) {
    const std::array<double, 2> down = LatticeMap(layer).to_cell(1, 0);
    const std::array<double, 2> across = LatticeMap(layer).to_cell(0, 1);
    json.open('{');
    json.key("rows");
    json.number(CellTable::kOversampling * layer.rows);
    json.key("cols");
    json.number(CellTable::kOversampling * layer.cols);
    json.key("inverse");
    json.numbers({static_cast<float>(down[0]), static_cast<float>(across[0]),
                  static_cast<float>(down[1]), static_cast<float>(across[1])});
    json.close('}');
}

/// The direction nearest to the middle of every square, as DirectionMesh::starts() lays them out.
void append_nearest(const DirectionMesh& mesh, std::vector<std::uint32_t>& words) {
    constexpr auto n = DirectionMesh::kStartSide;
    const auto middle = [](std::size_t i) {
        return (2 * static_cast<float>(i) + 1) / static_cast<float>(n) - 1;
    };
    for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c < n; ++c) {
            const float x = middle(c);
            const float y = middle(r);
            const float square = x * x + y * y;
            const float scale = 1 / (1 + square);
            const std::array<float, 3> d = {2 * x * scale, 2 * y * scale,
                                            std::max(0.0F, (1 - square) * scale)};
            words.push_back(mesh.nearest(d));
        }
}

}  // namespace

std::string describe(const Material& material) {
    Json json;
    json.open('{');
    json.key("name");
    json.string(material.provenance.name);
    json.key("source");
    json.string(material.provenance.source);
    json.key("bands");
    json.number(material.bands);
    json.key("sampleRows");
    json.number(material.sample_rows);
    json.key("sampleCols");
    json.number(material.sample_cols);
    json.key("pixelsPerMm");
    if (material.pixels_per_mm)
        json.number(*material.pixels_per_mm);
    else
        json.literal("null");
    json.key("cosineIncluded");
    json.literal(material.cosine_included ? "true" : "false");
    add_directions(json, "views", material.views);
    add_directions(json, "lights", material.lights);
    add_index(json, material);
    json.key("subspaces");
    json.open('[');
    for (const Subspace& subspace : material.subspaces) add_subspace(json, subspace);
    json.close(']');
    json.key("pattern");
    if (material.structure)
        add_pattern(json, material.structure->periodic);
    else
        json.literal("null");
    json.key("surface");
    if (material.surface) {
        json.open('{');
        json.key("rows");
        json.number(material.surface->rows);
        json.key("cols");
        json.number(material.surface->cols);
        json.key("delit");
        json.literal(material.surface->delit ? "true" : "false");
        json.key("ambient");
        json.number(material.surface->ambient);
        json.close('}');
    } else {
        json.literal("null");
    }
    json.close('}');
    return json.take();
}

std::vector<std::uint32_t> packed_cells(std::span<const Direction> directions) {
    std::vector<std::uint32_t> words;
    const Result<DirectionMesh> mesh = DirectionMesh::create(directions);
    if (!mesh) return words;
    constexpr std::uint32_t kSector = 1U << 15U;
    const auto append = [&](const std::array<float, 3>& row, std::uint32_t vertex,
                            std::uint32_t neighbour) {
        for (const float x : row) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, &x, sizeof bits);
            words.push_back(bits);
        }
        words.push_back(vertex | neighbour << 16U);
    };
    const std::span<const DirectionCell> cells = mesh->cells();
    if (cells.empty()) {
        words.push_back(static_cast<std::uint32_t>(directions.size()));
        append_nearest(*mesh, words);
        for (std::uint32_t i = 0; i < directions.size(); ++i)
            for (int k = 0; k < 3; ++k) append({0, 0, 1}, i, i);
        return words;
    }
    words.push_back(static_cast<std::uint32_t>(cells.size()));
    words.insert(words.end(), mesh->starts().begin(), mesh->starts().end());
    for (const DirectionCell& cell : cells)
        for (std::size_t k = 0; k < 3; ++k)
            append(cell.row[k], cell.vertex[k] | (k == 2 && cell.sector ? kSector : 0U),
                   cell.neighbour[k]);
    return words;
}

std::vector<std::uint8_t> complete_index(const Material& material) {
    const auto interpolation = DirectionalInterpolation::create(material, {});
    if (!interpolation) return {};
    return {interpolation->index().begin(), interpolation->index().end()};
}

std::vector<float> appearance_of_pairs(const Material& material) {
    std::vector<float> out;
    if (!material.reflectance) return out;
    for (std::size_t light = 0; light < material.lights.size(); ++light)
        for (std::size_t view = 0; view < material.views.size(); ++view) {
            const EncodedAppearance e =
                encoded_appearance(*material.reflectance, view, light);
            out.insert(out.end(), e.begin(), e.end());
        }
    return out;
}

}  // namespace sateen::wasm
