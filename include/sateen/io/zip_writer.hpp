// SPDX-License-Identifier: Apache-2.0
// Zip archives of files on disk.
#pragma once

#include <string>
#include <vector>

#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

struct ZipMember {
    std::string name;  ///< in the archive, folders separated by '/'
    std::string path;  ///< of the file to put there
};

/// Stores files uncompressed (images are compressed already), dated 1980: equal files and
/// names give equal bytes. The archive appears under its name when complete; what was
/// there before is replaced.
/// \error io         a file cannot be read, or the archive not be written
/// \error cancelled  nothing is left behind
[[nodiscard]] Result<void> write_zip(const std::string& path,
                                     const std::vector<ZipMember>& members,
                                     Progress& progress);

}  // namespace sateen
