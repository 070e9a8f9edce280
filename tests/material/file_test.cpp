// SPDX-License-Identifier: Apache-2.0
#include "sateen/material/file.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "support/golden_materials.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

using test::assorted_materials;
using test::random_material;

std::vector<std::uint8_t> written(const Material& m) {
    auto payload = write_material(m);
    EXPECT_TRUE(payload) << payload.error().message;
    return *payload;
}

Material read_back(const std::vector<std::uint8_t>& payload) {
    auto m = read_material(payload);
    EXPECT_TRUE(m) << m.error().message;
    return *m;
}

template <class Field>
auto& coefficients(Field& field) {
    return *std::visit(
        [](auto& model) {
            if constexpr (is_joint<std::decay_t<decltype(model)>>)
                return &model.A;
            else
                return &model.a;
        },
        field);
}

// Everything but what is quantised must be equal, and that nearly.
void expect_close(const Material& read, Material m) {
    for (std::size_t i = 0; i < m.subspaces.size(); ++i) {
        const Subspace& found = read.subspaces[i];
        Subspace& expected = m.subspaces[i];
        for (std::size_t plane = 0; plane < m.bands; ++plane) {
            auto& knots = expected.marginals[plane].knots;
            for (std::size_t k = 0; k < knots.size(); ++k)
                EXPECT_NEAR(found.marginals[plane].knots[k], knots[k], 6.2e-5);
            knots = found.marginals[plane].knots;
            for (std::size_t level = 0; level < expected.levels.size(); ++level) {
                if (plane >= expected.levels[level].fields.size()) continue;
                const auto& read_a = coefficients(found.levels[level].fields[plane]);
                auto& a = coefficients(expected.levels[level].fields[plane]);
                const float largest = std::abs(*std::ranges::max_element(
                    a, {}, [](float value) { return std::abs(value); }));
                for (std::size_t k = 0; k < a.size(); ++k)
                    EXPECT_NEAR(read_a[k], a[k], largest / 32768);
                a = read_a;
            }
        }
    }
    if (m.reflectance) {
        // At most half a step of the largest value of each component or channel.
        const auto expect_near = [](const auto& found, auto& expected, float tolerance) {
            ASSERT_EQ(found.size(), expected.size());
            for (std::size_t i = 0; i < found.size(); ++i)
                EXPECT_NEAR(found[i], expected[i], tolerance);
            expected = found;
        };
        expect_near(read.reflectance->base, m.reflectance->base, 1.0F / 65536);
        expect_near(read.reflectance->lights, m.reflectance->lights, 1.0F / 128);
        expect_near(read.reflectance->views, m.reflectance->views, 0.125F / 128);
    }
    EXPECT_TRUE(read == m);
}

TEST(MaterialFile, ReadingGivesWhatWasWrittenUpToQuantisation) {
    for (const Material& m : assorted_materials()) expect_close(read_back(written(m)), m);
}

TEST(MaterialFile, ReadingAndWritingAgainGivesTheSameBytes) {
    auto materials = assorted_materials();
    for (std::uint64_t seed = 10; seed < 60; ++seed)
        materials.push_back(random_material({.seed = seed, .subspaces = 2, .levels = 2}));
    for (const Material& m : materials) {
        const auto once = written(m);
        const Material read = read_back(once);
        const auto twice = written(read);
        EXPECT_TRUE(twice == once);
        EXPECT_TRUE(read_back(twice) == read);
    }
}

TEST(MaterialFile, EqualMaterialsGiveEqualBytes) {
    Material positive = random_material({.views = 2, .lights = 2});
    positive.views[0] = {0, 0};
    positive.subspaces[0].spectral.mean[0] = 0;
    std::get<Car2d>(positive.subspaces[0].levels[0].fields[0]).a[0] = 0;
    std::get<Car2d>(positive.subspaces[0].levels[0].fields[0]).variance = 0;
    Material negative = positive;
    negative.views[0] = {-0.0F, -0.0F};
    negative.subspaces[0].spectral.mean[0] = -0.0F;
    std::get<Car2d>(negative.subspaces[0].levels[0].fields[0]).a[0] = -0.0F;
    std::get<Car2d>(negative.subspaces[0].levels[0].fields[0]).variance = -0.0F;
    ASSERT_TRUE(positive == negative);
    EXPECT_TRUE(written(positive) == written(negative));
}

// FNV-1a, to state the bytes of a payload in one number.
std::uint64_t checksum(const std::vector<std::uint8_t>& bytes) {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3;
    return hash;
}

TEST(MaterialFile, PayloadsAreTheSameInEveryRunAndOnEveryPlatform) {
    EXPECT_EQ(checksum(written(test::golden_photograph())), 14614278742556359716U);
    EXPECT_EQ(checksum(written(test::golden_grid())), 8611525742676356084U);
    EXPECT_EQ(checksum(written(test::golden_incomplete())), 2289078049558508316U);
}

TEST(MaterialFile, WholeDegreesComeBackExactly) {
    Material m = random_material({.views = 91, .lights = 91});
    for (std::size_t i = 0; i < 91; ++i) {
        m.views[i] =
            direction_from_degrees(static_cast<float>(i), static_cast<float>(4 * i));
        m.lights[i] = direction_from_degrees(static_cast<float>(90 - i),
                                             -static_cast<float>(4 * i));
    }
    const Material read = read_back(written(m));
    EXPECT_TRUE(read.views == m.views);
    EXPECT_TRUE(read.lights == m.lights);
}

TEST(MaterialFile, ANeighbourhoodIsStoredOnceAndAHierarchicalOneAsItsOrder) {
    const auto bytes_of = [](const Material& m) {
        const auto parts = *material_part_bytes(m);
        for (const PartBytes& part : parts)
            if (part.part == "neighbourhoods") return part.bytes;
        return std::size_t{0};
    };
    Material m = random_material({.subspaces = 5, .levels = 4});
    EXPECT_EQ(bytes_of(m), 1U);
    for (Subspace& subspace : m.subspaces)
        for (Level& level : subspace.levels) {
            auto& field = std::get<Car2d>(level.fields[1]);
            std::swap(field.neighbourhood[0], field.neighbourhood[1]);
        }
    EXPECT_EQ(bytes_of(m), 1U + 1U + 1U + 2U * 14U) << "two kinds, one with a list of 14";
    expect_close(read_back(written(m)), m);
}

TEST(MaterialFile, BytesOfTheLargestMaterialAreReadable) {
    const Material m = random_material({.subspaces = kMaxSubspaces,
                                        .levels = kMaxLevels,
                                        .order = kMaxOrder,
                                        .views = 1024,
                                        .lights = 1024});
    ASSERT_EQ(m.index.size(), kMaxPairs);
    expect_close(read_back(written(m)), m);
}

TEST(MaterialFile, PayloadsMayStartAtAnyAddress) {
    const auto payload = written(random_material());
    const Material m = read_back(payload);
    for (std::size_t shift = 1; shift < 8; ++shift) {
        std::vector<std::uint8_t> moved(shift);
        moved.insert(moved.end(), payload.begin(), payload.end());
        const auto read = read_material(std::span(moved).subspan(shift));
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_TRUE(*read == m);
    }
}

TEST(MaterialFile, PartsAddUpToThePayload) {
    for (const Material& m : assorted_materials()) {
        const auto parts = material_part_bytes(m);
        ASSERT_TRUE(parts);
        std::size_t sum = 0;
        for (const PartBytes& part : *parts) sum += part.bytes;
        EXPECT_EQ(sum, written(m).size());
        EXPECT_LT(parts->back().bytes, 680U) << "tables and lengths";
    }
}

}  // namespace
}  // namespace sateen
