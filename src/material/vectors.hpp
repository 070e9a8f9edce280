// SPDX-License-Identifier: Apache-2.0
// Reading the vectors of a verified payload, which may be absent and of any length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "material/message.hpp"
#include "material/quantise.hpp"
#include "material/schema.hpp"

namespace sateen {

template <class T>
[[nodiscard]] std::size_t count(const flatbuffers::Vector<T>* vector) {
    return vector == nullptr ? 0 : vector->size();
}

/// An element, for an index that has been compared with the count.
template <class T>
[[nodiscard]] T at(const flatbuffers::Vector<T>* vector, std::size_t i) {
    return vector->Get(static_cast<flatbuffers::uoffset_t>(i));
}

template <class T>
[[nodiscard]] std::vector<float> floats(const flatbuffers::Vector<T>* vector,
                                        std::size_t first, std::size_t n) {
    std::vector<float> out(n);
    for (std::size_t i = 0; i < n; ++i) out[i] = at(vector, first + i);
    return out;
}

[[nodiscard]] inline std::vector<float> block(
    const flatbuffers::Vector<std::int16_t>* integers, std::size_t first, std::size_t n,
    int exponent) {
    std::vector<float> out(n);
    for (std::size_t i = 0; i < n; ++i)
        out[i] = dequantise(at(integers, first + i), exponent);
    return out;
}

[[nodiscard]] inline Result<void> expect_at_most(std::string_view what, std::size_t found,
                                                 std::size_t limit) {
    if (found <= limit) return {};
    return Error{Errc::limit_exceeded, std::string(what) + ": " + text(found) +
                                           " entries, expected at most " + text(limit)};
}

}  // namespace sateen
