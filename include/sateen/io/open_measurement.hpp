// SPDX-License-Identifier: Apache-2.0
// Opens what a user has: a UBO2003 or ATRIUM zip or folder, a folder with directions.csv,
// one photograph, several photographs of one material.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "sateen/core/result.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen {

struct OpenOptions {
    /// Leave out files whose name, direction or header is bad, and list them in
    /// MeasurementInfo::skipped, instead of failing.
    bool skip_bad = false;
    Encoding encoding = Encoding::automatic;
};

/// \param paths  one zip, one folder, one RTI light position file (.lp, beside its images),
///               or one or more image files
/// \error io          a path does not exist, is unreadable or empty
/// \error bad_format  unparsable or duplicate direction, wrong size; names the file and
/// says
///                    what was expected
[[nodiscard]] Result<std::unique_ptr<Measurement>> open_measurement(
    std::span<const std::string> paths, const OpenOptions& options = {});

}  // namespace sateen
