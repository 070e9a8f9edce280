// SPDX-License-Identifier: Apache-2.0
// Light position files of reflectance transformation imaging (RTI), NAME.lp: the number of
// images, then a line for each: file name, x, y, z of a vector towards the light; x to the
// right, y up, z to the camera, which looks straight down.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/direction_names.hpp"

namespace sateen::io {

/// Most lines of a light position file.
inline constexpr std::size_t kMaxLights = 65535;

struct LightPosition {
    std::string file;        ///< without folders
    DirectionKey direction;  ///< of the vector, normalised
    std::size_t line = 0;
    std::string problem;  ///< not empty: the line cannot be used
};

struct LightPositions {
    std::vector<LightPosition> lights;
    /// What is odd about the file as a whole, for the user; often empty.
    std::string note;
};

/// Understands what is found in the wild: blanks or tabs, names with blanks, paths of
/// Windows and others (the base name counts), CRLF, blank lines, decimal commas, vectors of
/// any length, z slightly below the horizon (to 2 degrees; taken as on it), a count that is
/// missing or wrong (a note says so).
/// \error bad_format      without any line; lines state their own problems
/// \error limit_exceeded  more than kMaxLights lines
[[nodiscard]] Result<LightPositions> parse_light_positions(std::string_view text,
                                                           std::string_view name);

}  // namespace sateen::io
