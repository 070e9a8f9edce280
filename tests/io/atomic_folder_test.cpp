// SPDX-License-Identifier: Apache-2.0
#include "sateen/io/atomic_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "io/files.hpp"
#include "sateen/io/atomic_file.hpp"

namespace sateen {
namespace {

using test::bytes_of;
using test::FileBytes;
using test::TemporaryFolder;

void put(const std::string& path, const FileBytes& bytes) {
    ASSERT_TRUE(write_file(path, bytes));
}

TEST(AtomicFolder, AppearsOnlyWhenCommitted) {
    const TemporaryFolder folder;
    for (const std::string& path :
         {folder.file("a/b/maps"), folder.file("slash") + "/"}) {
        auto maps = AtomicFolder::create(path);
        ASSERT_TRUE(maps) << maps.error().message;
        put(maps->temporary_path() + "/one", {1});
        EXPECT_FALSE(std::filesystem::exists(path));
        ASSERT_TRUE(maps->commit());
        EXPECT_EQ(bytes_of(path + "/one"), FileBytes{1});
        EXPECT_FALSE(std::filesystem::exists(maps->temporary_path()));
    }
}

TEST(AtomicFolder, LeavesNothingBehindIfNotCommitted) {
    const TemporaryFolder folder;
    {
        auto maps = AtomicFolder::create(folder.file("maps"));
        ASSERT_TRUE(maps);
        put(maps->temporary_path() + "/one", {1});
        const AtomicFolder moved = std::move(*maps);
        EXPECT_EQ(folder.count(), 1U);
    }
    EXPECT_EQ(folder.count(), 0U);
}

TEST(AtomicFolder, KeepsWhatElseIsInTheFolder) {
    const TemporaryFolder folder;
    const std::string path = folder.file("maps");
    std::filesystem::create_directory(path);
    put(path + "/mine", {7});
    put(path + "/one", {0});
    {
        auto maps = AtomicFolder::create(path);
        ASSERT_TRUE(maps);
        put(maps->temporary_path() + "/one", {1});
        ASSERT_TRUE(maps->commit());
    }
    EXPECT_EQ(bytes_of(path + "/mine"), FileBytes{7});
    EXPECT_EQ(bytes_of(path + "/one"), FileBytes{1});
    EXPECT_EQ(folder.count(), 1U);
}

TEST(AtomicFolder, RefusesFiles) {
    const TemporaryFolder folder;
    put(folder.file("maps"), {7});
    const auto maps = AtomicFolder::create(folder.file("maps"));
    ASSERT_FALSE(maps);
    EXPECT_THAT(maps.error().message, testing::HasSubstr("is a file, expected a folder"));
}

}  // namespace
}  // namespace sateen
