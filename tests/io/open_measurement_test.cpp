// SPDX-License-Identifier: Apache-2.0
#include "sateen/io/open_measurement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "io/files.hpp"
#include "sateen/io/executor.hpp"

namespace sateen {
namespace {

using test::encoded;
using test::FileBytes;
using test::put;
using test::TemporaryFolder;
using test::write_zip;
using testing::ElementsAre;
using testing::HasSubstr;

Result<std::unique_ptr<Measurement>> open(const std::string& path,
                                          const OpenOptions& options = {}) {
    return open_measurement({&path, 1}, options);
}

std::string error_of(const std::string& path) {
    const auto measurement = open(path);
    EXPECT_FALSE(measurement) << path;
    if (measurement) return "";
    EXPECT_THAT(measurement.error().message, testing::Not(HasSubstr("\n")));
    return measurement.error().message;
}

/// A PNG of one colour, `level` of 255.
FileBytes flat_png(std::uint8_t level, std::size_t rows = 4, std::size_t cols = 6,
                   std::size_t bands = 3) {
    Image image(bands, rows, cols);
    for (float& v : image.values()) v = static_cast<float>(level) / 255;
    return encoded(".png", image, {.encoding = Encoding::linear});
}

std::string ubo_name(int tl, int pl, int tv, int pv) {
    const auto digits = [](int value) {
        const std::string text = std::to_string(value);
        return std::string(3 - text.size(), '0') + text;
    };
    return "tv" + digits(tv) + "_pv" + digits(pv) + "/00000 tl" + digits(tl) + " pl" +
           digits(pl) + " tv" + digits(tv) + " pv" + digits(pv) + ".png";
}

/// Two lights x three views, without the last pair; level = 10 light + view.
std::vector<test::ZipEntry> small_set() {
    const std::pair<int, int> lights[] = {{0, 0}, {30, 90}};
    const std::pair<int, int> views[] = {{0, 0}, {15, 60}, {15, 300}};
    std::vector<test::ZipEntry> entries;
    for (std::uint8_t v = 3; v-- > 0;)
        for (std::uint8_t l = 0; l < 2; ++l)
            if (l != 1 || v != 2)
                entries.push_back(
                    {"Wool/" + ubo_name(lights[l].first, lights[l].second, views[v].first,
                                        views[v].second),
                     flat_png(static_cast<std::uint8_t>(100 + 10 * l + v))});
    return entries;
}

void put_all(const TemporaryFolder& folder, const std::vector<test::ZipEntry>& entries) {
    for (const test::ZipEntry& entry : entries) put(folder.file(entry.name), entry.bytes);
}

void expect_small_set(const Measurement& measurement) {
    const MeasurementInfo& info = measurement.info();
    EXPECT_EQ(info.layout, "ubo2003");
    EXPECT_EQ(info.rows, 4U);
    EXPECT_EQ(info.cols, 6U);
    EXPECT_EQ(info.bands, 3U);
    EXPECT_EQ(info.radiometry.encoding, "srgb");
    EXPECT_THAT(info.skipped, testing::IsEmpty());
    ASSERT_EQ(info.lights.size(), 2U);
    ASSERT_EQ(info.views.size(), 3U);
    EXPECT_EQ(info.lights[0], direction_from_degrees(0, 0));
    EXPECT_FLOAT_EQ(info.lights[1].phi, 90 * kRadiansPerDegree);
    EXPECT_FLOAT_EQ(info.views[1].phi, 60 * kRadiansPerDegree);
    EXPECT_FLOAT_EQ(info.views[2].phi, 300 * kRadiansPerDegree);
    ASSERT_EQ(info.observations.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
        const Observation& observation = info.observations[i];
        EXPECT_EQ(observation.light, i / 3);
        EXPECT_EQ(observation.view, i % 3);
    }
}

void expect_levels(const Measurement& measurement) {
    for (std::size_t i = 0; i < 5; ++i) {
        const auto image = measurement.read(i);
        ASSERT_TRUE(image) << image.error().message;
        const auto& observation = measurement.info().observations[i];
        EXPECT_NEAR((*image)(1, 2, 3) * 255,
                    static_cast<float>(100 + 10 * observation.light + observation.view),
                    1e-3F);
    }
}

TEST(OpenMeasurement, ZipAndFolderGiveTheSameMeasurement) {
    const TemporaryFolder folder;
    const TemporaryFolder other;
    put_all(folder, small_set());
    put(folder.file("Thumbs.db"), "x");
    put(folder.file("readme.txt"), "x");
    put(folder.file("Wool/._hidden.png"), "x");
    put(folder.file(".cache/a.png"), "x");
    auto entries = small_set();
    entries.push_back({"__MACOSX/Wool/._x.png", {1, 2}});
    entries.push_back({"notes.xml", {1, 2}});
    write_zip(other.file("set.zip"), entries);

    const OpenOptions linear{.encoding = Encoding::linear};
    for (const std::string& path :
         {folder.path(), folder.path() + "/", other.file("set.zip")}) {
        const auto measurement = open(path);
        ASSERT_TRUE(measurement) << measurement.error().message;
        expect_small_set(**measurement);
        const auto as_linear = open(path, linear);
        ASSERT_TRUE(as_linear);
        EXPECT_EQ((*as_linear)->info().radiometry.encoding, "linear");
        expect_levels(**as_linear);
    }
    EXPECT_EQ((*open(folder.path()))->info().observations.front().name,
              (*open(other.file("set.zip")))->info().observations.front().name);
    EXPECT_EQ((*open(other.file("set.zip")))->info().name, "set");
}

TEST(OpenMeasurement, ChecksumFollowsTheContents) {
    const TemporaryFolder folder;
    auto entries = small_set();
    write_zip(folder.file("a.zip"), entries);
    write_zip(folder.file("b.zip"), entries);
    entries[2].bytes = flat_png(7);
    write_zip(folder.file("c.zip"), entries);
    const auto checksum = [&](const char* name) {
        return (*open(folder.file(name)))->info().checksum;
    };
    EXPECT_EQ(checksum("a.zip"), checksum("b.zip"));
    EXPECT_NE(checksum("a.zip"), checksum("c.zip"));
}

TEST(OpenMeasurement, ReadsDirectionsFromCsvInFolderAndZip) {
    const std::string csv =
        "file,theta_i,phi_i,theta_v,phi_v\r\nb/2.png,30.5,0,10,20\r\n1.png,0,77,0,0\r\n";
    const std::vector<test::ZipEntry> entries = {
        {"set/directions.csv", FileBytes(csv.begin(), csv.end())},
        {"set/1.png", flat_png(10)},
        {"set/b/2.png", flat_png(20)},
        {"set/unlisted.png", flat_png(30)}};
    const TemporaryFolder folder;
    const TemporaryFolder other;
    put_all(folder, entries);
    write_zip(other.file("set.zip"), entries);
    for (const std::string& path :
         {folder.path(), folder.file("set"), other.file("set.zip")}) {
        const auto measurement = open(path);
        ASSERT_TRUE(measurement) << measurement.error().message;
        const MeasurementInfo& info = (*measurement)->info();
        EXPECT_EQ(info.layout, "directions.csv");
        ASSERT_EQ(info.observations.size(), 2U);
        EXPECT_THAT(info.observations[1].name, HasSubstr("b/2.png"));
        EXPECT_FLOAT_EQ(info.lights[1].theta, 30.5F * kRadiansPerDegree);
        EXPECT_EQ(info.lights[0].phi, 0);
        EXPECT_TRUE((*measurement)->read(1));
    }
}

TEST(OpenMeasurement, CsvThatListsAMissingFileIsAnError) {
    const TemporaryFolder folder;
    put(folder.file("directions.csv"),
        "file,theta_i,phi_i,theta_v,phi_v\na.png,0,0,0,0\ngone.png,15,0,0,0\n"
        "a.png,x,0,0,0\n");
    put(folder.file("a.png"), flat_png(10));
    EXPECT_THAT(
        error_of(folder.path()),
        HasSubstr("directions.csv, line 3: lists 'gone.png', which does not exist"));
    const auto skipping = open(folder.path(), {.skip_bad = true});
    ASSERT_TRUE(skipping);
    EXPECT_THAT((*skipping)->info().skipped,
                ElementsAre(HasSubstr("gone.png"), HasSubstr("line 4")));
}

TEST(OpenMeasurement, PhotographsHaveNoDirectionsAndAnySize) {
    const TemporaryFolder folder;
    put(folder.file("b.png"), flat_png(10, 4, 6, 1));
    put(folder.file("a.png"), flat_png(20, 5, 9, 3));
    const std::string one = folder.file("b.png");
    const auto single = open(one);
    ASSERT_TRUE(single);
    EXPECT_EQ((*single)->info().layout, "photograph");
    EXPECT_EQ((*single)->info().name, "b");
    EXPECT_EQ((*single)->info().bands, 1U);
    EXPECT_FALSE((*single)->info().has_directions());

    const auto in_folder = open(folder.path());
    ASSERT_TRUE(in_folder);
    EXPECT_EQ((*in_folder)->info().layout, "photographs");
    EXPECT_EQ((*in_folder)->info().observations[0].name, "a.png");

    const std::vector<std::string> paths = {folder.file("b.png"), folder.file("a.png")};
    const auto several = open_measurement(paths);
    ASSERT_TRUE(several);
    const MeasurementInfo& info = (*several)->info();
    EXPECT_EQ(info.layout, "photographs");
    EXPECT_EQ(info.observations[0].name, paths[0]);
    EXPECT_EQ(info.rows, 4U);
    EXPECT_EQ(info.bands, 3U);
    const auto grey = (*several)->read(0);
    ASSERT_TRUE(grey);
    EXPECT_EQ(grey->bands(), 3U);
    EXPECT_EQ((*grey)(0, 1, 1), (*grey)(2, 1, 1));
    EXPECT_EQ((*several)->read(1)->cols(), 9U);
}

TEST(OpenMeasurement, NamesWhatIsMissingOrEmpty) {
    const TemporaryFolder folder;
    EXPECT_THAT(error_of(folder.path() + "/none"), HasSubstr("none: does not exist"));
    EXPECT_THAT(error_of(folder.path()), HasSubstr("found no image among 0 files"));
    put(folder.file("notes.txt"), "x");
    EXPECT_THAT(error_of(folder.path()), HasSubstr("found no image among 1 files"));
    write_zip(folder.file("a.zip"), {{"notes.txt", {1}}});
    EXPECT_THAT(error_of(folder.file("a.zip")), HasSubstr("a.zip: found no image"));
    EXPECT_THAT(error_of(folder.file("notes.txt")), HasSubstr("is not an image"));
    EXPECT_FALSE(open_measurement({}));
    const std::vector<std::string> mixed = {folder.file("notes.txt"), folder.path()};
    const auto measurement = open_measurement(mixed);
    ASSERT_FALSE(measurement);
    EXPECT_THAT(measurement.error().message, HasSubstr("found a folder among several"));
}

TEST(OpenMeasurement, DamagedZipsAreErrors) {
    const TemporaryFolder folder;
    write_zip(folder.file("good.zip"), small_set());
    const FileBytes good = test::bytes_of(folder.file("good.zip"));
    put(folder.file("cut.zip"),
        FileBytes(good.begin(),
                  good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2)));
    EXPECT_THAT(error_of(folder.file("cut.zip")), HasSubstr("not a whole zip archive"));
    put(folder.file("text.zip"), "hello");
    EXPECT_THAT(error_of(folder.file("text.zip")), HasSubstr("not a whole zip archive"));
    put(folder.file("empty.zip"), "");
    EXPECT_THAT(error_of(folder.file("empty.zip")), HasSubstr("empty.zip: "));

    // The data of an entry altered: its CRC tells. The first local header is 30 bytes and
    // the name.
    FileBytes altered = good;
    for (std::size_t i = 140; i < 160; ++i) altered[i] ^= 0x55;
    put(folder.file("altered.zip"), altered);
    const auto measurement = open(folder.file("altered.zip"));
    if (measurement) {
        std::size_t failures = 0;
        for (std::size_t i = 0; i < 5; ++i)
            if (!(*measurement)->read(i)) ++failures;
        EXPECT_EQ(failures, 1U);
    }

    write_zip(folder.file("secret.zip"), small_set(), "word");
    EXPECT_THAT(error_of(folder.file("secret.zip")), HasSubstr("is encrypted"));
}

TEST(OpenMeasurement, BadNamesAreErrorsOrSkipped) {
    const TemporaryFolder folder;
    put_all(folder, small_set());
    put(folder.file("tlXX pl000 tv000 pv000.png"), flat_png(1));
    EXPECT_THAT(error_of(folder.path()), HasSubstr("tlXX pl000 tv000 pv000.png: found no "
                                                   "degrees after 'tl'"));
    put(folder.file("tl095 pl000 tv000 pv000.png"), flat_png(1));
    put(folder.file("preview.png"), flat_png(1));
    const auto skipping = open(folder.path(), {.skip_bad = true});
    ASSERT_TRUE(skipping);
    EXPECT_EQ((*skipping)->info().observations.size(), 5U);
    EXPECT_THAT(
        (*skipping)->info().skipped,
        testing::UnorderedElementsAre(HasSubstr("tlXX"), HasSubstr("theta 95"),
                                      HasSubstr("preview.png: found no directions")));
}

TEST(OpenMeasurement, DuplicatesNameBothFiles) {
    const TemporaryFolder folder;
    put_all(folder, small_set());
    put(folder.file("again/tl30 pl450 tv15 pv60.00001.x.png"), flat_png(1));
    const std::string message = error_of(folder.path());
    EXPECT_THAT(message, HasSubstr("again/tl30 pl450"));
    EXPECT_THAT(message, HasSubstr("tl030 pl090 tv015 pv060.png"));
    EXPECT_THAT(message, HasSubstr("light 30,90 and view 15,60"));
    const auto skipping = open(folder.path(), {.skip_bad = true});
    ASSERT_TRUE(skipping);
    EXPECT_EQ((*skipping)->info().observations.size(), 5U);
    EXPECT_EQ((*skipping)->info().skipped.size(), 1U);
}

TEST(OpenMeasurement, ImagesOfAnotherSizeOrTruncatedFailWhenRead) {
    const TemporaryFolder folder;
    auto entries = small_set();
    // In order of (light, view), entries[3] is the second and entries[2] the first of its
    // light.
    entries[3].bytes.resize(entries[3].bytes.size() - 20);
    entries[2].bytes = flat_png(10, 4, 7);
    put_all(folder, entries);
    const auto measurement = open(folder.path());
    ASSERT_TRUE(measurement) << measurement.error().message;

    const auto executor = make_executor(2);
    Progress progress;
    const auto strict = for_each_image(**measurement, false, *executor, progress,
                                       [](std::size_t, const Image&) {});
    EXPECT_FALSE(strict);
    const auto report = for_each_image(**measurement, true, *executor, progress,
                                       [](std::size_t, const Image&) {});
    ASSERT_TRUE(report);
    ASSERT_EQ(report->failed.size(), 2U);
    std::string both = report->reasons[0] + report->reasons[1];
    EXPECT_THAT(both,
                HasSubstr("has 7 x 4 pixels, expected 6 x 4 as the first image has"));
    EXPECT_THAT(both, HasSubstr("truncated PNG"));
}

TEST(OpenMeasurement, ABadFirstHeaderIsSkippedForTheNext) {
    const TemporaryFolder folder;
    put_all(folder, small_set());
    put(folder.file("Wool/" + ubo_name(0, 0, 0, 0)), "not a picture");
    EXPECT_THAT(error_of(folder.path()), HasSubstr("is not an image"));
    const auto skipping = open(folder.path(), {.skip_bad = true});
    ASSERT_TRUE(skipping);
    EXPECT_EQ((*skipping)->info().observations.size(), 4U);
    EXPECT_THAT((*skipping)->info().skipped, ElementsAre(HasSubstr("is not an image")));
    EXPECT_EQ((*skipping)->info().rows, 4U);
}

TEST(OpenMeasurement, NothingUsableIsAnErrorEvenWhenSkipping) {
    const TemporaryFolder folder;
    put(folder.file("a.png"), "no");
    const auto measurement = open(folder.path(), {.skip_bad = true});
    ASSERT_FALSE(measurement);
    EXPECT_THAT(measurement.error().message, HasSubstr("found no usable image"));
}

TEST(OpenMeasurement, SeveralThreadsReadAtOnce) {
    const TemporaryFolder folder;
    std::vector<test::ZipEntry> entries;
    for (int pv = 0; pv < 360; pv += 3)
        entries.push_back(
            {ubo_name(30, 0, 45, pv), flat_png(static_cast<std::uint8_t>(pv / 2))});
    write_zip(folder.file("set.zip"), entries);
    const auto measurement = open(folder.file("set.zip"), {.encoding = Encoding::linear});
    ASSERT_TRUE(measurement);
    std::vector<std::thread> readers;
    std::atomic<int> wrong = 0;
    for (std::size_t t = 0; t < 4; ++t)
        readers.emplace_back([&, t] {
            for (std::size_t i = t % 2; i < 120; i += 2) {
                const auto image = (*measurement)->read(i);
                const auto level = static_cast<float>(i * 3 / 2);
                if (!image || std::abs((*image)(0, 0, 0) * 255 - level) > 0.01F) ++wrong;
            }
        });
    for (std::thread& reader : readers) reader.join();
    EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace sateen
