// SPDX-License-Identifier: Apache-2.0
// Prediction of the height codes of a tile, so that the gzip around the file packs them.
//
// A code is predicted from its neighbours to the left, above and above left by the median
// edge detector of LOCO-I: median(left, above, left + above - above left); the residual,
// modulo 2^16, is folded to 0, -1, 1, -2, … -> 0, 1, 2, 3, …
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sateen {

/// What codes[r, c] is expected to be, from the codes before it in raster order.
inline std::uint16_t predicted_code(std::span<const std::uint16_t> codes,
                                    std::size_t cols, std::size_t r, std::size_t c) {
    const std::size_t i = r * cols + c;
    if (r == 0) return c == 0 ? 0 : codes[i - 1];
    if (c == 0) return codes[i - cols];
    const int left = codes[i - 1];
    const int above = codes[i - cols];
    const int plane = left + above - codes[i - cols - 1];
    const auto [low, high] = std::minmax(left, above);
    return static_cast<std::uint16_t>(std::clamp(plane, low, high));
}

inline std::uint16_t fold(std::uint16_t residual) {
    const auto sign = static_cast<std::uint16_t>(residual >> 15U) != 0 ? 0xFFFFU : 0U;
    return static_cast<std::uint16_t>((std::uint32_t{residual} << 1U) ^ sign);
}
inline std::uint16_t unfold(std::uint16_t folded) {
    const auto sign = (folded & 1U) != 0 ? 0xFFFFU : 0U;
    return static_cast<std::uint16_t>((std::uint32_t{folded} >> 1U) ^ sign);
}

/// Appends the folded residuals of a tile, low and high bytes apart.
inline void append_residuals(std::span<const std::uint16_t> codes, std::size_t cols,
                             std::vector<std::uint8_t>& low,
                             std::vector<std::uint8_t>& high) {
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const std::uint16_t expected = predicted_code(codes, cols, i / cols, i % cols);
        const std::uint16_t folded =
            fold(static_cast<std::uint16_t>(codes[i] - expected));
        low.push_back(static_cast<std::uint8_t>(folded & 0xFFU));
        high.push_back(static_cast<std::uint8_t>(folded >> 8U));
    }
}

/// The codes of a tile from its folded residuals; the inverse.
/// \param low, high  callables: the byte of a number
template <class Low, class High>
std::vector<std::uint16_t> restore_codes(Low low, High high, std::size_t first,
                                         std::size_t rows, std::size_t cols) {
    std::vector<std::uint16_t> codes(rows * cols);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const auto folded =
            static_cast<std::uint16_t>(low(first + i) | (high(first + i) << 8U));
        codes[i] = static_cast<std::uint16_t>(
            predicted_code(codes, cols, i / cols, i % cols) + unfold(folded));
    }
    return codes;
}

}  // namespace sateen
