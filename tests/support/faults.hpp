// SPDX-License-Identifier: Apache-2.0
// Materials and payloads with one thing wrong each, and what must be said of it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "material/schema.hpp"
#include "sateen/material/file.hpp"

namespace sateen::test {

struct Fault {
    std::string message;  ///< a part of it
    std::function<void(Material&)> make;
};

inline void expect_each_fault_is_named(const Material& valid,
                                       const std::vector<Fault>& faults) {
    ASSERT_TRUE(validate(valid));
    for (const Fault& fault : faults) {
        Material m = valid;
        fault.make(m);
        const auto result = validate(m);
        ASSERT_FALSE(result) << fault.message;
        EXPECT_EQ(result.error().code, Errc::bad_format);
        EXPECT_THAT(result.error().message, testing::HasSubstr(fault.message));
        EXPECT_FALSE(write_material(m)) << "written all the same: " << fault.message;
    }
}

inline std::vector<std::uint8_t> packed(const schema::MaterialT& material) {
    flatbuffers::FlatBufferBuilder builder;
    builder.FinishSizePrefixed(schema::Material::Pack(builder, &material),
                               schema::MaterialIdentifier());
    return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

/// Of one table of a payload.
template <class Table>
struct Alteration {
    std::string message;  ///< a part of what reading says
    std::function<void(Table&)> alter;
};

template <class Table>
void expect_each_is_rejected(const Material& valid,
                             std::unique_ptr<Table> schema::MaterialT::*table,
                             const std::vector<Alteration<Table>>& alterations) {
    const auto payload = *write_material(valid);
    for (const Alteration<Table>& alteration : alterations) {
        const auto tables = schema::UnPackSizePrefixedMaterial(payload.data());
        alteration.alter(*((*tables).*table));
        const auto m = read_material(packed(*tables));
        ASSERT_FALSE(m) << alteration.message;
        EXPECT_THAT(m.error().message, testing::HasSubstr(alteration.message));
    }
}

}  // namespace sateen::test
