// SPDX-License-Identifier: Apache-2.0
// Folders of files that appear together, or not at all.
#pragma once

#include <string>

#include "sateen/core/result.hpp"

namespace sateen {

/// A temporary folder `.NAME.tmp-PID` beside `path`; commit() renames it, the destructor
/// removes it otherwise. Where the folder exists already, its other files stay: commit()
/// moves the new ones into it, each of them whole.
class AtomicFolder {
  public:
    /// Makes the folders above `path` as needed. \error io  `path` is a file, or its folder
    ///                                                  is not writable
    [[nodiscard]] static Result<AtomicFolder> create(const std::string& path);
    AtomicFolder(AtomicFolder&& other) noexcept;
    AtomicFolder& operator=(AtomicFolder&&) = delete;
    ~AtomicFolder();

    [[nodiscard]] const std::string& temporary_path() const { return temporary_; }
    [[nodiscard]] const std::string& path() const { return path_; }
    /// \error io
    [[nodiscard]] Result<void> commit();

  private:
    AtomicFolder() = default;
    std::string path_;
    std::string temporary_;  // empty once committed
};

}  // namespace sateen
