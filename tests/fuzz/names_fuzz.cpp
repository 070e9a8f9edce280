// SPDX-License-Identifier: Apache-2.0
// The readers of our own text: any bytes as a file name and as a directions.csv.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "io/direction_names.hpp"
#include "io/light_positions.hpp"

namespace {

// What a reader accepts must be a direction, and what it refuses must have a reason.
void check(const sateen::io::DirectionPair& pair) {
    for (const auto& key : {pair.light, pair.view})
        if (key.theta < 0 || key.theta > 900000 || key.phi < 0 || key.phi >= 3600000)
            std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto named = sateen::io::parse_directions(text);
    if (named.kind == sateen::io::NameKind::full) check(named.directions);
    if (named.kind == sateen::io::NameKind::partial && named.problem.empty())
        std::abort();
    const auto rows = sateen::io::parse_directions_csv(text, "fuzz");
    if (rows)
        for (const auto& row : *rows)
            if (row.problem.empty()) check(row.directions);
    const auto lights = sateen::io::parse_light_positions(text, "fuzz");
    if (lights)
        for (const auto& light : lights->lights)
            if (light.problem.empty()) check({light.direction, {}});
    return 0;
}
