// SPDX-License-Identifier: Apache-2.0
// A measurement: images of one flat material by view and light, streamed one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sateen/core/direction.hpp"
#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"

namespace sateen {

/// What the pixel values of a measurement mean.
struct Radiometry {
    /// The values contain cos θ of the light (as UBO2003 does), rather than reflectance.
    bool cosine_included = true;
    /// How the files encode values: "srgb", "linear" or "gamma 2.2".
    std::string encoding = "srgb";
};

/// One image of a measurement.
struct Observation {
    /// For photographs without known directions.
    static constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t view = kUnknown;   ///< index into MeasurementInfo::views
    std::uint32_t light = kUnknown;  ///< index into MeasurementInfo::lights
    std::string name;                ///< file name as the user knows it, for messages
};

/// What a measurement holds, known before any image is decoded.
struct MeasurementInfo {
    std::string name;  ///< of the material, from the folder or file name
    /// "ubo2003", "directions.csv", "lp", "photograph" or "photographs".
    std::string layout;
    std::size_t rows = 0;
    std::size_t cols = 0;
    std::size_t bands = 0;  ///< 1 or 3
    Radiometry radiometry;
    std::optional<float> pixels_per_mm;
    /// A fingerprint of the source: equal inputs give equal numbers.
    std::uint64_t checksum = 0;
    std::vector<Direction> views;   ///< distinct directions in order of (theta, phi)
    std::vector<Direction> lights;  ///< the same
    /// In order of (light, view); photographs in order of their names as given.
    std::vector<Observation> observations;
    /// One line each: what was left out because of `skip_bad`, and why.
    std::vector<std::string> skipped;

    /// False for photographs: their directions are unknown, and their sizes may differ
    /// (rows and cols are then those of the first).
    [[nodiscard]] bool has_directions() const { return !views.empty(); }
};

/// Images by observation. Implementations are in io; tests have synthetic ones.
class Measurement {
  public:
    virtual ~Measurement() = default;
    [[nodiscard]] virtual const MeasurementInfo& info() const = 0;
    /// Decodes one image to linear planar float, (bands, rows, cols). Thread-safe.
    /// \error io, bad_format  the file is missing, truncated or of another size; the
    /// message
    ///                        names it and says what was expected
    [[nodiscard]] virtual Result<Image> read(std::size_t observation) const = 0;
};

/// What became of a pass over all images.
struct PassReport {
    /// Observations that could not be read, ascending, with the reason of each.
    std::vector<std::size_t> failed;
    std::vector<std::string> reasons;
};

/// Decodes every image once, in parallel, and hands each to `consume(observation,
/// image)`, which may run on several threads at a time. Memory: one image a thread.
/// \param skip_bad  go on past unreadable images and list them, instead of failing
/// \error the error of the first (lowest-numbered) unreadable image; cancelled
[[nodiscard]] Result<PassReport> for_each_image(
    const Measurement& measurement, bool skip_bad, Executor& executor, Progress& progress,
    const std::function<void(std::size_t, const Image&)>& consume);

}  // namespace sateen
