// SPDX-License-Identifier: Apache-2.0
// The table `reflectance`; docs/format.md section 10 is normative.
//
// Factors are integers of 8 bits, one component after the other with an exponent for its
// lights and one for its views; the base has 16 bits and an exponent a channel.
#include "material/reflectance_file.hpp"

#include "material/message.hpp"
#include "material/numbers.hpp"
#include "material/quantise.hpp"
#include "material/vectors.hpp"

namespace sateen {
namespace {

// Every `step`-th value from `first` on.
std::vector<float> gather(const std::vector<float>& values, std::size_t first,
                          std::size_t step) {
    std::vector<float> out;
    for (std::size_t i = first; i < values.size(); i += step) out.push_back(values[i]);
    return out;
}

// The integers of one component, to every `step`-th value from `first` on.
void scatter(const flatbuffers::Vector<std::int8_t>* integers, int exponent,
             std::size_t first, std::size_t step, std::vector<float>& values) {
    const std::size_t each = values.size() / step;
    for (std::size_t i = 0; i < each; ++i)
        values[i * step + first] = dequantise(at(integers, first * each + i), exponent);
}

Result<void> check_factors(std::string_view what, const std::vector<float>& values,
                           std::size_t expected) {
    SATEEN_CHECK(expect_count(what, values.size(), expected));
    for (const float value : values)
        SATEEN_CHECK(
            check_range(what, value, -Reflectance::kMaxFactor, Reflectance::kMaxFactor));
    return {};
}

}  // namespace

std::unique_ptr<schema::ReflectanceT> pack_reflectance(const Material& material) {
    const Reflectance& in = *material.reflectance;
    auto out = std::make_unique<schema::ReflectanceT>();
    for (std::size_t c = 0; c < in.channels; ++c)
        append_block(gather(in.base, c, in.channels), out->base, out->base_exponents);
    for (std::size_t k = 0; k < in.rank; ++k) {
        append_byte_block(gather(in.lights, k, in.rank), out->lights,
                          out->light_exponents);
        append_byte_block(gather(in.views, k, in.rank), out->views, out->view_exponents);
    }
    return out;
}

Result<void> unpack_reflectance(const schema::Reflectance& in, Material& material) {
    Reflectance out;
    const std::size_t views = material.views.size();
    const std::size_t lights = material.lights.size();
    const std::size_t channels = material.bands + std::size_t{1};
    const std::size_t rank = count(in.light_exponents());
    SATEEN_CHECK(
        expect_at_most("reflectance.light_exponents", rank, Reflectance::kMaxRank));
    SATEEN_CHECK(
        expect_count("reflectance.view_exponents", count(in.view_exponents()), rank));
    SATEEN_CHECK(
        expect_count("reflectance.base_exponents", count(in.base_exponents()), channels));
    SATEEN_CHECK(expect_count("reflectance.base", count(in.base()), views * channels));
    SATEEN_CHECK(expect_count("reflectance.lights", count(in.lights()), lights * rank));
    SATEEN_CHECK(
        expect_count("reflectance.views", count(in.views()), views * channels * rank));
    out.channels = static_cast<std::uint32_t>(channels);
    out.rank = static_cast<std::uint32_t>(rank);
    out.base.resize(views * channels);
    out.lights.resize(lights * rank);
    out.views.resize(views * channels * rank);
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t v = 0; v < views; ++v)
            out.base[v * channels + c] =
                dequantise(at(in.base(), c * views + v), at(in.base_exponents(), c));
    for (std::size_t k = 0; k < rank; ++k) {
        scatter(in.lights(), at(in.light_exponents(), k), k, rank, out.lights);
        scatter(in.views(), at(in.view_exponents(), k), k, rank, out.views);
    }
    material.reflectance = std::move(out);
    return {};
}

Result<void> validate_reflectance(const Material& m) {
    if (!m.reflectance) return {};
    const Reflectance& r = *m.reflectance;
    if (m.index.empty())
        return bad_format("reflectance: without views and lights, expected none");
    if (r.rank > Reflectance::kMaxRank)
        return bad_format("reflectance, rank: ", text(std::size_t{r.rank}),
                          ", expected at most ", text(Reflectance::kMaxRank));
    SATEEN_CHECK(
        expect_count("reflectance, channels", r.channels, m.bands + std::size_t{1}));
    const std::size_t columns = m.views.size() * r.channels;
    SATEEN_CHECK(check_factors("reflectance, base", r.base, columns));
    SATEEN_CHECK(
        check_factors("reflectance, lights", r.lights, m.lights.size() * r.rank));
    return check_factors("reflectance, views", r.views, columns * r.rank);
}

}  // namespace sateen
