// SPDX-License-Identifier: Apache-2.0
// Temporary folders, files and images for the tests of io.
#pragma once

#include <gtest/gtest.h>
#include <zip.h>

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sateen/io/atomic_file.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::test {

/// A folder that is gone at the end of the test.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name =
            (std::filesystem::temp_directory_path() / "sateen-test-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) std::abort();
        path_ = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] const std::string& path() const { return path_; }
    /// Path of a file in it; folders in `name` are made.
    [[nodiscard]] std::string file(const std::string& name) const {
        const std::filesystem::path full = std::filesystem::path(path_) / name;
        std::filesystem::create_directories(full.parent_path());
        return full.string();
    }
    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(path_),
                          std::filesystem::directory_iterator()));
    }

  private:
    std::string path_;
};

using FileBytes = std::vector<std::uint8_t>;

inline FileBytes bytes_of(const std::string& path) {
    auto bytes = read_file(path, std::size_t{1} << 30);
    if (!bytes) ADD_FAILURE() << bytes.error().message;
    return bytes ? *bytes : FileBytes();
}

inline void put(const std::string& path, const FileBytes& bytes) {
    const auto written = write_file(path, bytes);
    ASSERT_TRUE(written) << written.error().message;
}
inline void put(const std::string& path, const std::string& text) {
    put(path, FileBytes(text.begin(), text.end()));
}

/// Uniform values in [0, 1], fixed by the seed.
inline Image random_image(std::size_t bands, std::size_t rows, std::size_t cols,
                          unsigned seed = 1) {
    std::mt19937 generator(seed);
    Image image(bands, rows, cols);
    for (float& v : image.values()) v = static_cast<float>(generator()) / 4294967296.0F;
    return image;
}

/// A file of the extension, as bytes.
inline FileBytes encoded(const std::string& extension, const Image& image,
                         const WriteOptions& options = {}) {
    const TemporaryFolder folder;
    const std::string path = folder.file("image" + extension);
    const auto written = write_image(path, image.view(), options);
    if (!written) ADD_FAILURE() << written.error().message;
    return bytes_of(path);
}

inline float largest_difference(const Image& a, const Image& b) {
    if (a.bands() != b.bands() || a.rows() != b.rows() || a.cols() != b.cols())
        return std::numeric_limits<float>::infinity();
    float largest = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i)
        largest = std::max(largest, std::abs(a.values()[i] - b.values()[i]));
    return largest;
}

struct ZipEntry {
    std::string name;
    FileBytes bytes;
};

inline void write_zip(const std::string& path, const std::vector<ZipEntry>& entries,
                      const char* password = nullptr) {
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    ASSERT_NE(archive, nullptr);
    for (const ZipEntry& entry : entries) {
        zip_source_t* source =
            zip_source_buffer(archive, entry.bytes.data(), entry.bytes.size(), 0);
        const zip_int64_t index =
            zip_file_add(archive, entry.name.c_str(), source, ZIP_FL_ENC_UTF_8);
        ASSERT_GE(index, 0);
        if (password != nullptr) {
            ASSERT_EQ(zip_file_set_encryption(archive, static_cast<zip_uint64_t>(index),
                                              ZIP_EM_AES_256, password),
                      0);
        }
    }
    ASSERT_EQ(zip_close(archive), 0);
}

}  // namespace sateen::test
