// SPDX-License-Identifier: Apache-2.0
// Material to payload; docs/format.md is normative. Partner: file_read.cpp.
#include <algorithm>
#include <memory>
#include <span>

#include "material/message.hpp"
#include "material/modulation_file.hpp"
#include "material/quantise.hpp"
#include "material/reflectance_file.hpp"
#include "material/schema.hpp"
#include "material/structure_file.hpp"
#include "material/surface_file.hpp"

namespace sateen {
namespace {

std::unique_ptr<schema::ProvenanceT> pack_provenance(const Provenance& provenance) {
    auto out = std::make_unique<schema::ProvenanceT>();
    out->name = provenance.name;
    out->source = provenance.source;
    out->options = provenance.options;
    out->writer = provenance.writer;
    out->source_checksum = provenance.source_checksum;
    return out;
}

std::unique_ptr<schema::DirectionsT> pack_directions(
    const std::vector<Direction>& directions) {
    auto out = std::make_unique<schema::DirectionsT>();
    for (const Direction& direction : directions) {
        out->theta.push_back(canonical(quantised_degrees(direction.theta)));
        out->phi.push_back(canonical(quantised_degrees(direction.phi)));
    }
    return out;
}

std::unique_ptr<schema::IndexT> pack_index(const Material& m) {
    auto out = std::make_unique<schema::IndexT>();
    // Entries are distinct and in order: as many as pairs, and they are all pairs.
    const bool complete = m.index.size() == m.lights.size() * m.views.size();
    for (const IndexEntry& entry : m.index) {
        out->subspaces.push_back(entry.subspace);
        if (complete) continue;
        out->lights.push_back(entry.light);
        out->views.push_back(entry.view);
    }
    return out;
}

// The tables over all subspaces, filled in one pass. Lists of offsets are stored once.
class SubspaceWriter {
  public:
    explicit SubspaceWriter(schema::MaterialT& out)
        : neighbourhoods_(
              *(out.neighbourhoods = std::make_unique<schema::NeighbourhoodsT>())),
          subspaces_(*(out.subspaces = std::make_unique<schema::SubspacesT>())),
          marginals_(*(out.marginals = std::make_unique<schema::MarginalsT>())),
          fields_(*(out.fields = std::make_unique<schema::FieldsT>())) {}

    void append(const Subspace& subspace) {
        subspaces_.members.push_back(subspace.members);
        subspaces_.views.push_back(subspace.view);
        subspaces_.lights.push_back(subspace.light);
        subspaces_.levels.push_back(static_cast<std::uint8_t>(subspace.levels.size()));
        subspaces_.tones.push_back(static_cast<std::uint8_t>(subspace.spectral.tone));
        for (const float value : subspace.spectral.mean)
            subspaces_.mean.push_back(canonical(value));
        for (const float value : subspace.spectral.T)
            subspaces_.transform.push_back(canonical(value));
        for (const Marginal& marginal : subspace.marginals) append(marginal);
        for (const Level& level : subspace.levels)
            for (const FieldModel& field : level.fields) {
                fields_.models.push_back(static_cast<std::uint8_t>(field.index()));
                std::visit([this](const auto& model) { append(model); }, field);
            }
    }

  private:
    void append(const Marginal& marginal) {
        marginals_.scales.push_back(canonical(marginal.scale));
        marginals_.counts.push_back(static_cast<std::uint8_t>(marginal.knots.size()));
        append_block(marginal.knots, marginals_.knots, marginals_.exponents);
    }

    template <class Model>
    requires(!is_joint<Model>) void append(const Model& field) {
        fields_.neighbourhoods.push_back(number_of(field.neighbourhood));
        append_block(field.a, fields_.coefficients, fields_.exponents);
        fields_.variances.push_back(canonical(field.variance));
    }

    void append(const Autoregression3d& field) {
        fields_.neighbourhoods.push_back(number_of(field.neighbourhood));
        append_block(field.A, fields_.coefficients, fields_.exponents);
        for (std::size_t i = 0; i < field.planes; ++i)
            for (std::size_t j = 0; j <= i; ++j)
                fields_.variances.push_back(canonical(field.Sigma[i * field.planes + j]));
    }

    std::uint16_t number_of(const std::vector<Offset>& offsets) {
        const auto known = std::find(known_.begin(), known_.end(), offsets);
        const auto number = static_cast<std::uint16_t>(known - known_.begin());
        if (known == known_.end()) append_neighbourhood(offsets);
        return number;
    }

    void append_neighbourhood(const std::vector<Offset>& offsets) {
        known_.push_back(offsets);
        for (int order = 1; order <= kMaxOrder; ++order)
            if (offsets == hierarchical_half_plane(order)) {
                neighbourhoods_.orders.push_back(static_cast<std::uint8_t>(order));
                return;
            }
        neighbourhoods_.orders.push_back(kExplicitOffsets);
        neighbourhoods_.counts.push_back(static_cast<std::uint8_t>(offsets.size()));
        for (const Offset s : offsets) {
            neighbourhoods_.rows.push_back(s.row);
            neighbourhoods_.cols.push_back(s.col);
        }
    }

    schema::NeighbourhoodsT& neighbourhoods_;
    schema::SubspacesT& subspaces_;
    schema::MarginalsT& marginals_;
    schema::FieldsT& fields_;
    std::vector<std::vector<Offset>> known_;
};

schema::MaterialT pack(const Material& m) {
    schema::MaterialT out;
    out.version = kFormatVersion;
    out.drawing = static_cast<std::uint8_t>(m.drawing);
    out.bands = static_cast<std::uint8_t>(m.bands);
    out.cosine_included = m.cosine_included;
    out.sample_rows = m.sample_rows;
    out.sample_cols = m.sample_cols;
    out.pixels_per_mm = m.pixels_per_mm;
    out.provenance = pack_provenance(m.provenance);
    out.views = pack_directions(m.views);
    out.lights = pack_directions(m.lights);
    out.index = pack_index(m);
    SubspaceWriter writer(out);
    for (const Subspace& subspace : m.subspaces) writer.append(subspace);
    if (m.structure) out.structure = pack_structure(m);
    if (m.surface) out.surface = pack_surface(*m.surface);
    if (m.reflectance) out.reflectance = pack_reflectance(m);
    if (m.modulation) out.modulation = pack_modulation(m);
    return out;
}

}  // namespace

Result<std::vector<std::uint8_t>> write_material(const Material& material) {
    SATEEN_CHECK(validate(material));
    const schema::MaterialT packed = pack(material);
    flatbuffers::FlatBufferBuilder builder;
    builder.FinishSizePrefixed(schema::Material::Pack(builder, &packed),
                               schema::MaterialIdentifier());
    const std::span<const std::uint8_t> bytes{builder.GetBufferPointer(),
                                              builder.GetSize()};
    return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
}

}  // namespace sateen
