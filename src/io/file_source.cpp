// SPDX-License-Identifier: Apache-2.0
// Folders and lists of files. See file_source.hpp; zips are in zip_archive.cpp.
#include "io/file_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <utility>

#include "sateen/io/atomic_file.hpp"

namespace sateen::io {
namespace {

namespace fs = std::filesystem;

// 2^29 pixels of 32-bit RGB fit, uncompressed.
constexpr std::size_t kMaxFileBytes = std::size_t{7} << 30;

class FolderSource final : public FileSource {
  public:
    FolderSource(std::string root, std::vector<FileEntry> entries)
        : root_(std::move(root)), entries_(std::move(entries)) {}

    [[nodiscard]] const std::vector<FileEntry>& entries() const override {
        return entries_;
    }
    [[nodiscard]] Result<std::vector<std::uint8_t>> read(
        std::size_t entry) const override {
        return read_file(display_name(entry), kMaxFileBytes);
    }
    [[nodiscard]] std::string display_name(std::size_t entry) const override {
        return (fs::path(root_) / entries_[entry].name).string();
    }

  private:
    std::string root_;
    std::vector<FileEntry> entries_;
};

class ListSource final : public FileSource {
  public:
    explicit ListSource(std::vector<FileEntry> entries) : entries_(std::move(entries)) {}

    [[nodiscard]] const std::vector<FileEntry>& entries() const override {
        return entries_;
    }
    [[nodiscard]] Result<std::vector<std::uint8_t>> read(
        std::size_t entry) const override {
        return read_file(entries_[entry].name, kMaxFileBytes);
    }
    [[nodiscard]] std::string display_name(std::size_t entry) const override {
        return entries_[entry].name;
    }

  private:
    std::vector<FileEntry> entries_;
};

Error folder_error(const std::string& path, const std::error_code& code) {
    return {Errc::io, path + ": cannot be read: " + code.message()};
}

}  // namespace

bool is_hidden(const std::string& name) {
    for (const fs::path& part : fs::path(name)) {
        const std::string text = part.string();
        if (text == "__MACOSX" ||
            (text.size() > 1 && text.front() == '.' && text != ".."))
            return true;
    }
    return false;
}

std::string base_name(const std::string& name) {
    return name.substr(name.find_last_of('/') + 1);
}

bool has_image_extension(const std::string& name) {
    constexpr std::array<std::string_view, 7> kExtensions = {"jpg", "jpeg", "png", "exr",
                                                             "tif", "tiff", "hdr"};
    const std::string base = base_name(name);
    const std::size_t dot = base.rfind('.');
    if (dot == std::string::npos) return false;
    std::string extension = base.substr(dot + 1);
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::find(kExtensions.begin(), kExtensions.end(), extension) !=
           kExtensions.end();
}

Result<std::unique_ptr<FileSource>> open_folder(const std::string& path) {
    std::error_code code;
    fs::recursive_directory_iterator it(path, code);
    if (code) return folder_error(path, code);
    std::vector<FileEntry> entries;
    for (; it != fs::recursive_directory_iterator(); it.increment(code)) {
        if (code) return folder_error(path, code);
        std::error_code ignored;
        const std::string name = it->path().lexically_relative(path).generic_string();
        if (is_hidden(name)) {
            if (it->is_directory(ignored)) it.disable_recursion_pending();
            continue;
        }
        if (!it->is_regular_file(ignored)) continue;
        entries.push_back({name, it->file_size(ignored), 0});
    }
    if (code) return folder_error(path, code);
    std::sort(entries.begin(), entries.end(),
              [](const FileEntry& a, const FileEntry& b) { return a.name < b.name; });
    return std::unique_ptr<FileSource>(
        std::make_unique<FolderSource>(path, std::move(entries)));
}

Result<std::unique_ptr<FileSource>> open_files(std::span<const std::string> paths) {
    std::vector<FileEntry> entries;
    for (const std::string& path : paths) entries.push_back({path, 0, 0});
    return std::unique_ptr<FileSource>(std::make_unique<ListSource>(std::move(entries)));
}

}  // namespace sateen::io
