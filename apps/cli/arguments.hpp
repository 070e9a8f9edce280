// SPDX-License-Identifier: Apache-2.0
// Arguments that several verbs share, and their types as text.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "sateen/core/direction.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::cli {

/// Options that most verbs have.
struct CommonArguments {
    std::uint64_t seed = 0;
    std::size_t threads = 0;
    bool json = false;

    void add_to(CLI::App& verb);
};

struct Size {
    std::size_t cols = 512;
    std::size_t rows = 512;
};

/// A size, or the best one near it for the pattern of the material.
struct WantedSize {
    Size size;
    bool best = false;
};

struct Position {
    std::int32_t col = 0;
    std::int32_t row = 0;
};

/// A check for CLI11, which itself takes -1 for the largest number.
[[nodiscard]] std::function<std::string(const std::string&)> whole_number_up_to(
    std::uint64_t largest);

/// Materials are gzip files, which no image or measurement is.
[[nodiscard]] bool looks_like_material(const std::string& path);

/// "WxH" or "N" for a square. Throws CLI::ValidationError, as CLI11 wants it.
[[nodiscard]] Size parse_size(const std::string& text);
/// The same, or "best:" before it.
[[nodiscard]] WantedSize parse_wanted_size(const std::string& text);
/// "X,Y", whole numbers that may be negative.
[[nodiscard]] Position parse_position(const std::string& text);
/// "THETA,PHI" in degrees.
[[nodiscard]] Direction parse_direction(const std::string& text);
/// "auto" (gives 0) or a number in [smallest, largest].
[[nodiscard]] std::size_t parse_auto_or_number(const std::string& text,
                                               std::size_t smallest, std::size_t largest);
[[nodiscard]] Encoding parse_encoding(const std::string& text);

/// A check for CLI11 of what one of these parses.
template <class Parse>
[[nodiscard]] std::function<std::string(const std::string&)> checked(Parse parse) {
    return [parse](const std::string& text) {
        (void)parse(text);
        return std::string();
    };
}

/// The option of a material to read, the first of a verb.
void add_material(CLI::App& verb, std::string& material);
/// An option that takes one direction or, into a vector, several.
template <class Texts>
CLI::Option* add_direction(CLI::App& verb, const std::string& name, Texts& directions,
                           const std::string& help) {
    return verb.add_option(name, directions, help)
        ->type_name("THETA,PHI")
        ->check(checked(parse_direction));
}

}  // namespace sateen::cli
