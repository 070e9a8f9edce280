// SPDX-License-Identifier: Apache-2.0
// Lines of the text files that say where images were taken from.
#pragma once

#include <cstddef>
#include <string_view>

namespace sateen::io {

/// What separates words; the carriage return belongs to line ends.
inline constexpr std::string_view kBlank = " \t\r";

/// Without blanks at its ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Takes the next line off `text`; it is trimmed.
[[nodiscard]] inline std::string_view next_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return trimmed(line);
}

/// Some editors begin a text in UTF-8 with one.
inline void skip_byte_order_mark(std::string_view& text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark)
        text.remove_prefix(kByteOrderMark.size());
}

}  // namespace sateen::io
