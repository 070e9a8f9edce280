// SPDX-License-Identifier: Apache-2.0
// What `sateen compare` says of all directions.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compare_directions.hpp"

namespace sateen::cli {

/// Errors of many pairs. The texture score is a geometric mean, each of the sampled pairs
/// weighted by those that it stands for.
struct DirectionSummary {
    std::size_t pairs = 0;
    double mean = 0;  ///< of ΔE, as are p95 and largest
    double p95 = 0;
    double largest = 0;
    double contrast = 0;       ///< mean magnitude of the logarithm
    std::size_t textures = 0;  ///< scored
    double texture = 1;
    std::array<double, 5> components = {1, 1, 1, 1, 1};  ///< in the order of TextureScore
};

/// Which of the two errors of a pair is meant.
enum class Shown { drawn, nearest };

[[nodiscard]] DirectionSummary summary_of(
    const DirectionComparison& comparison,
    const std::function<bool(const PairError&)>& belongs, Shown shown = Shown::drawn);

/// View or light at 60° from the normal or more.
[[nodiscard]] bool is_grazing(const DirectionComparison& comparison,
                              const PairError& pair);

/// Summaries by elevation of the views or of the lights, in whole degrees.
[[nodiscard]] std::map<int, DirectionSummary> by_elevation(
    const DirectionComparison& comparison, const std::vector<Direction>& directions,
    std::size_t PairError::*which);

/// Over all pairs, by elevation of view and light, and grazing ones apart; pairs that the
/// material was not made from apart, beside their nearest.
[[nodiscard]] nlohmann::ordered_json json_of(const DirectionComparison& comparison);

/// A few lines of the same.
[[nodiscard]] std::string text_of(const DirectionComparison& comparison);

/// A section of the report: pictures of pairs, map of the errors over views and lights, index
/// table, curves and table by elevation.
[[nodiscard]] Result<std::string> section_of(const DirectionComparison& comparison);

}  // namespace sateen::cli
