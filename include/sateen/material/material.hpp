// SPDX-License-Identifier: Apache-2.0
// A material: all that is kept of a measurement. Analysis makes it, synthesis draws from
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/band_modulation.hpp"
#include "sateen/material/field_model.hpp"
#include "sateen/material/reflectance.hpp"
#include "sateen/material/structure.hpp"
#include "sateen/material/surface.hpp"

namespace sateen {

/// Limits that every material keeps, in memory and in a file.
inline constexpr std::size_t kMaxSubspaces = 20;
inline constexpr std::size_t kMaxLevels = 8;
inline constexpr std::size_t kMaxBands = 3;
inline constexpr std::size_t kMaxDirections = 65535;
inline constexpr std::size_t kMaxPairs = 1U << 20U;
inline constexpr std::uint32_t kMaxSampleSide = 1U << 15U;
/// Bytes of each text of the provenance.
inline constexpr std::size_t kMaxTextBytes = 4096;
/// No mean, scale, knot or coefficient is larger; no variance larger than its square.
inline constexpr float kMaxMagnitude = 1e6F;

/// The values that are transformed and modelled: of linear reflectance v, or of its
/// sRGB-encoded value, whose distribution in photographs is much closer to Gaussian.
enum class Tone : std::uint8_t { linear = 0, srgb = 1 };

/// Karhunen-Loève spectral factorisation [GMRF, eq. 3]: ȳ = T (tone(v) - mean), back with
/// Tᵀ.
struct SpectralTransform {
    Tone tone = Tone::srgb;
    std::vector<float> mean;  ///< (d)
    std::vector<float>
        T;  ///< (d, d), row-major; rows are unit eigenvectors, largest first
    friend bool operator==(const SpectralTransform&, const SpectralTransform&) = default;
};

/// The marginal distribution of one plane, as a monotone curve from a standard normal
/// value g to the plane's value: linear between knots at g = -3 … 3, constant outside.
/// Without knots the value is scale · g.
struct Marginal {
    static constexpr std::size_t kKnots = 16;
    static constexpr float kRange = 3.0F;

    float scale = 1;  ///< standard deviation of the plane; 0 for a constant one
    std::vector<float>
        knots;  ///< kKnots values in units of scale, non-decreasing; or none
    friend bool operator==(const Marginal&, const Marginal&) = default;
};

/// One level of the Gaussian-Laplacian pyramid.
struct Level {
    std::vector<FieldModel> fields;  ///< one for every plane, or one for all of them
    friend bool operator==(const Level&, const Level&) = default;
};

/// A cluster of the BTF space, modelled by the image nearest its centre.
struct Subspace {
    std::uint32_t members = 1;  ///< images that it stands for
    std::uint16_t view = 0;     ///< directions of the representative image
    std::uint16_t light = 0;
    SpectralTransform spectral;
    std::vector<Marginal> marginals;  ///< (d)
    std::vector<Level> levels;        ///< finest first; the last is the low-pass residue
    std::optional<SubspaceStructure> structure;    ///< where the material has one
    std::optional<SubspaceModulation> modulation;  ///< the same
    friend bool operator==(const Subspace&, const Subspace&) = default;
};

/// Which subspace a measured pair of directions belongs to.
struct IndexEntry {
    std::uint16_t light = 0;
    std::uint16_t view = 0;
    std::uint8_t subspace = 0;
    friend bool operator==(const IndexEntry&, const IndexEntry&) = default;
};

/// How the fields are meant to be drawn.
enum class Drawing : std::uint8_t {
    spectral = 0,   ///< zero-phase, all levels at once, power preserved across levels
    recursive = 1,  ///< paper mode: causal recursion, level by level
};

/// Where a material comes from.
struct Provenance {
    std::string name;     ///< of the material
    std::string source;   ///< layout of the measurement, e.g. "ubo2003"
    std::string options;  ///< that differ from the defaults, as on the command line
    std::string writer;   ///< program and version
    std::uint64_t source_checksum = 0;
    friend bool operator==(const Provenance&, const Provenance&) = default;
};

struct Material {
    Provenance provenance;
    bool cosine_included = true;         ///< values contain cos θ of the light
    std::optional<float> pixels_per_mm;  ///< where known
    std::uint32_t sample_rows = 0;       ///< of the measured images
    std::uint32_t sample_cols = 0;
    std::uint32_t bands = 3;  ///< d: 1 or 3
    Drawing drawing = Drawing::spectral;

    std::vector<Direction> views;  ///< empty for photographs, as are lights and index
    std::vector<Direction> lights;
    std::vector<IndexEntry> index;  ///< ascending by (light, view), without repetition
    std::vector<Subspace> subspaces;
    std::optional<Structure> structure;        ///< what stationary fields cannot hold
    std::optional<BandModulation> modulation;  ///< nor Gaussian ones
    std::optional<Surface> surface;            ///< the range map, where one was estimated
    std::optional<Reflectance> reflectance;    ///< of every pair of views and lights
    friend bool operator==(const Material&, const Material&) = default;
};

/// A name, of a file for instance, as validate() accepts it: control characters and bytes
/// that are not UTF-8 become '?', and what exceeds kMaxTextBytes is cut.
[[nodiscard]] std::string valid_text(std::string_view text);

/// Checks every count, index and number against the limits above.
/// \error bad_format  names the field, what it holds and what was expected
[[nodiscard]] Result<void> validate(const Material& material);

}  // namespace sateen
