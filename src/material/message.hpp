// SPDX-License-Identifier: Apache-2.0
// Error messages of the material: what, where, found versus expected.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sateen/core/result.hpp"

namespace sateen {

/// The shortest decimal number that reads back as the value, in any locale.
inline std::string text(float value) {
    char buffer[32];
#ifdef __cpp_lib_to_chars
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
#else
    // libc++ before 17, as WebAssembly has it, where there is no locale but "C".
    int digits = 1;
    do std::snprintf(buffer, sizeof buffer, "%.*g", digits, static_cast<double>(value));
    while (std::strtof(buffer, nullptr) != value && ++digits <= 9);
    return buffer;
#endif
}
inline std::string text(std::size_t value) {
    return std::to_string(value);
}

template <class... Parts>
Error bad_format(const Parts&... parts) {
    Error error{Errc::bad_format, {}};
    (error.message.append(parts), ...);
    return error;
}

/// Names the element in which `inner` failed: "subspace 3, " before its message.
inline Result<void> in_element(std::string_view what, std::size_t i, Result<void> inner) {
    if (inner) return inner;
    Error error = std::move(inner).error();
    error.message.insert(0, std::string(what) + " " + text(i) + ", ");
    return error;
}

/// \error bad_format  "fields.variances: 14 entries, expected 15"
inline Result<void> expect_count(std::string_view what, std::size_t found,
                                 std::size_t expected) {
    if (found == expected) return {};
    return bad_format(what, ": ", text(found), " entries, expected ", text(expected));
}

}  // namespace sateen
