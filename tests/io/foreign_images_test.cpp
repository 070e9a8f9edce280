// SPDX-License-Identifier: Apache-2.0
// Images that only other programs write, made here by the format's own library or by
// hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>

#include <array>
#include <cstdio>
// jpeglib.h needs FILE.
#include <jpeglib.h>

#include "io/files.hpp"
#include "io/transfer.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen {
namespace {

using test::FileBytes;
using test::TemporaryFolder;

float linear8(std::size_t code) {
    return io::decode_table8(Encoding::srgb)[code];
}
float linear16(std::size_t code) {
    return io::decode_table16(Encoding::srgb)[code];
}

// --- PNG ------------------------------------------------------------------------------

struct PngKind {
    int colour = PNG_COLOR_TYPE_RGB;
    int depth = 8;
    int interlace = PNG_INTERLACE_NONE;
};

void append(png_structp png, png_bytep data, std::size_t count) {
    auto* const bytes = static_cast<FileBytes*>(png_get_io_ptr(png));
    bytes->insert(bytes->end(), data, data + count);
}

FileBytes make_png(const PngKind& kind, std::uint32_t rows, std::uint32_t cols,
                   std::vector<FileBytes> lines) {
    FileBytes bytes;
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &bytes, append, nullptr);
    png_set_IHDR(png, info, cols, rows, kind.depth, kind.colour, kind.interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_gAMA(png, info, 1.0);
    const std::array<png_color, 4> palette = {
        {{10, 20, 30}, {40, 50, 60}, {70, 80, 90}, {100, 110, 120}}};
    if (kind.colour == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    std::vector<png_bytep> pointers;
    for (FileBytes& line : lines) pointers.push_back(line.data());
    png_set_rows(png, info, pointers.data());
    png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

Image decoded(const FileBytes& bytes) {
    auto image = decode_image(bytes, "test");
    EXPECT_TRUE(image) << image.error().message;
    return image ? *image : Image(3, 1, 1);
}

TEST(ForeignPng, AlphaAndGammaAreIgnored) {
    const Image rgba = decoded(
        make_png({PNG_COLOR_TYPE_RGBA}, 1, 2, {{10, 20, 30, 0, 40, 50, 60, 255}}));
    ASSERT_EQ(rgba.bands(), 3U);
    EXPECT_EQ(rgba(0, 0, 0), linear8(10));
    EXPECT_EQ(rgba(2, 0, 1), linear8(60));
    const Image grey =
        decoded(make_png({PNG_COLOR_TYPE_GRAY_ALPHA}, 1, 2, {{10, 0, 20, 255}}));
    ASSERT_EQ(grey.bands(), 1U);
    EXPECT_EQ(grey(0, 0, 1), linear8(20));
}

TEST(ForeignPng, SmallDepthsSpanTheWholeRange) {
    const Image one = decoded(make_png({PNG_COLOR_TYPE_GRAY, 1}, 1, 4, {{0b01100000}}));
    EXPECT_THAT(one.values(), testing::ElementsAre(0.0F, 1.0F, 1.0F, 0.0F));
    const Image two = decoded(make_png({PNG_COLOR_TYPE_GRAY, 2}, 1, 4, {{0b00011011}}));
    EXPECT_THAT(two.values(),
                testing::ElementsAre(0.0F, linear8(85), linear8(170), 1.0F));
    const Image four = decoded(make_png({PNG_COLOR_TYPE_GRAY, 4}, 1, 2, {{0x3F}}));
    EXPECT_THAT(four.values(), testing::ElementsAre(linear8(51), 1.0F));
}

TEST(ForeignPng, PalettesAreLookedUp) {
    const Image image =
        decoded(make_png({PNG_COLOR_TYPE_PALETTE, 2}, 1, 4, {{0b00011011}}));
    ASSERT_EQ(image.bands(), 3U);
    EXPECT_EQ(image(0, 0, 1), linear8(40));
    EXPECT_EQ(image(2, 0, 3), linear8(120));
}

TEST(ForeignPng, InterlacedIsTheSameAsNot) {
    std::vector<FileBytes> lines(13, FileBytes(11 * 8));
    std::uint8_t value = 0;
    for (FileBytes& line : lines)
        for (std::uint8_t& byte : line)
            byte = value = static_cast<std::uint8_t>(value * 5 + 7);
    for (const int colour :
         {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGBA}) {
        for (const int depth : {8, 16}) {
            const Image plain = decoded(make_png({colour, depth}, 13, 11, lines));
            const Image interlaced =
                decoded(make_png({colour, depth, PNG_INTERLACE_ADAM7}, 13, 11, lines));
            EXPECT_EQ(test::largest_difference(plain, interlaced), 0);
        }
    }
}

// --- JPEG -----------------------------------------------------------------------------

FileBytes make_jpeg(J_COLOR_SPACE space, int components, bool progressive) {
    jpeg_compress_struct info = {};
    jpeg_error_mgr errors;
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &memory, &size);
    info.image_width = 40;
    info.image_height = 30;
    info.input_components = components;
    info.in_color_space = space;
    jpeg_set_defaults(&info);
    if (progressive) jpeg_simple_progression(&info);
    jpeg_start_compress(&info, TRUE);
    std::vector<JSAMPLE> row(40U * 4U, 128);
    JSAMPROW pointer = row.data();
    while (info.next_scanline < 30) jpeg_write_scanlines(&info, &pointer, 1);
    jpeg_finish_compress(&info);
    FileBytes bytes(memory, memory + size);
    free(memory);
    jpeg_destroy_compress(&info);
    return bytes;
}

TEST(ForeignJpeg, CmykIsUnsupported) {
    const auto image = decode_image(make_jpeg(JCS_CMYK, 4, false), "print.jpg");
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, Errc::unsupported);
    EXPECT_THAT(image.error().message, testing::HasSubstr("CMYK"));
}

TEST(ForeignJpeg, ProgressiveIsReadButNotIfTruncated) {
    const FileBytes whole = make_jpeg(JCS_RGB, 3, true);
    EXPECT_NEAR(decoded(whole)(1, 15, 20), linear8(128), 0.01F);
    for (std::size_t size = 0; size < whole.size(); ++size)
        ASSERT_FALSE(decode_image(std::span(whole).first(size), "test")) << size;
}

// --- TIFF -----------------------------------------------------------------------------

struct TiffKind {
    int bits = 8;
    int samples = 3;
    int photometric = PHOTOMETRIC_RGB;
    int planar = PLANARCONFIG_CONTIG;
    int compression = COMPRESSION_LZW;
    bool tiled = false;
    const char* mode = "w";
};

constexpr std::uint32_t kRows = 37;
constexpr std::uint32_t kCols = 21;

std::uint16_t code_at(std::uint32_t row, std::uint32_t col, int sample, int bits) {
    const std::uint32_t code = row * 701 + col * 311 + static_cast<unsigned>(sample) * 97;
    return static_cast<std::uint16_t>(bits == 8 ? code & 255 : code & 65535);
}

FileBytes make_tiff(const TiffKind& kind) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.tif");
    TIFF* tiff = TIFFOpen(path.c_str(), kind.mode);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kRows);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kCols);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kind.photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, kind.planar);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
    std::vector<std::uint16_t> map(256);
    for (std::size_t i = 0; i < 256; ++i) map[i] = static_cast<std::uint16_t>(i * 257);
    if (kind.photometric == PHOTOMETRIC_PALETTE)
        TIFFSetField(tiff, TIFFTAG_COLORMAP, map.data(), map.data(), map.data());
    const std::uint32_t block_rows = kind.tiled ? 16 : 10;
    const std::uint32_t block_cols = kind.tiled ? 16 : kCols;
    if (kind.tiled) {
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, block_rows);
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, block_cols);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, block_rows);
    }
    const bool separate = kind.planar == PLANARCONFIG_SEPARATE;
    const int together = separate ? 1 : kind.samples;
    for (int plane = 0; plane < (separate ? kind.samples : 1); ++plane) {
        for (std::uint32_t row = 0; row < kRows; row += block_rows) {
            for (std::uint32_t col = 0; col < kCols; col += block_cols) {
                FileBytes block;
                const std::uint32_t height =
                    kind.tiled ? block_rows : std::min(block_rows, kRows - row);
                for (std::uint32_t r = 0; r < height; ++r)
                    for (std::uint32_t c = 0; c < block_cols; ++c)
                        for (int s = 0; s < together; ++s) {
                            const std::uint16_t code =
                                code_at(row + r, col + c, plane + s, kind.bits);
                            block.push_back(static_cast<std::uint8_t>(code));
                            if (kind.bits == 16)
                                block.push_back(static_cast<std::uint8_t>(code >> 8));
                        }
                const auto size = static_cast<tmsize_t>(block.size());
                const auto sample = static_cast<std::uint16_t>(plane);
                if (kind.tiled)
                    TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, col, row, 0, sample),
                                         block.data(), size);
                else
                    TIFFWriteEncodedStrip(tiff, TIFFComputeStrip(tiff, row, sample),
                                          block.data(), size);
            }
        }
    }
    TIFFClose(tiff);
    return test::bytes_of(path);
}

void expect_codes(const Image& image, int bits) {
    for (std::uint32_t row = 0; row < kRows; ++row)
        for (std::uint32_t col = 0; col < kCols; ++col)
            for (std::size_t band = 0; band < image.bands(); ++band) {
                const std::uint16_t code =
                    code_at(row, col, static_cast<int>(band), bits);
                ASSERT_EQ(image(band, row, col),
                          bits == 8 ? linear8(code) : linear16(code))
                    << row << " " << col << " " << band;
            }
}

TEST(ForeignTiff, EveryLayoutIsRead) {
    for (const int bits : {8, 16})
        for (const int samples : {1, 2, 3, 4})
            for (const int planar : {PLANARCONFIG_CONTIG, PLANARCONFIG_SEPARATE})
                for (const bool tiled : {false, true})
                    for (const char* mode : {"w", "wb", "w8"}) {
                        const int photometric =
                            samples < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
                        const Image image =
                            decoded(make_tiff({bits, samples, photometric, planar,
                                               COMPRESSION_LZW, tiled, mode}));
                        ASSERT_EQ(image.bands(), samples < 3 ? 1U : 3U);
                        ASSERT_EQ(image.rows(), kRows);
                        ASSERT_EQ(image.cols(), kCols);
                        expect_codes(image, bits);
                    }
}

TEST(ForeignTiff, WhiteIsZeroIsInverted) {
    const Image image = decoded(make_tiff({8, 1, PHOTOMETRIC_MINISWHITE}));
    EXPECT_EQ(image(0, 3, 4), linear8(255U - code_at(3, 4, 0, 8)));
}

TEST(ForeignTiff, PalettesAreLookedUp) {
    const Image image = decoded(make_tiff({8, 1, PHOTOMETRIC_PALETTE}));
    ASSERT_EQ(image.bands(), 3U);
    EXPECT_EQ(image(1, 3, 4), linear8(code_at(3, 4, 0, 8)));
}

TEST(ForeignTiff, OtherSamplesAreUnsupported) {
    const auto cmyk = decode_image(make_tiff({8, 4, PHOTOMETRIC_SEPARATED}), "a.tif");
    ASSERT_FALSE(cmyk);
    EXPECT_EQ(cmyk.error().code, Errc::unsupported);
}

// --- Radiance -------------------------------------------------------------------------

/// Pixel (row, col) of the picture as one sees it has red 10 row + col, exponent 128.
FileBytes make_radiance(const std::string& resolution, bool columns_first, bool flip_rows,
                        bool flip_cols, bool run_length) {
    constexpr std::uint8_t kHeight = 9;
    constexpr std::uint8_t kWidth = 12;
    const std::string header = "#?RADIANCE\nEXPOSURE=1\n\n" + resolution + "\n";
    FileBytes bytes(header.begin(), header.end());
    const std::uint8_t lines = columns_first ? kWidth : kHeight;
    const std::uint8_t length = columns_first ? kHeight : kWidth;
    const auto red = [&](std::uint8_t line, std::uint8_t i) {
        std::uint8_t row = columns_first ? i : line;
        std::uint8_t col = columns_first ? line : i;
        if (flip_rows) row = static_cast<std::uint8_t>(kHeight - 1 - row);
        if (flip_cols) col = static_cast<std::uint8_t>(kWidth - 1 - col);
        return static_cast<std::uint8_t>(10 * row + col);
    };
    for (std::uint8_t line = 0; line < lines; ++line) {
        if (!run_length) {
            for (std::uint8_t i = 0; i < length; ++i)
                bytes.insert(bytes.end(), {red(line, i), 5, 3, 128});
            continue;
        }
        bytes.insert(bytes.end(), {2, 2, 0, length, length});
        for (std::uint8_t i = 0; i < length; ++i) bytes.push_back(red(line, i));
        for (const std::uint8_t value : std::array<std::uint8_t, 3>{5, 3, 128})
            bytes.insert(bytes.end(), {static_cast<std::uint8_t>(128 + length), value});
    }
    return bytes;
}

TEST(ForeignRadiance, AllEightOrientationsShowTheSamePicture) {
    for (const bool columns_first : {false, true})
        for (const bool flip_rows : {false, true})
            for (const bool flip_cols : {false, true})
                for (const bool run_length : {false, true}) {
                    const std::string y = flip_rows ? "+Y 9" : "-Y 9";
                    const std::string x = flip_cols ? "-X 12" : "+X 12";
                    const std::string line = columns_first ? x + " " + y : y + " " + x;
                    const Image image = decoded(make_radiance(
                        line, columns_first, flip_rows, flip_cols, run_length));
                    ASSERT_EQ(image.rows(), 9U) << line;
                    ASSERT_EQ(image.cols(), 12U) << line;
                    for (std::size_t r = 0; r < 9; ++r)
                        for (std::size_t c = 0; c < 12; ++c)
                            ASSERT_EQ(image(0, r, c),
                                      (static_cast<float>(10 * r + c) + 0.5F) / 256)
                                << line;
                    EXPECT_EQ(image(2, 4, 4), 3.5F / 256);
                }
}

TEST(ForeignRadiance, OldRunsAreRead) {
    const std::string header = "#?RGBE\n\n-Y 1 +X 6\n";
    FileBytes bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), {9, 8, 7, 128, 1, 1, 1, 4, 5, 5, 5, 129});
    const Image image = decoded(bytes);
    for (std::size_t c = 0; c < 5; ++c) EXPECT_EQ(image(0, 0, c), 9.5F / 256);
    EXPECT_EQ(image(0, 0, 5), 5.5F / 128);
}

TEST(ForeignRadiance, ExponentZeroIsBlack) {
    const std::string header = "#?RGBE\n\n-Y 1 +X 1\n";
    FileBytes bytes(header.begin(), header.end());
    bytes.insert(bytes.end(), {9, 8, 7, 0});
    EXPECT_EQ(decoded(bytes)(0, 0, 0), 0.0F);
}

}  // namespace
}  // namespace sateen
