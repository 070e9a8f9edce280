// SPDX-License-Identifier: Apache-2.0
// Which field models a material uses, for people.
#pragma once

#include <span>
#include <string>

#include "sateen/material/material.hpp"

namespace sateen::cli {

/// "car2d", or "car2d, gmrf2d" where both are used.
inline std::string field_names(std::span<const Subspace> subspaces) {
    std::string names;
    for (const Subspace& subspace : subspaces)
        for (const Level& level : subspace.levels)
            for (const FieldModel& field : level.fields)
                if (const std::string name = name_of(field);
                    coefficients_of(field) != 0 && names.find(name) == std::string::npos)
                    names += (names.empty() ? "" : ", ") + name;
    return names.empty() ? "none" : names;
}

}  // namespace sateen::cli
