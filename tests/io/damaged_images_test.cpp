// SPDX-License-Identifier: Apache-2.0
// A truncated image gives an error, never part of an image; an altered one never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "io/files.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen {
namespace {

using test::encoded;
using test::FileBytes;
using test::random_image;

struct Case {
    const char* name;
    const char* extension;
    int bits;
    std::size_t bands;
};

/// A Radiance picture of 16 x 12, run-length encoded.
FileBytes radiance() {
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 12 +X 16\n";
    FileBytes bytes(header.begin(), header.end());
    for (std::uint8_t line = 0; line < 12; ++line) {
        bytes.insert(bytes.end(), {2, 2, 0, 16});
        for (std::uint8_t k = 0; k < 4; ++k) {
            bytes.insert(bytes.end(),
                         {128 + 10, static_cast<std::uint8_t>(line + 100), 6});
            for (std::uint8_t i = 0; i < 6; ++i)
                bytes.push_back(static_cast<std::uint8_t>(120 + i));
        }
    }
    return bytes;
}

FileBytes make(const Case& param) {
    if (std::string(param.extension) == ".hdr") return radiance();
    return encoded(param.extension, random_image(param.bands, 21, 17),
                   {.bits = param.bits});
}

class Damaged : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Formats, Damaged,
    testing::Values(Case{"jpeg", ".jpg", 8, 3}, Case{"greyjpeg", ".jpg", 8, 1},
                    Case{"png8", ".png", 8, 3}, Case{"png16", ".png", 16, 1},
                    Case{"tiff8", ".tif", 8, 3}, Case{"tiff16", ".tif", 16, 1},
                    Case{"tiff32", ".tif", 32, 3}, Case{"exrhalf", ".exr", 16, 3},
                    Case{"exrfloat", ".exr", 32, 1}, Case{"radiance", ".hdr", 32, 3}),
    [](const auto& instance) { return instance.param.name; });

TEST_P(Damaged, TheWholeFileIsFine) {
    const auto image = decode_image(make(GetParam()), "test");
    EXPECT_TRUE(image) << image.error().message;
}

TEST_P(Damaged, EveryPrefixIsAnErrorOfOneLine) {
    const FileBytes whole = make(GetParam());
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const FileBytes prefix(whole.begin(),
                               whole.begin() + static_cast<std::ptrdiff_t>(size));
        const auto image = decode_image(prefix, "test.file");
        ASSERT_FALSE(image) << size << " of " << whole.size();
        EXPECT_THAT(image.error().message, testing::StartsWith("test.file: "));
        EXPECT_THAT(image.error().message, testing::Not(testing::HasSubstr("\n")));
        static_cast<void>(decode_image_header(prefix, "test.file"));
    }
}

TEST_P(Damaged, AlteredBytesNeverCrash) {
    const FileBytes whole = make(GetParam());
    std::mt19937 generator(7);
    for (int trial = 0; trial < 600; ++trial) {
        FileBytes altered = whole;
        const std::size_t changes = 1 + generator() % 4;
        for (std::size_t i = 0; i < changes; ++i) {
            // Half of the changes hit the header.
            const std::size_t range = trial % 2 == 0
                                          ? altered.size()
                                          : std::min<std::size_t>(400, altered.size());
            altered[generator() % range] = static_cast<std::uint8_t>(generator());
        }
        static_cast<void>(decode_image(altered, "test"));
    }
}

TEST(JpegFile, BytesAfterTheEndAreIgnored) {
    FileBytes bytes = encoded(".jpg", random_image(3, 20, 20));
    bytes.insert(bytes.end(), {1, 2, 3, 4, 5});
    EXPECT_TRUE(decode_image(bytes, "test"));
}

TEST(JpegFile, ExtraneousBytesBetweenMarkersAreHarmless) {
    FileBytes bytes = encoded(".jpg", random_image(3, 20, 20));
    // After the start marker and the JFIF segment of 18 bytes.
    bytes.insert(bytes.begin() + 20, {0, 0, 0});
    const auto image = decode_image(bytes, "test");
    EXPECT_TRUE(image) << image.error().message;
}

TEST(ImageLimits, HugeSizesAreRefusedBeforeAllocation) {
    const auto png_of_size = [](std::uint32_t cols, std::uint32_t rows) {
        FileBytes bytes = encoded(".png", random_image(3, 4, 4));
        for (std::size_t i = 0; i < 4; ++i) {
            bytes[16 + i] = static_cast<std::uint8_t>(cols >> (24 - 8 * i));
            bytes[20 + i] = static_cast<std::uint8_t>(rows >> (24 - 8 * i));
        }
        return bytes;
    };
    // The changed header fails its checksum, unless libpng looks at it later: either way
    // an error, and no memory.
    EXPECT_FALSE(decode_image(png_of_size(40000, 10), "test"));
    EXPECT_FALSE(decode_image(png_of_size(32768, 32768), "test"));
    EXPECT_FALSE(decode_image(png_of_size(30000, 17000), "test"));

    const std::string large = "#?RADIANCE\n\n-Y 32769 +X 10\n";
    const auto side = decode_image(FileBytes(large.begin(), large.end()), "test");
    ASSERT_FALSE(side);
    EXPECT_EQ(side.error().code, Errc::limit_exceeded);
    const std::string area = "#?RADIANCE\n\n-Y 32768 +X 32768\n";
    const auto pixels = decode_image(FileBytes(area.begin(), area.end()), "test");
    ASSERT_FALSE(pixels);
    EXPECT_EQ(pixels.error().code, Errc::limit_exceeded);
    const std::string bomb = "#?RADIANCE\n\n-Y 20000 +X 20000\n";
    const auto short_file = decode_image(FileBytes(bomb.begin(), bomb.end()), "test");
    ASSERT_FALSE(short_file);
    EXPECT_THAT(short_file.error().message, testing::HasSubstr("cannot hold"));
}

}  // namespace
}  // namespace sateen
