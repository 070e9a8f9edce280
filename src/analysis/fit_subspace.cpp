// SPDX-License-Identifier: Apache-2.0
// One subspace of a material. See fit_subspace.hpp.
#include "analysis/fit_subspace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/band_modulation.hpp"
#include "analysis/fit_field.hpp"
#include "analysis/window.hpp"
#include "sateen/analysis/autocovariance.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/analysis/neighbourhood.hpp"
#include "sateen/analysis/spectral.hpp"
#include "sateen/analysis/translation.hpp"
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
Image crop_to_lattice(Image image, std::size_t levels) {
    const std::size_t factor = std::size_t{1} << (levels - 1);
    const std::size_t rows = fft_size_at_most(image.rows(), factor);
    const std::size_t cols = fft_size_at_most(image.cols(), factor);
    return middle_window(std::move(image), rows, cols);
}

std::vector<PlaneView<const float>> planes_of(const std::vector<Image>& images,
                                              std::size_t plane) {
    std::vector<PlaneView<const float>> views;
    for (const Image& image : images) views.push_back(image.plane(plane));
    return views;
}

/// The autocovariances of every level of the Gaussian field behind the curve, pooled.
Result<std::vector<Autocovariance>> level_statistics(
    std::span<const PlaneView<const float>> planes, const Marginal& marginal,
    std::size_t levels, int reach, Executor& executor) {
    std::vector<Autocovariance> pooled(levels);
    for (const auto& plane : planes) {
        Image gaussian(1, plane.rows, plane.cols);
        SATEEN_CHECK(gaussian_behind_curve(plane, marginal, gaussian.plane(0), executor));
        SATEEN_TRY(const auto statistics,
                   power_preserving_pyramid(gaussian.plane(0), levels, reach, executor));
        for (std::size_t level = 0; level < levels; ++level)
            pooled[level].pool(statistics[level]);
    }
    return pooled;
}

std::string place(std::size_t level, std::size_t plane) {
    return "level " + std::to_string(level) + ", plane " + std::to_string(plane);
}

/// Fields of all levels of one plane, in the default mode.
Result<std::vector<FieldModel>> fit_plane(std::span<const PlaneView<const float>> planes,
                                          const Marginal& marginal, std::size_t levels,
                                          const AnalysisOptions& options,
                                          FieldChoice& choice, Executor& executor) {
    const int reach = 2 * reach_of(neighbourhood_of(options));
    SATEEN_TRY(const auto statistics,
               level_statistics(planes, marginal, levels, reach, executor));
    std::vector<FieldModel> fields;
    for (const Autocovariance& R : statistics) {
        SATEEN_TRY(FieldModel field, fit_field(R, options, choice));
        fields.push_back(std::move(field));
    }
    return fields;
}

/// Cropped, or one of several photographs, a plane may have a mean, which least squares
/// would take for a unit root of the low-pass residue.
void centre_and_scale(PlaneView<const float> from, double scale, PlaneView<float> to) {
    double mean = 0;
    for (std::size_t i = 0; i < from.size(); ++i)
        mean += static_cast<double>(from.data[i]) / static_cast<double>(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
        to.data[i] =
            static_cast<float>((static_cast<double>(from.data[i]) - mean) / scale);
}

/// Fields of all levels of one plane, in paper mode. Several photographs: the first
/// counts.
Result<std::vector<FieldModel>> fit_plane_as_printed(
    PlaneView<const float> plane, double scale, std::size_t levels, std::size_t number,
    const AnalysisOptions& options, std::vector<std::string>& notes, Executor& executor) {
    Image unit(1, plane.rows, plane.cols);
    centre_and_scale(plane, scale, unit.plane(0));
    SATEEN_TRY(std::vector<Image> bands, decompose(unit.view(), levels, executor));
    std::vector<FieldModel> fields;
    for (std::size_t level = 0; level < levels; ++level) {
        SATEEN_TRY(FieldModel field,
                   fit_field_as_printed(bands[level].plane(0), options,
                                        place(level, number), notes, executor));
        fields.push_back(std::move(field));
    }
    return fields;
}

/// All planes of one image as the joint models see them: the Gaussian fields behind their
/// curves, or in paper mode of unit variance; 0 where constant.
Result<Image> modelled_planes(const Image& image, const std::vector<Marginal>& marginals,
                              bool paper, Executor& executor) {
    Image planes(image.bands(), image.rows(), image.cols());
    for (std::size_t i = 0; i < image.bands(); ++i) {
        const PlaneView<const float> plane = image.plane(i);
        if (marginals[i].scale == 0) continue;
        if (paper)
            centre_and_scale(plane, static_cast<double>(marginals[i].scale),
                             planes.plane(i));
        else
            SATEEN_CHECK(
                gaussian_behind_curve(plane, marginals[i], planes.plane(i), executor));
    }
    return planes;
}

std::vector<PlaneView<const float>> planes_of(const Image& image) {
    std::vector<PlaneView<const float>> views;
    for (std::size_t plane = 0; plane < image.bands(); ++plane)
        views.push_back(image.plane(plane));
    return views;
}

/// Cross-covariances of every level of the ordinary pyramid.
Result<std::vector<CrossAutocovariance>> statistics_as_printed(const Image& planes,
                                                               std::size_t levels,
                                                               int reach,
                                                               Executor& executor) {
    SATEEN_TRY(const std::vector<Image> bands,
               decompose(planes.view(), levels, executor));
    std::vector<CrossAutocovariance> statistics;
    for (const Image& band : bands) {
        SATEEN_TRY(CrossAutocovariance R,
                   toroidal_cross_autocovariance(planes_of(band), reach, executor));
        statistics.push_back(std::move(R));
    }
    return statistics;
}

/// One field a level for all planes. In paper mode the first photograph counts.
Result<void> fit_joint_levels(const std::vector<Image>& images,
                              const AnalysisOptions& options, SubspaceFit& fit,
                              Executor& executor) {
    Subspace& subspace = fit.subspace;
    const std::size_t levels = subspace.levels.size();
    const int reach = 2 * reach_of(neighbourhood_of(options));
    std::vector<CrossAutocovariance> pooled(levels);
    for (const Image& image : images) {
        SATEEN_TRY(const Image planes,
                   modelled_planes(image, subspace.marginals, options.paper, executor));
        SATEEN_TRY(const auto statistics,
                   options.paper ? statistics_as_printed(planes, levels, reach, executor)
                                 : joint_power_preserving_pyramid(
                                       planes_of(planes), levels, reach, executor));
        for (std::size_t level = 0; level < levels; ++level)
            pooled[level].pool(statistics[level]);
        if (options.paper) break;
    }
    for (std::size_t level = 0; level < levels; ++level) {
        SATEEN_TRY(FieldModel field, fit_joint_field(pooled[level], options,
                                                     "level " + std::to_string(level),
                                                     fit.choice, fit.notes));
        subspace.levels[level].fields.push_back(std::move(field));
    }
    return {};
}

/// A field for every level and plane.
Result<void> fit_planes_apart(const std::vector<Image>& images,
                              const AnalysisOptions& options, SubspaceFit& fit,
                              Executor& executor) {
    Subspace& subspace = fit.subspace;
    const std::size_t levels = subspace.levels.size();
    for (std::size_t plane = 0; plane < subspace.marginals.size(); ++plane) {
        std::vector<FieldModel> fields(levels);
        const double scale = static_cast<double>(subspace.marginals[plane].scale);
        if (scale > 0 && options.paper) {
            SATEEN_TRY(fields,
                       fit_plane_as_printed(images.front().plane(plane), scale, levels,
                                            plane, options, fit.notes, executor));
        } else if (scale > 0) {
            SATEEN_TRY(fields,
                       fit_plane(planes_of(images, plane), subspace.marginals[plane],
                                 levels, options, fit.choice, executor));
        }
        for (std::size_t level = 0; level < levels; ++level)
            subspace.levels[level].fields.push_back(std::move(fields[level]));
    }
    return {};
}

/// Replaces the fields by joint ones where these explain the sample better for what they
/// cost: planes that the Karhunen-Loève transform made uncorrelated at a site may still
/// follow each other at a distance.
Result<void> try_planes_together(const std::vector<Image>& images,
                                 const AnalysisOptions& options, SubspaceFit& fit,
                                 Executor& executor) {
    AnalysisOptions together = options;
    together.field = FieldKind::car3d;
    SubspaceFit joint;
    joint.subspace.marginals = fit.subspace.marginals;
    joint.subspace.levels.resize(fit.subspace.levels.size());
    SATEEN_CHECK(fit_joint_levels(images, together, joint, executor));
    const double information = joint.choice.information_car3d;
    fit.choice.information_car3d = information;
    if (!(information < fit.choice.information_apart)) return {};
    fit.subspace.levels = std::move(joint.subspace.levels);
    fit.choice.car3d = joint.choice.car3d;
    fit.choice.car2d = fit.choice.gmrf2d = 0;
    return {};
}

/// The fields of all levels and planes.
Result<void> fit_levels(const std::vector<Image>& images, const AnalysisOptions& options,
                        SubspaceFit& fit, Executor& executor) {
    if (is_joint_kind(options.field))
        return fit_joint_levels(images, options, fit, executor);
    SATEEN_CHECK(fit_planes_apart(images, options, fit, executor));
    const auto varying = std::ranges::count_if(
        fit.subspace.marginals,
        [](const Marginal& marginal) { return marginal.scale > 0; });
    if (options.field == FieldKind::automatic && options.joint && !options.paper &&
        varying > 1)
        return try_planes_together(images, options, fit, executor);
    return {};
}

/// Planes whose residual turns with the place in the cell. Their bands look modulated for
/// that reason; to modulate them as well makes saturated specks.
std::vector<bool> mixed_planes(const Subspace& subspace) {
    std::vector<bool> mixed(subspace.marginals.size(), false);
    if (!subspace.structure) return mixed;
    const auto& cells = subspace.structure->cells;
    for (std::size_t plane = 0; plane < cells.size(); ++plane)
        mixed[plane] = cells[plane].mixing_step > 0;
    return mixed;
}

/// Of the variance of the residual, what planes have whose colours turn with the place; where
/// it is more, the amplitudes of the first plane follow the place as well.
constexpr double kMostMixed = 0.03;

double mixed_share(const Subspace& subspace) {
    const std::vector<bool> mixed = mixed_planes(subspace);
    double share = 0;
    double whole = 0;
    for (std::size_t plane = 0; plane < mixed.size(); ++plane) {
        const auto scale = static_cast<double>(subspace.marginals[plane].scale);
        whole += scale * scale;
        if (mixed[plane]) share += scale * scale;
    }
    return whole > 0 ? share / whole : 0;
}

/// Modulates the bands of a subspace where they vary enough, or where those of another one
/// do. The middle of large images says it as well.
Result<void> modulate(Image planes, const SharedModulation* known, SubspaceFit& fit,
                      Executor& executor) {
    constexpr std::size_t kMostSide = 1024;
    const std::size_t rows = planes.rows();
    const std::size_t cols = planes.cols();
    Subspace& subspace = fit.subspace;
    ModulationOptions options;
    options.shared = known;
    options.joint = planes_of(subspace.levels.front().fields.front()) > 1;
    options.left_alone = mixed_planes(subspace);
    const Image middle =
        middle_window(std::move(planes), fft_size_at_most(std::min(kMostSide, rows)),
                      fft_size_at_most(std::min(kMostSide, cols)));
    SATEEN_TRY(ModulationFit found,
               fit_band_modulation(middle, subspace.marginals, options, executor));
    if (known == nullptr && found.excess < least_excess(middle.plane_size())) return {};
    subspace.modulation = found.modulation.curves;
    fit.modulation = std::move(found.modulation);
    subspace.marginals = std::move(found.marginals);
    return {};
}

/// Planes of no variance to speak of are constant: scale 0.
std::vector<Marginal> fit_marginals(const std::vector<Image>& images, std::size_t d,
                                    const AnalysisOptions& options) {
    std::vector<MarginalDistribution> distributions;
    double total_variance = 0;
    for (std::size_t plane = 0; plane < d; ++plane) {
        distributions.emplace_back(planes_of(images, plane));
        const double deviation = distributions.back().standard_deviation();
        total_variance += deviation * deviation;
    }
    std::vector<Marginal> marginals;
    for (const MarginalDistribution& distribution : distributions) {
        const double deviation = distribution.standard_deviation();
        const bool constant = deviation <= kNegligibleDeviation ||
                              deviation * deviation <= kNegligibleShare * total_variance;
        marginals.push_back(constant        ? Marginal{0, {}}
                            : options.paper ? distribution.without_curve()
                                            : distribution.fit_curve());
    }
    return marginals;
}

/// Of all photographs those that have the pattern.
std::vector<Image> chosen(std::vector<Image> images,
                          const std::vector<std::size_t>& numbers) {
    std::vector<Image> result;
    for (const std::size_t number : numbers) result.push_back(std::move(images[number]));
    return result;
}

/// The channels themselves.
SpectralTransform untransformed(SpectralTransform spectral) {
    const std::size_t d = spectral.mean.size();
    for (std::size_t k = 0; k < d * d; ++k)
        spectral.T[k] = k % (d + 1) == 0 ? 1.0F : 0.0F;
    return spectral;
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
                                 const SpectralTransform* reference,
                                 const AlignedLayer* layer,
                                 const SharedModulation* modulation, Executor& executor) {
    std::size_t side = std::numeric_limits<std::size_t>::max();
    for (const Image& image : images) side = std::min({side, image.rows(), image.cols()});
    const std::size_t levels = choose_levels(side, options);

    // 1. Spectral factorisation of the values in the tone.
    if (layer != nullptr) images = chosen(std::move(images), layer->photographs);
    for (Image& image : images) image = apply_tone(image, options.tone);
    SubspaceFit fit;
    Subspace& subspace = fit.subspace;
    std::vector<Image> patterned;
    if (layer != nullptr) {
        SeparatedImages separated =
            separate(images, *layer, options.tone, reference, executor);
        subspace.spectral = std::move(separated.spectral);
        subspace.structure = std::move(separated.structure);
        patterned = std::move(separated.planes);
        images.clear();
        for (Image& residual : separated.residuals)
            images.push_back(crop_to_lattice(std::move(residual), levels));
    } else {
        subspace.spectral = fit_spectral_transform(images, options.tone);
        const Space space =
            options.space.value_or(options.paper ? Space::rgb : Space::kl);
        if (is_joint_kind(options.field) && space == Space::rgb)
            subspace.spectral = untransformed(std::move(subspace.spectral));
        else if (reference != nullptr)
            align(subspace.spectral, *reference);
        for (Image& image : images)
            image =
                decorrelate(crop_to_lattice(std::move(image), levels), subspace.spectral);
    }

    // 2. The marginal of every plane.
    const std::size_t d = subspace.spectral.mean.size();
    subspace.marginals = fit_marginals(images, d, options);
    if (layer != nullptr)
        fit_tone_curves(patterned, layer->layer, subspace.marginals,
                        subspace.structure->cells);

    // 3. The pyramid and the fields of every level.
    subspace.levels.resize(levels);
    SATEEN_CHECK(fit_levels(images, options, fit, executor));

    // 4. What Gaussian fields lack: bands whose amplitude varies.
    const bool wanted = options.modulation && !options.paper;
    if (wanted && (modulation != nullptr || mixed_share(subspace) < kMostMixed))
        SATEEN_CHECK(modulate(std::move(images.front()), modulation, fit, executor));
    return fit;
}

}  // namespace sateen
