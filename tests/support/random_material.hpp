// SPDX-License-Identifier: Apache-2.0
// Valid materials with random contents, from a seed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "sateen/material/material.hpp"
#include "support/surfaces.hpp"

namespace sateen::test {

struct RandomMaterialOptions {
    std::uint64_t seed = 0;
    std::size_t subspaces = 1;
    std::size_t levels = 5;
    std::uint32_t bands = 3;
    int order = 6;                  ///< hierarchical, of most fields
    bool explicit_offsets = false;  ///< one field a level has a list of its own
    bool knots = true;              ///< marginal curves
    std::size_t views = 0;          ///< 0 for photographs
    std::size_t lights = 0;
    bool complete = true;  ///< every pair of directions is measured
    /// Of the fields, by number in FieldModel; joint ones draw all planes.
    std::size_t model = 0;
    bool structure = false;   ///< a periodic layer
    bool modulation = false;  ///< of the bands
    std::size_t tiles = 0;    ///< of the range map; 0 for none
    std::size_t rank = 0;     ///< of a reflectance, where not 0
};

class RandomMaterial {
  public:
    explicit RandomMaterial(const RandomMaterialOptions& options)
        : options_(options), engine_(options.seed) {}

    Material make() {
        Material m;
        m.provenance = {"a material", options_.views == 0 ? "photograph" : "ubo2003",
                        "--field car2d", "sateen 0.1.0", engine_()};
        m.cosine_included = engine_() % 2 == 0;
        if (engine_() % 2 == 0) m.pixels_per_mm = uniform(1, 40);
        m.sample_rows = 256;
        m.sample_cols = 320;
        m.bands = options_.bands;
        m.drawing = engine_() % 2 == 0 ? Drawing::spectral : Drawing::recursive;
        m.views = directions(options_.views);
        m.lights = directions(options_.lights);
        fill_index(m);
        for (std::size_t i = 0; i < options_.subspaces; ++i)
            m.subspaces.push_back(subspace(m));
        if (options_.structure) fill_structure(m);
        if (options_.modulation) fill_modulation(m);
        if (options_.tiles != 0)
            m.surface = random_surface({.seed = engine_(),
                                        .shear_px = static_cast<std::uint32_t>(below(13)),
                                        .tiles = options_.tiles});
        if (options_.rank != 0) m.reflectance = reflectance(m);
        return m;
    }

  private:
    // The distributions of <random> differ between libraries; its engines do not.
    float uniform(float low, float high) {
        const auto bits = static_cast<float>(engine_() >> 40U);
        return low + (high - low) * bits / 16777216.0F;
    }
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

    // Whole degrees, as measurements have them.
    std::vector<Direction> directions(std::size_t n) {
        std::vector<Direction> out;
        for (std::size_t i = 0; i < n; ++i)
            out.push_back(direction_from_degrees(static_cast<float>(below(91)),
                                                 static_cast<float>(below(360))));
        return out;
    }

    void fill_index(Material& m) {
        for (std::size_t light = 0; light < options_.lights; ++light)
            for (std::size_t view = 0; view < options_.views; ++view)
                if (options_.complete || below(8) != 0)
                    m.index.push_back(
                        {static_cast<std::uint16_t>(light),
                         static_cast<std::uint16_t>(view),
                         static_cast<std::uint8_t>(below(options_.subspaces))});
    }

    Subspace subspace(const Material& m) {
        Subspace out;
        out.members = static_cast<std::uint32_t>(1 + below(400));
        out.view =
            static_cast<std::uint16_t>(m.views.empty() ? 0 : below(m.views.size()));
        out.light =
            static_cast<std::uint16_t>(m.lights.empty() ? 0 : below(m.lights.size()));
        out.spectral.tone = below(2) == 0 ? Tone::linear : Tone::srgb;
        for (std::size_t i = 0; i < m.bands; ++i)
            out.spectral.mean.push_back(uniform(0, 1));
        out.spectral.T = rotation(m.bands);
        for (std::size_t i = 0; i < m.bands; ++i) out.marginals.push_back(marginal());
        for (std::size_t i = 0; i < options_.levels; ++i) out.levels.push_back(level());
        return out;
    }

    Reflectance reflectance(const Material& m) {
        Reflectance out;
        out.channels = m.bands + 1;
        out.rank = static_cast<std::uint32_t>(options_.rank);
        const std::size_t columns = m.views.size() * out.channels;
        for (std::size_t i = 0; i < columns; ++i) out.base.push_back(uniform(0, 1));
        for (std::size_t i = 0; i < m.lights.size() * options_.rank; ++i)
            out.lights.push_back(uniform(-1, 1));
        for (std::size_t i = 0; i < columns * options_.rank; ++i)
            out.views.push_back(uniform(-0.1F, 0.1F));
        return out;
    }

    SmoothField smooth_field() {
        SmoothField out;
        out.deviation = uniform(0.1F, 3);
        for (std::uint8_t& weight : out.weights)
            weight = static_cast<std::uint8_t>(below(256));
        return out;
    }

    void fill_structure(Material& m) {
        PeriodicLayer layer;
        layer.a = {uniform(-3, 3), uniform(12, 14)};
        layer.b = {uniform(20, 24), uniform(-5, 5)};
        layer.rows = 13;
        layer.cols = 22;
        layer.spacing = 8;
        layer.displacement = {smooth_field(), smooth_field()};
        m.structure = Structure{layer};
        for (Subspace& subspace : m.subspaces) {
            subspace.structure.emplace();
            for (std::size_t plane = 0; plane < m.bands; ++plane)
                subspace.structure->cells.push_back(cell(layer, plane));
        }
    }

    AmplitudeCurve amplitude_curve() {
        AmplitudeCurve out;
        for (std::int8_t& value : out.values)
            value = static_cast<std::int8_t>(static_cast<int>(below(61)) - 30);
        return out;
    }

    void fill_modulation(Material& m) {
        BandModulation& modulation = m.modulation.emplace();
        for (SmoothField& field : modulation.fields) {
            field = smooth_field();
            field.deviation = uniform(0.1F, 0.5F);
        }
        modulation.fields[2].deviation = 0;
        for (Subspace& subspace : m.subspaces) {
            SubspaceModulation& to = subspace.modulation.emplace();
            for (std::size_t i = 0; i < m.bands * BandModulation::kLevels; ++i) {
                ModulatedBand& band = to.bands.emplace_back();
                band.value_scale = to_half_of_float(uniform(1, 3));
                band.energy_scale = to_half_of_float(uniform(2, 30));
                band.gain = to_half_of_float(uniform(0.7F, 1));
                for (AmplitudeCurve* curve :
                     {&band.of_value, &band.of_parent, &band.of_first})
                    *curve = amplitude_curve();
            }
            for (std::size_t i = 0; i < m.bands; ++i)
                to.units.push_back(to_half_of_float(uniform(0.8F, 1)));
        }
    }

    PeriodicCell cell(const PeriodicLayer& layer, std::size_t plane) {
        PeriodicCell out;
        out.step = uniform(0.0001F, 0.001F);
        for (std::size_t i = 0; i < 41; ++i)
            out.coefficients.push_back(
                static_cast<std::int16_t>(static_cast<int>(below(601)) - 300));
        out.deviation_step = uniform(0.005F, 0.02F);
        const std::size_t sites = deviation_side(layer.rows) * deviation_side(layer.cols);
        for (std::size_t i = 0; i < sites; ++i)
            out.deviations.push_back(static_cast<std::uint8_t>(below(256)));
        if (plane > 0) out.mixing_step = uniform(0.001F, 0.004F);
        for (std::size_t i = 0;
             i < plane * mixing_side(layer.rows) * mixing_side(layer.cols); ++i)
            out.mixing.push_back(
                static_cast<std::int8_t>(static_cast<int>(below(255)) - 127));
        out.curve.low = uniform(-1, -0.5F);
        out.curve.high = uniform(0.5F, 1);
        for (std::size_t i = 0; i < ToneCurve::kKnots; ++i)
            out.curve.values.push_back(static_cast<float>(below(2049)) / 1024 - 1);
        std::ranges::sort(out.curve.values);
        return out;
    }

    // Rows of a rotation about x and then z.
    std::vector<float> rotation(std::size_t bands) {
        if (bands == 1) return {1};
        const float a = uniform(0, 6);
        const float b = uniform(0, 6);
        return {std::cos(a),
                std::sin(a),
                0,
                -std::sin(a) * std::cos(b),
                std::cos(a) * std::cos(b),
                std::sin(b),
                std::sin(a) * std::sin(b),
                -std::cos(a) * std::sin(b),
                std::cos(b)};
    }

    Marginal marginal() {
        Marginal out;
        out.scale = uniform(0.01F, 0.3F);
        if (!options_.knots) return out;
        for (std::size_t i = 0; i < Marginal::kKnots; ++i)
            out.knots.push_back(uniform(-Marginal::kRange, Marginal::kRange));
        std::ranges::sort(out.knots);
        return out;
    }

    // Σ |a_s| < 1, ½ for a Markov field: stable.
    template <class Model>
    Model plane_field(std::vector<Offset> offsets, float sum) {
        Model out;
        out.neighbourhood = std::move(offsets);
        const float bound = sum / static_cast<float>(out.neighbourhood.size());
        for (std::size_t i = 0; i < out.neighbourhood.size(); ++i)
            out.a.push_back(uniform(-bound, bound));
        out.variance = uniform(0.1F, 1);
        return out;
    }

    Autoregression3d joint_field(std::vector<Offset> offsets) {
        const std::size_t d = options_.bands;
        Autoregression3d out{d, std::move(offsets), {}, std::vector<float>(d * d)};
        const std::size_t count = out.neighbourhood.size() * d * d;
        const float bound = 0.95F / static_cast<float>(count);
        for (std::size_t k = 0; k < count; ++k) out.A.push_back(uniform(-bound, bound));
        for (std::size_t i = 0; i < d; ++i)
            for (std::size_t j = 0; j <= i; ++j)
                out.Sigma[i * d + j] = out.Sigma[j * d + i] =
                    i == j ? uniform(0.3F, 1) : uniform(-0.1F, 0.1F);
        return out;
    }

    Level level() {
        Level out;
        if (options_.model >= 2) {
            Autoregression3d field = joint_field(
                options_.explicit_offsets ? scattered_offsets()
                                          : hierarchical_half_plane(options_.order));
            if (options_.model == 2)
                out.fields.emplace_back(Car3d{std::move(field)});
            else
                out.fields.emplace_back(Sar3d{std::move(field)});
            return out;
        }
        for (std::uint32_t i = 0; i < options_.bands; ++i) {
            auto offsets = options_.explicit_offsets && i == 0
                               ? scattered_offsets()
                               : hierarchical_half_plane(options_.order);
            if (options_.model == 0)
                out.fields.emplace_back(plane_field<Car2d>(std::move(offsets), 0.95F));
            else
                out.fields.emplace_back(plane_field<Gmrf2d>(std::move(offsets), 0.45F));
        }
        return out;
    }

    std::vector<Offset> scattered_offsets() {
        std::vector<Offset> out;
        for (const Offset s : hierarchical_half_plane(kMaxOrder))
            if (below(3) == 0) out.push_back(s);
        return out;
    }

    RandomMaterialOptions options_;
    std::mt19937_64 engine_;
};

/// A random valid material.
inline Material random_material(const RandomMaterialOptions& options = {}) {
    return RandomMaterial(options).make();
}

/// Some of every kind: photographs and measurements, one band and three, explicit lists.
inline std::vector<Material> assorted_materials() {
    return {
        random_material({.seed = 1}),
        random_material({.seed = 2, .levels = 1, .bands = 1, .order = 1, .knots = false}),
        random_material({.seed = 3,
                         .subspaces = 3,
                         .levels = 3,
                         .explicit_offsets = true,
                         .views = 7,
                         .lights = 5}),
        random_material({.seed = 4,
                         .subspaces = 2,
                         .levels = 8,
                         .order = 13,
                         .views = 4,
                         .lights = 9,
                         .complete = false}),
        random_material({.seed = 5, .explicit_offsets = true, .model = 1}),
        random_material({.seed = 6, .subspaces = 2, .order = 4, .model = 2}),
        random_material({.seed = 7, .levels = 2, .explicit_offsets = true, .model = 3}),
        random_material({.seed = 8, .levels = 3, .bands = 1, .model = 3}),
        random_material({.seed = 9, .structure = true}),
        random_material(
            {.seed = 10, .subspaces = 2, .views = 2, .lights = 2, .structure = true}),
        random_material({.seed = 11, .levels = 2, .views = 2, .lights = 3, .tiles = 4}),
        random_material({.seed = 12, .subspaces = 2, .views = 7, .lights = 5, .rank = 3}),
        random_material({.seed = 13,
                         .levels = 2,
                         .bands = 1,
                         .views = 1,
                         .lights = 9,
                         .complete = false,
                         .rank = 16}),
        random_material({.seed = 14, .levels = 2, .modulation = true}),
        random_material({.seed = 15,
                         .subspaces = 2,
                         .levels = 2,
                         .bands = 1,
                         .views = 2,
                         .lights = 2,
                         .modulation = true}),
    };
}

}  // namespace sateen::test
