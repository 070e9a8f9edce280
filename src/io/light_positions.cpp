// SPDX-License-Identifier: Apache-2.0
// Light position files. See light_positions.hpp.
#include "io/light_positions.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "io/text_lines.hpp"

namespace sateen::io {
namespace {

constexpr double kRadiansToDegrees = 180 / std::numbers::pi;
/// How far below the horizon a light may be by its rounding, in units of sin θ.
constexpr double kHorizonTolerance = 0.035;

/// Takes the last word off `line`.
std::string_view last_word(std::string_view& line) {
    const std::size_t blank = line.find_last_of(kBlank);
    const std::string_view word =
        line.substr(blank == std::string_view::npos ? 0 : blank + 1);
    line.remove_suffix(word.size());
    line = trimmed(line);
    return word;
}

std::optional<double> to_number(std::string_view word) {
    std::string text(word);
    std::replace(text.begin(), text.end(), ',', '.');
    if (!text.empty() && text.front() == '+') text.erase(text.begin());
    double value = 0;
    const auto [rest, code] =
        std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || rest != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::optional<std::size_t> to_count(std::string_view line) {
    std::size_t value = 0;
    const auto [rest, code] =
        std::from_chars(line.data(), line.data() + line.size(), value);
    if (code != std::errc() || rest != line.data() + line.size()) return std::nullopt;
    return value;
}

/// \error bad_format  no direction, or one below the horizon
Result<DirectionKey> direction_of(const std::array<double, 3>& vector) {
    const double length = std::hypot(vector[0], vector[1], vector[2]);
    if (!(length > 1e-6) || !std::isfinite(length))
        return Error{Errc::bad_format, "found a vector without length"};
    const double z = vector[2] / length;
    if (z < -kHorizonTolerance)
        return Error{Errc::bad_format, "found z = " + std::to_string(z) +
                                           ", expected a light above the horizon"};
    const double theta = std::acos(std::clamp(z, 0.0, 1.0)) * kRadiansToDegrees;
    return direction_key(theta, std::atan2(vector[1], vector[0]) * kRadiansToDegrees);
}

LightPosition parse_line(std::string_view line, std::size_t number) {
    LightPosition out;
    out.line = number;
    std::array<double, 3> vector = {};
    for (std::size_t i = 3; i-- > 0;) {
        const std::string_view word = last_word(line);
        const std::optional<double> value = to_number(word);
        if (!value) {
            out.problem = "found '" + std::string(word) + "', expected FILE X Y Z";
            return out;
        }
        vector[i] = *value;
    }
    const std::size_t folder = line.find_last_of("/\\");
    out.file = line.substr(folder == std::string_view::npos ? 0 : folder + 1);
    if (out.file.empty()) {
        out.problem = "found no file name, expected FILE X Y Z";
        return out;
    }
    const Result<DirectionKey> direction = direction_of(vector);
    if (direction)
        out.direction = *direction;
    else
        out.problem = direction.error().message;
    return out;
}

}  // namespace

Result<LightPositions> parse_light_positions(std::string_view text,
                                             std::string_view name) {
    skip_byte_order_mark(text);
    LightPositions out;
    std::optional<std::size_t> stated;
    bool first = true;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::string_view line = next_line(text);
        if (line.empty()) continue;
        if (std::exchange(first, false)) {
            stated = to_count(line);
            if (stated) continue;
        }
        if (out.lights.size() == kMaxLights)
            return Error{Errc::limit_exceeded, std::string(name) + ": more than " +
                                                   std::to_string(kMaxLights) +
                                                   " lights"};
        out.lights.push_back(parse_line(line, number));
    }
    if (out.lights.empty())
        return Error{Errc::bad_format,
                     std::string(name) + ": lists no light, expected lines FILE X Y Z"};
    if (!stated)
        out.note = std::string(name) + ": does not begin with the number of images";
    else if (*stated != out.lights.size())
        out.note = std::string(name) + ": states " + std::to_string(*stated) +
                   " images and lists " + std::to_string(out.lights.size());
    return out;
}

}  // namespace sateen::io
