// SPDX-License-Identifier: Apache-2.0
// Directions of light and view as files state them: in names, or in directions.csv.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/result.hpp"

namespace sateen::io {

/// A direction to 1e-4 degree: theta in [0, 90], phi in [0, 360), phi = 0 at the pole.
struct DirectionKey {
    std::int32_t theta = 0;  ///< 1e-4 degree
    std::int32_t phi = 0;
    friend auto operator<=>(const DirectionKey&, const DirectionKey&) = default;

    [[nodiscard]] Direction direction() const;
};

/// \error bad_format  theta outside [0, 90], or a value that is not finite
[[nodiscard]] Result<DirectionKey> direction_key(double theta_deg, double phi_deg);

struct DirectionPair {
    DirectionKey light;
    DirectionKey view;
};

/// What the name of an image says.
enum class NameKind {
    none,     ///< no directions: at most one of the keys
    partial,  ///< some keys, but not four angles that make two directions
    full,
};
struct NamedDirections {
    NameKind kind = NameKind::none;
    DirectionPair directions;
    std::string problem;  ///< of a partial name: found, expected
};

/// Finds tl, pl, tv, pv in the base name of `name`, in any order, each followed by
/// degrees; a key may be separated from its number, and from the next key, by spaces,
/// underscores or nothing. Folders and the extension are not looked at.
[[nodiscard]] NamedDirections parse_directions(std::string_view name);

struct CsvRow {
    std::string file;
    DirectionPair directions;
    std::size_t line = 0;
    std::string problem;  ///< not empty: the row cannot be used
};

/// Parses `file,theta_i,phi_i,theta_v,phi_v`: header required, in any order and with any
/// other columns; blank lines, lines beginning with #, CRLF and quotes are understood.
/// \error bad_format  the header lacks a column; rows state their own problems
[[nodiscard]] Result<std::vector<CsvRow>> parse_directions_csv(std::string_view text,
                                                               std::string_view name);
/// The same without files: columns theta_i, phi_i, theta_v, phi_v; or theta, phi, for all
/// pairs of one list (a pair has the line of its light).
[[nodiscard]] Result<std::vector<CsvRow>> parse_direction_pairs(std::string_view text,
                                                                std::string_view name);

}  // namespace sateen::io
