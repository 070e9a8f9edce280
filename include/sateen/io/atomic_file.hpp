// SPDX-License-Identifier: Apache-2.0
// Files that are whole or absent: written beside their name, renamed when complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sateen/core/result.hpp"

namespace sateen {

/// A temporary file `.NAME.tmp-PID` beside `path`; commit() renames it, the destructor
/// removes it otherwise. What exists under `path` and is not a regular file (a device, a
/// pipe) is written to directly.
class AtomicFile {
  public:
    /// \error io  the folder does not exist or is not writable, or `path` is a folder
    [[nodiscard]] static Result<AtomicFile> create(std::string path);
    AtomicFile(AtomicFile&& other) noexcept;
    AtomicFile& operator=(AtomicFile&& other) noexcept;
    ~AtomicFile();

    [[nodiscard]] const std::string& temporary_path() const { return temporary_; }
    [[nodiscard]] const std::string& path() const { return path_; }
    /// Appends at the present position. \error io  e.g. the disk is full
    [[nodiscard]] Result<void> write(std::span<const std::uint8_t> bytes);
    /// Reads back at most `bytes.size()` bytes from the present position.
    /// \returns how many
    [[nodiscard]] Result<std::size_t> read(std::span<std::uint8_t> bytes);
    /// The next write begins `offset` bytes from the start.
    [[nodiscard]] Result<void> seek(std::uint64_t offset);
    [[nodiscard]] std::uint64_t position() const { return position_; }
    /// Closes and renames. \error io  nothing is left behind
    [[nodiscard]] Result<void> commit();

  private:
    AtomicFile() = default;
    void discard() noexcept;
    [[nodiscard]] Error failure(int code) const;
    std::string path_;
    std::string temporary_;
    std::uint64_t position_ = 0;
    int descriptor_ = -1;
};

[[nodiscard]] Result<void> write_file(const std::string& path,
                                      std::span<const std::uint8_t> bytes);
/// \param limit_bytes  larger files are refused
/// \error io  the message tells a path that does not exist from one that cannot be read
[[nodiscard]] Result<std::vector<std::uint8_t>> read_file(const std::string& path,
                                                          std::size_t limit_bytes);

}  // namespace sateen
