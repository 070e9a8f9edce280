// SPDX-License-Identifier: Apache-2.0
#include "io/transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace sateen::io {
namespace {

// The definitions, in extended precision.
long double encoded(Encoding encoding, long double v) {
    if (encoding == Encoding::linear) return v;
    if (encoding == Encoding::gamma22) return std::pow(v, 1 / 2.2L);
    return v <= 0.0031308L ? 12.92L * v : 1.055L * std::pow(v, 1 / 2.4L) - 0.055L;
}

long rounded(Encoding encoding, float v, long codes) {
    if (!(v > 0)) return 0;
    if (v >= 1) return codes;
    return std::lround(
        static_cast<double>(static_cast<long double>(codes) *
                            encoded(encoding, static_cast<long double>(v))));
}

/// Values around every place where the code changes, and elsewhere.
std::vector<float> hard_values(std::span<const float> table) {
    std::vector<float> values;
    for (std::size_t code = 0; code + 1 < table.size(); ++code) {
        float v = (table[code] + table[code + 1]) / 2;
        for (int i = 0; i < 4; ++i) v = std::nextafter(v, 0.0F);
        for (int i = 0; i < 9; ++i, v = std::nextafter(v, 2.0F)) values.push_back(v);
        values.push_back(table[code]);
    }
    for (int i = 0; i <= 100000; ++i) values.push_back(static_cast<float>(i) / 1e5F);
    for (float v = 1; v > 1e-12F; v *= 0.999F) values.push_back(v);
    return values;
}

constexpr Encoding kEncodings[] = {Encoding::srgb, Encoding::gamma22, Encoding::linear};

TEST(Transfer, EightBitCodesAreCorrectlyRounded) {
    for (const Encoding encoding : kEncodings) {
        const std::vector<float> values = hard_values(decode_table8(encoding));
        std::vector<std::uint8_t> codes(values.size());
        encode_row(values.data(), values.size(), 1, encoding, codes.data());
        for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_EQ(codes[i], rounded(encoding, values[i], 255)) << values[i];
    }
}

TEST(Transfer, SixteenBitCodesAreCorrectlyRounded) {
    for (const Encoding encoding : kEncodings) {
        const std::vector<float> values = hard_values(decode_table16(encoding));
        std::vector<std::uint16_t> codes(values.size());
        encode_row(values.data(), values.size(), 1, encoding, codes.data());
        for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_EQ(codes[i], rounded(encoding, values[i], 65535)) << values[i];
    }
}

TEST(Transfer, EveryCodeSurvivesDecodingAndEncoding) {
    for (const Encoding encoding : kEncodings) {
        std::vector<std::uint8_t> codes8(256);
        encode_row(decode_table8(encoding).data(), 256, 1, encoding, codes8.data());
        for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(codes8[i], i);
        std::vector<std::uint16_t> codes16(65536);
        encode_row(decode_table16(encoding).data(), 65536, 1, encoding, codes16.data());
        for (std::size_t i = 0; i < 65536; ++i) EXPECT_EQ(codes16[i], i);
    }
}

TEST(Transfer, ClampsAndWritesNotANumberAsZero) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> values = {kNan, -kNan, -1,        -0.0F,     0,
                                       1,    2,     kInfinity, -kInfinity};
    for (const Encoding encoding : kEncodings) {
        std::vector<std::uint8_t> codes8(values.size());
        encode_row(values.data(), values.size(), 1, encoding, codes8.data());
        EXPECT_EQ(codes8, (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 255, 255, 255, 0}));
        std::vector<std::uint16_t> codes16(values.size());
        encode_row(values.data(), values.size(), 1, encoding, codes16.data());
        EXPECT_EQ(codes16,
                  (std::vector<std::uint16_t>{0, 0, 0, 0, 0, 65535, 65535, 65535, 0}));
    }
}

}  // namespace
}  // namespace sateen::io
