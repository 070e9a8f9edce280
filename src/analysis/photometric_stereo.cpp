// SPDX-License-Identifier: Apache-2.0
// Over-determined photometric stereo. See photometric_stereo.hpp.
#include "sateen/analysis/photometric_stereo.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/pixel_normal.hpp"
#include "sateen/core/direction.hpp"

namespace sateen {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector = std::array<double, 3>;

constexpr double kSaturated = 0.995;
// Mixtures of channels are fitted so many times: better normals know gloss better.
constexpr int kMixtures = 2;
// A layer over the body is taken only if lights agree so much better with it.
constexpr double kLayerAgrees = 0.99;
// Pixels a side of those that say whether there is one.
constexpr std::size_t kSamplesASide = 24;

std::uint32_t most_upright(const std::vector<Direction>& views) {
    const auto nearest =
        std::min_element(views.begin(), views.end(),
                         [](Direction a, Direction b) { return a.theta < b.theta; });
    return static_cast<std::uint32_t>(nearest - views.begin());
}

/// The images of one view and their lights.
struct LitImages {
    std::vector<std::size_t> observations;
    std::vector<Vector> lights;
    std::vector<double> factors;  ///< from the values of the files to those with cos θ

    void leave_out(std::size_t k) {
        const auto at = static_cast<std::ptrdiff_t>(k);
        observations.erase(observations.begin() + at);
        lights.erase(lights.begin() + at);
        factors.erase(factors.begin() + at);
    }
};

LitImages images_of_view(const MeasurementInfo& info, std::uint32_t view,
                         const StereoOptions& options) {
    LitImages out;
    for (std::size_t i = 0; i < info.observations.size(); ++i) {
        const Observation& observation = info.observations[i];
        const auto& without = options.without_lights;
        if (observation.view != view ||
            std::find(without.begin(), without.end(), observation.light) != without.end())
            continue;
        const auto l = to_vector(info.lights[observation.light]);
        out.observations.push_back(i);
        out.lights.push_back({static_cast<double>(l[0]), static_cast<double>(l[1]),
                              static_cast<double>(l[2])});
        out.factors.push_back(
            info.radiometry.cosine_included ? 1.0 : static_cast<double>(l[2]));
    }
    return out;
}

/// Rows of all images, (images, bands, rows, cols).
class Strip {
  public:
    Strip(std::size_t images, std::size_t bands, std::size_t rows, std::size_t cols)
        : bands_(bands), pixels_(rows * cols), values_(images * bands * rows * cols) {}
    [[nodiscard]] std::size_t pixels() const { return pixels_; }
    void put(std::size_t image, std::size_t first_row, const Image& from) {
        for (std::size_t band = 0; band < bands_; ++band) {
            const float* row = from.plane(band).row(first_row);
            std::copy(row, row + pixels_, &values_[(image * bands_ + band) * pixels_]);
        }
    }
    /// Pixels of the given numbers.
    void put(std::size_t image, std::span<const std::size_t> pixels, const Image& from) {
        for (std::size_t band = 0; band < bands_; ++band)
            for (std::size_t i = 0; i < pixels.size(); ++i)
                values_[(image * bands_ + band) * pixels_ + i] =
                    from.plane(band).data[pixels[i]];
    }
    [[nodiscard]] double value(std::size_t image, std::size_t band,
                               std::size_t pixel) const {
        return static_cast<double>(values_[(image * bands_ + band) * pixels_ + pixel]);
    }

  private:
    std::size_t bands_;
    std::size_t pixels_;
    std::vector<float> values_;
};

class Stereo {
  public:
    Stereo(const Measurement& measurement, const StereoOptions& options,
           Executor& executor, Progress& progress)
        : measurement_(measurement),
          options_(options),
          executor_(executor),
          progress_(progress) {}

    Result<StereoEstimate> run() {
        const MeasurementInfo& info = measurement_.info();
        out_.view = most_upright(info.views);
        images_ = images_of_view(info, out_.view, options_);
        SATEEN_CHECK(check_lights());
        out_.normals = Image(3, info.rows, info.cols);
        out_.albedo = Image(info.bands, info.rows, info.cols);
        const std::size_t row_bytes =
            images_.lights.size() * info.bands * info.cols * sizeof(float);
        const std::size_t height =
            std::clamp<std::size_t>(options_.memory_bytes / row_bytes, 1, info.rows);
        for (std::size_t row = 0; row < info.rows; row += height)
            SATEEN_CHECK(fit_rows(row, std::min(height, info.rows - row)));
        out_.lights = images_.lights.size();
        out_.mean_used = used_ / static_cast<double>(info.rows * info.cols * out_.lights);
        make_upright();
        return std::move(out_);
    }

  private:
    Result<void> check_lights() const {
        if (span_space(images_.lights)) return {};
        return Error{Errc::singular,
                     "photometric stereo: " + std::to_string(images_.lights.size()) +
                         " lights of view " + std::to_string(out_.view) +
                         ", expected at least 3 that are not in one plane"};
    }

    Result<void> fit_rows(std::size_t first, std::size_t rows) {
        const MeasurementInfo& info = measurement_.info();
        std::optional<Strip> strip;
        for (bool complete = false; !complete;) {
            strip.emplace(images_.lights.size(), info.bands, rows, info.cols);
            if (first == 0) sample_pixels();
            SATEEN_TRY(complete, read(first, *strip));
            SATEEN_CHECK(check_lights());
        }
        if (first == 0 && options_.robust) choose_body();
        std::vector<double> used(rows);
        parallel_for(executor_, rows, [&](std::size_t r) {
            PixelFitter fitter(images_.lights, body_);
            for (std::size_t c = 0; c < info.cols; ++c)
                used[r] += fit_pixel(fitter, *strip, r * info.cols + c, first + r, c);
        });
        for (const double row : used) used_ += row;
        return {};
    }

    /// Pixels evenly all over the images.
    void sample_pixels() {
        const MeasurementInfo& info = measurement_.info();
        const std::size_t rows = std::min(kSamplesASide, info.rows);
        const std::size_t cols = std::min(kSamplesASide, info.cols);
        sampled_.clear();
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c)
                sampled_.push_back((2 * r + 1) * info.rows / (2 * rows) * info.cols +
                                   (2 * c + 1) * info.cols / (2 * cols));
        samples_.emplace(images_.lights.size(), info.bands, rows, cols);
    }

    /// Reads all images. Leaves out those that cannot be read, and is false then: the
    /// strip is to be read again without them.
    Result<bool> read(std::size_t first, Strip& strip) {
        const std::size_t count = images_.observations.size();
        std::vector<std::optional<Error>> errors(count);
        parallel_for(executor_, count, [&](std::size_t k) {
            if (progress_.cancelled()) return;
            const Result<Image> image = measurement_.read(images_.observations[k]);
            if (image) {
                strip.put(k, first, *image);
                if (first == 0) samples_->put(k, sampled_, *image);
            } else {
                errors[k] = image.error();
            }
        });
        if (progress_.cancelled())
            return Error{Errc::cancelled, "cancelled while reading images"};
        bool complete = true;
        for (std::size_t k = count; k-- > 0;) {
            if (!errors[k]) continue;
            if (!options_.skip_bad) return *std::move(errors[k]);
            images_.leave_out(k);
            out_.notes.push_back("photometric stereo without " + errors[k]->message);
            complete = false;
        }
        return complete;
    }

    /// Whether the body lies under a layer, by how well the lights of pixels all over agree.
    void choose_body() {
        double disagreement[2] = {};
        for (const Body body : {Body::lambert, Body::under_a_layer}) {
            std::vector<double> found;
            PixelFitter fitter(images_.lights, body);
            for (std::size_t i = 0; i < samples_->pixels(); ++i) {
                const Pixel pixel = pixel_of(*samples_, i);
                if (const auto fit = fitter.robust(pixel.values, pixel.usable))
                    found.push_back(fit->disagreement);
            }
            disagreement[body == Body::lambert ? 0 : 1] = median(std::move(found));
        }
        if (disagreement[1] < kLayerAgrees * disagreement[0]) body_ = Body::under_a_layer;
    }

    static double median(std::vector<double> values) {
        if (values.empty()) return 0;
        const auto middle =
            values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    }

    struct Pixel {
        std::vector<std::array<double, 3>> colours;
        std::vector<double> values;  ///< luminance
        std::vector<std::uint8_t> usable;
    };

    [[nodiscard]] Pixel pixel_of(const Strip& strip, std::size_t pixel) const {
        const std::size_t bands = out_.albedo.bands();
        const std::size_t lights = images_.lights.size();
        Pixel out{std::vector<std::array<double, 3>>(lights), std::vector<double>(lights),
                  std::vector<std::uint8_t>(lights, 1)};
        for (std::size_t k = 0; k < lights; ++k) {
            for (std::size_t band = 0; band < bands; ++band) {
                const double value = strip.value(k, band, pixel);
                if (value >= kSaturated) out.usable[k] = 0;
                out.colours[k][band] = images_.factors[k] * value;
            }
            out.values[k] = luminance(out.colours[k], bands);
        }
        return out;
    }

    double fit_pixel(PixelFitter& fitter, const Strip& strip, std::size_t at,
                     std::size_t r, std::size_t c) {
        Pixel pixel = pixel_of(strip, at);
        std::optional<PixelNormal> fit;
        if (options_.robust) fit = fitter.robust(pixel.values, pixel.usable);
        const bool robust = fit.has_value();
        if (!robust) fit = fitter.plain(pixel.values);
        if (!fit) fit.emplace(PixelNormal{Vector3d(0, 0, 1), 0, 0});
        std::vector<double> weights(fitter.weights().begin(), fitter.weights().end());
        if (robust && out_.albedo.bands() == 3)
            fit_mixtures(fitter, pixel, weights, *fit);
        const double length = fit->g.norm();
        const Vector3d n = length > 0 ? Vector3d(fit->g / length) : Vector3d(0, 0, 1);
        const auto albedo = body_colour(pixel.colours, cosines(n), weights);
        for (std::size_t band = 0; band < out_.albedo.bands(); ++band)
            out_.albedo(band, r, c) = static_cast<float>(albedo[band]);
        for (std::size_t i = 0; i < 3; ++i)
            out_.normals(i, r, c) = static_cast<float>(n[static_cast<Eigen::Index>(i)]);
        return static_cast<double>(fit->used);
    }

    /// Fits mixtures of the channels that gloss hardly enters, and keeps the fit on which the
    /// lights agree best.
    static void fit_mixtures(PixelFitter& fitter, Pixel& pixel,
                             std::span<const double> weights, PixelNormal& best) {
        Vector3d g = best.g;
        for (int i = 0; i < kMixtures; ++i) {
            const std::span<const double> shading = fitter.shading(g);
            const auto body = body_colour(pixel.colours, shading, weights);
            const auto mixture = quiet_mixture(pixel.colours, shading, weights, body);
            if (!mixture) return;
            for (std::size_t k = 0; k < pixel.values.size(); ++k)
                pixel.values[k] = (*mixture)[0] * pixel.colours[k][0] +
                                  (*mixture)[1] * pixel.colours[k][1] +
                                  (*mixture)[2] * pixel.colours[k][2];
            const auto fit = fitter.robust(pixel.values, pixel.usable);
            if (!fit) return;
            g = fit->g;
            if (fit->disagreement < best.disagreement) best = *fit;
        }
    }

    [[nodiscard]] std::vector<double> cosines(const Vector3d& n) const {
        std::vector<double> out;
        for (const Vector& l : images_.lights)
            out.push_back(std::max(0.0, n[0] * l[0] + n[1] * l[1] + n[2] * l[2]));
        return out;
    }

    void make_upright() {
        Vector3d mean = Vector3d::Zero();
        const std::size_t size = out_.normals.plane_size();
        const auto normal = [&](std::size_t i) {
            return Vector3d(static_cast<double>(out_.normals.plane(0).data[i]),
                            static_cast<double>(out_.normals.plane(1).data[i]),
                            static_cast<double>(out_.normals.plane(2).data[i]));
        };
        for (std::size_t i = 0; i < size; ++i) mean += normal(i);
        if (!(mean.norm() > 0)) return;
        mean.normalize();
        out_.up = {mean[0], mean[1], mean[2]};
        if (!options_.upright) return;
        const Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(mean, Vector3d::UnitZ())
                                  .toRotationMatrix();
        for (std::size_t i = 0; i < size; ++i) {
            const Vector3d n = turn * normal(i);
            for (std::size_t band = 0; band < 3; ++band)
                out_.normals.plane(band).data[i] =
                    static_cast<float>(n[static_cast<Eigen::Index>(band)]);
        }
    }

    const Measurement& measurement_;
    const StereoOptions& options_;
    Executor& executor_;
    Progress& progress_;
    LitImages images_;
    Body body_ = Body::lambert;
    std::vector<std::size_t> sampled_;
    std::optional<Strip> samples_;  ///< of the pixels sampled
    StereoEstimate out_;
    double used_ = 0;
};

}  // namespace

Result<StereoEstimate> photometric_stereo(const Measurement& measurement,
                                          const StereoOptions& options,
                                          Executor& executor, Progress& progress) {
    if (!measurement.info().has_directions())
        return Error{Errc::invalid_argument,
                     measurement.info().name +
                         ": photographs without directions, expected several lights"};
    return Stereo(measurement, options, executor, progress).run();
}

}  // namespace sateen
