// SPDX-License-Identifier: Apache-2.0
// A material beside its measurement, direction by direction.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen::cli {

/// One image of the measurement and what the material has in its place.
struct PairError {
    std::size_t view = 0;
    std::size_t light = 0;
    double delta_e = 0;  ///< CIEDE2000 of the mean colours
    double contrast =
        0;  ///< logarithm of the ratio of the contrasts, material to measured
};

struct DirectionComparison {
    std::vector<Direction> views;
    std::vector<Direction> lights;
    std::vector<PairError> pairs;
    std::vector<std::uint8_t> index;  ///< (lights, views), subspaces
};

/// \param most  images at most, evenly spread; 0 for all
/// \error of reading; cancelled
[[nodiscard]] Result<DirectionComparison> compare_directions(
    const Material& material, const Measurement& measurement, std::size_t most,
    Executor& executor, Progress& progress);

/// Mean, 95th percentile and largest errors: over all pairs, by elevation of the view and of
/// the light, and grazing ones (either at 60° or lower) apart.
[[nodiscard]] nlohmann::ordered_json json_of(const DirectionComparison& comparison);

/// One line of the same.
[[nodiscard]] std::string text_of(const DirectionComparison& comparison);

/// A section of the report: map of the errors over views and lights, index table, curves.
[[nodiscard]] Result<std::string> section_of(const DirectionComparison& comparison);

}  // namespace sateen::cli
