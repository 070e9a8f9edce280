// SPDX-License-Identifier: Apache-2.0
// From measurement to range map. See range_map.hpp.
#include "sateen/analysis/range_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "material/surface_codec.hpp"
#include "sateen/analysis/integrate.hpp"
#include "sateen/analysis/photometric_stereo.hpp"
#include "sateen/analysis/roller.hpp"
#include "sateen/analysis/shape_from_shading.hpp"

namespace sateen {
namespace {

constexpr std::size_t kFewestLights = 5;
/// Distance of two codes in pixels: moves slopes by 0.01 on average.
constexpr float kFinestStep = 0.05F;
/// Of the range: an error of at most half of it.
constexpr float kCoarsestStep = 0.01F;

/// Rows and columns of the sample that tiles are cut from. Four tiles of larger ones fit the
/// budget only at steps that show, and take the Roller many seconds.
constexpr std::size_t kLargestSample = 384;

std::size_t lights_from_above(const MeasurementInfo& info) {
    if (!info.has_directions()) return 0;
    const auto view =
        std::min_element(info.views.begin(), info.views.end(),
                         [](Direction a, Direction b) { return a.theta < b.theta; });
    const auto number = static_cast<std::uint32_t>(view - info.views.begin());
    return static_cast<std::size_t>(
        std::count_if(info.observations.begin(), info.observations.end(),
                      [&](const Observation& o) { return o.view == number; }));
}

Image to_float(const BasicImage<double>& image) {
    Image out(image.bands(), image.rows(), image.cols());
    for (std::size_t i = 0; i < image.values().size(); ++i)
        out.values()[i] = static_cast<float>(image.values()[i]);
    return out;
}

/// The middle of a large range map, upright.
BasicImage<double> sample_of(const BasicImage<double>& height) {
    const std::size_t rows = std::min(height.rows(), kLargestSample);
    const std::size_t cols = std::min(height.cols(), kLargestSample);
    if (rows == height.rows() && cols == height.cols()) return height;
    BasicImage<double> out(1, rows, cols);
    const auto part = height.plane(0).window((height.rows() - rows) / 2,
                                             (height.cols() - cols) / 2, rows, cols);
    for (std::size_t r = 0; r < rows; ++r)
        std::copy_n(part.row(r), cols, out.plane(0).row(r));
    remove_tilt(out);
    return out;
}

Image normals_of_slopes(const SlopeField& slopes) {
    Image out(3, slopes.rows(), slopes.cols());
    for (std::size_t i = 0; i < slopes.plane_size(); ++i) {
        const double p = slopes.plane(0).data[i];
        const double q = slopes.plane(1).data[i];
        const double length = std::sqrt(1 + p * p + q * q);
        out.plane(0).data[i] = static_cast<float>(-p / length);
        out.plane(1).data[i] = static_cast<float>(-q / length);
        out.plane(2).data[i] = static_cast<float>(1 / length);
    }
    return out;
}

Result<BasicImage<double>> height_by_stereo(const Measurement& measurement,
                                            const RangeMapOptions& options, RangeMap& out,
                                            Executor& executor, Progress& progress) {
    StereoOptions stereo;
    stereo.robust = options.robust;
    stereo.skip_bad = options.skip_bad;
    SATEEN_TRY(StereoEstimate found,
               photometric_stereo(measurement, stereo, executor, progress));
    const SlopeField slopes = slopes_of_normals(found.normals);
    out.normals = std::move(found.normals);
    out.albedo = std::move(found.albedo);
    out.notes = std::move(found.notes);
    // Central differences, as normals are derived from the tiles.
    const bool torus = is_toroidal(slopes);
    auto height = integrate(slopes, Difference::central,
                            torus ? Periodicity::torus : Periodicity::mirror);
    if (torus) return height;
    remove_tilt(height);
    return height;
}

Result<BasicImage<double>> height_by_shading(const Measurement& measurement,
                                             const RangeMapOptions& options,
                                             RangeMap& out, Executor& executor,
                                             Progress& progress) {
    SATEEN_TRY(const Image image, measurement.read(0));
    ShadingOptions shading;
    shading.light = options.light;
    const MeasurementInfo& info = measurement.info();
    if (!shading.light && info.has_directions())
        shading.light = info.lights[info.observations[0].light];
    SATEEN_TRY(ShadingEstimate found,
               shape_from_shading(image, shading, executor, progress));
    out.normals = normals_of_slopes(slopes_of(found.height_px, Difference::central));
    out.albedo = Image(1, found.height_px.rows(), found.height_px.cols());
    for (float& v : out.albedo.values()) v = static_cast<float>(found.albedo);
    out.light = found.light;
    out.light_estimated = found.light_estimated;
    const auto degrees = [](float radians) {
        return std::to_string(std::lround(radians / kRadiansPerDegree));
    };
    if (found.light_estimated)
        out.notes.push_back("shape from shading: light estimated at theta " +
                            degrees(found.light.theta) + " (assumed), phi " +
                            degrees(found.light.phi) + " degrees");
    return std::move(found.height_px);
}

/// Entropy of bytes, in bytes: what gzip comes close to.
double entropy_bytes(const std::vector<std::uint8_t>& bytes) {
    std::array<double, 256> counts = {};
    for (const std::uint8_t byte : bytes) ++counts[byte];
    double bits = 0;
    for (const double count : counts)
        if (count > 0)
            bits -= count * std::log2(count / static_cast<double>(bytes.size()));
    return bits / 8;
}

std::size_t estimated_bytes(const Surface& surface) {
    std::vector<std::uint8_t> low;
    std::vector<std::uint8_t> high;
    for (const auto& tile : surface.tiles)
        append_residuals(tile, surface.cols, low, high);
    return static_cast<std::size_t>(entropy_bytes(low) + entropy_bytes(high));
}

float range_of(const std::vector<Image>& tiles) {
    float low = tiles[0].values()[0];
    float high = low;
    for (const Image& tile : tiles)
        for (const float z : tile.values()) {
            low = std::min(low, z);
            high = std::max(high, z);
        }
    return high - low;
}

/// The finest steps that the budget allows, then as many tiles.
Result<void> quantise_within(std::vector<Image> tiles, std::uint32_t shear,
                             std::size_t budget, RangeMap& out) {
    const float coarsest = kCoarsestStep * range_of(tiles);
    float step = std::min(kFinestStep, coarsest);
    for (;;) {
        SATEEN_TRY(out.surface, quantise_surface(tiles, step, shear));
        out.estimated_bytes = estimated_bytes(out.surface);
        if (out.estimated_bytes <= budget) return {};
        if (step < coarsest)
            step = std::min(coarsest, 1.25F * step);
        else if (tiles.size() > 1)
            tiles.pop_back();
        else
            return {};
    }
}

Result<RangeMap> estimate_by(SurfaceMethod method, const Measurement& measurement,
                             const RangeMapOptions& options, Executor& executor,
                             Progress& progress) {
    RangeMap out;
    out.method = method;
    SATEEN_TRY(const BasicImage<double> height,
               method == SurfaceMethod::stereo
                   ? height_by_stereo(measurement, options, out, executor, progress)
                   : height_by_shading(measurement, options, out, executor, progress));
    out.height_px = to_float(height);
    RollerOptions roller;
    roller.tiles = options.tiles;
    SATEEN_TRY(RolledSurface rolled, roll(sample_of(height), roller));
    out.seam_ratio = rolled.seam_ratio;
    out.normal_seam_ratio = rolled.normal_seam_ratio;
    SATEEN_CHECK(quantise_within(std::move(rolled.tiles), rolled.shear_px,
                                 options.budget_bytes, out));
    return out;
}

}  // namespace

Result<SurfaceMethod> parse_surface_method(std::string_view text) {
    if (text == "auto") return SurfaceMethod::automatic;
    if (text == "stereo") return SurfaceMethod::stereo;
    if (text == "shading") return SurfaceMethod::shading;
    if (text == "none") return SurfaceMethod::none;
    return Error{Errc::invalid_argument, "surface: found '" + std::string(text) +
                                             "', expected auto, stereo, shading or none"};
}

Result<std::optional<RangeMap>> estimate_range_map(const Measurement& measurement,
                                                   const RangeMapOptions& options,
                                                   Executor& executor,
                                                   Progress& progress) {
    SurfaceMethod method = options.method;
    const bool automatic = method == SurfaceMethod::automatic;
    if (automatic)
        method = lights_from_above(measurement.info()) >= kFewestLights
                     ? SurfaceMethod::stereo
                     : SurfaceMethod::none;
    if (method == SurfaceMethod::none) return std::optional<RangeMap>();
    progress.stage("finding the surface");
    Result<RangeMap> found =
        estimate_by(method, measurement, options, executor, progress);
    if (found) return std::optional<RangeMap>(std::move(*found));
    // Lights in one plane, or a sample too small for tiles: nobody asked for a surface.
    const Errc code = found.error().code;
    if (automatic && (code == Errc::singular || code == Errc::invalid_argument))
        return std::optional<RangeMap>();
    return std::move(found).error();
}

}  // namespace sateen
