// SPDX-License-Identifier: Apache-2.0
// Writes a measurement: a zip or a folder that open_measurement() reads.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen {

/// Which pairs of directions a measurement has, by view.
struct DirectionPlan {
    std::vector<Direction> views;
    std::vector<Direction> lights;
    /// For every view the indices of its lights, ascending.
    std::vector<std::vector<std::size_t>> lights_of_view;

    /// All pairs.
    [[nodiscard]] static DirectionPlan product(std::vector<Direction> views,
                                               std::vector<Direction> lights);
    [[nodiscard]] std::size_t pairs() const;
};

/// Reads a list of directions: with the columns theta_i, phi_i, theta_v, phi_v each row
/// is one pair of light and view; with theta, phi the list is for lights and views, all
/// pairs. Degrees; other columns are ignored.
/// \error io, bad_format  names the line, what was found and expected
[[nodiscard]] Result<DirectionPlan> read_direction_plan(const std::string& path);

struct MeasurementFormat {
    std::string extension = "jpg";  ///< jpg, png or exr
    WriteOptions options;
};

/// Collects images in a folder `OUT.partial`; finish() makes OUT of it, by its name a zip
/// or a folder. Names are those of UBO2003 where all angles are whole degrees:
///
///     tv015_pv060/00084 tl015 pl000 tv015 pv060.jpg,   number = light · views + view
///
/// in a zip below a folder of the archive's name; else images/000084.jpg beside a
/// directions.csv. What is in OUT.partial is whole at any time, and a later writer with
/// the same manifest can go on with it.
class MeasurementWriter {
  public:
    /// \param manifest  text of measurement.json: says how the images are made
    /// \param resume    go on with the images of an earlier writer, if there are any;
    ///                  otherwise they are thrown away
    /// \error io                a folder OUT is there already and not empty, or nothing
    ///                          can be written
    /// \error invalid_argument  resume: the earlier manifest differs
    [[nodiscard]] static Result<MeasurementWriter> create(const std::string& path,
                                                          DirectionPlan plan,
                                                          MeasurementFormat format,
                                                          const std::string& manifest,
                                                          bool resume);

    [[nodiscard]] const DirectionPlan& plan() const { return plan_; }
    [[nodiscard]] const std::string& partial_path() const { return work_; }
    /// True if the image has been written, by this writer or an earlier one.
    [[nodiscard]] bool has(std::size_t view, std::size_t light) const;
    /// Thread-safe.
    [[nodiscard]] Result<void> add(std::size_t view, std::size_t light,
                                   const Image& image) const;
    [[nodiscard]] Result<void> finish(Progress& progress);

  private:
    MeasurementWriter() = default;
    [[nodiscard]] std::string name_of(std::size_t view, std::size_t light) const;
    [[nodiscard]] Result<void> write_directions() const;
    std::string path_;
    std::string work_;
    DirectionPlan plan_;
    MeasurementFormat format_;
    bool named_ = false;  ///< directions are in the names
};

}  // namespace sateen
