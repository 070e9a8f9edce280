// SPDX-License-Identifier: Apache-2.0
// The random field models as data: what analysis estimates and synthesis draws.
#pragma once

#include <variant>
#include <vector>

#include "sateen/material/neighbourhood.hpp"

namespace sateen {

/// Two-dimensional causal autoregressive model of one zero-mean plane [CAR2, eq. 1]:
///
///     Y_r = Σ_{s ∈ I^c} a_s Y_{r-s} + e_r,   e_r ~ N(0, σ²)
///
/// Spectral density S(ω) = σ² / |1 - Σ a_s exp(-iω·s)|².
struct Car2d {
    std::vector<Offset> neighbourhood;  ///< causal, see is_causal()
    std::vector<float> a;               ///< one a_s an offset
    float variance = 0;                 ///< σ²; 0 for a plane that is constant
    friend bool operator==(const Car2d&, const Car2d&) = default;
};

/// One random field of one level of the pyramid.
using FieldModel = std::variant<Car2d>;

}  // namespace sateen
