// SPDX-License-Identifier: Apache-2.0
#include "sateen/io/atomic_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "io/files.hpp"

namespace sateen {
namespace {

using test::bytes_of;
using test::FileBytes;
using test::TemporaryFolder;

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
    const TemporaryFolder folder;
    const std::string path = folder.file("out.bin");
    auto file = AtomicFile::create(path);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(FileBytes{1, 2, 3}));
    EXPECT_FALSE(std::filesystem::exists(path));
    ASSERT_TRUE(file->commit());
    EXPECT_EQ(bytes_of(path), (FileBytes{1, 2, 3}));
    EXPECT_EQ(folder.count(), 1U);
}

TEST(AtomicFile, LeavesNothingBehindIfNotCommitted) {
    const TemporaryFolder folder;
    {
        auto file = AtomicFile::create(folder.file("out.bin"));
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->write(FileBytes{1}));
        AtomicFile moved = std::move(*file);
        EXPECT_EQ(folder.count(), 1U);
    }
    EXPECT_EQ(folder.count(), 0U);
}

TEST(AtomicFile, KeepsTheOldFileUntilCommitted) {
    const TemporaryFolder folder;
    const std::string path = folder.file("out.bin");
    test::put(path, "old");
    {
        auto file = AtomicFile::create(path);
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->write(FileBytes{1}));
    }
    EXPECT_EQ(bytes_of(path), (FileBytes{'o', 'l', 'd'}));
}

TEST(AtomicFile, WritesAtAnyPosition) {
    const TemporaryFolder folder;
    auto file = AtomicFile::create(folder.file("out.bin"));
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(FileBytes{1, 2, 3, 4}));
    ASSERT_TRUE(file->seek(1));
    ASSERT_TRUE(file->write(FileBytes{9}));
    EXPECT_EQ(file->position(), 2U);
    ASSERT_TRUE(file->commit());
    EXPECT_EQ(bytes_of(folder.file("out.bin")), (FileBytes{1, 9, 3, 4}));
}

TEST(AtomicFile, TwoWritersOfOneNameDoNotDisturbEachOther) {
    const TemporaryFolder folder;
    auto first = AtomicFile::create(folder.file("out.bin"));
    auto second = AtomicFile::create(folder.file("out.bin"));
    ASSERT_TRUE(first && second);
    ASSERT_TRUE(first->write(FileBytes{1}));
    ASSERT_TRUE(second->write(FileBytes{2}));
    ASSERT_TRUE(second->commit());
    ASSERT_TRUE(first->commit());
    EXPECT_EQ(bytes_of(folder.file("out.bin")), (FileBytes{1}));
}

TEST(AtomicFile, NamesTheFileThatCannotBeWritten) {
    const TemporaryFolder folder;
    const auto missing = AtomicFile::create(folder.path() + "/none/out.bin");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, Errc::io);
    EXPECT_THAT(missing.error().message, testing::HasSubstr("none/out.bin"));
    EXPECT_FALSE(AtomicFile::create(folder.path()));
}

TEST(AtomicFile, ReportsAFullDisk) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
    const auto written = write_file("/dev/full", FileBytes(100));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Errc::io);
    EXPECT_THAT(written.error().message, testing::HasSubstr("/dev/full"));
    EXPECT_TRUE(std::filesystem::exists("/dev/full"));
}

TEST(ReadFile, TellsMissingFromUnreadable) {
    const TemporaryFolder folder;
    const auto missing = read_file(folder.path() + "/none", 100);
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().message, testing::HasSubstr("does not exist"));
    const auto directory = read_file(folder.path(), 100);
    ASSERT_FALSE(directory);
    EXPECT_THAT(directory.error().message, testing::HasSubstr("is a folder"));
}

TEST(ReadFile, RefusesFilesOverTheLimit) {
    const TemporaryFolder folder;
    test::put(folder.file("a"), FileBytes(100));
    EXPECT_TRUE(read_file(folder.file("a"), 100));
    const auto large = read_file(folder.file("a"), 99);
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, Errc::limit_exceeded);
}

}  // namespace
}  // namespace sateen
