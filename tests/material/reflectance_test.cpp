// SPDX-License-Identifier: Apache-2.0
// Mean colour and contrast by direction: evaluation, limits, hostile files.
#include "sateen/material/reflectance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "material/schema.hpp"
#include "support/faults.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

using test::random_material;
using testing::HasSubstr;

Material reflecting() {
    return random_material({.seed = 4,
                            .subspaces = 2,
                            .levels = 1,
                            .order = 1,
                            .knots = false,
                            .views = 6,
                            .lights = 4,
                            .rank = 3});
}

TEST(EncodedAppearance, IsTheSumOverComponents) {
    const Material m = reflecting();
    const Reflectance& r = *m.reflectance;
    for (std::size_t view = 0; view < 6; ++view)
        for (std::size_t light = 0; light < 4; ++light) {
            const EncodedAppearance e = encoded_appearance(r, view, light);
            for (std::size_t c = 0; c < 4; ++c) {
                float expected = r.base[view * 4 + c];
                for (std::size_t k = 0; k < 3; ++k)
                    expected += r.lights[light * 3 + k] * r.views[(view * 4 + c) * 3 + k];
                EXPECT_NEAR(e[c], expected, 1e-6);
            }
        }
}

TEST(EncodedAppearance, IsLinearInTheWeightsOfEither) {
    const Material m = reflecting();
    const Reflectance& r = *m.reflectance;
    const DirectionWeights view{{1, 3, 5}, {0.5F, 0.25F, 0.25F}};
    const DirectionWeights light{{0, 2, 3}, {0.125F, 0.625F, 0.25F}};
    const EncodedAppearance e = encoded_appearance(r, view, light);
    for (std::size_t c = 0; c < 4; ++c) {
        float expected = 0;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                expected += view.weight[i] * light.weight[j] *
                            encoded_appearance(r, view.index[i], light.index[j])[c];
        EXPECT_NEAR(e[c], expected, 1e-6);
    }
}

TEST(ValidateReflectance, NamesEachFault) {
    test::expect_each_fault_is_named(
        reflecting(),
        {
            {"reflectance, rank: 17", [](auto& m) { m.reflectance->rank = 17; }},
            {"reflectance, channels: 2 entries, expected 4",
             [](auto& m) { m.reflectance->channels = 2; }},
            {"reflectance, base: 23 entries, expected 24",
             [](auto& m) { m.reflectance->base.pop_back(); }},
            {"reflectance, lights: 0", [](auto& m) { m.reflectance->lights.clear(); }},
            {"reflectance, views: 72 entries, expected 48",
             [](auto& m) { m.reflectance->rank = 2, m.reflectance->lights.resize(8); }},
            {"reflectance, views: nan",
             [](auto& m) {
                 m.reflectance->views[7] = std::numeric_limits<float>::quiet_NaN();
             }},
            {"reflectance, base: 1001", [](auto& m) { m.reflectance->base[0] = 1001; }},
            {"reflectance: without views",
             [](auto& m) {
                 m.index.clear(), m.views.clear(), m.lights.clear();
                 for (Subspace& subspace : m.subspaces)
                     subspace.view = subspace.light = 0;
             }},
        });
}

TEST(HostileReflectance, CountsThatDoNotFitTogetherAreRejected) {
    test::expect_each_is_rejected<schema::ReflectanceT>(
        reflecting(), &schema::MaterialT::reflectance,
        {
            {"light_exponents: 17", [](auto& t) { t.light_exponents.resize(17); }},
            {"view_exponents: 2", [](auto& t) { t.view_exponents.pop_back(); }},
            {"base_exponents: 5", [](auto& t) { t.base_exponents.push_back(0); }},
            {"reflectance.base: 25", [](auto& t) { t.base.push_back(0); }},
            {"reflectance.lights: 11", [](auto& t) { t.lights.pop_back(); }},
            {"reflectance.views: 0", [](auto& t) { t.views.clear(); }},
            {"reflectance, lights: ", [](auto& t) { t.light_exponents[0] = 127; }},
            {"reflectance, base: ", [](auto& t) { t.base_exponents[3] = 127; }},
        });
}

TEST(HostileReflectance, EveryAlteredByteIsHandled) {
    auto payload = *write_material(reflecting());
    for (std::size_t i = 0; i < payload.size(); ++i)
        for (const int mask : {0x01, 0x10, 0x80, 0xFF}) {
            payload[i] = static_cast<std::uint8_t>(payload[i] ^ mask);
            const auto m = read_material(payload);
            if (m) {
                ASSERT_TRUE(write_material(*m)) << i;
            } else {
                ASSERT_FALSE(m.error().message.empty());
            }
            payload[i] = static_cast<std::uint8_t>(payload[i] ^ mask);
        }
}

}  // namespace
}  // namespace sateen
