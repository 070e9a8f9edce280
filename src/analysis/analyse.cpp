// SPDX-License-Identifier: Apache-2.0
// Measurement to material. See analyse.hpp.
#include "sateen/analysis/analyse.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "analysis/fit_subspace.hpp"
#include "analysis/periodic_layer.hpp"
#include "analysis/window.hpp"
#include "sateen/analysis/delight.hpp"
#include "sateen/analysis/segment.hpp"
#include "sateen/analysis/spectral.hpp"

namespace sateen {
namespace {

/// Patterns are looked for in so many representatives of a BTF; light from the side counts
/// so much less than a view from the side.
constexpr std::size_t kMostSeen = 3;
constexpr float kLightTilt = 0.3F;

/// What the material says of the measurement as a whole.
Material describe(const MeasurementInfo& info, const AnalysisOptions& options) {
    Material material;
    material.provenance.name = valid_text(info.name);
    material.provenance.source = info.layout;
    material.provenance.source_checksum = info.checksum;
    material.cosine_included = info.radiometry.cosine_included;
    material.pixels_per_mm = info.pixels_per_mm;
    material.sample_rows = static_cast<std::uint32_t>(info.rows);
    material.sample_cols = static_cast<std::uint32_t>(info.cols);
    material.bands = static_cast<std::uint32_t>(info.bands);
    const bool causal =
        options.field == FieldKind::automatic || options.field == FieldKind::car2d;
    material.drawing = options.paper && causal ? Drawing::recursive : Drawing::spectral;
    material.views = info.views;
    material.lights = info.lights;
    return material;
}

/// The images that stand for each subspace: one representative, or all photographs
/// pooled.
struct Representatives {
    std::vector<std::vector<std::size_t>> observations;
    std::vector<std::uint32_t> members;
    std::vector<std::uint8_t> labels;  ///< a subspace for every observation
    std::vector<ImageMoments> moments;
    std::vector<double> eigenvalues;
};

Result<Representatives> choose_representatives(const Measurement& measurement,
                                               const AnalysisOptions& options,
                                               std::vector<std::string>& notes,
                                               Executor& executor, Progress& progress) {
    const std::size_t count = measurement.info().observations.size();
    Representatives result;
    if (!measurement.info().has_directions()) {
        std::vector<std::size_t> all(count);
        for (std::size_t i = 0; i < count; ++i) all[i] = i;
        result.observations.push_back(std::move(all));
        result.members.push_back(static_cast<std::uint32_t>(count));
        return result;
    }
    progress.stage("segmenting");
    SegmentationOptions segmentation;
    segmentation.subspaces = options.subspaces;
    segmentation.seed = options.seed;
    segmentation.skip_bad = options.skip_bad;
    if (options.paper) {
        segmentation.orientation_weight = 0;
        segmentation.side_weight = 0;
        segmentation.grazing_penalty = 0;
    }
    SATEEN_TRY(Segmentation segments,
               segment(measurement, segmentation, executor, progress));
    for (const std::string& reason : segments.pass.reasons)
        notes.push_back("skipped " + reason);
    for (const std::size_t observation : segments.representatives)
        result.observations.push_back({observation});
    result.members = std::move(segments.members);
    result.labels = std::move(segments.labels);
    result.moments = std::move(segments.moments);
    result.eigenvalues = std::move(segments.eigenvalues);
    return result;
}

std::vector<IndexEntry> index_table(const MeasurementInfo& info,
                                    const std::vector<std::uint8_t>& labels) {
    std::vector<IndexEntry> index;
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i] != kUnreadable)
            index.push_back({static_cast<std::uint16_t>(info.observations[i].light),
                             static_cast<std::uint16_t>(info.observations[i].view),
                             labels[i]});
    return index;
}

/// Pixels held of all photographs of a subspace together, so that memory grows neither with
/// their number nor with their size; statistics of more pixels are hardly better.
constexpr std::size_t kPooledPixels = std::size_t{1} << 23U;

/// At most `pixels` out of the middle, of the shape of the image.
Image at_most(std::size_t pixels, Image image) {
    if (image.plane_size() <= pixels) return image;
    const double share =
        std::sqrt(static_cast<double>(pixels) / static_cast<double>(image.plane_size()));
    const auto part = [share](std::size_t side) {
        return std::max<std::size_t>(
            1, static_cast<std::size_t>(share * static_cast<double>(side)));
    };
    const std::size_t rows = part(image.rows());
    const std::size_t cols = part(image.cols());
    return middle_window(std::move(image), rows, cols);
}

/// Mean colour and contrast of all pairs of directions, from those that were measured.
Result<Reflectance> fit_reflectance(const MeasurementInfo& info,
                                    const Representatives& measured) {
    const AppearanceGrid grid{info.views, info.lights, info.bands + 1,
                              info.radiometry.cosine_included};
    std::vector<MeasuredAppearance> known;
    for (std::size_t i = 0; i < measured.labels.size(); ++i)
        if (measured.labels[i] != kUnreadable)
            known.push_back({info.observations[i].view, info.observations[i].light,
                             encode_appearance(measured.moments[i], info.bands)});
    SATEEN_TRY(const std::vector<float> table, complete_appearance(grid, known));
    return factorise_appearance(grid, table);
}

/// The shading of a surface as one observation shows it, of the surface's own size.
Image shading_of(const MeasurementInfo& info, std::size_t observation,
                 const RangeMap& surface) {
    if (!info.has_directions()) return shading_seen(surface, {}, surface.light);
    const Observation& at = info.observations[observation];
    return shading_seen(surface, info.views[at.view], info.lights[at.light]);
}

Image window_on(const RangeMap& surface, Image image) {
    return middle_window(std::move(image), surface.height_px.rows(),
                         surface.height_px.cols());
}

/// So many representatives say whether shading explains them all.
constexpr std::size_t kMostJudged = 7;

/// Images as they are modelled.
class Reader {
  public:
    Reader(const Measurement& measurement, bool skip_bad, Executor& executor)
        : measurement_(measurement), skip_bad_(skip_bad), executor_(executor) {}

    /// From now on images are divided by the shading of this surface, which outlives them.
    void divide_by_shading_of(const RangeMap& surface, float ambient) {
        surface_ = &surface;
        ambient_ = ambient;
    }

    Result<std::vector<Image>> read(const std::vector<std::size_t>& observations,
                                    std::vector<std::string>& notes) const {
        std::vector<Result<Image>> read(observations.size(), Result<Image>(Image()));
        parallel_for(executor_, observations.size(), [&](std::size_t i) {
            read[i] = measurement_.read(observations[i]);
            if (read[i])
                read[i] = at_most(kPooledPixels / observations.size(),
                                  delit(std::move(*read[i]), observations[i]));
        });
        std::vector<Image> images;
        for (Result<Image>& image : read) {
            if (!image && !skip_bad_) return std::move(image).error();
            if (image)
                images.push_back(std::move(*image));
            else
                notes.push_back("skipped " + image.error().message);
        }
        if (images.empty())
            return Error{Errc::bad_format,
                         "no readable image in " + measurement_.info().name};
        return images;
    }

  private:
    Image delit(Image image, std::size_t observation) const {
        if (surface_ == nullptr) return image;
        return divide_by_shading(
            window_on(*surface_, std::move(image)),
            with_ambient(shading_of(measurement_.info(), observation, *surface_),
                         ambient_));
    }

    const Measurement& measurement_;
    bool skip_bad_;
    Executor& executor_;
    const RangeMap* surface_ = nullptr;
    float ambient_ = 0;
};

/// How much of the representatives the shading of the surface explains. Photographs that
/// are pooled show other places than the one that the surface was found in: nothing.
ExplainedContrast explained_by_shading(const Measurement& measurement,
                                       const Representatives& representatives,
                                       const RangeMap& surface, Executor& executor) {
    if (representatives.observations.front().size() > 1) return {};
    const std::size_t every = 1 + (representatives.observations.size() - 1) / kMostJudged;
    const std::size_t count = (representatives.observations.size() - 1) / every + 1;
    std::vector<ExplainedContrast> parts(count);
    parallel_for(executor, count, [&](std::size_t i) {
        const std::size_t k = i * every;
        const std::size_t observation = representatives.observations[k].front();
        Result<Image> image = measurement.read(observation);
        if (!image) return;  // reported, or skipped, where it is modelled
        parts[i].add(window_on(surface, std::move(*image)),
                     shading_of(measurement.info(), observation, surface),
                     static_cast<double>(representatives.members[k]));
    });
    ExplainedContrast all;
    for (const ExplainedContrast& part : parts) all.add(part);
    return all;
}

/// The subspaces in order of how well their representatives see the material: from above and
/// lit from above is best.
std::vector<std::size_t> best_seen(const MeasurementInfo& info,
                                   const Representatives& representatives) {
    std::vector<std::size_t> order(representatives.observations.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (!info.has_directions()) return order;
    std::ranges::stable_sort(order, {}, [&](std::size_t k) {
        const Observation& at =
            info.observations[representatives.observations[k].front()];
        return info.views[at.view].theta + kLightTilt * info.lights[at.light].theta;
    });
    return order;
}

/// The layer that several photographs of a material share.
Result<std::optional<AlignedLayer>> find_shared_layer(
    const Reader& reader, const std::vector<std::size_t>& photographs, Tone tone,
    Executor& executor) {
    std::vector<std::string> notes;
    SATEEN_TRY(std::vector<Image> images, reader.read(photographs, notes));
    for (Image& image : images) image = apply_tone(image, tone);
    const SpectralTransform spectral = fit_spectral_transform(images, tone);
    std::vector<std::optional<AlignedLayer>> layers;
    for (Image& image : images) {
        image = decorrelate(image, spectral);
        SATEEN_TRY(std::optional<AlignedLayer> layer, align_layer(image, executor));
        layers.push_back(std::move(layer));
    }
    return join_layers(std::move(layers), images, executor);
}

/// The periodic layer of a material: of the representative whose pattern is plainest.
Result<std::optional<AlignedLayer>> find_layer(const MeasurementInfo& info,
                                               const Reader& reader,
                                               const Representatives& representatives,
                                               Tone tone, Executor& executor) {
    const auto& photographs = representatives.observations.front();
    if (photographs.size() > 1)
        return find_shared_layer(reader, photographs, tone, executor);
    std::optional<AlignedLayer> best;
    std::vector<std::size_t> order = best_seen(info, representatives);
    order.resize(std::min(order.size(), kMostSeen));
    for (const std::size_t k : order) {
        std::vector<std::string> notes;
        Result<std::vector<Image>> images =
            reader.read(representatives.observations[k], notes);
        if (!images) continue;  // reported, or skipped, where it is modelled
        std::vector<Image> toned;
        toned.push_back(apply_tone(images->front(), tone));
        const Image planes =
            decorrelate(toned.front(), fit_spectral_transform(toned, tone));
        SATEEN_TRY(std::optional<AlignedLayer> layer, align_layer(planes, executor));
        if (layer && (!best || layer->periodicity > best->periodicity))
            best = std::move(layer);
    }
    return best;
}

}  // namespace

Result<Analysis> analyse(const Measurement& measurement, const AnalysisOptions& options,
                         Executor& executor, Progress& progress,
                         const RangeMap* surface) {
    SATEEN_CHECK(check(options));
    const MeasurementInfo& info = measurement.info();
    Analysis result{describe(info, options), info.skipped, {}, {}, {}, 0};
    Material& material = result.material;

    // 1. Segment the BTF space into subspaces, each with its representative image.
    SATEEN_TRY(
        const Representatives representatives,
        choose_representatives(measurement, options, result.notes, executor, progress));
    material.index = index_table(info, representatives.labels);
    result.eigenvalues = representatives.eigenvalues;
    if (info.has_directions() && !options.paper && options.reflectance) {
        Result<Reflectance> reflectance = fit_reflectance(info, representatives);
        if (reflectance)
            material.reflectance = std::move(*reflectance);
        else
            result.notes.push_back("no reflectance: " + reflectance.error().message);
    }

    // 2. Find the pattern of the material, if it has one: the same for all subspaces.
    Reader reader(measurement, options.skip_bad, executor);
    std::optional<AlignedLayer> layer;
    if (options.structure && !options.paper) {
        progress.stage("looking for a pattern");
        SATEEN_TRY(layer,
                   find_layer(info, reader, representatives, options.tone, executor));
    }
    if (layer) {
        material.structure = Structure{layer->layer};
        const std::size_t photographs = representatives.observations.front().size();
        if (layer->photographs.size() < photographs)
            result.notes.push_back("one pattern is in " +
                                   std::to_string(layer->photographs.size()) + " of " +
                                   std::to_string(photographs) +
                                   " photographs: the others are left out");
    }

    // 3. Divide the shading of the surface out of the images, if it explains them and no
    //    pattern would be drawn out of step with it. [CAR2] multiplies by it without.
    if (surface != nullptr) {
        material.surface = surface->surface;
        const ExplainedContrast contrast =
            explained_by_shading(measurement, representatives, *surface, executor);
        result.shading_share = contrast.share();
        material.surface->delit =
            options.paper || (!layer && result.shading_share >= kLeastShadingShare);
        if (material.surface->delit && !options.paper) {
            material.surface->ambient = contrast.ambient();
            reader.divide_by_shading_of(*surface, material.surface->ambient);
        }
    }

    // 4. Factorise each representative and estimate its fields. The one that sees the
    //    material best comes first: the others align their spectral transforms with it, and
    //    have its modulation.
    progress.stage("modelling");
    const std::size_t count = representatives.observations.size();
    AnalysisOptions fields = options;
    fields.joint = options.joint && count == 1;
    std::vector<std::optional<Result<SubspaceFit>>> fits(count);
    std::mutex mutex;
    std::size_t finished = 0;
    const SpectralTransform* reference = nullptr;
    std::optional<SharedModulation> modulation;
    const auto fit = [&](std::size_t k) {
        std::vector<std::string> notes;
        Result<std::vector<Image>> images =
            reader.read(representatives.observations[k], notes);
        fits[k] = images ? fit_subspace(std::move(*images), fields, reference,
                                        layer ? &*layer : nullptr,
                                        modulation ? &*modulation : nullptr, executor)
                         : Result<SubspaceFit>(std::move(images).error());
        const std::lock_guard lock(mutex);
        if (*fits[k])
            (*fits[k])->notes.insert((*fits[k])->notes.begin(), notes.begin(),
                                     notes.end());
        progress.report(static_cast<double>(++finished), static_cast<double>(count));
    };
    const std::size_t first = options.paper ? 0 : best_seen(info, representatives)[0];
    fit(first);
    if (*fits[first]) {
        reference = &(*fits[first])->subspace.spectral;
        modulation = (*fits[first])->modulation;
        fields.modulation = modulation.has_value();
        if (modulation) material.modulation = modulation->fields;
    }
    parallel_for(executor, count - 1, [&](std::size_t k) {
        if (!progress.cancelled()) fit(k < first ? k : k + 1);
    });
    if (progress.cancelled()) return Error{Errc::cancelled, "cancelled while modelling"};

    for (std::size_t k = 0; k < count; ++k) {
        SATEEN_TRY(SubspaceFit done, std::move(*fits[k]));
        Subspace& subspace = done.subspace;
        subspace.members = representatives.members[k];
        const std::size_t observation = representatives.observations[k].front();
        if (info.has_directions()) {
            subspace.view =
                static_cast<std::uint16_t>(info.observations[observation].view);
            subspace.light =
                static_cast<std::uint16_t>(info.observations[observation].light);
        }
        for (const std::string& note : done.notes)
            result.notes.push_back("subspace " + std::to_string(k) + ": " + note);
        result.representatives.push_back(observation);
        result.choice.add(done.choice);
        material.subspaces.push_back(std::move(subspace));
    }
    return result;
}

}  // namespace sateen
