// SPDX-License-Identifier: Apache-2.0
// Arguments as text. See arguments.hpp.
#include "arguments.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "sateen/synthesis/synthesise.hpp"

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
    constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::uint64_t>::max();
    verb.add_option("--seed", seed, "Seed of everything random")
        ->type_name("N")
        ->capture_default_str()
        ->check(whole_number_up_to(kLargestSeed));
    verb.add_option("--threads", threads, "Threads; 0 for all cores")
        ->type_name("N")
        ->capture_default_str()
        ->check(whole_number_up_to(1024));
    verb.add_flag("--json", json, "Print the results as JSON on stdout");
    verb.set_help_flag("-h,--help", "Print this help");
}

std::function<std::string(const std::string&)> whole_number_up_to(std::uint64_t largest) {
    return [largest](const std::string& text) {
        const auto number = whole_number<std::uint64_t>(text);
        if (number && *number <= largest) return std::string();
        return fmt::format("\"{}\" is not a whole number from 0 to {}", text, largest);
    };
}

bool looks_like_material(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return file.get() == 0x1F && file.get() == 0x8B;
}

Size parse_size(const std::string& text) {
    const auto [left, right] = split(text, 'x');
    const auto cols = whole_number<std::size_t>(left);
    const auto rows = right.empty() ? cols : whole_number<std::size_t>(right);
    const bool complete = text.empty() || text.back() != 'x';
    const auto drawable = [](std::optional<std::size_t> side) {
        return side && *side >= 1 && *side <= kMaxTextureSide;
    };
    if (!complete || !drawable(cols) || !drawable(rows))
        throw CLI::ValidationError(
            fmt::format("\"{}\" is not a size such as 512x512 or 2048, 1 to {} pixels a "
                        "side",
                        text, kMaxTextureSide));
    return {*cols, *rows};
}

WantedSize parse_wanted_size(const std::string& text) {
    constexpr std::string_view kBest = "best:";
    if (text.starts_with(kBest)) return {parse_size(text.substr(kBest.size())), true};
    return {parse_size(text), false};
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
        throw CLI::ValidationError(fmt::format(
            "\"{}\" is not a position X,Y of whole pixels within 2^30", text));
    return {*col, *row};
}

Direction parse_direction(const std::string& text) {
    const auto [left, right] = split(text, ',');
    double theta = 0;
    double phi = 0;
    const bool numbers =
        CLI::detail::lexical_cast(left, theta) && CLI::detail::lexical_cast(right, phi);
    if (!numbers || !(theta >= 0 && theta <= 90) || !(phi >= -360 && phi <= 360))
        throw CLI::ValidationError(fmt::format(
            "\"{}\" is not THETA,PHI in degrees, theta 0 to 90, phi -360 to 360", text));
    return direction_from_degrees(static_cast<float>(theta), static_cast<float>(phi));
}

std::size_t parse_auto_or_number(const std::string& text, std::size_t smallest,
                                 std::size_t largest) {
    if (text == "auto") return 0;
    const auto number = whole_number<std::size_t>(text);
    if (!number || *number < smallest || *number > largest)
        throw CLI::ValidationError(fmt::format(
            "\"{}\" is not auto or a number from {} to {}", text, smallest, largest));
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
        fmt::format("\"{}\" is not auto, srgb, gamma2.2 or linear", text));
}

void add_material(CLI::App& verb, std::string& material) {
    verb.add_option("MATERIAL", material, "The material, NAME.sateen")
        ->type_name("")
        ->required();
}

}  // namespace sateen::cli
