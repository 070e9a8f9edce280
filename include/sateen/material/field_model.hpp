// SPDX-License-Identifier: Apache-2.0
// The random field models as data: what analysis estimates and synthesis draws.
#pragma once

#include <cstddef>
#include <type_traits>
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

/// Two-dimensional Gaussian Markov random field of one zero-mean plane [GMRF, eq. 8-11]:
///
///     Y_r = Σ_{s ∈ I⁺} a_s (Y_{r-s} + Y_{r+s}) + e_r,   E e_r² = σ², E e_r e_{r-s} = -σ² a_s
///
/// Spectral density S(ω) = σ² / (1 - 2 Σ a_s cos ω·s), valid where it is positive.
struct Gmrf2d {
    std::vector<Offset> neighbourhood;  ///< I⁺, one of every pair {s, -s}: causal
    std::vector<float> a;               ///< one a_s an offset
    float variance = 0;                 ///< σ², of Y_r given all others
    friend bool operator==(const Gmrf2d&, const Gmrf2d&) = default;
};

/// What the three-dimensional models hold: an autoregression of d planes together,
///
///     Y_r = Σ_s A_s Y_{r-s} + e_r,   e_r ~ N(0, Σ)
///
/// Spectral density S(ω) = Λ⁻¹ Σ Λ⁻ᴴ, Λ(ω) = I - Σ_s A_s exp(-iω·s), (d, d) and Hermitian.
struct Autoregression3d {
    std::size_t planes = 0;  ///< d
    std::vector<Offset> neighbourhood;
    std::vector<float> A;      ///< (η, d, d), row-major: A_s of every offset
    std::vector<float> Sigma;  ///< (d, d), symmetric; 0 for planes that are constant
    friend bool operator==(const Autoregression3d&, const Autoregression3d&) = default;
};

/// Three-dimensional causal autoregressive model: a causal neighbourhood.
struct Car3d : Autoregression3d {
    friend bool operator==(const Car3d&, const Car3d&) = default;
};

/// Three-dimensional simultaneous autoregressive model on a torus [SAR, eq. 3-11]: any
/// neighbourhood without the origin.
struct Sar3d : Autoregression3d {
    friend bool operator==(const Sar3d&, const Sar3d&) = default;
};

/// One random field of one level of the pyramid, of one plane or of all.
using FieldModel = std::variant<Car2d, Gmrf2d, Car3d, Sar3d>;

template <class Model>
inline constexpr bool is_joint = std::is_base_of_v<Autoregression3d, Model>;

/// How many planes a field draws.
[[nodiscard]] inline std::size_t planes_of(const FieldModel& field) {
    return std::visit(
        [](const auto& model) -> std::size_t {
            if constexpr (is_joint<std::decay_t<decltype(model)>>)
                return model.planes;
            else
                return 1;
        },
        field);
}

/// How many coefficients a field holds.
[[nodiscard]] inline std::size_t coefficients_of(const FieldModel& field) {
    return std::visit(
        [](const auto& model) {
            if constexpr (is_joint<std::decay_t<decltype(model)>>)
                return model.A.size();
            else
                return model.a.size();
        },
        field);
}

/// "car2d", "gmrf2d", "car3d" or "sar3d".
[[nodiscard]] const char* name_of(const FieldModel& field);

}  // namespace sateen
