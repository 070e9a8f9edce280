// SPDX-License-Identifier: Apache-2.0
// A material as JSON. See describe.hpp.
#include "describe.hpp"

#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "material/message.hpp"
#include "sateen/material/cell_table.hpp"

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

/// The curves for what fields_only draws: straight where the planes hold a structure already.
std::vector<Marginal> drawn_marginals(const Material& material,
                                      const Subspace& subspace) {
    if (!material.structure) return subspace.marginals;
    std::vector<Marginal> straight;
    for (const float deviation : plane_deviations(*material.structure, subspace))
        straight.push_back({deviation, {}});
    return straight;
}

void add_subspace(Json& json, const Material& material, const Subspace& subspace) {
    const std::vector<Marginal> marginals = drawn_marginals(material, subspace);
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
    for (const Marginal& marginal : marginals) json.number(marginal.scale);
    json.close(']');
    json.key("knots");
    json.open('[');
    for (const Marginal& marginal : marginals) json.numbers(marginal.knots);
    json.close(']');
    json.close('}');
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
    for (const Subspace& subspace : material.subspaces)
        add_subspace(json, material, subspace);
    json.close(']');
    json.close('}');
    return json.take();
}

}  // namespace sateen::wasm
