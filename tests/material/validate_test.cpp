// SPDX-License-Identifier: Apache-2.0
// Each limit of material.hpp: a valid material with one thing wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "sateen/material/file.hpp"
#include "support/faults.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

using test::Fault;
using test::random_material;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

void expect_each_fault_is_named(const std::vector<Fault>& faults) {
    const Material valid = random_material(
        {.seed = 7, .subspaces = 4, .levels = 3, .views = 6, .lights = 5});
    test::expect_each_fault_is_named(valid, faults);
}

Car2d& field(Material& m) {
    return std::get<Car2d>(m.subspaces[3].levels[1].fields[0]);
}

Car3d& joint(Material& m) {
    return std::get<Car3d>(m.subspaces[0].levels[1].fields[0]);
}

TEST(Validate, AcceptsAssortedMaterials) {
    for (const Material& m : test::assorted_materials()) {
        const auto result = validate(m);
        EXPECT_TRUE(result) << result.error().message;
    }
}

TEST(Validate, AcceptsAPlaneWithoutNeighboursOrVariance) {
    Material m = random_material();
    m.subspaces[0].levels[0].fields[0] = Car2d{};
    m.subspaces[0].marginals[0] = {0, {}};
    EXPECT_TRUE(validate(m));
}

TEST(Validate, NamesFaultsOfTheWhole) {
    expect_each_fault_is_named({
        {"bands: 2, expected 1 or 3", [](auto& m) { m.bands = 2; }},
        {"bands: 0", [](auto& m) { m.bands = 0; }},
        {"drawing: 2", [](auto& m) { m.drawing = static_cast<Drawing>(2); }},
        {"sample_rows: 0, expected 1 to 32768", [](auto& m) { m.sample_rows = 0; }},
        {"sample_cols: 32769", [](auto& m) { m.sample_cols = kMaxSampleSide + 1; }},
        {"pixels_per_mm: 0", [](auto& m) { m.pixels_per_mm = 0.0F; }},
        {"pixels_per_mm: nan", [](auto& m) { m.pixels_per_mm = kNan; }},
        {"pixels_per_mm: inf", [](auto& m) { m.pixels_per_mm = kInfinity; }},
        {"subspaces: 0, expected 1 to 20", [](auto& m) { m.subspaces.clear(); }},
        {"subspaces: 21", [](auto& m) { m.subspaces.resize(21, m.subspaces[0]); }},
        {"provenance.name: 4097 bytes",
         [](auto& m) { m.provenance.name.assign(4097, 'a'); }},
        {"provenance.source: byte 1", [](auto& m) { m.provenance.source = "a\x1b[2J"; }},
        {"provenance.options: byte 0", [](auto& m) { m.provenance.options = "\xff"; }},
        {"provenance.writer: byte 1", [](auto& m) { m.provenance.writer = "a\xc3"; }},
    });
}

TEST(Validate, AcceptsExactlyWellFormedUtf8InTexts) {
    const auto valid = [](const char* text) {
        Material m = random_material();
        m.provenance.name = text;
        return validate(m).has_value();
    };
    for (const char* text :
         {"", "plain ~", "gr\xC3\xBCn", "\xE5\xB8\x83", "\xF0\x9F\xA7\xB5", "\xC2\xA0",
          "\xEF\xBF\xBD", "\xF4\x8F\xBF\xBF"})
        EXPECT_TRUE(valid(text)) << text;
    for (const char* text :
         {"\n", "\x7F", "\x80", "\xC0\x80", "\xC1\xBF", "\xC2\x80", "\xE0\x80\x80",
          "\xE0\x9F\xBF", "\xED\xA0\x80", "\xE5\xB8", "\xF0\x8F\xBF\xBF",
          "\xF4\x90\x80\x80", "\xF8\x88\x80\x80\x80"})
        EXPECT_FALSE(valid(text)) << testing::PrintToString(text);
}

TEST(Validate, NamesFaultsOfDirections) {
    expect_each_fault_is_named({
        {"light 2, theta in degrees: -1, expected 0 to 90",
         [](auto& m) { m.lights[2] = direction_from_degrees(-1, 0); }},
        {"view 5, theta in degrees: 90.25",
         [](auto& m) { m.views[5] = direction_from_degrees(90.25F, 0); }},
        {"view 0, theta in degrees: nan", [](auto& m) { m.views[0].theta = kNan; }},
        {"view 1, phi in degrees: 361",
         [](auto& m) { m.views[1] = direction_from_degrees(0, 361); }},
        {"light 0, phi in degrees: -inf", [](auto& m) { m.lights[0].phi = -kInfinity; }},
        {"views: 65536, expected at most 65535", [](auto& m) { m.views.resize(65536); }},
    });
    Material m = random_material({.views = 1, .lights = 1});
    m.views[0].theta = std::numbers::pi_v<float> / 2;
    m.views[0].phi = 2 * std::numbers::pi_v<float>;
    EXPECT_TRUE(validate(m)) << "the horizon, rounded up";
}

TEST(Validate, NamesFaultsOfTheIndex) {
    expect_each_fault_is_named({
        {"index entry 3, light: 5, expected less than 5",
         [](auto& m) { m.index[3].light = 5; }},
        {"index entry 4, view: 6", [](auto& m) { m.index[4].view = 6; }},
        {"index entry 5, subspace: 4", [](auto& m) { m.index[5].subspace = 4; }},
        {"index entry 2: light 0, view 1", [](auto& m) { m.index[2] = m.index[1]; }},
        {"index entry 1: light 0, view 0",
         [](auto& m) { std::swap(m.index[0], m.index[1]); }},
        {"index: 0 pairs of 5 lights and 6 views", [](auto& m) { m.index.clear(); }},
        {"index: 30 pairs of 5 lights and 0 views", [](auto& m) { m.views.clear(); }},
        {"index: 30 pairs of 0 lights and 6 views", [](auto& m) { m.lights.clear(); }},
        {"index: 1048577 pairs", [](auto& m) { m.index.resize(kMaxPairs + 1); }},
    });
}

TEST(Validate, NamesFaultsOfSubspaces) {
    expect_each_fault_is_named({
        {"subspace 1, members: 0", [](auto& m) { m.subspaces[1].members = 0; }},
        {"subspace 2, view: 6", [](auto& m) { m.subspaces[2].view = 6; }},
        {"subspace 0, light: 5", [](auto& m) { m.subspaces[0].light = 5; }},
        {"subspace 0, levels: 0, expected 1 to 8",
         [](auto& m) { m.subspaces[0].levels.clear(); }},
        {"subspace 0, levels: 9", [](auto& m) { m.subspaces[0].levels.resize(9); }},
        {"subspace 1, tone: 9",
         [](auto& m) { m.subspaces[1].spectral.tone = static_cast<Tone>(9); }},
        {"subspace 1, mean: 2 entries, expected 3",
         [](auto& m) { m.subspaces[1].spectral.mean.pop_back(); }},
        {"subspace 1, mean: nan",
         [](auto& m) { m.subspaces[1].spectral.mean[1] = kNan; }},
        {"subspace 1, T: 10 entries, expected 9",
         [](auto& m) { m.subspaces[1].spectral.T.push_back(0); }},
        {"subspace 1, T: inf", [](auto& m) { m.subspaces[1].spectral.T[4] = kInfinity; }},
        {"subspace 1, T: rows 1 and 1",
         [](auto& m) { m.subspaces[1].spectral.T = {1, 0, 0, 0, 1.1F, 0, 0, 0, 1}; }},
        {"subspace 1, T: rows 0 and 2",
         [](auto& m) { m.subspaces[1].spectral.T = {1, 0, 0, 0, 1, 0, 1, 0, 0}; }},
        {"subspace 2, marginals: 2 entries, expected 3",
         [](auto& m) { m.subspaces[2].marginals.pop_back(); }},
        {"subspace 2, plane 1, marginal scale: -1",
         [](auto& m) { m.subspaces[2].marginals[1].scale = -1; }},
        {"subspace 2, plane 1, marginal knots: 15 entries, expected 16",
         [](auto& m) { m.subspaces[2].marginals[1].knots.pop_back(); }},
        {"subspace 2, plane 0, marginal knots: nan",
         [](auto& m) { m.subspaces[2].marginals[0].knots[8] = kNan; }},
        {"subspace 2, plane 0, marginal knots: -7 after",
         [](auto& m) { m.subspaces[2].marginals[0].knots[8] = -7; }},
    });
}

TEST(Validate, NamesFaultsOfFields) {
    expect_each_fault_is_named({
        {"subspace 3, level 1, fields: 2 entries, expected 3",
         [](auto& m) { m.subspaces[3].levels[1].fields.pop_back(); }},
        {"subspace 3, level 1, plane 0, 13 coefficients for 14 offsets",
         [](auto& m) { field(m).a.pop_back(); }},
        {"plane 0, coefficient: nan", [](auto& m) { field(m).a[2] = kNan; }},
        {"plane 0, coefficient: 2e+06", [](auto& m) { field(m).a[2] = 2e6F; }},
        {"plane 0, variance: -1", [](auto& m) { field(m).variance = -1; }},
        {"plane 0, variance: nan", [](auto& m) { field(m).variance = kNan; }},
        {"plane 0, variance: inf", [](auto& m) { field(m).variance = kInfinity; }},
        {"offset (-1, 2): expected one of the causal half plane",
         [](auto& m) {
             field(m).neighbourhood[0] = {-1, 2};
         }},
        {"offset (0, 0): expected one of the causal half plane",
         [](auto& m) {
             field(m).neighbourhood[0] = {0, 0};
         }},
        {"offset (9, 0): expected a reach of at most 8",
         [](auto& m) {
             field(m).neighbourhood[0] = {9, 0};
         }},
        {"offset (1, -128): expected a reach",
         [](auto& m) {
             field(m).neighbourhood[0] = {1, -128};
         }},
        {"offset (0, 1): repeated",
         [](auto& m) {
             field(m).neighbourhood[1] = {0, 1};
         }},
        {"neighbourhood: 65 offsets, expected at most 64",
         [](auto& m) { field(m).neighbourhood.resize(65); }},
    });
}

TEST(Validate, NamesFaultsOfFieldsOfAllPlanes) {
    const Material valid =
        random_material({.seed = 9, .levels = 2, .order = 2, .model = 2});
    ASSERT_TRUE(validate(valid));
    const std::vector<Fault> faults = {
        {"level 1, plane 0, a field of 2 planes, expected 3",
         [](auto& m) { joint(m).planes = 2; }},
        {"35 coefficients for 4 offsets", [](auto& m) { joint(m).A.pop_back(); }},
        {"Sigma: 8 entries, expected 9", [](auto& m) { joint(m).Sigma.pop_back(); }},
        {"variance: -1", [](auto& m) { joint(m).Sigma[4] = -1; }},
        {"variance: nan", [](auto& m) { joint(m).Sigma[8] = kNan; }},
        {"covariance: 9", [](auto& m) { joint(m).Sigma[1] = joint(m).Sigma[3] = 9; }},
        {"covariance: nan", [](auto& m) { joint(m).Sigma[3] = kNan; }},
        {"expected symmetry", [](auto& m) { joint(m).Sigma[1] = 0.2F; }},
        {"expected one of the causal half plane",
         [](auto& m) {
             joint(m).neighbourhood[0] = {0, -1};
         }},
        {"fields: 2 entries, expected 3",
         [](auto& m) {
             auto& fields = m.subspaces[0].levels[1].fields;
             fields.push_back(fields[0]);
         }},
    };
    test::expect_each_fault_is_named(valid, faults);
}

TEST(Validate, LetsSimultaneousFieldsLookAnywhereButAtThemselves) {
    Material m = random_material({.levels = 1, .order = 2, .model = 3});
    auto& field = std::get<Sar3d>(m.subspaces[0].levels[0].fields[0]);
    field.neighbourhood[0] = {-1, -2};
    EXPECT_TRUE(validate(m));
    field.neighbourhood[0] = {0, 0};
    EXPECT_THAT(validate(m).error().message, HasSubstr("expected another site"));
}

}  // namespace
}  // namespace sateen
