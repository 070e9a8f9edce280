// SPDX-License-Identifier: Apache-2.0
// Over-determined photometric stereo. See photometric_stereo.hpp.
#include "sateen/analysis/photometric_stereo.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sateen/core/direction.hpp"

namespace sateen {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector = std::array<double, 3>;

constexpr double kSaturated = 0.995;
constexpr double kShadow = 0.1;       // of the median: attached or cast shadow
constexpr double kHighlights = 0.15;  // of the values, left out of the first estimate
constexpr int kIterations = 8;
constexpr double kCauchy = 2.385 * 1.4826;  // tuning constant x median to deviation
constexpr double kLeastScale = 1e-3;        // of |g|: rounding of 8-bit values
constexpr double kLargestCondition = 20;
constexpr std::size_t kFewestValues = 5;
// Lights below 30° above the horizon see mostly shadow.
constexpr double kGrazing = 0.5;

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// g and whether the lights that have weight span it.
std::optional<Vector3d> solve(std::span<const double> values,
                              std::span<const Vector> lights,
                              std::span<const double> weights) {
    Matrix3d A = Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    for (std::size_t k = 0; k < values.size(); ++k) {
        const Vector3d l(lights[k][0], lights[k][1], lights[k][2]);
        A.noalias() += weights[k] * (l * l.transpose());
        b += weights[k] * values[k] * l;
    }
    Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
    eigen.computeDirect(A);
    const Vector3d lambda = eigen.eigenvalues();
    if (!(lambda[0] * kLargestCondition * kLargestCondition > lambda[2]))
        return std::nullopt;
    return eigen.eigenvectors() *
           (eigen.eigenvectors().transpose() * b).cwiseQuotient(lambda);
}

class RobustFit {
  public:
    RobustFit(std::span<const double> values, std::span<const Vector> lights)
        : values_(values), lights_(lights), prior_(values.size(), 0) {
        choose_values();
    }

    /// Nothing if too few values are left.
    std::optional<std::pair<Vector3d, std::vector<double>>> run() {
        std::vector<double> weights = first_weights();
        std::optional<Vector3d> g = solve(values_, lights_, weights);
        for (int i = 0; g && i < kIterations; ++i) {
            if (!reweight(*g, weights)) return std::nullopt;
            g = solve(values_, lights_, weights);
        }
        if (!g) return std::nullopt;
        return std::pair{*g, std::move(weights)};
    }

    [[nodiscard]] std::size_t used(std::span<const double> weights) const {
        std::size_t count = 0;
        for (std::size_t k = 0; k < weights.size(); ++k)
            count +=
                static_cast<std::size_t>(prior_[k] > 0 && weights[k] >= 0.1 * prior_[k]);
        return count;
    }

  private:
    void choose_values() {
        std::vector<double> lit;
        for (const double value : values_)
            if (value > 0) lit.push_back(value);
        if (lit.empty()) return;
        const double shadow = kShadow * median(lit);
        for (std::size_t k = 0; k < values_.size(); ++k)
            if (values_[k] > shadow && values_[k] < kSaturated && lights_[k][2] > 0)
                prior_[k] = std::min(1.0, lights_[k][2] / kGrazing);
    }

    // Without the brightest of the values that are left, where highlights are.
    std::vector<double> first_weights() const {
        std::vector<double> kept;
        for (std::size_t k = 0; k < values_.size(); ++k)
            if (prior_[k] > 0) kept.push_back(values_[k]);
        std::vector<double> weights = prior_;
        if (kept.size() < 2 * kFewestValues) return weights;
        const auto nth =
            kept.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(kept.size()) *
                                                       (1 - kHighlights));
        std::nth_element(kept.begin(), nth, kept.end());
        for (std::size_t k = 0; k < values_.size(); ++k)
            if (values_[k] >= *nth) weights[k] = 0;
        return weights;
    }

    bool reweight(const Vector3d& g, std::vector<double>& weights) {
        residuals_.clear();
        std::vector<double> e(values_.size());
        for (std::size_t k = 0; k < values_.size(); ++k) {
            const double shading =
                g[0] * lights_[k][0] + g[1] * lights_[k][1] + g[2] * lights_[k][2];
            e[k] = std::abs(values_[k] - std::max(0.0, shading));
            if (prior_[k] > 0) residuals_.push_back(e[k]);
        }
        if (residuals_.size() < kFewestValues) return false;
        const double c = kCauchy * std::max(median(residuals_), kLeastScale * g.norm());
        if (!(c > 0)) return false;
        for (std::size_t k = 0; k < values_.size(); ++k)
            weights[k] = prior_[k] / (1 + (e[k] / c) * (e[k] / c));
        return used(weights) >= kFewestValues;
    }

    std::span<const double> values_;
    std::span<const Vector> lights_;
    std::vector<double> prior_;
    std::vector<double> residuals_;
};

struct WeightedFit {
    NormalFit fit;
    std::vector<double> weights;
};

WeightedFit fit_weighted(std::span<const double> values, std::span<const Vector> lights,
                         bool robust) {
    const auto found = [](const Vector3d& g, std::size_t used, std::vector<double> w) {
        return WeightedFit{{{g[0], g[1], g[2]}, used}, std::move(w)};
    };
    if (robust) {
        RobustFit fit(values, lights);
        if (auto result = fit.run()) {
            const std::size_t used = fit.used(result->second);
            return found(result->first, used, std::move(result->second));
        }
    }
    std::vector<double> ones(values.size(), 1.0);
    const std::optional<Vector3d> g = solve(values, lights, ones);
    return found(g ? *g : Vector3d(0, 0, 0), values.size(), std::move(ones));
}

double luminance(std::span<const double> colour) {
    if (colour.size() == 1) return colour[0];
    return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
}

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
    void put(std::size_t image, std::size_t first_row, const Image& from) {
        for (std::size_t band = 0; band < bands_; ++band) {
            const float* row = from.plane(band).row(first_row);
            std::copy(row, row + pixels_, &values_[(image * bands_ + band) * pixels_]);
        }
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
        const std::vector<double> ones(images_.lights.size(), 1.0);
        if (images_.lights.size() >= 3 && solve(ones, images_.lights, ones)) return {};
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
            SATEEN_TRY(complete, read(first, *strip));
            SATEEN_CHECK(check_lights());
        }
        std::vector<double> used(rows);
        parallel_for(executor_, rows, [&](std::size_t r) {
            for (std::size_t c = 0; c < info.cols; ++c)
                used[r] += fit_pixel(*strip, r * info.cols + c, first + r, c);
        });
        for (const double row : used) used_ += row;
        return {};
    }

    /// Reads all images. Leaves out those that cannot be read, and is false then: the
    /// strip is to be read again without them.
    Result<bool> read(std::size_t first, Strip& strip) {
        const std::size_t count = images_.observations.size();
        std::vector<std::optional<Error>> errors(count);
        parallel_for(executor_, count, [&](std::size_t k) {
            if (progress_.cancelled()) return;
            const Result<Image> image = measurement_.read(images_.observations[k]);
            if (image)
                strip.put(k, first, *image);
            else
                errors[k] = image.error();
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

    double fit_pixel(const Strip& strip, std::size_t pixel, std::size_t r,
                     std::size_t c) {
        const std::size_t bands = out_.albedo.bands();
        const std::vector<Vector>& lights = images_.lights;
        std::vector<double> values(lights.size());
        std::vector<std::array<double, 3>> colours(lights.size());
        for (std::size_t k = 0; k < lights.size(); ++k) {
            for (std::size_t band = 0; band < bands; ++band)
                colours[k][band] = images_.factors[k] * strip.value(k, band, pixel);
            values[k] = luminance({colours[k].data(), bands});
        }
        const WeightedFit fitted = fit_weighted(values, lights, options_.robust);
        Vector3d n(fitted.fit.g[0], fitted.fit.g[1], fitted.fit.g[2]);
        const double length = n.norm();
        n = length > 0 ? Vector3d(n / length) : Vector3d(0, 0, 1);
        for (std::size_t band = 0; band < bands; ++band) {
            double product = 0;
            double square = 0;
            for (std::size_t k = 0; k < lights.size(); ++k) {
                const double s =
                    n[0] * lights[k][0] + n[1] * lights[k][1] + n[2] * lights[k][2];
                if (s <= 0) continue;
                product += fitted.weights[k] * s * colours[k][band];
                square += fitted.weights[k] * s * s;
            }
            out_.albedo(band, r, c) =
                static_cast<float>(square > 0 ? std::max(0.0, product / square) : 0.0);
        }
        for (std::size_t i = 0; i < 3; ++i)
            out_.normals(i, r, c) = static_cast<float>(n[static_cast<Eigen::Index>(i)]);
        return static_cast<double>(fitted.fit.used);
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
    StereoEstimate out_;
    double used_ = 0;
};

}  // namespace

NormalFit fit_normal(std::span<const double> values,
                     std::span<const std::array<double, 3>> lights, bool robust) {
    return fit_weighted(values, lights, robust).fit;
}

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
