// SPDX-License-Identifier: Apache-2.0
// Where the files of a measurement come from: a folder, a zip or a list of paths.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sateen/core/result.hpp"

namespace sateen::io {

/// A file of a source.
struct FileEntry {
    std::string name;         ///< relative to the source, folders separated by '/'
    std::uint64_t bytes = 0;  ///< unpacked
    std::uint32_t crc = 0;    ///< from the directory of a zip, otherwise 0
};

class FileSource {
  public:
    virtual ~FileSource() = default;
    /// Sorted by name; without folders, and without what operating systems leave behind
    /// (names that begin with a dot, __MACOSX).
    [[nodiscard]] virtual const std::vector<FileEntry>& entries() const = 0;
    /// The whole file. Thread-safe.
    [[nodiscard]] virtual Result<std::vector<std::uint8_t>> read(
        std::size_t entry) const = 0;
    /// The entry as the user knows it, for messages.
    [[nodiscard]] virtual std::string display_name(std::size_t entry) const = 0;
};

[[nodiscard]] Result<std::unique_ptr<FileSource>> open_folder(const std::string& path);
[[nodiscard]] Result<std::unique_ptr<FileSource>> open_zip(const std::string& path);
/// Files as given; their order is kept, and entries are named as given.
[[nodiscard]] Result<std::unique_ptr<FileSource>> open_files(
    std::span<const std::string> paths);

/// True for a path that has a part beginning with a dot, or __MACOSX.
[[nodiscard]] bool is_hidden(const std::string& name);
/// The part after the last '/'.
[[nodiscard]] std::string base_name(const std::string& name);
/// True if the extension is that of an image format that can be read.
[[nodiscard]] bool has_image_extension(const std::string& name);

}  // namespace sateen::io
