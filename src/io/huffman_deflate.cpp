// SPDX-License-Identifier: Apache-2.0
// A fast deflate coder. See huffman_deflate.hpp.
#include "io/huffman_deflate.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <utility>

namespace sateen::io {
namespace {

// Codes of at most 12 bits: four and the seven bits left over fit a 64-bit word.
constexpr unsigned kMaxCodeBits = 12;
constexpr std::size_t kEndOfBlock = 256;
constexpr std::size_t kSymbols = 286;
constexpr std::size_t kMinMatch = 3;
constexpr std::size_t kMaxMatch = 258;

using Counts = std::array<std::uint32_t, kSymbols>;
using Lengths = std::array<std::uint8_t, kSymbols>;

struct Code {
    std::uint16_t bits = 0;  ///< first bit lowest
    std::uint8_t length = 0;
};
using Codes = std::array<Code, kSymbols>;

/// RFC 1951, 3.2.5: symbol, extra bits and their number for every match length.
struct MatchCode {
    std::uint16_t symbol = 0;
    std::uint8_t extra = 0;
    std::uint8_t extra_bits = 0;
};

constexpr auto kMatchCodes = [] {
    std::array<MatchCode, kMaxMatch + 1> codes = {};
    std::uint16_t symbol = 257;
    for (std::size_t first = kMinMatch; first < kMaxMatch; ++symbol) {
        const auto bits =
            static_cast<std::uint8_t>(symbol < 265 ? 0 : (symbol - 261) / 4);
        for (std::size_t i = 0; i < std::size_t{1} << bits && first + i < kMaxMatch; ++i)
            codes[first + i] = {symbol, static_cast<std::uint8_t>(i), bits};
        first += std::size_t{1} << bits;
    }
    codes[kMaxMatch] = {285, 0, 0};
    return codes;
}();

std::uint64_t load64(const std::uint8_t* from) {
    std::uint64_t word = 0;
    std::memcpy(&word, from, sizeof(word));
    return word;
}

/// Calls literal(byte) and match(length) in order; a match repeats the byte before it.
template <class Literal, class Match>
void tokenise(std::span<const std::uint8_t> bytes, Literal&& literal, Match&& match) {
    const std::uint8_t* const data = bytes.data();
    const std::size_t size = bytes.size();
    if (size == 0) return;
    literal(data[0]);
    std::size_t i = 1;
    while (i + 8 <= size) {
        // Equal words one byte apart: eight bytes that repeat their predecessor.
        if (load64(data + i) != load64(data + i - 1)) {
            for (std::size_t k = 0; k < 4; ++k) literal(data[i + k]);
            i += 4;
            continue;
        }
        std::size_t run = 8;
        while (i + run < size && data[i + run] == data[i]) ++run;
        i += run;
        while (run > 0) {
            std::size_t length = std::min(run, kMaxMatch);
            if (run - length > 0 && run - length < kMinMatch) length -= kMinMatch;
            match(length);
            run -= length;
        }
    }
    for (; i < size; ++i) literal(data[i]);
}

Counts count_symbols(std::span<const std::uint8_t> bytes) {
    Counts counts = {};
    tokenise(
        bytes, [&](std::uint8_t byte) { ++counts[byte]; },
        [&](std::size_t length) { ++counts[kMatchCodes[length].symbol]; });
    counts[kEndOfBlock] = 1;
    return counts;
}

/// How many codes of each length an optimal code has: Huffman's algorithm on the sorted
/// counts with two queues, the leaves and the pairs in order of their making.
std::array<std::uint32_t, kSymbols> lengths_of_optimal_code(
    std::span<const std::uint32_t> sorted) {
    const std::size_t leaves = sorted.size();
    std::vector<std::uint64_t> weight(sorted.begin(), sorted.end());
    std::vector<std::size_t> parent(2 * leaves - 1);
    std::size_t leaf = 0;
    std::size_t pair = leaves;
    const auto lightest = [&] {
        const bool take_leaf =
            leaf < leaves && (pair >= weight.size() || weight[leaf] <= weight[pair]);
        return take_leaf ? leaf++ : pair++;
    };
    while (weight.size() < 2 * leaves - 1) {
        const std::size_t a = lightest();
        const std::size_t b = lightest();
        parent[a] = parent[b] = weight.size();
        weight.push_back(weight[a] + weight[b]);
    }
    std::array<std::uint32_t, kSymbols> number = {};
    std::vector<std::uint32_t> depth(2 * leaves - 1);
    for (std::size_t i = 2 * leaves - 2; i-- > 0;) {
        depth[i] = depth[parent[i]] + 1;
        if (i < leaves) ++number[depth[i]];
    }
    return number;
}

/// Code lengths of at most kMaxCodeBits; needs two symbols or more.
Lengths limited_lengths(const Counts& counts) {
    std::vector<std::pair<std::uint32_t, std::size_t>> symbols;
    for (std::size_t s = 0; s < kSymbols; ++s)
        if (counts[s] > 0) symbols.emplace_back(counts[s], s);
    std::sort(symbols.begin(), symbols.end());
    std::vector<std::uint32_t> sorted;
    for (const auto& [count, symbol] : symbols) sorted.push_back(count);
    auto number = lengths_of_optimal_code(sorted);

    // Codes that are too long are cut, which overfills the code space; lengthening the
    // longest code below the limit by a bit frees room for one of them at a time.
    for (std::size_t bits = kMaxCodeBits + 1; bits < number.size(); ++bits)
        number[kMaxCodeBits] += std::exchange(number[bits], 0);
    std::uint32_t space = 0;
    for (std::size_t bits = 1; bits <= kMaxCodeBits; ++bits)
        space += number[bits] << (kMaxCodeBits - bits);
    for (; space > 1U << kMaxCodeBits; --space) {
        std::size_t bits = kMaxCodeBits - 1;
        while (number[bits] == 0) --bits;
        --number[bits];
        number[bits + 1] += 2;
        --number[kMaxCodeBits];
    }

    Lengths lengths = {};
    auto rarest = symbols.begin();
    for (std::size_t bits = kMaxCodeBits; bits > 0; --bits)
        for (std::uint32_t i = 0; i < number[bits]; ++i, ++rarest)
            lengths[rarest->second] = static_cast<std::uint8_t>(bits);
    return lengths;
}

/// RFC 1951, 3.2.2: codes of one length follow each other in order of their symbols.
template <std::size_t kCount>
std::array<Code, kCount> canonical_codes(
    const std::array<std::uint8_t, kCount>& lengths) {
    std::array<Code, kCount> codes = {};
    std::uint32_t next = 0;
    for (std::uint8_t bits = 1; bits <= kMaxCodeBits; ++bits, next <<= 1) {
        for (std::size_t s = 0; s < kCount; ++s) {
            if (lengths[s] != bits) continue;
            std::uint32_t reversed = 0;
            for (unsigned b = 0; b < bits; ++b)
                reversed |= ((next >> b) & 1U) << (bits - 1U - b);
            codes[s] = {static_cast<std::uint16_t>(reversed), bits};
            ++next;
        }
    }
    return codes;
}

/// Bits into bytes, lowest first. The caller sees to it that the room suffices.
class BitWriter {
  public:
    explicit BitWriter(std::uint8_t* to) : begin_(to), to_(to) {}

    void put(std::uint64_t bits, unsigned count) {
        word_ |= bits << filled_;
        filled_ += count;
    }
    void put(const Code& code) { put(code.bits, code.length); }
    /// Leaves fewer than eight bits in the word.
    void flush() {
        for (std::size_t i = 0; i < 8; ++i)
            to_[i] = static_cast<std::uint8_t>(word_ >> (8 * i));
        to_ += filled_ / 8;
        word_ >>= filled_ & ~7U;
        filled_ &= 7U;
    }
    void align() {
        filled_ = (filled_ + 7U) & ~7U;
        flush();
    }
    [[nodiscard]] std::size_t size() const {
        return static_cast<std::size_t>(to_ - begin_);
    }

  private:
    std::uint8_t* begin_;
    std::uint8_t* to_;
    std::uint64_t word_ = 0;
    unsigned filled_ = 0;
};

/// The header of a block with dynamic codes. Its code lengths are themselves coded, by a
/// fixed code: three bits for 0, 7 and 8, four for the rest of 0 ... 12, which is
/// complete.
void put_block_header(const Lengths& lengths, BitWriter& writer) {
    constexpr std::array<std::uint8_t, 18> kOrder = {16, 17, 18, 0,  8, 7,  9, 6,  10,
                                                     5,  11, 4,  12, 3, 13, 2, 14, 1};
    constexpr unsigned kLastBlock = 0;
    constexpr unsigned kDynamic = 2;
    std::array<std::uint8_t, 19> code_lengths = {};
    for (std::size_t bits = 0; bits <= kMaxCodeBits; ++bits)
        code_lengths[bits] = bits == 0 || bits == 7 || bits == 8 ? 3 : 4;
    const auto codes = canonical_codes(code_lengths);

    writer.put(kLastBlock, 1);
    writer.put(kDynamic, 2);
    writer.put(kSymbols - 257, 5);
    writer.put(0, 5);  // one distance code
    writer.put(kOrder.size() - 4, 4);
    writer.flush();
    for (const std::uint8_t symbol : kOrder) {
        writer.put(code_lengths[symbol], 3);
        writer.flush();
    }
    for (const std::uint8_t length : lengths) {
        writer.put(codes[length]);
        writer.flush();
    }
    writer.put(codes[1]);  // distance 1, the only one, takes one bit: 0
    writer.flush();
}

}  // namespace

void append_huffman_deflate(std::span<const std::uint8_t> bytes,
                            std::vector<std::uint8_t>& out) {
    constexpr std::size_t kHeaderRoom = 512;
    const std::size_t before = out.size();
    out.resize(before + bytes.size() * kMaxCodeBits / 8 + kHeaderRoom);
    BitWriter writer(out.data() + before);

    const Lengths lengths = limited_lengths(count_symbols(bytes));
    const Codes codes = canonical_codes(lengths);
    put_block_header(lengths, writer);
    unsigned pending = 0;
    tokenise(
        bytes,
        [&](std::uint8_t byte) {
            writer.put(codes[byte]);
            if (++pending % 4 == 0) writer.flush();
        },
        [&](std::size_t length) {
            const MatchCode& match = kMatchCodes[length];
            writer.flush();
            writer.put(codes[match.symbol]);
            writer.put(match.extra, match.extra_bits);
            writer.put(0, 1);  // distance 1
            writer.flush();
            pending = 0;
        });
    writer.flush();
    writer.put(codes[kEndOfBlock]);
    // An empty stored block: header 000, to the byte boundary, length 0 and its
    // complement.
    writer.put(0, 3);
    writer.align();
    writer.put(0xFFFF0000U, 32);
    writer.flush();
    out.resize(before + writer.size());
}

}  // namespace sateen::io
