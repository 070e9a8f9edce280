// SPDX-License-Identifier: Apache-2.0
// A measurement without files. See goniometer.hpp.
#include <algorithm>
#include <tuple>
#include <utility>

#include "sateen/goniometer/goniometer.hpp"

namespace sateen {
namespace {

void sort_directions(std::vector<Direction>& directions) {
    std::sort(directions.begin(), directions.end(),
              [](const Direction& a, const Direction& b) {
                  return std::tie(a.theta, a.phi) < std::tie(b.theta, b.phi);
              });
}

class VirtualMeasurement final : public Measurement {
  public:
    VirtualMeasurement(Goniometer goniometer, MeasurementInfo info)
        : goniometer_(std::move(goniometer)), info_(std::move(info)) {}

    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }

    [[nodiscard]] Result<Image> read(std::size_t observation) const override {
        const Observation& which = info_.observations.at(observation);
        const std::size_t light = which.light;
        Image result;
        SerialExecutor executor;
        SATEEN_CHECK(goniometer_.measure(
            info_.views[which.view], {&light, 1},
            [&](std::size_t, const Image& image) -> Result<void> {
                result = image;
                return {};
            },
            executor, Progress()));
        return result;
    }

  private:
    Goniometer goniometer_;
    MeasurementInfo info_;
};

}  // namespace

Result<std::unique_ptr<Measurement>> virtual_measurement(const SurfaceMaps& surface,
                                                         std::vector<Direction> views,
                                                         std::vector<Direction> lights,
                                                         const GoniometerOptions& options,
                                                         Executor& executor) {
    sort_directions(views);
    sort_directions(lights);
    GoniometerOptions wide = options;
    for (const Direction& view : views)
        wide.max_view_theta = std::max(wide.max_view_theta, view.theta);
    SATEEN_TRY(Goniometer goniometer,
               Goniometer::create(surface, lights, wide, executor));
    MeasurementInfo info;
    info.name = "virtual";
    info.layout = "virtual";
    info.rows = options.rows;
    info.cols = options.cols;
    info.bands = 3;
    info.radiometry = {true, "linear"};
    for (std::uint32_t light = 0; light < lights.size(); ++light)
        for (std::uint32_t view = 0; view < views.size(); ++view)
            info.observations.push_back(
                {view, light,
                 "light " + std::to_string(light) + ", view " + std::to_string(view)});
    info.views = std::move(views);
    info.lights = std::move(lights);
    return std::unique_ptr<Measurement>(
        std::make_unique<VirtualMeasurement>(std::move(goniometer), std::move(info)));
}

}  // namespace sateen
