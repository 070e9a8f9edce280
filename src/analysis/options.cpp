// SPDX-License-Identifier: Apache-2.0
// Options of the analysis as text. See options.hpp.
#include "sateen/analysis/options.hpp"

#include <array>
#include <charconv>
#include <utility>

namespace sateen {
namespace {

struct RuleName {
    NeighbourhoodRule rule;
    std::string_view name;
    int smallest;
    int largest;
};

constexpr std::array kRules = {
    RuleName{NeighbourhoodRule::order, "order", 1, kMaxOrder},
    RuleName{NeighbourhoodRule::correlation, "correlation", 1, 60},
    RuleName{NeighbourhoodRule::evidence, "evidence", 1, kMaxOrder},
    RuleName{NeighbourhoodRule::forward, "forward", 1, 60},
    RuleName{NeighbourhoodRule::nearest, "nearest", 1, 3},
};

}  // namespace

Result<FieldKind> parse_field_kind(std::string_view text) {
    constexpr std::array<std::pair<std::string_view, FieldKind>, 5> kKinds = {
        {{"auto", FieldKind::automatic},
         {"car2d", FieldKind::car2d},
         {"gmrf2d", FieldKind::gmrf2d},
         {"car3d", FieldKind::car3d},
         {"sar3d", FieldKind::sar3d}}};
    for (const auto& [name, kind] : kKinds)
        if (name == text) return kind;
    return Error{Errc::invalid_argument, "field \"" + std::string(text) +
                                             "\" is not one of auto, car2d, gmrf2d, "
                                             "car3d, sar3d"};
}

Result<NeighbourhoodOptions> parse_neighbourhood(std::string_view text) {
    if (text == "auto") return NeighbourhoodOptions{};
    const std::size_t colon = text.find(':');
    if (colon != std::string_view::npos) {
        const std::string_view digits = text.substr(colon + 1);
        int value = 0;
        const auto [end, status] =
            std::from_chars(digits.data(), digits.data() + digits.size(), value);
        const bool whole = status == std::errc() && end == digits.data() + digits.size();
        for (const RuleName& rule : kRules)
            if (text.substr(0, colon) == rule.name && whole && value >= rule.smallest &&
                value <= rule.largest)
                return NeighbourhoodOptions{rule.rule, value};
    }
    std::string expected = "auto";
    for (const RuleName& rule : kRules)
        expected += std::string(", ") + std::string(rule.name) + ":N with N from " +
                    std::to_string(rule.smallest) + " to " + std::to_string(rule.largest);
    return Error{Errc::invalid_argument,
                 "neighbourhood \"" + std::string(text) + "\" is not one of " + expected};
}

std::string to_string(const NeighbourhoodOptions& options) {
    for (const RuleName& rule : kRules)
        if (rule.rule == options.rule)
            return std::string(rule.name) + ":" + std::to_string(options.value);
    return "auto";
}

}  // namespace sateen
