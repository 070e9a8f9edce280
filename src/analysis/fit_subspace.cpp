// SPDX-License-Identifier: Apache-2.0
// One subspace of a material. See fit_subspace.hpp.
#include "analysis/fit_subspace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sateen/analysis/autocovariance.hpp"
#include "sateen/analysis/car2d.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/analysis/neighbourhood.hpp"
#include "sateen/analysis/spectral.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/core/pyramid.hpp"

namespace sateen {
namespace {

/// Factors below this share of the total variance are rounding noise of a grey or
/// two-colour material: they are kept constant.
constexpr double kNegligibleShare = 1e-6;
/// Below this deviation, in units of the tone, a plane is constant.
constexpr double kNegligibleDeviation = 1e-5;
/// The coarsest level keeps at least so many pixels a side.
constexpr std::size_t kCoarsestSide = 16;
constexpr std::size_t kPaperLevels = 3;

/// The largest window that the FFT and the pyramid accept, from the middle of the image.
Image crop_to_lattice(const Image& image, std::size_t levels) {
    const std::size_t factor = std::size_t{1} << (levels - 1);
    const std::size_t rows = fft_size_at_most(image.rows(), factor);
    const std::size_t cols = fft_size_at_most(image.cols(), factor);
    if (rows == image.rows() && cols == image.cols()) return image;
    const std::size_t top = (image.rows() - rows) / 2;
    const std::size_t left = (image.cols() - cols) / 2;
    Image result(image.bands(), rows, cols);
    for (std::size_t band = 0; band < image.bands(); ++band)
        for (std::size_t r = 0; r < rows; ++r)
            std::copy_n(image.plane(band).row(top + r) + left, cols,
                        result.plane(band).row(r));
    return result;
}

std::vector<PlaneView<const float>> planes_of(const std::vector<Image>& images,
                                              std::size_t plane) {
    std::vector<PlaneView<const float>> views;
    for (const Image& image : images) views.push_back(image.plane(plane));
    return views;
}

/// The autocovariances of every level, pooled over the images; the planes made Gaussian.
Result<std::vector<Autocovariance>> level_statistics(
    std::span<const PlaneView<const float>> planes, const MarginalDistribution& marginal,
    std::size_t levels, int reach, Executor& executor) {
    std::vector<Autocovariance> pooled(levels);
    for (const auto& plane : planes) {
        Image gaussian(1, plane.rows, plane.cols);
        marginal.gaussianise(plane, gaussian.plane(0));
        SATEEN_TRY(const auto statistics,
                   power_preserving_pyramid(gaussian.plane(0), levels, reach, executor));
        for (std::size_t level = 0; level < levels; ++level)
            pooled[level].pool(statistics[level]);
    }
    return pooled;
}

/// The field of one level from its autocovariances, with exactly their variance.
Result<Car2d> fit_level(const Autocovariance& R, const AnalysisOptions& options) {
    if (R.variance() < kNegligibleDeviation * kNegligibleDeviation) return Car2d{};
    SATEEN_TRY(auto neighbourhood, select_neighbourhood(R, options.neighbourhood));
    SATEEN_TRY(Car2dEstimate estimate,
               estimate_car2d(toroidal_normal_equations(R, std::move(neighbourhood))));
    Car2d model = std::move(estimate.model);
    const double implied = model_variance(model);
    model.variance =
        static_cast<float>(static_cast<double>(model.variance) * R.variance() / implied);
    return model;
}

/// The field of one band of the ordinary pyramid, as [CAR2] estimates it.
Result<Car2d> fit_level_as_printed(PlaneView<const float> band,
                                   const AnalysisOptions& options) {
    Autocovariance unused(1, static_cast<double>(band.size()));
    SATEEN_TRY(auto neighbourhood, select_neighbourhood(unused, options.neighbourhood));
    Result<Car2dEstimate> estimate =
        estimate_car2d(interior_normal_equations(band, std::move(neighbourhood)));
    if (!estimate) return Car2d{};
    return std::move(estimate->model);
}

std::string place(std::size_t level, std::size_t plane) {
    return "level " + std::to_string(level) + ", plane " + std::to_string(plane);
}

/// Sum of squares over sites of a band, for the variance that a repaired model must keep.
double variance_of(PlaneView<const float> band) {
    double sum = 0;
    for (std::size_t r = 0; r < band.rows; ++r)
        for (std::size_t c = 0; c < band.cols; ++c)
            sum += static_cast<double>(band(r, c)) * static_cast<double>(band(r, c));
    return sum / static_cast<double>(band.size());
}

/// Fields of all levels of one plane, in the default mode.
Result<std::vector<Car2d>> fit_plane(std::span<const PlaneView<const float>> planes,
                                     const MarginalDistribution& marginal,
                                     std::size_t levels, const AnalysisOptions& options,
                                     Executor& executor) {
    const int reach = 2 * reach_of(options.neighbourhood);
    SATEEN_TRY(const auto statistics,
               level_statistics(planes, marginal, levels, reach, executor));
    std::vector<Car2d> fields;
    for (const Autocovariance& R : statistics) {
        SATEEN_TRY(Car2d field, fit_level(R, options));
        fields.push_back(std::move(field));
    }
    return fields;
}

/// Fields of all levels of one plane, in paper mode. Several photographs: the first
/// counts.
Result<std::vector<Car2d>> fit_plane_as_printed(
    PlaneView<const float> plane, double scale, std::size_t levels, std::size_t number,
    const AnalysisOptions& options, std::vector<std::string>& notes, Executor& executor) {
    Image unit(1, plane.rows, plane.cols);
    const float inverse = static_cast<float>(1 / scale);
    for (std::size_t i = 0; i < plane.size(); ++i)
        unit.values()[i] = plane.data[i] * inverse;
    SATEEN_TRY(std::vector<Image> bands, decompose(unit.view(), levels, executor));
    std::vector<Car2d> fields;
    for (std::size_t level = 0; level < levels; ++level) {
        SATEEN_TRY(Car2d field, fit_level_as_printed(bands[level].plane(0), options));
        const double radius = spectral_radius(field);
        if (radius >= 1) {
            field = stabilised(field, variance_of(bands[level].plane(0)));
            notes.push_back(place(level, number) + ": unstable, spectral radius " +
                            std::to_string(radius) + "; coefficients shrunk");
        }
        fields.push_back(std::move(field));
    }
    return fields;
}

}  // namespace

std::size_t choose_levels(std::size_t side_px, const AnalysisOptions& options) {
    const std::size_t wanted = options.levels != 0 ? options.levels
                               : options.paper     ? kPaperLevels
                                                   : 5;
    std::size_t levels = 1;
    while (levels < wanted &&
           side_px >> levels >= (options.levels != 0 ? 2 : kCoarsestSide))
        ++levels;
    return levels;
}

Result<SubspaceFit> fit_subspace(std::vector<Image> images,
                                 const AnalysisOptions& options,
                                 const SpectralTransform* reference, Executor& executor) {
    std::size_t side = std::numeric_limits<std::size_t>::max();
    for (const Image& image : images) side = std::min({side, image.rows(), image.cols()});
    const std::size_t levels = choose_levels(side, options);

    // 1. Spectral factorisation of the values in the tone.
    for (Image& image : images) image = apply_tone(image, options.tone);
    SubspaceFit fit;
    Subspace& subspace = fit.subspace;
    subspace.spectral = fit_spectral_transform(images, options.tone);
    if (reference != nullptr) align(subspace.spectral, *reference);
    for (Image& image : images)
        image = decorrelate(crop_to_lattice(image, levels), subspace.spectral);

    // 2. The marginal of every plane.
    const std::size_t d = subspace.spectral.mean.size();
    std::vector<MarginalDistribution> distributions;
    double total_variance = 0;
    for (std::size_t plane = 0; plane < d; ++plane) {
        distributions.emplace_back(planes_of(images, plane));
        const double deviation = distributions.back().standard_deviation();
        total_variance += deviation * deviation;
    }

    // 3. The pyramid and the field of every level.
    subspace.levels.resize(levels);
    for (std::size_t plane = 0; plane < d; ++plane) {
        const MarginalDistribution& distribution = distributions[plane];
        const double deviation = distribution.standard_deviation();
        std::vector<Car2d> fields(levels);
        Marginal marginal;
        marginal.scale = 0;
        if (deviation > kNegligibleDeviation &&
            deviation * deviation > kNegligibleShare * total_variance) {
            if (options.paper) {
                marginal = distribution.without_curve();
                SATEEN_TRY(fields, fit_plane_as_printed(images.front().plane(plane),
                                                        deviation, levels, plane, options,
                                                        fit.notes, executor));
            } else {
                marginal = distribution.fit_curve();
                SATEEN_TRY(fields, fit_plane(planes_of(images, plane), distribution,
                                             levels, options, executor));
            }
        }
        subspace.marginals.push_back(std::move(marginal));
        for (std::size_t level = 0; level < levels; ++level)
            subspace.levels[level].fields.emplace_back(std::move(fields[level]));
    }
    return fit;
}

}  // namespace sateen
