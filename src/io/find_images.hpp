// SPDX-License-Identifier: Apache-2.0
// Which files of a source are images of a measurement, and of which directions.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "io/direction_names.hpp"
#include "io/file_source.hpp"
#include "sateen/core/result.hpp"

namespace sateen::io {

/// Errors that end the opening or, with skip_bad, are listed.
class Rejects {
  public:
    explicit Rejects(bool skip_bad) : skip_bad_(skip_bad) {}
    [[nodiscard]] Result<void> add(Error error) {
        if (!skip_bad_) return error;
        lines_.push_back(std::move(error.message));
        return {};
    }
    [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

  private:
    bool skip_bad_;
    std::vector<std::string> lines_;
};

/// An image found, before anything of it is read.
struct FoundImage {
    std::size_t entry = 0;
    DirectionPair directions;
};

struct FoundImages {
    std::string layout;
    bool has_directions = false;
    std::vector<FoundImage> images;
    std::vector<std::string> notes;
};

[[nodiscard]] Error bad_entry(const FileSource& source, std::size_t entry,
                              const std::string& what);

[[nodiscard]] bool ends_like_light_positions(const std::string& path);

/// The images of a source: as its directions.csv lists them, else its light position file,
/// else by their names; sorted by light and view, each pair once. `path` is what the user
/// named, `given_one_by_one` whether as a list of image files.
/// \error bad_format, io  as the first reject, unless `rejects` collects them; no image at all
[[nodiscard]] Result<FoundImages> find_images(const FileSource& source,
                                              const std::string& path,
                                              bool given_one_by_one, Rejects& rejects);

}  // namespace sateen::io
