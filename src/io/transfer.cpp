// SPDX-License-Identifier: Apache-2.0
// Transfer curves by table. See transfer.hpp.
#include "io/transfer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace sateen::io {
namespace {

// sRGB, IEC 61966-2-1:
//     v = c / 12.92                     for c <= 0.04045
//     v = ((c + 0.055) / 1.055)^2.4     otherwise
double srgb_to_linear(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double linear_to_srgb(double v) {
    return v <= 0.04045 / 12.92 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

double to_linear(Encoding encoding, double c) {
    switch (encoding) {
        case Encoding::linear:
            return c;
        case Encoding::gamma22:
            return std::pow(c, 2.2);
        case Encoding::srgb:
        case Encoding::automatic:
            break;
    }
    return srgb_to_linear(c);
}

double from_linear(Encoding encoding, double v) {
    switch (encoding) {
        case Encoding::linear:
            return v;
        case Encoding::gamma22:
            return std::pow(v, 1 / 2.2);
        case Encoding::srgb:
        case Encoding::automatic:
            break;
    }
    return linear_to_srgb(v);
}

template <std::size_t kCodes>
std::vector<float> make_decode_table(Encoding encoding) {
    std::vector<float> table(kCodes);
    for (std::size_t code = 0; code < kCodes; ++code)
        table[code] = static_cast<float>(
            to_linear(encoding, static_cast<double>(code) / (kCodes - 1)));
    return table;
}

template <std::size_t kCodes>
std::span<const float> decode_table(Encoding encoding) {
    switch (encoding) {
        case Encoding::linear: {
            static const std::vector<float> table =
                make_decode_table<kCodes>(Encoding::linear);
            return table;
        }
        case Encoding::gamma22: {
            static const std::vector<float> table =
                make_decode_table<kCodes>(Encoding::gamma22);
            return table;
        }
        case Encoding::srgb:
        case Encoding::automatic:
            break;
    }
    static const std::vector<float> table = make_decode_table<kCodes>(Encoding::srgb);
    return table;
}

/// The smallest float whose code is `code`: encode(v) (kCodes - 1) >= code - 1/2.
float threshold(Encoding encoding, std::size_t code, std::size_t codes) {
    const double exact = to_linear(
        encoding, (static_cast<double>(code) - 0.5) / static_cast<double>(codes - 1));
    const auto nearest = static_cast<float>(exact);
    if (static_cast<double>(nearest) >= exact) return nearest;
    return std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

// Clamps to [low, 1); NaN gives low, since every comparison with it is false.
constexpr float kBelowOne = 0x1.fffffep-1F;
inline float clamp(float v, float low) {
    v = v > low ? v : low;
    return v < kBelowOne ? v : kBelowOne;
}

// Floats with the same sign, exponent and seven leading mantissa bits form a bucket, at
// most 1/128 wide relative to its values. The thresholds of 8-bit sRGB and gamma 2.2 lie
// further apart than that everywhere (2.2/255 = 1/116 at the top), so a bucket holds at
// most one, and with m the 16 low mantissa bits of v and m_t those of the threshold,
//
//     code(v) = base + [m >= m_t] = (2^16 base + 2^16 - m_t + m) >> 16.
//
// The table holds everything but m; m_t = 2^16 where there is no threshold.
constexpr unsigned kBucketShift = 16;
constexpr std::uint32_t kBucketMask = (1U << kBucketShift) - 1;
// Both curves give code 0 below: (0.5/255)^2.2 = 1.1e-6 > 2^-20 = 0.95e-6.
constexpr float kLowest = 0x1p-20F;
constexpr std::uint32_t kFirstBucket =
    std::bit_cast<std::uint32_t>(kLowest) >> kBucketShift;
constexpr std::uint32_t kLastBucket =
    std::bit_cast<std::uint32_t>(kBelowOne) >> kBucketShift;

// Clamping a block before looking it up lets the compiler vectorise the one and keeps
// branches out of the other. Two loops: merged, the comparisons become masks, not minima.
constexpr std::size_t kClampBlock = 64;
using ClampedBits = std::array<std::uint32_t, kClampBlock>;

inline ClampedBits clamped_bits(const float* in, std::size_t count) {
    std::array<float, kClampBlock> v;
    if (count == kClampBlock) {
        for (std::size_t i = 0; i < kClampBlock; ++i)
            v[i] = in[i] > kLowest ? in[i] : kLowest;
    } else {
        v.fill(kLowest);
        for (std::size_t i = 0; i < count; ++i) v[i] = in[i] > kLowest ? in[i] : kLowest;
    }
    for (float& x : v) x = x < kBelowOne ? x : kBelowOne;
    return std::bit_cast<ClampedBits>(v);
}

using BucketTable = std::array<std::uint32_t, kLastBucket - kFirstBucket + 1>;

BucketTable make_bucket_table(Encoding encoding) {
    BucketTable table;
    std::uint32_t code = 0;
    std::uint32_t next = std::bit_cast<std::uint32_t>(threshold(encoding, 1, 256));
    for (std::uint32_t i = 0; i < table.size(); ++i) {
        const std::uint32_t base = code;
        std::uint32_t m_t = kBucketMask + 1;
        if (code < 255 && next >> kBucketShift == kFirstBucket + i) {
            m_t = next & kBucketMask;
            ++code;
            next = std::bit_cast<std::uint32_t>(threshold(encoding, code + 1, 256));
        }
        table[i] = (base << kBucketShift) + (kBucketMask + 1 - m_t);
    }
    return table;
}

const BucketTable& bucket_table(Encoding encoding) {
    if (encoding == Encoding::gamma22) {
        static const BucketTable table = make_bucket_table(Encoding::gamma22);
        return table;
    }
    static const BucketTable table = make_bucket_table(Encoding::srgb);
    return table;
}

// 16 bits have too many thresholds for buckets: a chord over each bucket is within one
// code of the curve, and comparing with the thresholds of the code found corrects it.
struct ChordTable {
    struct Chord {
        float offset;
        float slope;
    };
    std::array<Chord, kLastBucket - kFirstBucket + 1> chords;
    std::vector<float> thresholds;  ///< of codes 0 … 65536
};

ChordTable make_chord_table(Encoding encoding) {
    ChordTable table;
    for (std::uint32_t i = 0; i < table.chords.size(); ++i) {
        const double v0 =
            static_cast<double>(std::bit_cast<float>((kFirstBucket + i) << kBucketShift));
        const double v1 = static_cast<double>(
            std::bit_cast<float>((kFirstBucket + i + 1) << kBucketShift));
        const double c0 = 65535 * from_linear(encoding, v0);
        const double c1 = 65535 * from_linear(encoding, v1);
        const double slope = (c1 - c0) / (v1 - v0);
        table.chords[i] = {static_cast<float>(c0 - slope * v0),
                           static_cast<float>(slope)};
    }
    table.thresholds.resize(65537);
    table.thresholds.front() = 0;
    for (std::size_t code = 1; code < 65536; ++code)
        table.thresholds[code] = threshold(encoding, code, 65536);
    table.thresholds.back() = std::numeric_limits<float>::infinity();
    return table;
}

const ChordTable& chord_table(Encoding encoding) {
    if (encoding == Encoding::gamma22) {
        static const ChordTable table = make_chord_table(Encoding::gamma22);
        return table;
    }
    static const ChordTable table = make_chord_table(Encoding::srgb);
    return table;
}

template <class Code>
void encode_linear(const float* in, std::size_t count, std::size_t step, Code* out) {
    constexpr auto kScale = static_cast<double>(std::numeric_limits<Code>::max());
    for (std::size_t i = 0; i < count; ++i) {
        const float positive = in[i] > 0.0F ? in[i] : 0.0F;
        const auto v = static_cast<double>(positive < 1.0F ? positive : 1.0F);
        out[i * step] = static_cast<Code>(static_cast<std::int32_t>(v * kScale + 0.5));
    }
}

template <class Code>
void decode_codes(const Code* codes, std::size_t channels, std::span<const float> table,
                  std::size_t row, ImageView<float> out) {
    const float* const values = table.data();
    if (out.bands == 3 && channels == 3) {
        float* const red = out.plane(0).row(row);
        float* const green = out.plane(1).row(row);
        float* const blue = out.plane(2).row(row);
        for (std::size_t c = 0; c < out.cols; ++c) {
            red[c] = values[codes[3 * c]];
            green[c] = values[codes[3 * c + 1]];
            blue[c] = values[codes[3 * c + 2]];
        }
        return;
    }
    for (std::size_t band = 0; band < out.bands; ++band) {
        float* const plane = out.plane(band).row(row);
        for (std::size_t c = 0; c < out.cols; ++c)
            plane[c] = values[codes[channels * c + band]];
    }
}

}  // namespace

std::span<const float> decode_table8(Encoding encoding) {
    return decode_table<256>(encoding);
}
std::span<const float> decode_table16(Encoding encoding) {
    return decode_table<65536>(encoding);
}

void decode_row(const std::uint8_t* codes, std::size_t channels,
                std::span<const float> table, std::size_t row, ImageView<float> out) {
    decode_codes(codes, channels, table, row, out);
}
void decode_row(const std::uint16_t* codes, std::size_t channels,
                std::span<const float> table, std::size_t row, ImageView<float> out) {
    decode_codes(codes, channels, table, row, out);
}

void linearise(std::span<float> values, Encoding encoding) {
    if (encoding == Encoding::automatic || encoding == Encoding::linear) return;
    for (float& v : values)
        v = static_cast<float>(
            to_linear(encoding, std::max(0.0, static_cast<double>(v))));
}

void delinearise(std::span<float> values, Encoding encoding) {
    if (encoding == Encoding::automatic || encoding == Encoding::linear) return;
    for (float& v : values)
        v = static_cast<float>(
            from_linear(encoding, std::max(0.0, static_cast<double>(v))));
}

void encode_row(const float* in, std::size_t count, std::size_t step, Encoding encoding,
                std::uint8_t* out) {
    if (encoding == Encoding::linear) {
        encode_linear(in, count, step, out);
        return;
    }
    const std::uint32_t* const table = bucket_table(encoding).data();
    for (std::size_t first = 0; first < count; first += kClampBlock) {
        const std::size_t size = std::min(kClampBlock, count - first);
        const ClampedBits bits = clamped_bits(in + first, size);
        std::uint8_t* const codes = out + first * step;
        for (std::size_t i = 0; i < size; ++i) {
            const std::uint32_t entry = table[(bits[i] >> kBucketShift) - kFirstBucket];
            codes[i * step] = static_cast<std::uint8_t>(
                (entry + (bits[i] & kBucketMask)) >> kBucketShift);
        }
    }
}

void encode_row(const float* in, std::size_t count, std::size_t step, Encoding encoding,
                std::uint16_t* out) {
    if (encoding == Encoding::linear) {
        encode_linear(in, count, step, out);
        return;
    }
    const ChordTable& table = chord_table(encoding);
    const float* const thresholds = table.thresholds.data();
    for (std::size_t i = 0; i < count; ++i) {
        // Not clamped at the low end of the table: chord 0 would be a code too high
        // there.
        const float v = clamp(in[i], 0.0F);
        const auto bits = std::bit_cast<std::uint32_t>(std::max(v, kLowest));
        const auto& chord = table.chords[(bits >> kBucketShift) - kFirstBucket];
        auto code = static_cast<std::uint32_t>(
            std::clamp(chord.offset + chord.slope * v + 0.5F, 0.0F, 65535.0F));
        while (v < thresholds[code]) --code;
        while (v >= thresholds[code + 1]) ++code;
        out[i * step] = static_cast<std::uint16_t>(code);
    }
}

}  // namespace sateen::io
