// SPDX-License-Identifier: Apache-2.0
// Segmentation of the BTF space. See segment.hpp.
#include "sateen/analysis/segment.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "sateen/analysis/colour_histogram.hpp"
#include "sateen/analysis/kmeans.hpp"
#include "sateen/analysis/oriented_contrast.hpp"
#include "sateen/material/material.hpp"

namespace sateen {
namespace {

// Features that differ by less, in √Lab, differ by rounding: one pixel of an image of
// 1000 x 1000 in another bin makes 7e-7.
constexpr double kResolution = 1e-7;

// One row an image.
using Features = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// What is kept of an image after the pass.
struct Summary {
    ColourHistogram colour;
    OrientedContrast contrast = {};
    ImageMoments moments;
};

// Images are compared by so many of their pixels at most: a distribution is known to 1 %
// from them, and the pass then takes little longer than decoding.
constexpr std::size_t kCounted = 8192;

// Every `step`-th pixel of every `step`-th row.
Image thinned(ImageView<const float> image, std::size_t step) {
    Image thin(image.bands, (image.rows + step - 1) / step,
               (image.cols + step - 1) / step, uninitialised);
    for (std::size_t band = 0; band < image.bands; ++band)
        for (std::size_t r = 0; r < thin.rows(); ++r) {
            const float* from = image.plane(band).row(r * step);
            float* to = thin.plane(band).row(r);
            for (std::size_t c = 0; c < thin.cols(); ++c) to[c] = from[c * step];
        }
    return thin;
}

Summary summarise(ImageView<const float> image, bool oriented) {
    std::size_t step = 1;
    while (image.plane_size() > kCounted * step * step) ++step;
    const Image thin = thinned(image, step);
    Summary summary;
    summary.moments = image_moments(thin.view());
    if (!oriented) {
        summary.colour = colour_histogram(thin.view());
        return summary;
    }
    Image lightness(1, thin.rows(), thin.cols(), uninitialised);
    summary.colour = colour_histogram(thin.view(), lightness.plane(0));
    summary.contrast = oriented_contrast(std::as_const(lightness).plane(0),
                                         std::max<std::size_t>(1, 3 / step));
    return summary;
}

Result<void> check(const SegmentationOptions& options, std::size_t images) {
    const auto out_of_range = [](const std::string& name, const std::string& expected) {
        return Error{Errc::invalid_argument, name + ": expected " + expected};
    };
    if (images == 0)
        return Error{Errc::invalid_argument,
                     "the measurement holds no images to segment"};
    if (options.subspaces > kMaxSubspaces)
        return Error{Errc::invalid_argument,
                     "subspaces: found " + std::to_string(options.subspaces) +
                         ", expected 1 to " + std::to_string(kMaxSubspaces) +
                         ", or 0 for automatic"};
    if (!(options.share > 0 && options.share <= 1))
        return out_of_range("share", "a number above 0 and up to 1");
    if (options.restarts < 1 || options.restarts > 1000)
        return out_of_range("restarts", "1 to 1000");
    if (!(options.orientation_weight >= 0 && std::isfinite(options.orientation_weight)))
        return out_of_range("orientation_weight", "a number not below 0");
    if (!(options.side_weight >= 0 && std::isfinite(options.side_weight)))
        return out_of_range("side_weight", "a number not below 0");
    if (!(options.grazing_penalty >= 0 && std::isfinite(options.grazing_penalty)))
        return out_of_range("grazing_penalty", "a number not below 0");
    return {};
}

/// The light of an observation across the columns and up the rows, 0 where it is unknown.
std::array<double, 2> light_across(const MeasurementInfo& info, std::size_t observation) {
    const std::uint32_t light = info.observations[observation].light;
    if (light >= info.lights.size()) return {0, 0};
    const auto l = to_vector(info.lights[light]);
    return {static_cast<double>(l[0]), static_cast<double>(l[1])};
}

/// Contrast along the columns, number 0, or along the rows, number 2, as a root.
double contrast_along(const Summary& summary, std::size_t axis) {
    return std::sqrt(summary.contrast[2 * axis]);
}

Features make_features(std::span<const Summary> summaries, const MeasurementInfo& info,
                       std::span<const std::size_t> readable,
                       const SegmentationOptions& options) {
    const double orientation_weight = options.orientation_weight;
    std::vector<ColourHistogram> histograms;
    for (const std::size_t i : readable) histograms.push_back(summaries[i].colour);
    const FeatureGrid grid = common_grid(histograms);
    const std::size_t oriented =
        orientation_weight > 0 ? std::tuple_size_v<OrientedContrast> : 0;
    const std::size_t sided = options.side_weight > 0 && oriented > 0 ? 2 : 0;
    Features features(readable.size(), kColourFeatures + oriented + sided);
    // What the image that shows least of it has is there without any light from the side.
    std::array<double, 2> least = {};
    for (std::size_t k = 0; k < sided; ++k) {
        least[k] = contrast_along(summaries[readable.front()], k);
        for (const std::size_t i : readable)
            least[k] = std::min(least[k], contrast_along(summaries[i], k));
    }
    for (std::size_t row = 0; row < readable.size(); ++row) {
        double* f = features.row(static_cast<Eigen::Index>(row)).data();
        cumulative_feature(histograms[row], grid,
                           std::span<double, kColourFeatures>(f, kColourFeatures));
        // Roots, so that squared distances are in Lab units as the Cramér distance is; less
        // their mean, since the histogram of L has seen the contrast as a whole.
        double mean = 0;
        for (std::size_t k = 0; k < oriented; ++k)
            mean += std::sqrt(summaries[readable[row]].contrast[k]) / 4.0;
        for (std::size_t k = 0; k < oriented; ++k) {
            const double root = std::sqrt(summaries[readable[row]].contrast[k]);
            f[kColourFeatures + k] = orientation_weight * (root - mean);
        }
        const std::array<double, 2> light = light_across(info, readable[row]);
        for (std::size_t k = 0; k < sided; ++k)
            f[kColourFeatures + oriented + k] =
                options.side_weight * light[k] *
                (contrast_along(summaries[readable[row]], k) - least[k]);
    }
    return features;
}

struct Reduced {
    Features features;
    double lost = 0;                  // sum of squares that they leave out
    std::vector<double> eigenvalues;  // shares of all squares, descending
};

// The features in their leading principal components, which hold all but kLost of their
// sum of squares: K-means costs as many operations as there are numbers, and here 20 of
// 192 tell all. Expects features of zero mean.
Reduced reduce(const Features& features) {
    constexpr double kLost = 1e-3;
    constexpr double kLeastShare = 1e-6;
    const Eigen::Index size = features.cols();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(features.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
    const double squares = covariance.trace();
    const double allowed = kLost * squares;
    Reduced reduced;
    for (Eigen::Index i = size;
         i-- > 0 && eigen.eigenvalues()[i] > kLeastShare * squares;)
        reduced.eigenvalues.push_back(eigen.eigenvalues()[i] / squares);
    Eigen::Index kept = size;  // eigenvalues ascend
    while (kept > 1) {
        const double next =
            reduced.lost + std::max(0.0, eigen.eigenvalues()[size - kept]);
        if (next > allowed) break;
        reduced.lost = next;
        --kept;
    }
    reduced.features =
        features * eigen.eigenvectors().rightCols(kept).rowwise().reverse();
    return reduced;
}

// The clusters that were asked for; or the smallest number of them, up to kMaxSubspaces,
// that explains `share` of the variance, found by bisection, since the least inertia
// falls with their number. The search makes do with two starts (one finds a cluster too
// many on real materials): all of them, the same two included, can only explain more, so
// the share is always met, if possibly with more clusters than the best starts would need.
Clustering cluster(const Features& features, const Reduced& reduced,
                   const SegmentationOptions& options, Executor& executor) {
    const PlaneView<const double> points(
        reduced.features.data(), static_cast<std::size_t>(reduced.features.rows()),
        static_cast<std::size_t>(reduced.features.cols()));
    const auto run = [&](std::size_t clusters, std::uint32_t restarts) {
        return kmeans(points, {clusters, options.seed, restarts, kResolution}, executor);
    };
    if (options.subspaces != 0) return run(options.subspaces, options.restarts);
    const double rounding = static_cast<double>(points.rows) * kResolution * kResolution;
    const double allowed =
        std::max(rounding, (1.0 - options.share) * features.squaredNorm() - reduced.lost);
    const std::uint32_t few = std::min(options.restarts, 2U);
    std::size_t below = 0;
    std::size_t enough = kMaxSubspaces;
    while (enough - below > 1) {
        const std::size_t middle = below + (enough - below) / 2;
        if (run(middle, few).inertia > allowed) {
            below = middle;
        } else {
            enough = middle;
        }
    }
    return run(enough, options.restarts);
}

// Renumbers the clusters by the mean lightness of their members, dark to light, so that
// the number of a cluster does not depend on the start that found it.
void sort_by_lightness(Clustering& clustering, std::span<const double> lightness) {
    std::vector<double> sum(clustering.clusters);
    std::vector<double> count(clustering.clusters);
    for (std::size_t i = 0; i < lightness.size(); ++i) {
        sum[clustering.labels[i]] += lightness[i];
        ++count[clustering.labels[i]];
    }
    std::vector<std::uint32_t> order(clustering.clusters);
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return sum[a] / count[a] < sum[b] / count[b];
    });
    std::vector<std::uint32_t> rank(order.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
    for (std::uint32_t& label : clustering.labels) label = rank[label];
}

// Squared distances of the features from the means of their clusters.
std::vector<double> squared_radii(const Features& features,
                                  const Clustering& clustering) {
    const auto clusters = static_cast<Eigen::Index>(clustering.clusters);
    Features centre = Features::Zero(clusters, features.cols());
    Eigen::VectorXd count = Eigen::VectorXd::Zero(clusters);
    for (Eigen::Index i = 0; i < features.rows(); ++i) {
        const std::uint32_t k = clustering.labels[static_cast<std::size_t>(i)];
        centre.row(k) += features.row(i);
        count[k] += 1;
    }
    centre.array().colwise() /= count.array();
    std::vector<double> radii(clustering.labels.size());
    for (Eigen::Index i = 0; i < features.rows(); ++i) {
        const auto n = static_cast<std::size_t>(i);
        radii[n] = (features.row(i) - centre.row(clustering.labels[n])).squaredNorm();
    }
    return radii;
}

// 1 - cos θ_v, 0 where the view is unknown.
double grazing(const MeasurementInfo& info, std::size_t observation) {
    const std::uint32_t view = info.observations[observation].view;
    if (view >= info.views.size()) return 0;
    return 1.0 - std::cos(static_cast<double>(info.views[view].theta));
}

// Fills in representatives and members. Of equals, the first observation.
void choose_representatives(Segmentation& segmentation, const MeasurementInfo& info,
                            std::span<const std::size_t> readable,
                            const Clustering& clustering, std::span<const double> radii,
                            double grazing_penalty) {
    const std::size_t clusters = clustering.clusters;
    segmentation.members.assign(clusters, 0);
    std::vector<double> spread(clusters);
    for (std::size_t i = 0; i < readable.size(); ++i) {
        ++segmentation.members[clustering.labels[i]];
        spread[clustering.labels[i]] += radii[i];
    }
    segmentation.representatives.assign(clusters, info.observations.size());
    std::vector<double> least(clusters);
    for (std::size_t i = 0; i < readable.size(); ++i) {
        const std::uint32_t k = clustering.labels[i];
        const double mean = spread[k] / segmentation.members[k];
        const double score = (mean > 0 ? radii[i] / mean : 0.0) +
                             grazing_penalty * grazing(info, readable[i]);
        std::size_t& chosen = segmentation.representatives[k];
        if (chosen == info.observations.size() || score < least[k]) {
            chosen = readable[i];
            least[k] = score;
        }
    }
}

}  // namespace

Result<Segmentation> segment(const Measurement& measurement,
                             const SegmentationOptions& options, Executor& executor,
                             Progress& progress) {
    const MeasurementInfo& info = measurement.info();
    const std::size_t images = info.observations.size();
    SATEEN_CHECK(check(options, images));

    // 1. Reduce every image to its histograms.
    std::vector<Summary> summaries(images);
    Segmentation result;
    SATEEN_TRY(result.pass,
               for_each_image(measurement, options.skip_bad, executor, progress,
                              [&](std::size_t i, const Image& image) {
                                  summaries[i] = summarise(
                                      image.view(), options.orientation_weight > 0);
                              }));
    std::vector<std::size_t> readable;
    std::vector<double> lightness;
    for (std::size_t i = 0; i < images; ++i) {
        if (summaries[i].colour.pixels == 0) continue;
        readable.push_back(i);
        lightness.push_back(mean_lightness(summaries[i].colour));
    }
    if (readable.empty())
        return Error{Errc::bad_format, "no image of the measurement holds any pixels"};

    // 2. Cluster them by their features.
    Features features = make_features(summaries, info, readable, options);
    features.rowwise() -= features.colwise().mean().eval();
    Reduced reduced = reduce(features);
    Clustering clustering = cluster(features, reduced, options, executor);
    result.eigenvalues = std::move(reduced.eigenvalues);
    if (progress.cancelled()) return Error{Errc::cancelled, "cancelled while segmenting"};
    sort_by_lightness(clustering, lightness);

    // 3. Choose the image that stands for each cluster.
    const std::vector<double> radii = squared_radii(features, clustering);
    choose_representatives(result, info, readable, clustering, radii,
                           options.grazing_penalty);
    const double variance = features.squaredNorm();
    const double inertia = std::accumulate(radii.begin(), radii.end(), 0.0);
    result.explained = clustering.clusters > 1 ? 1.0 - inertia / variance : 0.0;
    for (const Summary& summary : summaries) result.moments.push_back(summary.moments);
    result.labels.assign(images, kUnreadable);
    for (std::size_t i = 0; i < readable.size(); ++i)
        result.labels[readable[i]] = static_cast<std::uint8_t>(clustering.labels[i]);
    return result;
}

}  // namespace sateen
