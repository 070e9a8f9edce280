// SPDX-License-Identifier: Apache-2.0
// Every limit of material.hpp, checked. Partner of file_read.cpp, which checks only what
// it takes to build a Material in memory.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>

#include "material/message.hpp"
#include "material/modulation_file.hpp"
#include "material/numbers.hpp"
#include "material/quantise.hpp"
#include "material/reflectance_file.hpp"
#include "material/structure_file.hpp"
#include "sateen/material/material.hpp"

namespace sateen {
namespace {

// Rows of T are computed in double and stored as float; more than this is not rounding.
constexpr float kOrthonormalTolerance = 1e-3F;

Result<void> check_below(std::string_view what, std::size_t value, std::size_t count) {
    if (value < count) return {};
    return bad_format(what, ": ", text(value), ", expected less than ", text(count));
}

// The length of the UTF-8 sequence that `text` starts with; 0 for ill-formed bytes and
// for control characters, which could drive the terminal that the text is printed on.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) -> std::uint32_t {
        return i < text.size() ? static_cast<std::uint8_t>(text[i]) : 0;
    };
    const std::uint32_t first = byte(0);
    if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
    const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    std::uint32_t code = first & (0x7FU >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) return 0;
        code = code << 6U | (byte(i) & 0x3FU);
    }
    constexpr std::uint32_t kShortest[] = {0, 0, 0xA0, 0x800, 0x10000};
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    const bool valid = first >= 0xC2 && first <= 0xF4 && code >= kShortest[length] &&
                       code <= 0x10FFFF && !surrogate;
    return valid ? length : 0;
}

Result<void> check_text(std::string_view what, std::string_view value) {
    if (value.size() > kMaxTextBytes)
        return bad_format(what, ": ", text(value.size()), " bytes, expected at most ",
                          text(kMaxTextBytes));
    for (std::size_t at = 0; at < value.size();) {
        const std::size_t length = character_length(value.substr(at));
        if (length == 0)
            return bad_format(what, ": byte ", text(at),
                              " is a control character or not UTF-8");
        at += length;
    }
    return {};
}

Result<void> check_provenance(const Provenance& provenance) {
    SATEEN_CHECK(check_text("provenance.name", provenance.name));
    SATEEN_CHECK(check_text("provenance.source", provenance.source));
    SATEEN_CHECK(check_text("provenance.options", provenance.options));
    return check_text("provenance.writer", provenance.writer);
}

Result<void> check_sample(const Material& m) {
    for (const auto& [what, side] : {std::pair{"sample_rows", m.sample_rows},
                                     std::pair{"sample_cols", m.sample_cols}})
        if (side < 1 || side > kMaxSampleSide)
            return bad_format(what, ": ", text(std::size_t{side}), ", expected 1 to ",
                              text(std::size_t{kMaxSampleSide}));
    if (m.bands != 1 && m.bands != kMaxBands)
        return bad_format("bands: ", text(std::size_t{m.bands}), ", expected 1 or 3");
    if (m.drawing != Drawing::spectral && m.drawing != Drawing::recursive)
        return bad_format("drawing: ", text(static_cast<std::size_t>(m.drawing)),
                          ", expected 0 or 1");
    if (m.pixels_per_mm && !(*m.pixels_per_mm > 0 && *m.pixels_per_mm <= kMaxMagnitude))
        return bad_format("pixels_per_mm: ", text(*m.pixels_per_mm),
                          ", expected more than 0 and at most ", text(kMaxMagnitude));
    return {};
}

Result<void> check_directions(std::string_view what,
                              const std::vector<Direction>& directions) {
    if (directions.size() > kMaxDirections)
        return bad_format(what, "s: ", text(directions.size()), ", expected at most ",
                          text(kMaxDirections));
    for (std::size_t i = 0; i < directions.size(); ++i) {
        // On the grid of the file, where 90 degrees are 90 degrees however they were
        // rounded.
        const float theta = quantised_degrees(directions[i].theta);
        const float phi = quantised_degrees(directions[i].phi);
        SATEEN_CHECK(in_element(what, i, check_range("theta in degrees", theta, 0, 90)));
        SATEEN_CHECK(in_element(what, i, check_range("phi in degrees", phi, -360, 360)));
    }
    return {};
}

Result<void> check_entry(const Material& m, const IndexEntry& entry) {
    SATEEN_CHECK(check_below("light", entry.light, m.lights.size()));
    SATEEN_CHECK(check_below("view", entry.view, m.views.size()));
    return check_below("subspace", entry.subspace, m.subspaces.size());
}

Result<void> check_index(const Material& m) {
    const bool measured = !m.index.empty();
    if (measured != !m.views.empty() || measured != !m.lights.empty())
        return bad_format("index: ", text(m.index.size()), " pairs of ",
                          text(m.lights.size()), " lights and ", text(m.views.size()),
                          " views, expected none or some of each");
    if (m.index.size() > kMaxPairs)
        return bad_format("index: ", text(m.index.size()), " pairs, expected at most ",
                          text(kMaxPairs));
    for (std::size_t i = 0; i < m.index.size(); ++i) {
        const IndexEntry& entry = m.index[i];
        SATEEN_CHECK(in_element("index entry", i, check_entry(m, entry)));
        if (i == 0) continue;
        const IndexEntry& before = m.index[i - 1];
        if (std::tie(before.light, before.view) >= std::tie(entry.light, entry.view))
            return bad_format("index entry ", text(i), ": light ",
                              text(std::size_t{entry.light}), ", view ",
                              text(std::size_t{entry.view}),
                              ", expected a pair after that of the entry before");
    }
    return {};
}

Result<void> check_spectral(const SpectralTransform& spectral, std::size_t bands) {
    if (spectral.tone != Tone::linear && spectral.tone != Tone::srgb)
        return bad_format("tone: ", text(static_cast<std::size_t>(spectral.tone)),
                          ", expected 0 or 1");
    SATEEN_CHECK(expect_count("mean", spectral.mean.size(), bands));
    SATEEN_CHECK(expect_count("T", spectral.T.size(), bands * bands));
    SATEEN_CHECK(check_numbers("mean", spectral.mean));
    SATEEN_CHECK(check_numbers("T", spectral.T));
    for (std::size_t i = 0; i < bands; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            float product = i == j ? -1.0F : 0.0F;
            for (std::size_t k = 0; k < bands; ++k)
                product += spectral.T[i * bands + k] * spectral.T[j * bands + k];
            if (std::abs(product) > kOrthonormalTolerance)
                return bad_format("T: rows ", text(j), " and ", text(i), " are off by ",
                                  text(product), ", expected orthonormal rows");
        }
    return {};
}

Result<void> check_marginal(const Marginal& marginal) {
    SATEEN_CHECK(check_range("marginal scale", marginal.scale, 0, kMaxMagnitude));
    if (!marginal.knots.empty())
        SATEEN_CHECK(
            expect_count("marginal knots", marginal.knots.size(), Marginal::kKnots));
    SATEEN_CHECK(check_numbers("marginal knots", marginal.knots));
    const auto fall = std::is_sorted_until(marginal.knots.begin(), marginal.knots.end());
    if (fall != marginal.knots.end())
        return bad_format("marginal knots: ", text(*fall), " after ",
                          text(*std::prev(fall)), ", expected no descent");
    return {};
}

enum class Support { causal, any };

Result<void> check_neighbourhood(std::span<const Offset> offsets, Support support) {
    if (offsets.size() > kMaxNeighbours)
        return bad_format("neighbourhood: ", text(offsets.size()),
                          " offsets, expected at most ", text(kMaxNeighbours));
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        const Offset s = offsets[i];
        const auto fail = [s](std::string_view what) {
            return bad_format("offset (", std::to_string(s.row), ", ",
                              std::to_string(s.col), "): ", what);
        };
        if (std::abs(s.row) > kMaxReach || std::abs(s.col) > kMaxReach)
            return fail("expected a reach of at most " + std::to_string(kMaxReach));
        if (support == Support::causal && !is_causal(s))
            return fail("expected one of the causal half plane");
        if (s == Offset{0, 0}) return fail("expected another site");
        const auto before = offsets.first(i);
        if (std::count(before.begin(), before.end(), s) != 0) return fail("repeated");
    }
    return {};
}

Result<void> check_coefficients(std::span<const float> a, std::size_t each,
                                std::size_t offsets) {
    if (a.size() != each * offsets)
        return bad_format(text(a.size()), " coefficients for ", text(offsets),
                          " offsets");
    return check_numbers("coefficient", a);
}

Result<void> check_variance(float variance) {
    return check_range("variance", variance, 0, kMaxMagnitude * kMaxMagnitude);
}

// Of a field of one plane.
template <class Model>
requires(!is_joint<Model>) Result<void> check_field(const Model& field,
                                                    std::size_t /*bands*/) {
    SATEEN_CHECK(check_neighbourhood(field.neighbourhood, Support::causal));
    SATEEN_CHECK(check_coefficients(field.a, 1, field.neighbourhood.size()));
    return check_variance(field.variance);
}

// Drawing takes any symmetric Σ and clamps negative eigenvalues; what is checked here is
// what gross damage breaks.
Result<void> check_covariance(std::span<const float> Sigma, std::size_t d) {
    SATEEN_CHECK(expect_count("Sigma", Sigma.size(), d * d));
    for (std::size_t i = 0; i < d; ++i) SATEEN_CHECK(check_variance(Sigma[i * d + i]));
    for (std::size_t i = 0; i < d; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const float covariance = Sigma[i * d + j];
            const float bound = std::sqrt(Sigma[i * d + i]) * std::sqrt(Sigma[j * d + j]);
            constexpr float kRounding = 1.001F;
            SATEEN_CHECK(check_range("covariance", covariance, -kRounding * bound,
                                     kRounding * bound));
            if (Sigma[j * d + i] != covariance)
                return bad_format("Sigma: ", text(covariance), " and ",
                                  text(Sigma[j * d + i]), ", expected symmetry");
        }
    return {};
}

Result<void> check_joint(const Autoregression3d& field, Support support,
                         std::size_t bands) {
    if (field.planes != bands)
        return bad_format("a field of ", text(field.planes), " planes, expected ",
                          text(bands));
    SATEEN_CHECK(check_neighbourhood(field.neighbourhood, support));
    SATEEN_CHECK(check_coefficients(field.A, bands * bands, field.neighbourhood.size()));
    return check_covariance(field.Sigma, bands);
}

Result<void> check_field(const Car3d& field, std::size_t bands) {
    return check_joint(field, Support::causal, bands);
}

Result<void> check_field(const Sar3d& field, std::size_t bands) {
    return check_joint(field, Support::any, bands);
}

Result<void> check_level(const Level& level, std::size_t bands) {
    const bool joint =
        level.fields.size() == 1 &&
        std::visit(
            [](const auto& field) { return is_joint<std::decay_t<decltype(field)>>; },
            level.fields[0]);
    if (!joint) SATEEN_CHECK(expect_count("fields", level.fields.size(), bands));
    for (std::size_t i = 0; i < level.fields.size(); ++i) {
        const auto check = [&](const auto& field) { return check_field(field, bands); };
        SATEEN_CHECK(in_element("plane", i, std::visit(check, level.fields[i])));
        if (!joint && planes_of(level.fields[i]) != 1)
            return bad_format("plane ", text(i), ", a field of ", text(bands),
                              " planes, expected it alone");
    }
    return {};
}

Result<void> check_subspace(const Material& m, const Subspace& subspace) {
    if (subspace.members < 1 || subspace.members > kMaxPairs)
        return bad_format("members: ", text(std::size_t{subspace.members}),
                          ", expected 1 to ", text(kMaxPairs));
    SATEEN_CHECK(
        check_below("view", subspace.view, std::max<std::size_t>(1, m.views.size())));
    SATEEN_CHECK(
        check_below("light", subspace.light, std::max<std::size_t>(1, m.lights.size())));
    SATEEN_CHECK(check_spectral(subspace.spectral, m.bands));
    SATEEN_CHECK(expect_count("marginals", subspace.marginals.size(), m.bands));
    for (std::size_t i = 0; i < subspace.marginals.size(); ++i)
        SATEEN_CHECK(in_element("plane", i, check_marginal(subspace.marginals[i])));
    if (subspace.levels.empty() || subspace.levels.size() > kMaxLevels)
        return bad_format("levels: ", text(subspace.levels.size()), ", expected 1 to ",
                          text(kMaxLevels));
    for (std::size_t i = 0; i < subspace.levels.size(); ++i)
        SATEEN_CHECK(in_element("level", i, check_level(subspace.levels[i], m.bands)));
    return {};
}

}  // namespace

std::string valid_text(std::string_view text) {
    std::string valid;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const std::string_view character = length > 0 ? text.substr(0, length) : "?";
        if (valid.size() + character.size() > kMaxTextBytes) break;
        valid += character;
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return valid;
}

Result<void> validate(const Material& material) {
    SATEEN_CHECK(check_provenance(material.provenance));
    SATEEN_CHECK(check_sample(material));
    if (material.subspaces.empty() || material.subspaces.size() > kMaxSubspaces)
        return bad_format("subspaces: ", text(material.subspaces.size()),
                          ", expected 1 to ", text(kMaxSubspaces));
    SATEEN_CHECK(check_directions("view", material.views));
    SATEEN_CHECK(check_directions("light", material.lights));
    SATEEN_CHECK(check_index(material));
    for (std::size_t i = 0; i < material.subspaces.size(); ++i)
        SATEEN_CHECK(
            in_element("subspace", i, check_subspace(material, material.subspaces[i])));
    SATEEN_CHECK(validate_structure(material));
    SATEEN_CHECK(validate_modulation(material));
    if (material.surface) SATEEN_CHECK(validate(*material.surface));
    return validate_reflectance(material);
}

}  // namespace sateen
