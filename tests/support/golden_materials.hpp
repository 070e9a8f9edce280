// SPDX-License-Identifier: Apache-2.0
// What the files of tests/golden/v1 hold. Every number is a short binary fraction, so
// that quantisation leaves it alone. Never change these: files of version 1 exist.
#pragma once

#include <cstdint>
#include <vector>

#include "sateen/material/material.hpp"

namespace sateen::test {

/// Coefficients 1/4, -1/8, 1/12 … cut to 1/1024.
inline Car2d golden_field(std::vector<Offset> offsets, float variance) {
    Car2d field{std::move(offsets), {}, variance};
    for (std::size_t i = 0; i < field.neighbourhood.size(); ++i) {
        const int step = 256 / (static_cast<int>(i) + 1);
        field.a.push_back(static_cast<float>(i % 2 == 0 ? step : -step) / 1024);
    }
    return field;
}

inline Marginal golden_marginal(float scale) {
    Marginal marginal{scale, {}};
    for (int i = 0; i < static_cast<int>(Marginal::kKnots); ++i)
        marginal.knots.push_back(static_cast<float>(i * i) / 64 - 2);
    return marginal;
}

/// One photograph: three planes, two levels, an explicit list of offsets.
inline Material golden_photograph() {
    Material m;
    m.provenance = {"gr\xC3\xBCner Satin", "photograph", "--levels 2", "sateen 0.1.0",
                    0x0123456789ABCDEF};
    m.cosine_included = false;
    m.sample_rows = 800;
    m.sample_cols = 640;
    Subspace subspace;
    subspace.spectral = {Tone::srgb, {0.5F, 0.25F, 0.125F}, {0, 0, 1, 1, 0, 0, 0, -1, 0}};
    subspace.marginals = {golden_marginal(0.25F), golden_marginal(0.125F), {0, {}}};
    const std::vector<Offset> scattered = {{0, 1}, {1, -3}, {2, 0}, {8, -8}};
    subspace.levels = {{{golden_field(hierarchical_half_plane(6), 0.5F),
                         golden_field(scattered, 0.25F), Car2d{}}},
                       {{golden_field(hierarchical_half_plane(3), 0.75F),
                         golden_field(scattered, 1), Car2d{}}}};
    m.subspaces = {subspace};
    return m;
}

/// A complete grid of 2 lights and 3 views, one band, two subspaces, drawn recursively.
inline Material golden_grid() {
    Material m;
    m.provenance = {"grid", "ubo2003", "--paper", "sateen 0.1.0", 42};
    m.pixels_per_mm = 12.5F;
    m.sample_rows = 256;
    m.sample_cols = 256;
    m.bands = 1;
    m.drawing = Drawing::recursive;
    m.views = {direction_from_degrees(0, 0), direction_from_degrees(15, 60),
               direction_from_degrees(75, 345)};
    m.lights = {direction_from_degrees(0, 0), direction_from_degrees(22.5F, -90)};
    m.index = {{0, 0, 0}, {0, 1, 0}, {0, 2, 1}, {1, 0, 1}, {1, 1, 0}, {1, 2, 1}};
    for (const float scale : {0.5F, 0.25F}) {
        Subspace subspace;
        subspace.members = 3;
        subspace.view = scale == 0.5F ? 1 : 2;
        subspace.light = scale == 0.5F ? 0 : 1;
        subspace.spectral = {Tone::linear, {scale}, {1}};
        subspace.marginals = {{scale, {}}};
        subspace.levels = {{{golden_field(hierarchical_half_plane(1), scale)}}};
        m.subspaces.push_back(subspace);
    }
    return m;
}

/// The same with one pair that was not measured.
inline Material golden_incomplete() {
    Material m = golden_grid();
    m.provenance.name = "incomplete";
    m.index.erase(m.index.begin() + 3);
    return m;
}

/// The photograph with a range map: two tiles of 3 x 4 in a sheared lattice, whose codes use
/// all 16 bits.
inline Material golden_surface() {
    Material m = golden_photograph();
    m.provenance.name = "surface";
    m.surface = Surface{3, 4, 1, -0.5F, 1.0F / 1024, true, 0, {}};
    for (const int step : {5461, 40503}) {
        auto& tile = m.surface->tiles.emplace_back();
        for (int i = 0; i < 12; ++i)
            tile.push_back(static_cast<std::uint16_t>(i * step & 0xFFFF));
    }
    return m;
}

/// The photograph with a pattern: a bent lattice, cells with all their parts, and one plane
/// without any.
inline Material golden_structure() {
    Material m = golden_photograph();
    m.provenance.name = "structure";
    PeriodicLayer layer;
    layer.a = {0.5F, 10};
    layer.b = {12.25F, -2};
    layer.rows = 10;
    layer.cols = 12;
    layer.spacing = 4;
    layer.displacement[0].deviation = 0.75F;
    layer.displacement[0].weights[7] = 255;
    layer.displacement[1].deviation = 0.5F;
    layer.displacement[1].weights = {200, 0, 0, 55};
    m.structure = Structure{layer};
    SubspaceStructure& structure = m.subspaces[0].structure.emplace();
    structure.cells.resize(3);
    for (std::size_t plane = 0; plane < 2; ++plane) {
        PeriodicCell& cell = structure.cells[plane];
        cell.step = 1.0F / 64;
        cell.coefficients = {-3, 20, -300, 0, 7, -1, 1};
        cell.deviation_step = 1.0F / 128;
        for (unsigned i = 0; i < deviation_side(10) * deviation_side(12); ++i)
            cell.deviations.push_back(static_cast<std::uint8_t>(64 + 10 * i));
        if (plane == 1) {
            cell.mixing_step = 1.0F / 256;
            cell.mixing = {127, -127, 1, 0, 64, -64, 2, -1, 5};
        }
        cell.curve.low = -0.5F;
        cell.curve.high = 0.75F;
        for (int i = 0; i < static_cast<int>(ToneCurve::kKnots); ++i)
            cell.curve.values.push_back(static_cast<float>(i * i) / 256 - 0.5F);
    }
    return m;
}

/// The photograph with modulated bands.
inline Material golden_modulated() {
    Material m = golden_photograph();
    BandModulation& modulation = m.modulation.emplace();
    for (std::size_t level = 0; level < BandModulation::kLevels; ++level) {
        SmoothField& field = modulation.fields[level];
        field.deviation = level == 1 ? 0 : 0.25F;
        field.weights[level] = static_cast<std::uint8_t>(255 - level);
    }
    SubspaceModulation& to = m.subspaces[0].modulation.emplace();
    for (std::size_t i = 0; i < 3 * BandModulation::kLevels; ++i) {
        ModulatedBand& band = to.bands.emplace_back();
        band.value_scale = 1.5F;
        band.energy_scale = static_cast<float>(i + 1);
        band.gain = 0.875F;
        for (std::size_t j = 0; j < AmplitudeCurve::kKnots; ++j) {
            band.of_value.values[j] = static_cast<std::int8_t>(j);
            band.of_parent.values[j] =
                static_cast<std::int8_t>(4 * static_cast<int>(j) - 16);
            band.of_first.values[j] = static_cast<std::int8_t>(-static_cast<int>(i));
        }
    }
    to.units = {1, 0.75F, 1};
    return m;
}

}  // namespace sateen::test
