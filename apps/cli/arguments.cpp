// SPDX-License-Identifier: Apache-2.0
// Arguments as text. See arguments.hpp.
#include "arguments.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace sateen::cli {
namespace {

template <class T>
std::optional<T> whole_number(std::string_view text) {
    T value{};
    const auto [end, status] =
        std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::pair<std::string, std::string> split(const std::string& text, char separator) {
    const std::size_t at = text.find(separator);
    if (at == std::string::npos) return {text, ""};
    return {text.substr(0, at), text.substr(at + 1)};
}

}  // namespace

void CommonArguments::add_to(CLI::App& verb) {
    verb.add_option("--seed", seed, "Seed of everything random")->capture_default_str();
    verb.add_option("--threads", threads, "Threads; 0 for all cores")
        ->capture_default_str()
        ->check(CLI::Range(std::size_t{0}, std::size_t{1024}));
    verb.add_flag("--json", json, "Print results as JSON on stdout");
}

Size parse_size(const std::string& text) {
    const auto [left, right] = split(text, 'x');
    const auto cols = whole_number<std::size_t>(left);
    const auto rows = right.empty() ? cols : whole_number<std::size_t>(right);
    const bool complete = text.empty() || text.back() != 'x';
    if (!complete || !cols || !rows || *cols == 0 || *rows == 0)
        throw CLI::ValidationError(
            "--size", fmt::format("\"{}\" is not a size such as 512x512 or 2048", text));
    return {*cols, *rows};
}

Position parse_position(const std::string& text) {
    constexpr std::int32_t kFurthest = 1 << 30;
    const auto [left, right] = split(text, ',');
    const auto col = whole_number<std::int32_t>(left);
    const auto row = whole_number<std::int32_t>(right);
    const auto near = [](std::optional<std::int32_t> x) {
        return x && *x >= -kFurthest && *x <= kFurthest;
    };
    if (!near(col) || !near(row))
        throw CLI::ValidationError(
            "--offset",
            fmt::format("\"{}\" is not a position X,Y of whole pixels within 2^30",
                        text));
    return {*col, *row};
}

Direction parse_direction(const std::string& text) {
    const auto [left, right] = split(text, ',');
    double theta = 0;
    double phi = 0;
    const bool numbers =
        CLI::detail::lexical_cast(left, theta) && CLI::detail::lexical_cast(right, phi);
    if (!numbers || !(theta >= 0 && theta <= 90) || !(phi >= -360 && phi <= 360))
        throw CLI::ValidationError(
            "direction",
            fmt::format(
                "\"{}\" is not THETA,PHI in degrees, theta 0 to 90, phi -360 to 360",
                text));
    return direction_from_degrees(static_cast<float>(theta), static_cast<float>(phi));
}

std::size_t parse_auto_or_number(const std::string& option, const std::string& text,
                                 std::size_t smallest, std::size_t largest) {
    if (text == "auto") return 0;
    const auto number = whole_number<std::size_t>(text);
    if (!number || *number < smallest || *number > largest)
        throw CLI::ValidationError(
            option, fmt::format("\"{}\" is not auto or a number from {} to {}", text,
                                smallest, largest));
    return *number;
}

Encoding parse_encoding(const std::string& text) {
    constexpr std::array<std::pair<std::string_view, Encoding>, 4> kNames = {
        {{"auto", Encoding::automatic},
         {"srgb", Encoding::srgb},
         {"gamma2.2", Encoding::gamma22},
         {"linear", Encoding::linear}}};
    for (const auto& [name, encoding] : kNames)
        if (text == name) return encoding;
    throw CLI::ValidationError(
        "--encoding", fmt::format("\"{}\" is not auto, srgb, gamma2.2 or linear", text));
}

}  // namespace sateen::cli
