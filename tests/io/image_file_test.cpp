// SPDX-License-Identifier: Apache-2.0
// Files written here and read back; files of others are in foreign_images_test.cpp.
#include "sateen/io/image_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/files.hpp"
#include "sateen/io/executor.hpp"

namespace sateen {
namespace {

using test::encoded;
using test::FileBytes;
using test::largest_difference;
using test::random_image;
using test::TemporaryFolder;

Image decoded(const FileBytes& bytes, Encoding encoding = Encoding::automatic) {
    auto image = decode_image(bytes, "test", encoding);
    EXPECT_TRUE(image) << image.error().message;
    return image ? *image : Image();
}

struct Case {
    const char* extension;
    int bits;
    /// Half a step where sRGB is steepest: its derivative at 1 is 1/2.27.
    float tolerance;
    const char* format;
};

constexpr float k8Bits = 0.5F / 255 * 2.28F;
constexpr float k16Bits = 0.5F / 65535 * 2.28F;
constexpr float kHalf = 0.5F / 1024;

class RoundTrip : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Formats, RoundTrip,
    testing::Values(Case{".png", 8, k8Bits, "PNG"}, Case{".png", 16, k16Bits, "PNG"},
                    Case{".tif", 8, k8Bits, "TIFF"}, Case{".tiff", 16, k16Bits, "TIFF"},
                    Case{".tif", 32, 0, "TIFF"}, Case{".exr", 16, kHalf, "OpenEXR"},
                    Case{".exr", 32, 0, "OpenEXR"}));

TEST_P(RoundTrip, KeepsValuesToHalfAStep) {
    const Case& param = GetParam();
    for (const std::size_t bands : {1U, 3U}) {
        for (const auto& [rows, cols] :
             {std::pair(1U, 1U), std::pair(3U, 117U), std::pair(131U, 64U)}) {
            const Image image = random_image(bands, rows, cols);
            const FileBytes bytes = encoded(param.extension, image, {.bits = param.bits});
            EXPECT_LE(largest_difference(decoded(bytes), image), param.tolerance);
        }
    }
}

TEST_P(RoundTrip, HeaderTellsSizeWithoutDecoding) {
    const Case& param = GetParam();
    FileBytes bytes =
        encoded(param.extension, random_image(3, 40, 50), {.bits = param.bits});
    const auto header = decode_image_header(bytes, "test");
    ASSERT_TRUE(header) << header.error().message;
    EXPECT_EQ(header->rows, 40U);
    EXPECT_EQ(header->cols, 50U);
    EXPECT_EQ(header->bands, 3U);
    EXPECT_EQ(header->bits, param.bits);
    EXPECT_EQ(header->format, param.format);
}

TEST_P(RoundTrip, EveryEncodingIsUndone) {
    const Case& param = GetParam();
    const Image image = random_image(3, 20, 30);
    for (const Encoding encoding :
         {Encoding::srgb, Encoding::gamma22, Encoding::linear}) {
        const FileBytes bytes =
            encoded(param.extension, image, {.bits = param.bits, .encoding = encoding});
        // Encoding a float and undoing it rounds twice.
        EXPECT_LE(largest_difference(decoded(bytes, encoding), image),
                  param.tolerance * 2.3F + 1e-6F);
    }
}

TEST_P(RoundTrip, StripsMakeTheSameFileAsTheWhole) {
    const Case& param = GetParam();
    const Image image = random_image(3, 57, 33);
    const TemporaryFolder folder;
    const std::string path = folder.file(std::string("image") + param.extension);
    auto writer = ImageWriter::open(path, 3, 57, 33, {.bits = param.bits});
    ASSERT_TRUE(writer) << writer.error().message;
    for (std::size_t row = 0, height = 1; row < 57; row += height, height += 3) {
        height = std::min(height, 57 - row);
        Image strip(3, height, 33);
        for (std::size_t band = 0; band < 3; ++band)
            std::copy_n(image.plane(band).row(row), height * 33, strip.plane(band).data);
        const auto written = (*writer)->write_rows(std::as_const(strip).view());
        ASSERT_TRUE(written) << written.error().message;
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    ASSERT_TRUE((*writer)->finish());
    EXPECT_EQ(test::bytes_of(path),
              encoded(param.extension, image, {.bits = param.bits}));
}

TEST_P(RoundTrip, AnUnfinishedImageLeavesNothingBehind) {
    const Case& param = GetParam();
    const TemporaryFolder folder;
    const std::string path = folder.file(std::string("image") + param.extension);
    const Image image = random_image(3, 10, 10);
    {
        auto writer = ImageWriter::open(path, 3, 20, 10, {.bits = param.bits});
        ASSERT_TRUE(writer);
        ASSERT_TRUE((*writer)->write_rows(image.view()));
        const auto finished = (*writer)->finish();
        ASSERT_FALSE(finished);
        EXPECT_THAT(finished.error().message, testing::HasSubstr("expected 20"));
    }
    EXPECT_EQ(folder.count(), 0U);
}

TEST_P(RoundTrip, AFullDiskIsAnError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
    const Case& param = GetParam();
    const TemporaryFolder folder;
    const std::string path = folder.file(std::string("full") + param.extension);
    std::filesystem::create_symlink("/dev/full", path);
    const auto written =
        write_image(path, random_image(3, 300, 300).view(), {.bits = param.bits});
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Errc::io);
    EXPECT_THAT(written.error().message, testing::HasSubstr(path));
}

TEST(JpegFile, KeepsSmoothImagesClosely) {
    for (const std::size_t bands : {1U, 3U}) {
        Image image(bands, 70, 90);
        for (std::size_t band = 0; band < bands; ++band)
            for (std::size_t r = 0; r < 70; ++r)
                for (std::size_t c = 0; c < 90; ++c)
                    image(band, r, c) = 0.2F +
                                        0.005F * static_cast<float>(r + band * 10) +
                                        0.003F * static_cast<float>(c);
        const FileBytes bytes = encoded(".jpg", image);
        EXPECT_LT(largest_difference(decoded(bytes), image), 0.03F);
        const auto header = decode_image_header(bytes, "test");
        ASSERT_TRUE(header);
        EXPECT_EQ(header->format, "JPEG");
        EXPECT_EQ(header->bands, bands);
    }
}

TEST(PngFile, IsTheSameForAnyNumberOfThreads) {
    const Image image = random_image(3, 700, 300);
    for (const int level : {0, 1, 2, 6, 9}) {
        const FileBytes serial = encoded(".png", image, {.png_compression = level});
        EXPECT_LE(largest_difference(decoded(serial), image), k8Bits);
        for (const std::size_t threads : {2U, 3U}) {
            const auto executor = make_executor(threads);
            EXPECT_EQ(encoded(".png", image,
                              {.png_compression = level, .executor = executor.get()}),
                      serial);
        }
    }
}

TEST(PngFile, FlatImagesAreSmall) {
    // 3 bytes a pixel in runs of 258 coded in two bits each, and tables.
    EXPECT_LT(encoded(".png", Image(3, 1000, 1000)).size(), 15000U);
}

TEST(ExrFile, HalfsThatOverflowAreTheLargestHalf) {
    Image image(1, 1, 2);
    image(0, 0, 0) = 1e6F;
    image(0, 0, 1) = -1e6F;
    const Image back = decoded(encoded(".exr", image, {.bits = 16}));
    EXPECT_EQ(back(0, 0, 0), 65504.0F);
    EXPECT_EQ(back(0, 0, 1), -65504.0F);
}

TEST(ImageWriter, RefusesWhatAFormatCannotHold) {
    const TemporaryFolder folder;
    const auto error = [&](const std::string& name, std::size_t bands, std::size_t rows,
                           std::size_t cols, const WriteOptions& options) {
        const auto writer =
            ImageWriter::open(folder.file(name), bands, rows, cols, options);
        EXPECT_FALSE(writer);
        EXPECT_EQ(folder.count(), 0U);
        return writer ? std::string() : writer.error().message;
    };
    EXPECT_THAT(error("a.bmp", 3, 5, 5, {}), testing::HasSubstr("expected .png"));
    EXPECT_THAT(error("a", 3, 5, 5, {}), testing::HasSubstr("expected .png"));
    EXPECT_THAT(error("a.jpg", 3, 5, 5, {.bits = 16}), testing::HasSubstr("8 bits"));
    EXPECT_THAT(error("a.png", 3, 5, 5, {.bits = 32}), testing::HasSubstr("8 or 16"));
    EXPECT_THAT(error("a.exr", 3, 5, 5, {.bits = 12}), testing::HasSubstr("16 (half)"));
    EXPECT_THAT(error("a.tif", 3, 5, 5, {.bits = 12}), testing::HasSubstr("8, 16"));
    EXPECT_THAT(error("a.jpg", 3, 5, 70000, {}), testing::HasSubstr("65500"));
    EXPECT_THAT(error("a.png", 2, 5, 5, {}), testing::HasSubstr("1 or 3 bands"));
    EXPECT_THAT(error("a.png", 3, 0, 5, {}), testing::HasSubstr("at least one pixel"));
    EXPECT_THAT(error("a.png", 3, 5, 5, {.png_compression = 10}),
                testing::HasSubstr("0 to 9"));
    EXPECT_THAT(error("a.jpg", 3, 5, 5, {.jpeg_quality = 0}),
                testing::HasSubstr("1 to 100"));
    EXPECT_FALSE(ImageWriter::open(folder.path() + "/none/a.png", 3, 5, 5, {}));
}

TEST(ImageWriter, RefusesStripsOfAnotherShape) {
    const TemporaryFolder folder;
    auto writer = ImageWriter::open(folder.file("a.png"), 3, 4, 5, {});
    ASSERT_TRUE(writer);
    EXPECT_FALSE((*writer)->write_rows(random_image(1, 2, 5).view()));
    EXPECT_FALSE((*writer)->write_rows(random_image(3, 2, 6).view()));
    EXPECT_FALSE((*writer)->write_rows(random_image(3, 5, 5).view()));
    EXPECT_TRUE((*writer)->write_rows(random_image(3, 4, 5).view()));
    EXPECT_TRUE((*writer)->finish());
}

TEST(ReadImage, NamesTheFile) {
    const TemporaryFolder folder;
    const auto missing = read_image(folder.file("none.png"));
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().message, testing::HasSubstr("none.png: does not exist"));
    test::put(folder.file("text.png"), "hello");
    const auto text = read_image(folder.file("text.png"));
    ASSERT_FALSE(text);
    EXPECT_THAT(text.error().message,
                testing::HasSubstr("text.png: is not an image: found first bytes 68 65"));
    test::put(folder.file("empty.png"), "");
    const auto empty = read_image_header(folder.file("empty.png"));
    ASSERT_FALSE(empty);
    EXPECT_THAT(empty.error().message, testing::HasSubstr("found no bytes at all"));
}

}  // namespace
}  // namespace sateen
