// SPDX-License-Identifier: Apache-2.0
// The band modulation of a material: limits, round trip, hostile files.
#include <gtest/gtest.h>

#include "material/modulation_file.hpp"
#include "support/faults.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

Material modulated() {
    return test::random_material({.seed = 31,
                                  .subspaces = 2,
                                  .levels = 2,
                                  .order = 2,
                                  .views = 2,
                                  .lights = 2,
                                  .modulation = true});
}

TEST(ModulationFile, HoldsWhatWasWritten) {
    const Material m = modulated();
    const auto again = read_material(*write_material(m));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->modulation, m.modulation);
    for (std::size_t k = 0; k < 2; ++k)
        EXPECT_EQ(again->subspaces[k].modulation, m.subspaces[k].modulation);
}

TEST(ModulationFile, TakesLessThanAKilobyteASubspace) {
    const auto parts = material_part_bytes(modulated());
    ASSERT_TRUE(parts);
    for (const PartBytes& part : *parts) {
        if (part.part != "modulation") continue;
        EXPECT_LT(part.bytes, 1000U);
        return;
    }
    FAIL() << "no such part";
}

TEST(HalfOfAFloat, IsWithinHalfAStepAndStaysItself) {
    for (float value = 1e-6F; value < 1e6F; value *= 1.37F) {
        const float half = to_half_of_float(value);
        EXPECT_NEAR(half / value, 1, 1.0 / 256);
        EXPECT_EQ(to_half_of_float(half), half);
    }
}

TEST(ValidateModulation, NamesEachFault) {
    test::expect_each_fault_is_named(
        modulated(),
        {
            {"modulation, level 1, deviation: 5",
             [](Material& m) { m.modulation->fields[1].deviation = 5; }},
            {"modulation, level 0, weights: all 0",
             [](Material& m) { m.modulation->fields[0].weights = {}; }},
            {"subspace 1, modulated bands: 11",
             [](Material& m) { m.subspaces[1].modulation->bands.pop_back(); }},
            {"subspace 0, modulation units: 2",
             [](Material& m) { m.subspaces[0].modulation->units.pop_back(); }},
            {"subspace 0, value scale: -1",
             [](Material& m) { m.subspaces[0].modulation->bands[3].value_scale = -1; }},
            {"subspace 0, energy scale: -1",
             [](Material& m) { m.subspaces[0].modulation->bands[3].energy_scale = -1; }},
            {"subspace 0, band gain: 65",
             [](Material& m) { m.subspaces[0].modulation->bands[3].gain = 65; }},
            {"subspace 0, no modulation",
             [](Material& m) { m.subspaces[0].modulation.reset(); }},
            {"subspace 0: a modulation, expected none",
             [](Material& m) { m.modulation.reset(); }},
        });
}

TEST(HostileModulation, CountsAndNumbersThatDoNotFitAreRejected) {
    test::expect_each_is_rejected<schema::ModulationT>(
        modulated(), &schema::MaterialT::modulation,
        {
            {"modulation.field_deviations: 3",
             [](auto& t) { t.field_deviations.pop_back(); }},
            {"modulation.field_weights: 101",
             [](auto& t) { t.field_weights.push_back(1); }},
            {"modulation.scales: 71", [](auto& t) { t.scales.pop_back(); }},
            {"modulation.curves: 577", [](auto& t) { t.curves.push_back(0); }},
            {"modulation.units: 5", [](auto& t) { t.units.pop_back(); }},
            {"value scale: nan", [](auto& t) { t.scales[0] = 0x7FC0; }},
            {"band gain: inf", [](auto& t) { t.scales[2] = 0x7F80; }},
            {"modulation unit: -", [](auto& t) { t.units[0] = 0xBF80; }},
        });
}

}  // namespace
}  // namespace sateen
