// SPDX-License-Identifier: Apache-2.0
// How many bytes of a payload each part takes.
#include <numeric>

#include "material/schema.hpp"

namespace sateen {
namespace {

template <class... Vectors>
std::size_t bytes(const Vectors*... vectors) {
    const auto one = [](const auto* vector) -> std::size_t {
        if (vector == nullptr) return 0;
        return vector->size() * sizeof(vector->Get(0));
    };
    return (one(vectors) + ...);
}

std::size_t structure_bytes(const schema::Structure& s) {
    return bytes(s.lattice(), s.field_deviations(), s.field_weights(), s.steps(),
                 s.counts(), s.low_bytes(), s.high_bytes(), s.deviation_steps(),
                 s.deviations(), s.mixing_steps(), s.mixing(), s.curve_ranges(),
                 s.curve_exponents(), s.curve_values());
}

}  // namespace

Result<std::vector<PartBytes>> material_part_bytes(const Material& material) {
    SATEEN_TRY(const auto payload, write_material(material));
    const auto& m = *flatbuffers::GetSizePrefixedRoot<schema::Material>(payload.data());
    const auto& provenance = *m.provenance();
    const auto& index = *m.index();
    const auto& subspaces = *m.subspaces();
    const auto& marginals = *m.marginals();
    const auto& neighbourhoods = *m.neighbourhoods();
    const auto& fields = *m.fields();
    std::vector<PartBytes> parts = {
        {"provenance", bytes(provenance.name(), provenance.source(), provenance.options(),
                             provenance.writer()) +
                           sizeof(provenance.source_checksum())},
        {"directions", bytes(m.views()->theta(), m.views()->phi(), m.lights()->theta(),
                             m.lights()->phi())},
        {"index", bytes(index.subspaces(), index.lights(), index.views(),
                        subspaces.members(), subspaces.views(), subspaces.lights())},
        {"spectral transforms",
         bytes(subspaces.tones(), subspaces.mean(), subspaces.transform())},
        {"marginals", bytes(marginals.scales(), marginals.counts(), marginals.exponents(),
                            marginals.knots())},
        {"neighbourhoods", bytes(neighbourhoods.orders(), neighbourhoods.counts(),
                                 neighbourhoods.rows(), neighbourhoods.cols())},
        {"fields", bytes(subspaces.levels(), fields.models(), fields.neighbourhoods(),
                         fields.exponents(), fields.coefficients(), fields.variances())},
    };
    if (const schema::Structure* structure = m.structure())
        parts.push_back({"structure", structure_bytes(*structure)});
    if (const schema::Modulation* b = m.modulation())
        parts.push_back({"modulation", bytes(b->field_deviations(), b->field_weights(),
                                             b->scales(), b->curves(), b->units())});
    if (const auto* surface = m.surface())
        parts.push_back({"surface", bytes(surface->low(), surface->high())});
    if (const schema::Reflectance* r = m.reflectance())
        parts.push_back({"reflectance",
                         bytes(r->base(), r->base_exponents(), r->lights(),
                               r->light_exponents(), r->views(), r->view_exponents())});
    // Tables, lengths of vectors and padding.
    const auto add = [](std::size_t sum, const PartBytes& part) {
        return sum + part.bytes;
    };
    const std::size_t named =
        std::accumulate(parts.begin(), parts.end(), std::size_t{0}, add);
    parts.push_back({"container", payload.size() - named});
    return parts;
}

}  // namespace sateen
