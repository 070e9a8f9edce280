// SPDX-License-Identifier: Apache-2.0
// The memory that hostile files can make the reader take: a program of its own, because
// it counts every allocation.
#define ZLIB_CONST
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "sateen/io/material_file.hpp"
#include "sateen/material/file.hpp"
#include "support/random_material.hpp"

namespace {

std::atomic<std::size_t> live_bytes = 0;
std::atomic<std::size_t> peak_bytes = 0;
constexpr std::size_t kHeader = alignof(std::max_align_t);

}  // namespace

// Each block is preceded by its size.
void* operator new(std::size_t size) {
    void* block = std::malloc(size + kHeader);
    if (block == nullptr) std::abort();
    *static_cast<std::size_t*>(block) = size;
    peak_bytes = std::max<std::size_t>(peak_bytes, live_bytes += size);
    return static_cast<char*>(block) + kHeader;
}
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
    return operator new(size);
}
void operator delete(void* pointer) noexcept {
    if (pointer == nullptr) return;
    void* block = static_cast<char*>(pointer) - kHeader;
    live_bytes -= *static_cast<std::size_t*>(block);
    std::free(block);
}
void operator delete(void* pointer, std::size_t /*size*/) noexcept {
    operator delete(pointer);
}

namespace sateen {
namespace {

constexpr std::size_t kLimit = std::size_t{64} << 20U;

// The file itself, which the caller holds, counts as well.
std::size_t peak_of_unpacking(const std::vector<std::uint8_t>& file) {
    const std::size_t before = live_bytes - file.size();
    peak_bytes = live_bytes.load();
    (void)unpack_material(file).has_value();
    return peak_bytes - before;
}

std::vector<std::uint8_t> gzip(const std::vector<std::uint8_t>& bytes, int level) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, level, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
    std::vector<std::uint8_t> out(deflateBound(&stream, bytes.size()));
    stream.next_in = bytes.data();
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

TEST(MaterialMemory, StaysBelow64MbForTheLargestMaterialAndForBombs) {
    const auto largest = pack_material(test::random_material({.subspaces = kMaxSubspaces,
                                                              .levels = kMaxLevels,
                                                              .order = kMaxOrder,
                                                              .views = 1024,
                                                              .lights = 1024}));
    ASSERT_TRUE(largest);
    EXPECT_LT(peak_of_unpacking(*largest), kLimit);
    EXPECT_LT(peak_of_unpacking(gzip(std::vector<std::uint8_t>(64U << 20U), 1)), kLimit);
    EXPECT_LT(peak_of_unpacking(gzip(std::vector<std::uint8_t>(kMaxPayloadBytes), 0)),
              kLimit);
}

TEST(MaterialMemory, IsInProportionToASmallFile) {
    const auto small = pack_material(test::random_material());
    ASSERT_TRUE(small);
    EXPECT_LT(peak_of_unpacking(*small), std::size_t{64} << 10U);
}

}  // namespace
}  // namespace sateen
