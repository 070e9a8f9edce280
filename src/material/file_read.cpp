// SPDX-License-Identifier: Apache-2.0
// Payload to material; docs/format.md is normative. Partner: file_write.cpp.
//
// A payload is read in three steps, because it may come from anywhere. FlatBuffers
// verifies that every vector lies inside the bytes. Here every count is compared with its
// limit and with the counts it must match, before memory is taken for it. validate() then
// checks the meaning: numbers, directions, indices.
#include <cstring>
#include <numeric>
#include <span>

#include "material/message.hpp"
#include "material/modulation_file.hpp"
#include "material/quantise.hpp"
#include "material/reflectance_file.hpp"
#include "material/schema.hpp"
#include "material/structure_file.hpp"
#include "material/surface_file.hpp"
#include "material/vectors.hpp"

namespace sateen {
namespace {

// The root and its nine tables, with room for tables that later writers append.
constexpr flatbuffers::Verifier::Options kVerifierLimits{.max_depth = 3,
                                                         .max_tables = 32};

std::string unpack_string(const flatbuffers::String* string) {
    return string == nullptr ? std::string() : string->str();
}

Result<Provenance> unpack_provenance(const schema::Provenance& in) {
    for (const auto* string : {in.name(), in.source(), in.options(), in.writer()})
        SATEEN_CHECK(expect_at_most("provenance", count(string), kMaxTextBytes));
    return Provenance{unpack_string(in.name()), unpack_string(in.source()),
                      unpack_string(in.options()), unpack_string(in.writer()),
                      in.source_checksum()};
}

Result<std::vector<Direction>> unpack_directions(const schema::Directions& in) {
    const std::size_t n = count(in.theta());
    SATEEN_CHECK(expect_at_most("directions.theta", n, kMaxDirections));
    SATEEN_CHECK(expect_count("directions.phi", count(in.phi()), n));
    std::vector<Direction> out(n);
    for (std::size_t i = 0; i < n; ++i)
        out[i] = direction_from_degrees(at(in.theta(), i), at(in.phi(), i));
    return out;
}

Result<std::vector<IndexEntry>> unpack_index(const schema::Index& in, std::size_t lights,
                                             std::size_t views) {
    const std::size_t n = count(in.subspaces());
    SATEEN_CHECK(expect_at_most("index.subspaces", n, kMaxPairs));
    const bool complete = count(in.lights()) == 0 && count(in.views()) == 0;
    if (complete) {
        SATEEN_CHECK(expect_count("index.subspaces", n, lights * views));
    } else {
        SATEEN_CHECK(expect_count("index.lights", count(in.lights()), n));
        SATEEN_CHECK(expect_count("index.views", count(in.views()), n));
    }
    std::vector<IndexEntry> out(n);
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t light = complete ? i / views : at(in.lights(), i);
        const std::size_t view = complete ? i % views : at(in.views(), i);
        out[i] = {static_cast<std::uint16_t>(light), static_cast<std::uint16_t>(view),
                  at(in.subspaces(), i)};
    }
    return out;
}

Result<std::vector<std::vector<Offset>>> unpack_neighbourhoods(
    const schema::Neighbourhoods& in) {
    SATEEN_CHECK(expect_at_most("neighbourhoods.orders", count(in.orders()), kMaxFields));
    std::vector<std::vector<Offset>> out(count(in.orders()));
    std::size_t lists = 0;
    std::size_t used = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::uint8_t order = at(in.orders(), i);
        if (order > kMaxOrder)
            return bad_format("neighbourhoods.orders: ", text(std::size_t{order}),
                              ", expected at most ", text(std::size_t{kMaxOrder}));
        if (order != kExplicitOffsets) {
            out[i] = hierarchical_half_plane(order);
            continue;
        }
        if (lists == count(in.counts()))
            return bad_format("neighbourhoods.counts: ", text(lists),
                              " entries, expected one for every explicit list");
        const std::size_t n = at(in.counts(), lists++);
        SATEEN_CHECK(expect_at_most("neighbourhoods.counts", n, kMaxNeighbours));
        if (used + n > count(in.rows()) || used + n > count(in.cols()))
            return bad_format("neighbourhoods.rows and cols: ", text(count(in.rows())),
                              " and ", text(count(in.cols())),
                              " entries, expected at least ", text(used + n));
        for (const std::size_t end = used + n; used < end; ++used)
            out[i].push_back({at(in.rows(), used), at(in.cols(), used)});
    }
    SATEEN_CHECK(expect_count("neighbourhoods.counts", count(in.counts()), lists));
    SATEEN_CHECK(expect_count("neighbourhoods.rows", count(in.rows()), used));
    SATEEN_CHECK(expect_count("neighbourhoods.cols", count(in.cols()), used));
    return out;
}

// The tables over all subspaces, read in the order in which they were written.
class SubspaceReader {
  public:
    SubspaceReader(const schema::Material& in, std::vector<std::vector<Offset>> offsets)
        : bands_(in.bands()),
          subspaces_(*in.subspaces()),
          marginals_(*in.marginals()),
          fields_(*in.fields()),
          neighbourhoods_(std::move(offsets)) {}

    Result<std::vector<Subspace>> read() {
        SATEEN_CHECK(check_counts());
        std::vector<Subspace> out(count(subspaces_.members()));
        for (std::size_t i = 0; i < out.size(); ++i)
            SATEEN_CHECK(in_element("subspace", i, read(i, out[i])));
        SATEEN_CHECK(
            expect_count("marginals.knots", count(marginals_.knots()), knots_read_));
        SATEEN_CHECK(
            expect_count("fields.models", count(fields_.models()), fields_read_));
        SATEEN_CHECK(expect_count("fields.coefficients", count(fields_.coefficients()),
                                  coefficients_read_));
        SATEEN_CHECK(expect_count("fields.variances", count(fields_.variances()),
                                  variances_read_));
        return out;
    }

  private:
    Result<void> check_counts() const {
        const std::size_t n = count(subspaces_.members());
        const std::size_t planes = n * bands_;
        SATEEN_CHECK(expect_at_most("bands", bands_, kMaxBands));
        SATEEN_CHECK(expect_at_most("subspaces.members", n, kMaxSubspaces));
        SATEEN_CHECK(expect_count("subspaces.views", count(subspaces_.views()), n));
        SATEEN_CHECK(expect_count("subspaces.lights", count(subspaces_.lights()), n));
        SATEEN_CHECK(expect_count("subspaces.levels", count(subspaces_.levels()), n));
        SATEEN_CHECK(expect_count("subspaces.tones", count(subspaces_.tones()), n));
        SATEEN_CHECK(expect_count("subspaces.mean", count(subspaces_.mean()), planes));
        SATEEN_CHECK(expect_count("subspaces.transform", count(subspaces_.transform()),
                                  planes * bands_));
        SATEEN_CHECK(
            expect_count("marginals.scales", count(marginals_.scales()), planes));
        SATEEN_CHECK(
            expect_count("marginals.counts", count(marginals_.counts()), planes));
        SATEEN_CHECK(
            expect_count("marginals.exponents", count(marginals_.exponents()), planes));
        for (std::size_t i = 0; i < n; ++i)
            SATEEN_CHECK(expect_at_most("subspaces.levels", at(subspaces_.levels(), i),
                                        kMaxLevels));
        const std::size_t fields = count(fields_.models());
        SATEEN_CHECK(expect_at_most("fields.models", fields, kMaxFields));
        SATEEN_CHECK(expect_count("fields.neighbourhoods",
                                  count(fields_.neighbourhoods()), fields));
        return expect_count("fields.exponents", count(fields_.exponents()), fields);
    }

    Result<void> read(std::size_t i, Subspace& out) {
        out.members = at(subspaces_.members(), i);
        out.view = at(subspaces_.views(), i);
        out.light = at(subspaces_.lights(), i);
        out.spectral.tone = static_cast<Tone>(at(subspaces_.tones(), i));
        out.spectral.mean = floats(subspaces_.mean(), i * bands_, bands_);
        out.spectral.T =
            floats(subspaces_.transform(), i * bands_ * bands_, bands_ * bands_);
        out.marginals.resize(bands_);
        for (std::size_t plane = 0; plane < bands_; ++plane)
            SATEEN_CHECK(in_element("plane", plane,
                                    read(i * bands_ + plane, out.marginals[plane])));
        out.levels.resize(at(subspaces_.levels(), i));
        for (std::size_t level = 0; level < out.levels.size(); ++level)
            SATEEN_CHECK(in_element("level", level, read(out.levels[level])));
        return {};
    }

    Result<void> read(std::size_t i, Marginal& out) {
        const std::size_t n = at(marginals_.counts(), i);
        const std::size_t left = count(marginals_.knots()) - knots_read_;
        if (n > Marginal::kKnots || n > left)
            return bad_format(text(n), " knots of ", text(left), " left, expected 0 or ",
                              text(Marginal::kKnots));
        out.scale = at(marginals_.scales(), i);
        out.knots =
            block(marginals_.knots(), knots_read_, n, at(marginals_.exponents(), i));
        knots_read_ += n;
        return {};
    }

    // Fields follow one another until they have all planes.
    Result<void> read(Level& out) {
        std::size_t planes = 0;
        while (planes < bands_) {
            FieldModel field;
            SATEEN_CHECK(in_element("plane", planes, read_field(field)));
            planes += planes_of(field);
            out.fields.push_back(std::move(field));
        }
        return {};
    }

    Result<void> read_field(FieldModel& out) {
        if (fields_read_ == count(fields_.models()))
            return bad_format("fields.models: ", text(fields_read_),
                              " entries, expected more");
        const std::size_t i = fields_read_++;
        const std::size_t number = at(fields_.neighbourhoods(), i);
        if (number >= neighbourhoods_.size())
            return bad_format("neighbourhood ", text(number), " of ",
                              text(neighbourhoods_.size()));
        const std::vector<Offset>& offsets = neighbourhoods_[number];
        const int exponent = at(fields_.exponents(), i);
        switch (const std::size_t model = at(fields_.models(), i)) {
            case 0:
                return read_plane<Car2d>(offsets, exponent, out);
            case 1:
                return read_plane<Gmrf2d>(offsets, exponent, out);
            case 2:
                return read_planes<Car3d>(offsets, exponent, out);
            case 3:
                return read_planes<Sar3d>(offsets, exponent, out);
            default:
                return Error{Errc::unsupported, "field model " + text(model) +
                                                    ", known are " + kKnownModels};
        }
    }

    template <class Model>
    Result<void> read_plane(const std::vector<Offset>& offsets, int exponent,
                            FieldModel& out) {
        Model field{offsets, {}, 0};
        SATEEN_TRY(field.a, take_coefficients(offsets.size(), exponent));
        SATEEN_TRY(const std::vector<float> variances, take_variances(1));
        field.variance = variances[0];
        out = std::move(field);
        return {};
    }

    template <class Model>
    Result<void> read_planes(const std::vector<Offset>& offsets, int exponent,
                             FieldModel& out) {
        const std::size_t d = bands_;
        Model field{{d, offsets, {}, std::vector<float>(d * d)}};
        SATEEN_TRY(field.A, take_coefficients(offsets.size() * d * d, exponent));
        SATEEN_TRY(const std::vector<float> lower, take_variances(d * (d + 1) / 2));
        for (std::size_t i = 0, k = 0; i < d; ++i)
            for (std::size_t j = 0; j <= i; ++j, ++k)
                field.Sigma[i * d + j] = field.Sigma[j * d + i] = lower[k];
        out = std::move(field);
        return {};
    }

    Result<std::vector<float>> take_coefficients(std::size_t n, int exponent) {
        if (n > count(fields_.coefficients()) - coefficients_read_)
            return bad_format("fields.coefficients end too early");
        coefficients_read_ += n;
        return block(fields_.coefficients(), coefficients_read_ - n, n, exponent);
    }

    Result<std::vector<float>> take_variances(std::size_t n) {
        if (n > count(fields_.variances()) - variances_read_)
            return bad_format("fields.variances end too early");
        variances_read_ += n;
        return floats(fields_.variances(), variances_read_ - n, n);
    }

    std::size_t bands_;
    const schema::Subspaces& subspaces_;
    const schema::Marginals& marginals_;
    const schema::Fields& fields_;
    std::vector<std::vector<Offset>> neighbourhoods_;
    std::size_t fields_read_ = 0;
    std::size_t coefficients_read_ = 0;
    std::size_t variances_read_ = 0;
    std::size_t knots_read_ = 0;
};

// What can be said before looking inside.
Result<void> check_envelope(std::span<const std::uint8_t> payload) {
    if (payload.size() > kMaxPayloadBytes)
        return Error{Errc::limit_exceeded, "material of " + text(payload.size()) +
                                               " bytes, expected at most " +
                                               text(kMaxPayloadBytes)};
    if (payload.size() < kEnvelopeBytes)
        return bad_format("material of ", text(payload.size()), " bytes: too short");
    const char* identifier = schema::MaterialIdentifier();
    if (!flatbuffers::BufferHasIdentifier(payload.data(), identifier, true))
        return bad_format("not a material: no identifier ", identifier);
    const std::size_t stated =
        flatbuffers::ReadScalar<flatbuffers::uoffset_t>(payload.data());
    if (stated != payload.size() - kLengthBytes)
        return bad_format("material of ", text(payload.size() - kLengthBytes),
                          " bytes, expected ", text(stated), " as stated");
    return {};
}

Result<void> check_version(std::span<const std::uint8_t> payload) {
    flatbuffers::Verifier verifier(payload.data(), payload.size(), kVerifierLimits);
    if (!verifier.VerifySizePrefixedBuffer<schema::Header>(nullptr))
        return bad_format("damaged material: no version");
    const std::size_t version =
        flatbuffers::GetSizePrefixedRoot<schema::Header>(payload.data())->version();
    if (version == 0) return bad_format("material of version 0");
    if (version > kFormatVersion)
        return Error{Errc::unsupported, "material of version " + text(version) +
                                            ", known are versions up to " +
                                            text(std::size_t{kFormatVersion})};
    return {};
}

Result<Material> unpack(const schema::Material& in) {
    Material out;
    SATEEN_TRY(out.provenance, unpack_provenance(*in.provenance()));
    out.cosine_included = in.cosine_included();
    out.pixels_per_mm = in.pixels_per_mm();
    out.sample_rows = in.sample_rows();
    out.sample_cols = in.sample_cols();
    out.bands = in.bands();
    out.drawing = static_cast<Drawing>(in.drawing());
    SATEEN_TRY(out.views, unpack_directions(*in.views()));
    SATEEN_TRY(out.lights, unpack_directions(*in.lights()));
    SATEEN_TRY(out.index, unpack_index(*in.index(), out.lights.size(), out.views.size()));
    SATEEN_TRY(auto offsets, unpack_neighbourhoods(*in.neighbourhoods()));
    SATEEN_TRY(out.subspaces, SubspaceReader(in, std::move(offsets)).read());
    if (in.structure() != nullptr) SATEEN_CHECK(unpack_structure(*in.structure(), out));
    if (in.surface() != nullptr) {
        SATEEN_TRY(out.surface, unpack_surface(*in.surface()));
    }
    if (in.reflectance() != nullptr)
        SATEEN_CHECK(unpack_reflectance(*in.reflectance(), out));
    if (in.modulation() != nullptr)
        SATEEN_CHECK(unpack_modulation(*in.modulation(), out));
    return out;
}

}  // namespace

Result<Material> read_material(std::span<const std::uint8_t> payload) {
    SATEEN_CHECK(check_envelope(payload));
    // FlatBuffers reads numbers in place, aligned within the payload.
    constexpr std::size_t kAlignment = alignof(std::uint64_t);
    std::vector<std::uint8_t> aligned;
    if (reinterpret_cast<std::uintptr_t>(payload.data()) % kAlignment != 0) {
        aligned.assign(payload.begin(), payload.end());
        payload = aligned;
    }
    SATEEN_CHECK(check_version(payload));
    flatbuffers::Verifier verifier(payload.data(), payload.size(), kVerifierLimits);
    if (!schema::VerifySizePrefixedMaterialBuffer(verifier))
        return bad_format("damaged material: a table or a vector lies outside the bytes");
    SATEEN_TRY(
        Material material,
        unpack(*flatbuffers::GetSizePrefixedRoot<schema::Material>(payload.data())));
    SATEEN_CHECK(validate(material));
    return material;
}

}  // namespace sateen
