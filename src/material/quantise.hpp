// SPDX-License-Identifier: Apache-2.0
// The number formats of the material file.
//
// Coefficients and knots are block floating point: the values of a block share the power
// of two that lets the largest use all 16 bits,
//
//     value = q · 2^exponent,    2^14 ≤ max |q| < 2^15.
//
// Deviation from the usual scale max|value| / 32767: half a bit is lost on average, but
// every quantised value is a float exactly, so that quantising it again changes nothing,
// and an exponent takes one byte instead of four.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sateen/core/direction.hpp"

namespace sateen {

inline constexpr int kMinExponent = -126;
/// Angles are multiples of 2^-12 degree: whole and quarter degrees are exact, others are
/// off by 0.00012 degree at most, and the step outweighs the rounding to radians and
/// back.
inline constexpr double kAngleSteps = 4096;

/// The exponent of a block; 0 for one that is zero or too small to be represented.
/// \param bits  of the magnitudes: 15, or 7 for blocks of bytes
inline int block_exponent(std::span<const float> values, int bits = 15) {
    float largest = 0;
    for (const float value : values) largest = std::max(largest, std::abs(value));
    int binade = 0;
    std::frexp(largest, &binade);
    const bool vanishes = largest == 0 || binade - bits < kMinExponent;
    return vanishes ? 0 : binade - bits;
}

inline std::int16_t quantise(float value, int exponent) {
    // Just below the top of its binade a value rounds to 2^15, one more than 16 bits
    // hold.
    const float q = std::round(std::ldexp(value, -exponent));
    return static_cast<std::int16_t>(std::clamp(q, -32767.0F, 32767.0F));
}

inline float dequantise(std::int16_t q, int exponent) {
    return std::ldexp(static_cast<float>(q), exponent);
}

inline std::int8_t quantise_byte(float value, int exponent) {
    const float q = std::round(std::ldexp(value, -exponent));
    return static_cast<std::int8_t>(std::clamp(q, -127.0F, 127.0F));
}

/// Quantises a block: appends its integers and its exponent.
inline void append_block(std::span<const float> values,
                         std::vector<std::int16_t>& integers,
                         std::vector<std::int8_t>& exponents) {
    const int exponent = block_exponent(values);
    exponents.push_back(static_cast<std::int8_t>(exponent));
    for (const float value : values) integers.push_back(quantise(value, exponent));
}

/// The same in 8 bits: 2^6 ≤ max |q| < 2^7.
inline void append_byte_block(std::span<const float> values,
                              std::vector<std::int8_t>& integers,
                              std::vector<std::int8_t>& exponents) {
    const int exponent = block_exponent(values, 7);
    exponents.push_back(static_cast<std::int8_t>(exponent));
    for (const float value : values) integers.push_back(quantise_byte(value, exponent));
}

/// Radians to degrees on the grid of the file; direction_from_degrees() is the way back.
inline float quantised_degrees(float radians) {
    const double degrees =
        static_cast<double>(radians) / static_cast<double>(kRadiansPerDegree);
    return static_cast<float>(std::round(degrees * kAngleSteps) / kAngleSteps);
}

/// Equal numbers have equal bytes: minus zero becomes zero.
inline float canonical(float value) {
    return value == 0 ? 0.0F : value;
}

}  // namespace sateen
