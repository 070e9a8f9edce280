// SPDX-License-Identifier: Apache-2.0
#include "io/huffman_deflate.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <random>
#include <vector>

namespace sateen::io {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Unpacks raw deflate by zlib.
Bytes inflated(const Bytes& packed, std::size_t size) {
    Bytes bytes(size + 1);
    z_stream stream = {};
    EXPECT_EQ(inflateInit2(&stream, -15), Z_OK);
    stream.next_in = const_cast<std::uint8_t*>(packed.data());
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = bytes.data();
    stream.avail_out = static_cast<uInt>(bytes.size());
    EXPECT_EQ(inflate(&stream, Z_SYNC_FLUSH), Z_OK) << stream.msg;
    EXPECT_EQ(stream.avail_in, 0U);
    bytes.resize(stream.total_out);
    inflateEnd(&stream);
    return bytes;
}

void expect_round_trip(const Bytes& bytes) {
    Bytes packed;
    append_huffman_deflate(bytes, packed);
    EXPECT_EQ(inflated(packed, bytes.size()), bytes);
}

TEST(HuffmanDeflate, UnpacksToTheSameBytes) {
    std::mt19937 generator(3);
    for (const unsigned spread : {1U, 2U, 5U, 40U, 256U}) {
        for (const std::size_t size : {1U, 2U, 7U, 8U, 9U, 10U, 100U, 4099U, 140000U}) {
            Bytes bytes(size);
            for (auto& byte : bytes)
                byte = static_cast<std::uint8_t>(generator() % spread);
            expect_round_trip(bytes);
        }
    }
}

TEST(HuffmanDeflate, UnpacksRunsOfEveryLength) {
    Bytes bytes;
    for (std::size_t length = 1; length < 1100; ++length)
        bytes.insert(bytes.end(), length, static_cast<std::uint8_t>(length * 7));
    expect_round_trip(bytes);
}

TEST(HuffmanDeflate, LimitsTheLengthOfCodes) {
    // Fibonacci counts make Huffman's own codes as long as there are symbols.
    Bytes bytes;
    std::size_t a = 1;
    std::size_t b = 1;
    for (std::uint8_t symbol = 0; symbol < 24; ++symbol) {
        for (std::size_t i = 0; i < a; ++i) bytes.push_back(symbol);
        b += std::exchange(a, b);
    }
    std::shuffle(bytes.begin(), bytes.end(), std::mt19937(4));
    expect_round_trip(bytes);
}

TEST(HuffmanDeflate, ShrinksSkewedNoiseCloseToItsEntropy) {
    std::mt19937 generator(5);
    std::geometric_distribution<int> geometric(0.25);
    Bytes bytes(100000);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(geometric(generator));
    Bytes packed;
    append_huffman_deflate(bytes, packed);
    // Entropy of the geometric distribution: (-q log2 q - p log2 p) / p = 3.245 bits.
    EXPECT_LT(static_cast<double>(packed.size()), 1.03 * 100000 * 3.245 / 8);
}

}  // namespace
}  // namespace sateen::io
