// SPDX-License-Identifier: Apache-2.0
// Names of the field models. See field_model.hpp.
#include "sateen/material/field_model.hpp"

#include <array>

namespace sateen {

const char* name_of(const FieldModel& field) {
    constexpr std::array<const char*, std::variant_size_v<FieldModel>> kNames = {
        "car2d", "gmrf2d", "car3d", "sar3d"};
    return kNames[field.index()];
}

}  // namespace sateen
