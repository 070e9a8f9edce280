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

Result<void> check(const NeighbourhoodOptions& options) {
    for (const RuleName& rule : kRules) {
        if (rule.rule != options.rule) continue;
        if (options.value >= rule.smallest && options.value <= rule.largest) return {};
        return Error{Errc::invalid_argument, "neighbourhood " + to_string(options) +
                                                 ": expected " +
                                                 std::to_string(rule.smallest) + " to " +
                                                 std::to_string(rule.largest)};
    }
    return Error{Errc::invalid_argument, "neighbourhood: unknown rule"};
}

NeighbourhoodOptions neighbourhood_of(const AnalysisOptions& options) {
    if (options.neighbourhood) return *options.neighbourhood;
    if (!options.paper) return {};
    return options.field == FieldKind::gmrf2d
               ? NeighbourhoodOptions{NeighbourhoodRule::order, 4}
               : NeighbourhoodOptions{NeighbourhoodRule::nearest, 3};
}

Result<void> check(const AnalysisOptions& options) {
    SATEEN_CHECK(check(neighbourhood_of(options)));
    const auto at_most = [](const std::string& name, std::size_t found,
                            std::size_t most) -> Result<void> {
        if (found <= most) return {};
        return Error{Errc::invalid_argument,
                     name + ": found " + std::to_string(found) + ", expected 1 to " +
                         std::to_string(most) + ", or 0 for automatic"};
    };
    SATEEN_CHECK(at_most("levels", options.levels, kMaxLevels));
    return at_most("subspaces", options.subspaces, kMaxSubspaces);
}

std::string to_string(const NeighbourhoodOptions& options) {
    for (const RuleName& rule : kRules)
        if (rule.rule == options.rule)
            return std::string(rule.name) + ":" + std::to_string(options.value);
    return "auto";
}

}  // namespace sateen
