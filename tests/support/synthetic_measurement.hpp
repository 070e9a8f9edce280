// SPDX-License-Identifier: Apache-2.0
// A measurement in memory.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sateen/measurement/measurement.hpp"

namespace sateen::test {

class SyntheticMeasurement final : public Measurement {
  public:
    /// Photographs without directions.
    explicit SyntheticMeasurement(std::vector<Image> photographs)
        : images_(std::move(photographs)) {
        info_.name = "synthetic";
        info_.layout = images_.size() == 1 ? "photograph" : "photographs";
        describe_images();
        for (std::size_t i = 0; i < images_.size(); ++i)
            info_.observations.push_back(
                {Observation::kUnknown, Observation::kUnknown, name_of(i)});
    }
    /// A BTF, images in order of (light, view).
    SyntheticMeasurement(std::vector<Direction> views, std::vector<Direction> lights,
                         std::vector<Image> images)
        : images_(std::move(images)) {
        info_.name = "synthetic";
        info_.layout = "ubo2003";
        describe_images();
        for (std::uint32_t light = 0; light < lights.size(); ++light) {
            for (std::uint32_t view = 0; view < views.size(); ++view)
                info_.observations.push_back(
                    {view, light, name_of(info_.observations.size())});
        }
        info_.views = std::move(views);
        info_.lights = std::move(lights);
    }

    /// From now on this image cannot be read.
    void damage(std::size_t observation) { damaged_.insert(observation); }

    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t observation) const override {
        if (damaged_.contains(observation))
            return Error{Errc::bad_format, name_of(observation) + ": damaged"};
        return images_[observation];
    }

  private:
    static std::string name_of(std::size_t i) { return "image " + std::to_string(i); }
    void describe_images() {
        info_.rows = images_.front().rows();
        info_.cols = images_.front().cols();
        info_.bands = images_.front().bands();
        info_.checksum = 42;
    }

    std::vector<Image> images_;
    std::set<std::size_t> damaged_;
    MeasurementInfo info_;
};

}  // namespace sateen::test
