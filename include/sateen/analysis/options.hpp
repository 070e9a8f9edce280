// SPDX-License-Identifier: Apache-2.0
// Options of the analysis, listed once, with their defaults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// How the contextual neighbourhood of a field is chosen.
enum class NeighbourhoodRule {
    order,        ///< hierarchical half plane of an order
    correlation,  ///< the offsets of largest spatial correlation [SAR, GMRF]
    evidence,     ///< the hierarchical order of largest posterior evidence [CAR2]
    forward,      ///< forward selection in a wide window, as long as the evidence grows
    nearest,  ///< {(0,1), (1,0), (1,1)}, the first `count` of them: [SAR]'s and [CAR2]'s
};

/// On the command line: "order:6", "correlation:14", "evidence:10", "nearest:3".
struct NeighbourhoodOptions {
    NeighbourhoodRule rule = NeighbourhoodRule::evidence;
    /// The order, the number of offsets, the largest order tried, the number of sites.
    int value = 6;
    friend bool operator==(const NeighbourhoodOptions&,
                           const NeighbourhoodOptions&) = default;
};

/// \error invalid_argument  says what was found and what can be given
[[nodiscard]] Result<NeighbourhoodOptions> parse_neighbourhood(std::string_view text);
/// \error invalid_argument  a number outside the range of its rule
[[nodiscard]] Result<void> check(const NeighbourhoodOptions& options);
[[nodiscard]] std::string to_string(const NeighbourhoodOptions& options);

/// Which random field models the levels.
enum class FieldKind { automatic, car2d, gmrf2d, car3d, sar3d };

[[nodiscard]] constexpr bool is_joint_kind(FieldKind kind) {
    return kind == FieldKind::car3d || kind == FieldKind::sar3d;
}

/// "auto", "car2d", …
[[nodiscard]] Result<FieldKind> parse_field_kind(std::string_view text);

/// The planes that a three-dimensional model draws together.
enum class Space {
    kl,   ///< Karhunen-Loève factors
    rgb,  ///< the channels themselves, as [SAR] does
};

struct AnalysisOptions {
    /// automatic: of car2d and gmrf2d the one with the better Bayesian information, field
    /// by field; or, with `joint`, car3d for all levels where that is better still.
    FieldKind field = FieldKind::automatic;
    /// automatic may draw the planes together in materials of one subspace: about twice the
    /// bytes, which twenty subspaces have not to spare.
    bool joint = true;
    /// Of car3d and sar3d; none: kl, or rgb in paper mode, as [SAR] and the 3D CAR model do.
    std::optional<Space> space = {};
    /// Exactly what [CAR2] prints: few neighbours, at most 3 levels, no marginal curves,
    /// no power compensation, fit on interior sites, drawn by causal recursion.
    bool paper = false;
    /// Subspaces of a BTF, 1 … 20; 0 lets the segmentation choose.
    std::size_t subspaces = 0;
    /// Levels of the pyramid, 1 … 8; 0: as many as leave the coarsest 16 pixels a side, at
    /// most 5; 3 in paper mode.
    std::size_t levels = 0;
    /// None: what neighbourhood_of() says.
    std::optional<NeighbourhoodOptions> neighbourhood = {};
    Tone tone = Tone::srgb;
    /// Look for a pattern that repeats; never in paper mode.
    bool structure = true;
    /// Modulate bands whose amplitude varies more than that of Gaussian ones; never in paper
    /// mode.
    bool modulation = true;
    std::uint64_t seed = 0;
    /// Keep mean colour and contrast of every pair of directions; never in paper mode.
    bool reflectance = true;
    /// Go on past unreadable images.
    bool skip_bad = false;
};

/// The rule that was asked for; else evidence:6, or in paper mode what the papers use:
/// order:4 for gmrf2d, nearest:3 for the others.
[[nodiscard]] NeighbourhoodOptions neighbourhood_of(const AnalysisOptions& options);

/// \error invalid_argument  names the option, what was found and what was expected
[[nodiscard]] Result<void> check(const AnalysisOptions& options);

/// What FieldKind::automatic chose, and what the alternatives would have been.
struct FieldChoice {
    std::size_t car2d = 0;  ///< fields of this model
    std::size_t gmrf2d = 0;
    std::size_t car3d = 0;
    double information_car2d = 0;  ///< Σ of the Bayesian information, were all car2d
    double information_gmrf2d = 0;
    double information_apart = 0;  ///< of the better one of the two in every field
    double information_car3d = 0;  ///< were all car3d; 0 where that was not considered
    void add(const FieldChoice& other);
};

}  // namespace sateen
