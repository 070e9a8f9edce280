// SPDX-License-Identifier: Apache-2.0
// Directions in file names. See direction_names.hpp.
#include "io/direction_names.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace sateen::io {
namespace {

constexpr double kUnitsPerDegree = 1e4;
constexpr std::int64_t kFullCircle = 3600000;

constexpr std::array<std::string_view, 4> kKeys = {"tl", "pl", "tv", "pv"};

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
bool is_separator(char c) {
    return c == ' ' || c == '_';
}
char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Index of the key at position `at`, or -1.
int key_at(std::string_view text, std::size_t at) {
    if (at + 2 > text.size()) return -1;
    const std::array<char, 2> pair = {lower(text[at]), lower(text[at + 1])};
    for (std::size_t k = 0; k < kKeys.size(); ++k)
        if (kKeys[k][0] == pair[0] && kKeys[k][1] == pair[1]) return static_cast<int>(k);
    return -1;
}

/// Digits with an optional sign and decimals, from `at`; `at` moves behind them.
std::optional<double> number_at(std::string_view text, std::size_t& at) {
    std::size_t end = at;
    if (end < text.size() && text[end] == '-') ++end;
    const std::size_t digits = end;
    while (end < text.size() && is_digit(text[end])) ++end;
    if (end == digits) return std::nullopt;
    if (end + 1 < text.size() && text[end] == '.' && is_digit(text[end + 1])) {
        ++end;
        while (end < text.size() && is_digit(text[end])) ++end;
    }
    double value = 0;
    const auto [rest, code] = std::from_chars(text.data() + at, text.data() + end, value,
                                              std::chars_format::fixed);
    if (code != std::errc() || rest != text.data() + end) return std::nullopt;
    at = end;
    return value;
}

std::string_view base_without_extension(std::string_view name) {
    name.remove_prefix(name.find_last_of('/') + 1);
    return name.substr(0, name.rfind('.'));
}

struct Angles {
    std::array<std::optional<double>, 4> values;
    int keys = 0;
    std::string problem;
};

Angles find_angles(std::string_view text) {
    Angles angles;
    for (std::size_t at = 0; at < text.size();) {
        const int key = key_at(text, at);
        // A key inside a word, as in "castle", is none.
        if (key < 0 || (at > 0 && is_letter(text[at - 1]))) {
            ++at;
            continue;
        }
        const std::string_view key_text = text.substr(at, 2);
        std::size_t next = at + 2;
        while (next < text.size() && is_separator(text[next])) ++next;
        const std::optional<double> value = number_at(text, next);
        if (!value) {
            at += 2;
            continue;
        }
        ++angles.keys;
        if (next < text.size() && is_letter(text[next]) && key_at(text, next) < 0 &&
            angles.problem.empty())
            angles.problem = "found '" + std::string(text.substr(at, next + 1 - at)) +
                             "', expected degrees after '" + std::string(key_text) + "'";
        auto& slot = angles.values[static_cast<std::size_t>(key)];
        if (slot && angles.problem.empty())
            angles.problem = "found '" + std::string(key_text) + "' twice, expected once";
        slot = value;
        at = next;
    }
    return angles;
}

std::string shortest(double value) {
    std::array<char, 32> text;
    const auto [end, code] = std::to_chars(text.data(), text.data() + text.size(), value);
    return {text.data(), code == std::errc() ? end : text.data()};
}

}  // namespace

Direction DirectionKey::direction() const {
    const auto radians = [](std::int32_t units) {
        return static_cast<float>(units / kUnitsPerDegree * std::numbers::pi / 180);
    };
    return {radians(theta), radians(phi)};
}

Result<DirectionKey> direction_key(double theta_deg, double phi_deg) {
    // Beyond 2^53 / 1e4 degrees the remainder would be meaningless.
    constexpr double kMaxPhi = 1e9;
    if (!(theta_deg >= 0 && theta_deg <= 90))
        return Error{Errc::bad_format,
                     "found theta " + shortest(theta_deg) + ", expected 0 to 90 degrees"};
    if (!(std::abs(phi_deg) <= kMaxPhi))
        return Error{Errc::bad_format,
                     "found phi " + shortest(phi_deg) + ", expected an angle in degrees"};
    DirectionKey key;
    key.theta = static_cast<std::int32_t>(std::llround(theta_deg * kUnitsPerDegree));
    std::int64_t phi = std::llround(phi_deg * kUnitsPerDegree) % kFullCircle;
    if (phi < 0) phi += kFullCircle;
    key.phi = key.theta == 0 ? 0 : static_cast<std::int32_t>(phi);
    return key;
}

NamedDirections parse_directions(std::string_view name) {
    const std::string_view text = base_without_extension(name);
    const Angles angles = find_angles(text);
    NamedDirections named;
    if (angles.keys < 2) return named;
    named.kind = NameKind::partial;
    named.problem = angles.problem;
    if (!named.problem.empty()) return named;
    for (std::size_t k = 0; k < kKeys.size(); ++k) {
        if (angles.values[k]) continue;
        named.problem = "found no degrees after '" + std::string(kKeys[k]) +
                        "', expected a name like 'tl015 pl060 tv030 pv000'";
        return named;
    }
    auto light = direction_key(*angles.values[0], *angles.values[1]);
    auto view = direction_key(*angles.values[2], *angles.values[3]);
    if (!light || !view) {
        named.problem =
            !light ? "light: " + light.error().message : "view: " + view.error().message;
        return named;
    }
    named.kind = NameKind::full;
    named.directions = {*light, *view};
    return named;
}

}  // namespace sateen::io
