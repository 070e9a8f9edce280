// SPDX-License-Identifier: Apache-2.0
// The table `modulation`; docs/format.md section 8b is normative.
#include "material/modulation_file.hpp"

#include <numeric>

#include "material/message.hpp"
#include "material/numbers.hpp"
#include "material/vectors.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLevels = BandModulation::kLevels;
constexpr std::size_t kWeights = SmoothField::kScales * SmoothField::kScales;
constexpr std::size_t kKnots = AmplitudeCurve::kKnots;
constexpr std::size_t kScales = 3;  ///< numbers of a band that are half floats
constexpr std::size_t kCurves = 3;
/// No gain and no unit is larger.
constexpr float kMaxGain = 64;

ModulatedBand read_band(const schema::Modulation& in, std::size_t band) {
    ModulatedBand out;
    const auto scale = [&](std::size_t k) {
        return from_upper_half(at(in.scales(), band * kScales + k));
    };
    out.value_scale = scale(0);
    out.energy_scale = scale(1);
    out.gain = scale(2);
    std::size_t curve = band * kCurves;
    for (AmplitudeCurve* c : {&out.of_value, &out.of_parent, &out.of_first}) {
        for (std::size_t j = 0; j < kKnots; ++j)
            c->values[j] = at(in.curves(), curve * kKnots + j);
        ++curve;
    }
    return out;
}

Result<void> check_subspace(const Subspace& subspace) {
    if (!subspace.modulation)
        return bad_format("no modulation, expected one as the material has");
    const SubspaceModulation& modulation = *subspace.modulation;
    const std::size_t planes = subspace.marginals.size();
    SATEEN_CHECK(
        expect_count("modulated bands", modulation.bands.size(), planes * kLevels));
    SATEEN_CHECK(expect_count("modulation units", modulation.units.size(), planes));
    for (const ModulatedBand& band : modulation.bands) {
        SATEEN_CHECK(check_range("value scale", band.value_scale, 0, kMaxMagnitude));
        SATEEN_CHECK(check_range("energy scale", band.energy_scale, 0,
                                 kMaxMagnitude * kMaxMagnitude));
        SATEEN_CHECK(check_range("band gain", band.gain, 0, kMaxGain));
    }
    for (const float unit : modulation.units)
        SATEEN_CHECK(check_range("modulation unit", unit, 0, kMaxGain));
    return {};
}

Result<void> check_field(const SmoothField& field) {
    SATEEN_CHECK(
        check_range("deviation", field.deviation, 0, BandModulation::kMaxDeviation));
    const int sum = std::accumulate(field.weights.begin(), field.weights.end(), 0);
    if (field.deviation > 0 && sum == 0)
        return bad_format("weights: all 0, expected one that is not");
    return {};
}

}  // namespace

std::unique_ptr<schema::ModulationT> pack_modulation(const Material& material) {
    auto out = std::make_unique<schema::ModulationT>();
    for (const SmoothField& field : material.modulation->fields) {
        out->field_deviations.push_back(canonical(field.deviation));
        out->field_weights.insert(out->field_weights.end(), field.weights.begin(),
                                  field.weights.end());
    }
    for (const Subspace& subspace : material.subspaces) {
        for (const ModulatedBand& band : subspace.modulation->bands) {
            for (const float scale : {band.value_scale, band.energy_scale, band.gain})
                out->scales.push_back(upper_half(canonical(scale)));
            for (const AmplitudeCurve* curve :
                 {&band.of_value, &band.of_parent, &band.of_first})
                out->curves.insert(out->curves.end(), curve->values.begin(),
                                   curve->values.end());
        }
        for (const float unit : subspace.modulation->units)
            out->units.push_back(upper_half(canonical(unit)));
    }
    return out;
}

Result<void> unpack_modulation(const schema::Modulation& in, Material& out) {
    const std::size_t planes = out.subspaces.size() * out.bands;
    const std::size_t bands = planes * kLevels;
    SATEEN_CHECK(expect_count("modulation.field_deviations", count(in.field_deviations()),
                              kLevels));
    SATEEN_CHECK(expect_count("modulation.field_weights", count(in.field_weights()),
                              kLevels * kWeights));
    SATEEN_CHECK(expect_count("modulation.scales", count(in.scales()), bands * kScales));
    SATEEN_CHECK(
        expect_count("modulation.curves", count(in.curves()), bands * kCurves * kKnots));
    SATEEN_CHECK(expect_count("modulation.units", count(in.units()), planes));
    BandModulation& modulation = out.modulation.emplace();
    for (std::size_t level = 0; level < kLevels; ++level) {
        SmoothField& field = modulation.fields[level];
        field.deviation = at(in.field_deviations(), level);
        for (std::size_t k = 0; k < kWeights; ++k)
            field.weights[k] = at(in.field_weights(), level * kWeights + k);
    }
    std::size_t band = 0;
    std::size_t plane = 0;
    for (Subspace& subspace : out.subspaces) {
        SubspaceModulation& to = subspace.modulation.emplace();
        for (std::size_t k = 0; k < out.bands * kLevels; ++k)
            to.bands.push_back(read_band(in, band++));
        for (std::size_t k = 0; k < out.bands; ++k)
            to.units.push_back(from_upper_half(at(in.units(), plane++)));
    }
    return {};
}

Result<void> validate_modulation(const Material& material) {
    for (std::size_t level = 0; material.modulation && level < kLevels; ++level)
        SATEEN_CHECK(in_element("modulation, level", level,
                                check_field(material.modulation->fields[level])));
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        const Subspace& subspace = material.subspaces[k];
        if (material.modulation) {
            SATEEN_CHECK(in_element("subspace", k, check_subspace(subspace)));
        } else if (subspace.modulation) {
            return bad_format("subspace ", text(k),
                              ": a modulation, expected none as the material has");
        }
    }
    return {};
}

}  // namespace sateen
