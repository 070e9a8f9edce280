// SPDX-License-Identifier: Apache-2.0
// A material beside its measurement, direction by direction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sateen/analysis/quality.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen::cli {

/// How far an image is from the measured one, as a whole.
struct MeanError {
    double delta_e = 0;   ///< CIEDE2000 of the mean colours
    double contrast = 0;  ///< logarithm of the ratio of the contrasts, to the measured
};

/// One image of the measurement and what there is in its place.
struct PairError {
    std::size_t view = 0;
    std::size_t light = 0;
    MeanError drawn;  ///< what the material shows
    /// Of pairs that the material was not made from, beside the measured image of the nearest
    /// pair that it was made from.
    std::optional<MeanError> nearest;
};

/// The texture score of one of the pairs.
struct PairTexture {
    std::size_t pair = 0;  ///< of DirectionComparison::pairs
    double weight = 1;     ///< the number of pairs that it stands for
    TextureScore drawn;
    TextureScore nearest;  ///< where the pair has a nearest one
};

/// Pictures of one pair side by side.
struct Exhibit {
    std::string title;
    Image measured;
    Image drawn;
};

struct DirectionComparison {
    std::vector<Direction> views;
    std::vector<Direction> lights;
    std::vector<PairError> pairs;
    std::vector<PairTexture> textures;  ///< a sample
    std::vector<std::uint8_t> index;    ///< (lights, views), subspaces
    std::vector<Exhibit> exhibits;
};

struct CompareDirectionsOptions {
    std::size_t pairs = 0;      ///< at most, evenly spread; 0 for all
    std::size_t textures = 72;  ///< scored: at random, as many of each pair of elevations
    bool exhibits = false;
    std::uint64_t seed = 0;
};

/// Draws the material as every front end does (synthesis/evaluate.hpp) under the directions of
/// the measurement.
/// \error of reading; cancelled
/// \cost one pass over the images; 0.1 s a scored texture of 128 x 128
[[nodiscard]] Result<DirectionComparison> compare_directions(
    const Material& material, const Measurement& measurement,
    const CompareDirectionsOptions& options, Executor& executor, Progress& progress);

}  // namespace sateen::cli
