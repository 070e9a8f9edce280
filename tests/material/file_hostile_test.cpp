// SPDX-License-Identifier: Apache-2.0
// Payloads that no writer makes: each must give an error or a valid material.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "material/schema.hpp"
#include "support/faults.hpp"
#include "support/random_material.hpp"

namespace sateen {
namespace {

using test::packed;
using test::random_material;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Material valid_material() {
    return random_material({.seed = 3,
                            .subspaces = 2,
                            .levels = 2,
                            .order = 2,
                            .explicit_offsets = true,
                            .views = 3,
                            .lights = 2,
                            .complete = true,
                            .tiles = 2});
}

// Writes, changes the tables and reads.
Result<Material> read_altered(const std::function<void(schema::MaterialT&)>& alter) {
    const Bytes payload = *write_material(valid_material());
    const auto tables = schema::UnPackSizePrefixedMaterial(payload.data());
    alter(*tables);
    return read_material(packed(*tables));
}

// The payload gives an error, or a valid material that can be written again.
bool is_handled(const Bytes& payload) {
    const auto m = read_material(payload);
    if (!m) return !m.error().message.empty();
    const auto again = write_material(*m);
    return validate(*m) && again && read_material(*again);
}

TEST(HostilePayload, EveryPrefixIsRejected) {
    const Bytes payload = *write_material(valid_material());
    for (std::size_t size = 0; size < payload.size(); ++size) {
        // A fresh buffer of just that size: reading past it is seen by the sanitizer.
        const Bytes prefix(payload.begin(),
                           payload.begin() + static_cast<std::ptrdiff_t>(size));
        ASSERT_FALSE(read_material(prefix)) << size;
    }
}

TEST(HostilePayload, EveryPrefixThatStatesItsOwnLengthIsHandled) {
    const Bytes payload = *write_material(valid_material());
    for (std::size_t size = kEnvelopeBytes; size < payload.size(); ++size) {
        Bytes prefix(payload.begin(),
                     payload.begin() + static_cast<std::ptrdiff_t>(size));
        flatbuffers::WriteScalar(
            prefix.data(), static_cast<flatbuffers::uoffset_t>(size - kLengthBytes));
        ASSERT_TRUE(is_handled(prefix)) << size;
    }
}

TEST(HostilePayload, ExtraBytesAreRejected) {
    Bytes payload = *write_material(valid_material());
    payload.push_back(0);
    const auto m = read_material(payload);
    ASSERT_FALSE(m);
    EXPECT_EQ(m.error().code, Errc::bad_format);
    EXPECT_THAT(m.error().message, HasSubstr("as stated"));
}

TEST(HostilePayload, EveryAlteredByteIsHandled) {
    for (const Material& m :
         {valid_material(), random_material({.levels = 2}),
          random_material({.levels = 1, .order = 1, .structure = true})}) {
        Bytes payload = *write_material(m);
        for (std::size_t i = 0; i < payload.size(); ++i)
            for (const int mask :
                 {0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80, 0xFF}) {
                payload[i] = static_cast<std::uint8_t>(payload[i] ^ mask);
                ASSERT_TRUE(is_handled(payload)) << "byte " << i << " mask " << mask;
                payload[i] = static_cast<std::uint8_t>(payload[i] ^ mask);
            }
    }
}

TEST(HostilePayload, RandomBytesAreRejected) {
    std::mt19937 engine(5);
    for (int trial = 0; trial < 2000; ++trial) {
        Bytes payload(engine() % 400);
        for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(engine());
        ASSERT_FALSE(read_material(payload));
    }
}

TEST(HostilePayload, ALaterVersionIsUnsupportedAndNamed) {
    const auto m = read_altered([](auto& t) { t.version = 7; });
    ASSERT_FALSE(m);
    EXPECT_EQ(m.error().code, Errc::unsupported);
    EXPECT_EQ(m.error().message, "material of version 7, known are versions up to 1");
}

TEST(HostilePayload, ALaterVersionIsNamedEvenIfItsTablesAreOthers) {
    flatbuffers::FlatBufferBuilder builder;
    builder.FinishSizePrefixed(schema::CreateHeader(builder, 9), "STN1");
    const Bytes payload(builder.GetBufferPointer(),
                        builder.GetBufferPointer() + builder.GetSize());
    const auto m = read_material(payload);
    ASSERT_FALSE(m);
    EXPECT_EQ(m.error().code, Errc::unsupported);
}

TEST(HostilePayload, VersionZeroAndOtherIdentifiersAreRejected) {
    EXPECT_FALSE(read_altered([](auto& t) { t.version = 0; }));
    Bytes payload = *write_material(valid_material());
    payload[8] = 'X';
    const auto m = read_material(payload);
    ASSERT_FALSE(m);
    EXPECT_THAT(m.error().message, HasSubstr("not a material"));
}

TEST(HostilePayload, LargerThanTheLimitIsRefusedUnread) {
    const Bytes payload(kMaxPayloadBytes + 1);
    const auto m = read_material(payload);
    ASSERT_FALSE(m);
    EXPECT_EQ(m.error().code, Errc::limit_exceeded);
}

using Alteration = test::Alteration<schema::MaterialT>;

void expect_each_is_rejected(const std::vector<Alteration>& alterations) {
    ASSERT_TRUE(read_altered([](auto&) {}));
    for (const Alteration& alteration : alterations) {
        const auto m = read_altered(alteration.alter);
        ASSERT_FALSE(m) << alteration.message;
        EXPECT_THAT(m.error().message, HasSubstr(alteration.message));
    }
}

TEST(HostilePayload, CountsThatDoNotFitTogetherAreRejected) {
    expect_each_is_rejected({
        {"directions.phi: 2 entries, expected 3",
         [](auto& t) { t.views->phi.pop_back(); }},
        {"index.subspaces: 5 entries, expected 6",
         [](auto& t) { t.index->subspaces.pop_back(); }},
        {"index.lights: 1 entries, expected 6", [](auto& t) { t.index->lights = {0}; }},
        {"index.views: 1 entries, expected 6",
         [](auto& t) { t.index->lights.resize(6), t.index->views = {0}; }},
        {"subspaces.members: 21 entries, expected at most 20",
         [](auto& t) { t.subspaces->members.resize(21); }},
        {"subspaces.views: 0", [](auto& t) { t.subspaces->views.clear(); }},
        {"subspaces.lights: 3", [](auto& t) { t.subspaces->lights.push_back(0); }},
        {"subspaces.levels: 1", [](auto& t) { t.subspaces->levels.pop_back(); }},
        {"subspaces.levels: 255 entries", [](auto& t) { t.subspaces->levels[0] = 255; }},
        {"subspaces.tones: 1", [](auto& t) { t.subspaces->tones.pop_back(); }},
        {"subspaces.mean: 5", [](auto& t) { t.subspaces->mean.pop_back(); }},
        {"subspaces.transform: 17", [](auto& t) { t.subspaces->transform.pop_back(); }},
        {"bands: 255 entries", [](auto& t) { t.bands = 255; }},
        {"subspaces.mean: 6 entries, expected 2", [](auto& t) { t.bands = 1; }},
        {"subspaces.mean: 6 entries, expected 0", [](auto& t) { t.bands = 0; }},
        {"marginals.scales: 5", [](auto& t) { t.marginals->scales.pop_back(); }},
        {"marginals.counts: 5", [](auto& t) { t.marginals->counts.pop_back(); }},
        {"marginals.exponents: 5", [](auto& t) { t.marginals->exponents.pop_back(); }},
        {"17 knots", [](auto& t) { t.marginals->counts[0] = 17; }},
        {"marginal knots: 1 entries, expected 16",
         [](auto& t) { t.marginals->counts[0] = 1, t.marginals->knots.resize(81); }},
        {"16 knots of 15 left", [](auto& t) { t.marginals->knots.pop_back(); }},
        {"marginals.knots: 97", [](auto& t) { t.marginals->knots.push_back(0); }},
        {"fields.neighbourhoods: 12 entries, expected 11",
         [](auto& t) { t.fields->models.pop_back(); }},
        {"fields.neighbourhoods: 13",
         [](auto& t) { t.fields->neighbourhoods.push_back(0); }},
        {"fields.exponents: 11", [](auto& t) { t.fields->exponents.pop_back(); }},
        {"end too early", [](auto& t) { t.fields->coefficients.pop_back(); }},
        {"end too early", [](auto& t) { t.fields->coefficients.clear(); }},
        {"end too early", [](auto& t) { t.fields->variances.pop_back(); }},
        {"fields.coefficients: ", [](auto& t) { t.fields->coefficients.push_back(0); }},
        {"fields.variances: 13", [](auto& t) { t.fields->variances.push_back(0); }},
    });
}

TEST(HostilePayload, SurfacesThatDoNotFitTogetherAreRejected) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    expect_each_is_rejected({
        {"surface.low: 285", [](auto& t) { t.surface->low.pop_back(); }},
        {"surface.high: 287", [](auto& t) { t.surface->high.push_back(0); }},
        {"surface.tiles: 9 entries", [](auto& t) { t.surface->tiles = 9; }},
        {"surface.tiles: 0, expected",
         [](auto& t) {
             t.surface->tiles = 0;
             t.surface->low.clear(), t.surface->high.clear();
         }},
        {"surface.low: 286 entries, expected 0", [](auto& t) { t.surface->rows = 0; }},
        {"surface.low: 286 entries, expected 1441770",
         [](auto& t) { t.surface->rows = 0xFFFF, t.surface->cols = 11; }},
        {"expected at most 2097152",
         [](auto& t) { t.surface->rows = t.surface->cols = 0xFFFF; }},
        {"surface.shear_px: 13", [](auto& t) { t.surface->shear = 13; }},
        {"surface.offset_px: nan", [](auto& t) { t.surface->offset = kNan; }},
        {"surface.scale_px: -1", [](auto& t) { t.surface->scale = -1; }},
    });
}

TEST(HostilePayload, NeighbourhoodsThatDoNotFitTogetherAreRejected) {
    expect_each_is_rejected({
        {"neighbourhoods.orders: 14, expected at most 13",
         [](auto& t) { t.neighbourhoods->orders[1] = 14; }},
        {"neighbourhoods.orders: 481 entries",
         [](auto& t) { t.neighbourhoods->orders.resize(481); }},
        {"neighbourhoods.counts: 3 entries, expected one for every explicit list",
         [](auto& t) { t.neighbourhoods->counts.pop_back(); }},
        {"neighbourhoods.counts: 5",
         [](auto& t) { t.neighbourhoods->counts.push_back(0); }},
        {"neighbourhoods.counts: 65 entries",
         [](auto& t) { t.neighbourhoods->counts[0] = 65; }},
        {"neighbourhoods.rows and cols",
         [](auto& t) { t.neighbourhoods->rows.pop_back(); }},
        {"neighbourhoods.rows and cols", [](auto& t) { t.neighbourhoods->cols.clear(); }},
        {"neighbourhoods.rows: ", [](auto& t) { t.neighbourhoods->rows.push_back(1); }},
        {"neighbourhoods.cols: ", [](auto& t) { t.neighbourhoods->cols.push_back(1); }},
        {"neighbourhood 99 of 5", [](auto& t) { t.fields->neighbourhoods[5] = 99; }},
        {"expected one of the causal half plane",
         [](auto& t) { t.neighbourhoods->rows[0] = -1; }},
        {"expected a reach", [](auto& t) { t.neighbourhoods->cols[0] = 100; }},
    });
}

TEST(HostilePayload, NumbersWithoutMeaningAreRejected) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    expect_each_is_rejected({
        {"view 1, theta", [](auto& t) { t.views->theta[1] = 91; }},
        {"light 1, phi", [](auto& t) { t.lights->phi[1] = kNan; }},
        {"light 1, phi", [](auto& t) { t.lights->phi[1] = 1e30F; }},
        {"index entry 3, subspace: 2", [](auto& t) { t.index->subspaces[3] = 2; }},
        {"index entry 1: light 0, view 0",
         [](auto& t) { t.index->lights.resize(6), t.index->views.resize(6); }},
        {"members: 0", [](auto& t) { t.subspaces->members[0] = 0; }},
        {"subspace 1, view: 9", [](auto& t) { t.subspaces->views[1] = 9; }},
        {"levels: 0",
         [](auto& t) {
             t.subspaces->levels = {0, 0};
             *t.fields = {};
         }},
        {"tone: 2", [](auto& t) { t.subspaces->tones[0] = 2; }},
        {"T: rows", [](auto& t) { t.subspaces->transform[0] = 3; }},
        {"marginal scale: -1", [](auto& t) { t.marginals->scales[0] = -1; }},
        {"marginal knots: ", [](auto& t) { t.marginals->knots[3] = -32768; }},
        {"marginal knots: ", [](auto& t) { t.marginals->exponents[0] = 127; }},
        {"coefficient: ", [](auto& t) { t.fields->exponents[0] = 127; }},
        {"variance: nan", [](auto& t) { t.fields->variances[0] = kNan; }},
        {"variance: -1", [](auto& t) { t.fields->variances[0] = -1; }},
        {"drawing: 2", [](auto& t) { t.drawing = 2; }},
        {"sample_rows: 0", [](auto& t) { t.sample_rows = 0; }},
        {"pixels_per_mm: -1", [](auto& t) { t.pixels_per_mm = -1.0F; }},
        {"provenance", [](auto& t) { t.provenance->name.assign(5000, 'a'); }},
        {"provenance.name",
         [](auto& t) { t.provenance->name.push_back(static_cast<char>(0x80)); }},
    });
}

TEST(HostilePayload, AnUnknownFieldModelIsUnsupported) {
    const auto m = read_altered([](auto& t) { t.fields->models[4] = 200; });
    ASSERT_FALSE(m);
    EXPECT_EQ(m.error().code, Errc::unsupported);
    EXPECT_THAT(m.error().message,
                HasSubstr("subspace 0, level 1, plane 1, field model 200"));
}

TEST(HostilePayload, ManyVectorsMayShareBytesWithoutHarm) {
    // One vector of 2^20 zeros stands for every vector of bytes: 1 MB of file claims to
    // be many. Each count is compared with its limit before anything is taken from it.
    flatbuffers::FlatBufferBuilder b;
    const auto zeros = b.CreateVector(std::vector<std::uint8_t>(kMaxPairs));
    const auto floats = flatbuffers::Offset<flatbuffers::Vector<float>>(
        b.CreateVector(std::vector<float>(kMaxPairs)).o);
    const auto provenance = schema::CreateProvenance(b);
    const auto directions = schema::CreateDirections(b, floats, floats);
    const auto index = schema::CreateIndex(b, zeros);
    const auto neighbourhoods = schema::CreateNeighbourhoods(b, zeros, zeros);
    const auto subspaces =
        schema::CreateSubspaces(b, 0, 0, 0, zeros, zeros, floats, floats);
    const auto marginals = schema::CreateMarginals(b, floats, zeros);
    const auto fields = schema::CreateFields(b, zeros);
    b.FinishSizePrefixed(
        schema::CreateMaterial(b, 1, 0, 3, false, 1, 1, flatbuffers::nullopt, provenance,
                               directions, directions, index, neighbourhoods, subspaces,
                               marginals, fields),
        schema::MaterialIdentifier());
    const auto m = read_material({b.GetBufferPointer(), b.GetSize()});
    ASSERT_FALSE(m);
    EXPECT_EQ(m.error().code, Errc::limit_exceeded);
}

}  // namespace
}  // namespace sateen
