// SPDX-License-Identifier: Apache-2.0
// Some of the images of a measurement, and which of them a material was made from.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sateen/material/material.hpp"
#include "sateen/measurement/measurement.hpp"

namespace sateen::cli {

/// Some of the observations of a measurement, which it must not outlive.
class SomeImages final : public Measurement {
  public:
    SomeImages(const Measurement& all, std::vector<std::size_t> chosen);
    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t observation) const override {
        return all_.read(chosen_[observation]);
    }

  private:
    const Measurement& all_;
    MeasurementInfo info_;
    std::vector<std::size_t> chosen_;
};

/// `most` of `all` observations, evenly spread; all of them for 0.
[[nodiscard]] std::vector<std::size_t> evenly_spread(std::size_t all, std::size_t most);

/// Which observations of a measurement a material was made from, by its index table.
class KnownPairs {
  public:
    /// \param info  must outlive this
    KnownPairs(const Material& material, const MeasurementInfo& info);
    [[nodiscard]] bool contains(std::size_t observation) const {
        return is_known_[observation];
    }
    /// Empty for a material of another measurement.
    [[nodiscard]] const std::vector<std::size_t>& all() const { return known_; }
    /// The known observation of the largest sum of the cosines between the views and between
    /// the lights. There must be one.
    [[nodiscard]] std::size_t nearest(const Observation& wanted) const;

  private:
    using Vectors = std::vector<std::array<float, 3>>;
    const MeasurementInfo& info_;
    Vectors views_;
    Vectors lights_;
    std::vector<bool> is_known_;
    std::vector<std::size_t> known_;
};

}  // namespace sateen::cli
