// SPDX-License-Identifier: Apache-2.0
// Files in a zip by libzip. A handle serves one thread at a time; there are as many as
// have been reading at once.
#include <zip.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "io/file_source.hpp"

namespace sateen::io {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{7} << 30;
constexpr zip_int64_t kMaxEntries = 1 << 22;

struct CloseArchive {
    void operator()(zip_t* archive) const { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, CloseArchive>;

struct CloseFile {
    void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using File = std::unique_ptr<zip_file_t, CloseFile>;

std::string zip_message(int code) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    std::string text = zip_error_strerror(&error);
    zip_error_fini(&error);
    return text;
}

Result<Archive> open_archive(const std::string& path) {
    int code = 0;
    Archive archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
    if (archive) return archive;
    if (code == ZIP_ER_OPEN || code == ZIP_ER_NOENT)
        return Error{Errc::io, path + ": cannot be read: " + zip_message(code)};
    return Error{Errc::bad_format,
                 path + ": is not a whole zip archive: " + zip_message(code)};
}

class ZipSource final : public FileSource {
  public:
    struct Packed {
        zip_uint64_t index = 0;
        std::uint64_t bytes = 0;
        bool encrypted = false;
    };

    ZipSource(std::string path, Archive archive, std::vector<FileEntry> entries,
              std::vector<Packed> packed)
        : path_(std::move(path)),
          entries_(std::move(entries)),
          packed_(std::move(packed)) {
        idle_.push_back(std::move(archive));
    }

    [[nodiscard]] const std::vector<FileEntry>& entries() const override {
        return entries_;
    }

    [[nodiscard]] std::string display_name(std::size_t entry) const override {
        return path_ + ": " + entries_[entry].name;
    }

    [[nodiscard]] Result<std::vector<std::uint8_t>> read(
        std::size_t entry) const override {
        SATEEN_TRY(Archive archive, borrow());
        auto bytes = read_with(archive.get(), entry);
        give_back(std::move(archive));
        return bytes;
    }

  private:
    [[nodiscard]] Error failure(std::size_t entry, const std::string& what) const {
        return {Errc::bad_format, display_name(entry) + ": " + what};
    }

    [[nodiscard]] Result<std::vector<std::uint8_t>> read_with(zip_t* archive,
                                                              std::size_t entry) const {
        const std::uint64_t stated = entries_[entry].bytes;
        const Packed& packed = packed_[entry];
        if (packed.encrypted)
            return Error{Errc::unsupported, display_name(entry) +
                                                ": is encrypted, expected an archive "
                                                "without a password"};
        // Deflate makes at most 1032 bytes of one; other methods are rare and not known
        // to do better on images.
        if (stated > kMaxFileBytes || stated / 1100 > packed.bytes)
            return failure(
                entry, "states " + std::to_string(stated) + " bytes unpacked from " +
                           std::to_string(packed.bytes) + ", expected a possible size");
        const File file(zip_fopen_index(archive, packed.index, 0));
        if (!file) return failure(entry, "cannot be unpacked: " + last_message(archive));
        std::vector<std::uint8_t> bytes(stated);
        std::size_t done = 0;
        while (done < bytes.size()) {
            const zip_int64_t got =
                zip_fread(file.get(), bytes.data() + done, bytes.size() - done);
            if (got < 0) return failure(entry, unpack_message(file.get()));
            if (got == 0) break;
            done += static_cast<std::size_t>(got);
        }
        // Reading past the end is what checks the CRC.
        std::uint8_t beyond = 0;
        const zip_int64_t more = zip_fread(file.get(), &beyond, 1);
        if (more < 0) return failure(entry, unpack_message(file.get()));
        if (more > 0 || done != stated)
            return failure(entry, "found " + std::string(more > 0 ? "more than " : "") +
                                      std::to_string(done) + " bytes, expected " +
                                      std::to_string(stated));
        return bytes;
    }

    static std::string last_message(zip_t* archive) {
        return zip_error_strerror(zip_get_error(archive));
    }
    static std::string unpack_message(zip_file_t* file) {
        return std::string("cannot be unpacked: ") +
               zip_error_strerror(zip_file_get_error(file));
    }

    [[nodiscard]] Result<Archive> borrow() const {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                Archive archive = std::move(idle_.back());
                idle_.pop_back();
                return archive;
            }
        }
        return open_archive(path_);
    }
    void give_back(Archive archive) const {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(archive));
    }

    std::string path_;
    std::vector<FileEntry> entries_;
    std::vector<Packed> packed_;
    mutable std::mutex mutex_;
    mutable std::vector<Archive> idle_;
};

}  // namespace

Result<std::unique_ptr<FileSource>> open_zip(const std::string& path) {
    SATEEN_TRY(Archive archive, open_archive(path));
    const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
    if (count > kMaxEntries)
        return Error{Errc::limit_exceeded, path + ": has " + std::to_string(count) +
                                               " entries, expected at most " +
                                               std::to_string(kMaxEntries)};
    std::vector<std::pair<FileEntry, ZipSource::Packed>> found;
    for (zip_int64_t i = 0; i < count; ++i) {
        zip_stat_t status;
        if (zip_stat_index(archive.get(), static_cast<zip_uint64_t>(i), 0, &status) !=
                0 ||
            (status.valid & ZIP_STAT_NAME) == 0 || (status.valid & ZIP_STAT_SIZE) == 0 ||
            (status.valid & ZIP_STAT_COMP_SIZE) == 0)
            return Error{Errc::bad_format, path + ": entry " + std::to_string(i) +
                                               " of the zip has no name or size"};
        std::string name = status.name;
        if (name.empty() || name.back() == '/' || is_hidden(name)) continue;
        const bool encrypted = (status.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 &&
                               status.encryption_method != ZIP_EM_NONE;
        found.emplace_back(
            FileEntry{std::move(name), status.size, status.crc},
            ZipSource::Packed{static_cast<zip_uint64_t>(i), status.comp_size, encrypted});
    }
    std::sort(found.begin(), found.end(),
              [](const auto& a, const auto& b) { return a.first.name < b.first.name; });
    std::vector<FileEntry> entries;
    std::vector<ZipSource::Packed> packed;
    for (auto& [entry, where] : found) {
        entries.push_back(std::move(entry));
        packed.push_back(where);
    }
    return std::unique_ptr<FileSource>(std::make_unique<ZipSource>(
        path, std::move(archive), std::move(entries), std::move(packed)));
}

}  // namespace sateen::io
