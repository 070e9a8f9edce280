// SPDX-License-Identifier: Apache-2.0
// Material to texture. See synthesise.hpp.
#include "sateen/synthesis/synthesise.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "sateen/core/fft.hpp"
#include "synthesis/appearance.hpp"
#include "synthesis/band_modulation.hpp"
#include "synthesis/infinite_field.hpp"
#include "synthesis/noise_bands.hpp"
#include "synthesis/periodic_layer.hpp"
#include "synthesis/recursive_field.hpp"
#include "synthesis/spectral_density.hpp"
#include "synthesis/toroidal_field.hpp"

namespace sateen {
namespace {

/// Tileable textures up to this size are drawn at once, with mean and variance pinned.
constexpr std::size_t kWholeTextureSites = std::size_t{1} << 22U;

/// Far enough from the ends of 32 bits for any texture and its margins.
constexpr std::int32_t kFurthestOffset = std::int32_t{1} << 30;

Result<void> check_window(const SynthesisOptions& options) {
    for (const std::size_t side : {options.rows, options.cols})
        if (side == 0 || side > kMaxTextureSide)
            return Error{Errc::invalid_argument, "a texture of " +
                                                     std::to_string(options.cols) + "x" +
                                                     std::to_string(options.rows) +
                                                     " pixels: each side must be 1 to " +
                                                     std::to_string(kMaxTextureSide)};
    for (const std::int32_t offset : {options.offset_row, options.offset_col})
        if (offset < -kFurthestOffset || offset > kFurthestOffset)
            return Error{Errc::invalid_argument,
                         "an offset of " + std::to_string(options.offset_col) + "," +
                             std::to_string(options.offset_row) +
                             ": each must be within 2^30 of 0"};
    return {};
}

Result<void> check_subspace(const Material& material, std::size_t subspace) {
    if (subspace < material.subspaces.size()) return {};
    return Error{Errc::invalid_argument,
                 "subspace " + std::to_string(subspace) + ": the material has " +
                     std::to_string(material.subspaces.size()) + ", numbered from 0"};
}

bool fits_one_transform(const SynthesisOptions& options) {
    return is_fft_size(options.rows) && is_fft_size(options.cols) &&
           options.rows * options.cols <= kWholeTextureSites;
}

/// Shifts and scales a plane to mean 0 and variance 1; leaves a constant one.
void standardise(PlaneView<float> plane) {
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const auto value = static_cast<double>(plane.data[i]);
        sum += value;
        squares += value * value;
    }
    const double n = static_cast<double>(plane.size());
    const double mean = sum / n;
    const double variance = squares / n - mean * mean;
    if (!(variance > 0)) return;
    const auto shift = static_cast<float>(mean);
    const auto scale = static_cast<float>(1 / std::sqrt(variance));
    for (std::size_t i = 0; i < plane.size(); ++i)
        plane.data[i] = (plane.data[i] - shift) * scale;
}

/// The planes of a subspace: each alone, or all together where a field draws them so.
std::vector<PlaneField> independent_fields(const Material& material,
                                           const Subspace& subspace) {
    const std::size_t d = subspace.marginals.size();
    const bool joint = std::any_of(
        subspace.levels.begin(), subspace.levels.end(),
        [](const Level& level) { return planes_of(level.fields.front()) > 1; });
    const PlaneField first{subspace.levels, 0, static_cast<double>(material.sample_rows),
                           static_cast<double>(material.sample_cols), joint ? d : 1};
    std::vector<PlaneField> fields(joint ? 1 : d, first);
    for (std::size_t plane = 0; plane < fields.size(); ++plane)
        fields[plane].plane = plane;
    return fields;
}

/// Rows [first, first + count) of every plane.
std::vector<PlaneView<float>> windows_of(ImageView<float> image, std::size_t first,
                                         std::size_t count) {
    std::vector<PlaneView<float>> windows;
    for (std::size_t plane = 0; plane < image.bands; ++plane)
        windows.push_back(image.plane(plane).window(first, 0, count, image.cols));
    return windows;
}

/// Noise and textures of all planes of a material on one torus.
class Torus {
  public:
    static Result<Torus> create(const Material& material,
                                const SynthesisOptions& options) {
        SATEEN_TRY(Fft2d fft, Fft2d::create(options.rows, options.cols));
        return Torus(std::move(fft), material, options.seed);
    }

    /// The Fourier transforms of white noise, a spectrum for each plane.
    [[nodiscard]] std::vector<SplitComplexPlane> noise(Executor& executor) const {
        std::vector<SplitComplexPlane> spectra = this->spectra();
        for (std::uint32_t plane = 0; plane < spectra.size(); ++plane)
            draw_noise_spectrum({seed_, noise_band(plane)}, fft_.cols(),
                                spectra[plane].view(), executor);
        return spectra;
    }
    /// The texture of one subspace. Rows are transformed back and finished while they are
    /// in the cache.
    /// \param noise   noise(), or nothing: drawn for this texture alone
    /// \param finish  finish(row, planes, out) of every block of rows
    template <class FinishRows>
    [[nodiscard]] Image draw(const Subspace& subspace,
                             std::span<const SplitComplexPlane> noise,
                             const FinishRows& finish, Executor& executor) const {
        std::vector<SplitComplexPlane> coloured = spectra();
        std::vector<float> gains;
        for (const PlaneField& field : independent_fields(*material_, subspace)) {
            const auto of_field = colour_noise(
                field, fft_.cols(), {seed_, noise},
                std::span(coloured).subspan(field.plane, field.planes), executor);
            gains.insert(gains.end(), of_field.begin(), of_field.begin() + field.planes);
        }
        for (SplitComplexPlane& plane : coloured)
            fft_.inverse_columns(plane.view(), executor);
        Image texture(coloured.size(), fft_.rows(), fft_.cols(), uninitialised);
        const auto invert = [&](std::size_t first, std::size_t count,
                                Fft2d::Scratch& scratch) {
            SerialExecutor serial;
            const std::size_t floats = coloured.size() * count * fft_.cols();
            const ImageView<float> rows(scratch.floats(floats), coloured.size(), count,
                                        fft_.cols());
            for (std::size_t plane = 0; plane < coloured.size(); ++plane) {
                const SplitComplexPlane& spectrum = coloured[plane];
                fft_.inverse_rows(spectrum.view(), first, gains[plane], rows.plane(plane),
                                  scratch);
            }
            finish(static_cast<std::int32_t>(first), rows,
                   windows_of(texture.view(), first, count), serial);
        };
        fft_.for_row_blocks(executor, invert);
        return texture;
    }

  private:
    Torus(Fft2d fft, const Material& material, std::uint64_t seed)
        : fft_(std::move(fft)), material_(&material), seed_(seed) {}
    [[nodiscard]] std::vector<SplitComplexPlane> spectra() const {
        std::vector<SplitComplexPlane> spectra;
        for (std::size_t plane = 0; plane < material_->bands; ++plane)
            spectra.emplace_back(fft_.rows(), fft_.spectrum_cols(), uninitialised);
        return spectra;
    }
    Fft2d fft_;
    const Material* material_;
    std::uint64_t seed_;
};

/// Every plane of one subspace on the infinite lattice, by convolution.
class InfinitePlanes {
  public:
    static Result<InfinitePlanes> create(const Material& material,
                                         const Subspace& subspace, Period period,
                                         Executor& executor) {
        InfinitePlanes planes;
        for (const PlaneField& part : independent_fields(material, subspace)) {
            SATEEN_TRY(InfiniteField field,
                       InfiniteField::create(part, period, executor));
            planes.fields_.push_back(std::move(field));
        }
        return planes;
    }
    Result<void> draw(std::uint64_t seed, std::int32_t row, std::int32_t col,
                      ImageView<float> out, Executor& executor) const {
        std::vector<PlaneView<float>> views;
        for (std::size_t plane = 0; plane < out.bands; ++plane)
            views.push_back(out.plane(plane));
        const std::size_t each = out.bands / fields_.size();
        for (std::size_t i = 0; i < fields_.size(); ++i)
            SATEEN_CHECK(fields_[i].draw(seed, static_cast<std::uint32_t>(i * each), row,
                                         col, std::span(views).subspan(i * each, each),
                                         executor));
        return {};
    }
    [[nodiscard]] std::size_t strip_rows() const { return fields_.front().strip_rows(); }

  private:
    std::vector<InfiniteField> fields_;
};

/// Every plane of one subspace on the infinite lattice, by recursion.
class RecursivePlanes {
  public:
    static Result<RecursivePlanes> create(const Subspace& subspace) {
        RecursivePlanes planes;
        for (std::size_t plane = 0; plane < subspace.marginals.size(); ++plane) {
            SATEEN_TRY(RecursiveField field,
                       RecursiveField::create({subspace.levels, plane, 0, 0}));
            planes.fields_.push_back(std::move(field));
        }
        return planes;
    }
    Result<void> draw(std::uint64_t seed, std::int32_t row, std::int32_t col,
                      ImageView<float> out, Executor& executor) const {
        for (std::uint32_t plane = 0; plane < fields_.size(); ++plane)
            SATEEN_CHECK(
                fields_[plane].draw(seed, plane, row, col, out.plane(plane), executor));
        return {};
    }
    [[nodiscard]] std::size_t strip_rows() const { return fields_.front().strip_rows(); }

  private:
    std::vector<RecursiveField> fields_;
};

/// A plane that is constant stays as it is.
void divide(ImageView<float> planes, const std::vector<float>& deviations) {
    for (std::size_t plane = 0; plane < planes.bands; ++plane) {
        const float factor = deviations[plane] > 0 ? 1 / deviations[plane] : 0;
        const PlaneView<float> view = planes.plane(plane);
        for (std::size_t i = 0; i < view.size(); ++i) view.data[i] *= factor;
    }
}

/// From fields to reflectance, unless the caller wants the fields: the modulation of bands and
/// the periodic layer, where the material has them, then marginal curves, spectral transform
/// and tone.
class Finish {
  public:
    static Result<Finish> create(const Material& material,
                                 const SynthesisOptions& options, Period period,
                                 Executor& executor) {
        Finish finish;
        finish.fields_only_ = options.fields_only;
        if (material.modulation) {
            finish.modulation_ = &*material.modulation;
            SATEEN_TRY(finish.amplitudes_,
                       AmplitudeFields::create(*material.modulation, options.seed, period,
                                               executor));
        }
        if (!material.structure) return finish;
        finish.structure_ = &*material.structure;
        SATEEN_TRY(finish.phase_, PeriodicPhase::create(material.structure->periodic,
                                                        options.seed, period, executor));
        return finish;
    }
    /// Pixels that are needed on every side of a window.
    [[nodiscard]] std::size_t margin() const {
        return amplitudes_ ? kModulationReach : 0;
    }
    /// Of fields that are a whole torus, or that have the margin about them.
    void modulate(const Subspace& subspace, Border border, std::int32_t row,
                  std::int32_t col, ImageView<float> fields, Executor& executor) const {
        if (amplitudes_)
            modulate_planes(*modulation_, subspace, *amplitudes_, border, row, col,
                            fields, executor);
    }
    /// \param planes  fields whose top left is (row, col), overwritten
    /// \param out     a plane for each band, written; may be the fields
    void operator()(const Subspace& subspace, std::int32_t row, std::int32_t col,
                    ImageView<float> planes, std::span<const PlaneView<float>> out,
                    Executor& executor) const {
        Subspace coloured;
        if (phase_) {
            apply_periodic_layer(*structure_, subspace, *phase_, row, col, planes,
                                 executor);
            coloured.spectral = subspace.spectral;
            coloured.marginals.assign(planes.bands, Marginal{1, {}});
        }
        if (!fields_only_) {
            invert_spectral(phase_ ? coloured : subspace, planes, out, executor);
            return;
        }
        if (phase_) divide(planes, plane_deviations(*structure_, subspace));
        for (std::size_t band = 0; band < planes.bands; ++band)
            if (out[band].data != planes.plane(band).data)
                std::copy_n(planes.plane(band).data, planes.plane_size(), out[band].data);
    }
    /// In place.
    void operator()(const Subspace& subspace, std::int32_t row, std::int32_t col,
                    ImageView<float> planes, Executor& executor) const {
        (*this)(subspace, row, col, planes, windows_of(planes, 0, planes.rows), executor);
    }

  private:
    bool fields_only_ = false;
    const BandModulation* modulation_ = nullptr;
    std::optional<AmplitudeFields> amplitudes_;
    const Structure* structure_ = nullptr;
    std::optional<PeriodicPhase> phase_;
};

/// The finish of one subspace, for blocks of whole rows.
auto finish_rows(const Finish& finish, const Subspace& subspace) {
    return [&](std::int32_t row, ImageView<float> planes,
               std::span<const PlaneView<float>> out,
               Executor& executor) { finish(subspace, row, 0, planes, out, executor); };
}

/// The texture of one subspace on a torus.
Image draw_whole(const Torus& torus, const Finish& finish, const Subspace& subspace,
                 std::span<const SplitComplexPlane> noise, Executor& executor) {
    if (finish.margin() == 0)
        return torus.draw(subspace, noise, finish_rows(finish, subspace), executor);
    // Bands reach over all blocks of rows.
    const auto keep = [](std::int32_t, ImageView<float> planes,
                         std::span<const PlaneView<float>> out, Executor&) {
        for (std::size_t plane = 0; plane < planes.bands; ++plane)
            std::copy_n(planes.plane(plane).data, planes.plane_size(), out[plane].data);
    };
    Image texture = torus.draw(subspace, noise, keep, executor);
    finish.modulate(subspace, Border::wrap, 0, 0, texture.view(), executor);
    finish(subspace, 0, 0, texture.view(), executor);
    return texture;
}

Period period_of(const SynthesisOptions& options) {
    return {static_cast<std::int32_t>(options.rows),
            static_cast<std::int32_t>(options.cols)};
}

/// Rows of fields as they are drawn, with a margin about the strip that is wanted of them.
/// Strips come from top to bottom: rows that two of them share are drawn once.
template <class Planes>
class FieldRows {
  public:
    FieldRows(const Planes& planes, const SynthesisOptions& options, std::size_t bands,
              std::size_t margin)
        : planes_(planes), options_(options), bands_(bands), margin_(margin) {}

    /// \returns  fields of rows [first - margin, first + count + margin)
    Result<Image> strip(std::int64_t first, std::size_t count, Executor& executor) {
        const std::size_t cols = options_.cols + 2 * margin_;
        Image out(bands_, count + 2 * margin_, cols, uninitialised);
        const std::size_t known = kept_.rows();
        copy_rows(kept_.view(), 0, known, out.view(), 0);
        if (known < out.rows()) {
            Image fresh(bands_, out.rows() - known, cols, uninitialised);
            SATEEN_CHECK(planes_.draw(
                options_.seed,
                static_cast<std::int32_t>(first + static_cast<std::int64_t>(known) -
                                          static_cast<std::int64_t>(margin_)),
                options_.offset_col - static_cast<std::int32_t>(margin_), fresh.view(),
                executor));
            copy_rows(fresh.view(), 0, fresh.rows(), out.view(), known);
        }
        kept_ = Image(bands_, 2 * margin_, cols, uninitialised);
        copy_rows(out.view(), count, 2 * margin_, kept_.view(), 0);
        return out;
    }

  private:
    static void copy_rows(ImageView<const float> from, std::size_t first,
                          std::size_t count, ImageView<float> to, std::size_t at) {
        for (std::size_t band = 0; band < to.bands && count > 0; ++band)
            std::copy_n(from.plane(band).row(first), count * from.cols,
                        to.plane(band).row(at));
    }

    const Planes& planes_;
    const SynthesisOptions& options_;
    std::size_t bands_;
    std::size_t margin_;
    Image kept_;  ///< the last rows of the strip before
};

/// The middle of an image.
Image without_margin(const Image& image, std::size_t margin) {
    Image out(image.bands(), image.rows() - 2 * margin, image.cols() - 2 * margin,
              uninitialised);
    for (std::size_t band = 0; band < out.bands(); ++band)
        for (std::size_t r = 0; r < out.rows(); ++r)
            std::copy_n(image.plane(band).row(r + margin) + margin, out.cols(),
                        out.plane(band).row(r));
    return out;
}

/// Draws a window from top to bottom in strips that end on the block borders of the
/// planes.
template <class Planes>
Result<void> draw_in_strips(const Planes& planes, const Finish& finish,
                            const Subspace& subspace, const SynthesisOptions& options,
                            const StripSink& sink, Executor& executor,
                            Progress& progress) {
    const std::size_t bands = subspace.marginals.size();
    const auto step = static_cast<std::int64_t>(planes.strip_rows());
    const std::size_t margin = finish.margin();
    FieldRows<Planes> fields(planes, options, bands, margin);
    std::size_t row = 0;
    while (row < options.rows) {
        if (progress.cancelled())
            return Error{Errc::cancelled, "cancelled while drawing"};
        const std::int64_t at =
            std::int64_t{options.offset_row} + static_cast<std::int64_t>(row);
        // The rows that are drawn for this strip end below it by the margin.
        const std::int64_t past_border =
            (((at + static_cast<std::int64_t>(margin)) % step) + step) % step;
        const std::size_t count =
            std::min(static_cast<std::size_t>(step - past_border), options.rows - row);
        SATEEN_TRY(Image strip, fields.strip(at, count, executor));
        if (margin > 0) {
            const auto outer = static_cast<std::int32_t>(margin);
            finish.modulate(subspace, Border::mirror,
                            static_cast<std::int32_t>(at) - outer,
                            options.offset_col - outer, strip.view(), executor);
            strip = without_margin(strip, margin);
        }
        finish(subspace, static_cast<std::int32_t>(at), options.offset_col, strip.view(),
               executor);
        SATEEN_CHECK(sink(row, strip.view()));
        row += count;
        progress.report(static_cast<double>(row), static_cast<double>(options.rows));
    }
    return {};
}

/// A torus that one transform cannot draw: the infinite lattice with periodic noise.
Result<void> draw_periodic(const Material& material, const Subspace& subspace,
                           SynthesisOptions options, const StripSink& sink,
                           Executor& executor, Progress& progress) {
    options.offset_row = 0;
    options.offset_col = 0;
    const Period period = period_of(options);
    SATEEN_TRY(const Finish finish, Finish::create(material, options, period, executor));
    SATEEN_TRY(const InfinitePlanes planes,
               InfinitePlanes::create(material, subspace, period, executor));
    if (options.rows * options.cols > kWholeTextureSites)
        return draw_in_strips(planes, finish, subspace, options, sink, executor,
                              progress);

    Image whole(subspace.marginals.size(), options.rows, options.cols, uninitialised);
    SATEEN_CHECK(planes.draw(options.seed, 0, 0, whole.view(), executor));
    for (std::size_t plane = 0; plane < whole.bands(); ++plane)
        standardise(whole.plane(plane));
    finish.modulate(subspace, Border::wrap, 0, 0, whole.view(), executor);
    finish(subspace, 0, 0, whole.view(), executor);
    progress.report(1, 1);
    return sink(0, whole.view());
}

}  // namespace

Result<void> synthesise(const Material& material, std::size_t subspace_number,
                        const SynthesisOptions& options, const StripSink& sink,
                        Executor& executor, Progress& progress) {
    SATEEN_CHECK(check_window(options));
    SATEEN_CHECK(check_subspace(material, subspace_number));
    if (progress.cancelled()) return Error{Errc::cancelled, "cancelled while drawing"};
    const Subspace& subspace = material.subspaces[subspace_number];
    if (options.tileable) {
        if (!fits_one_transform(options))
            return draw_periodic(material, subspace, options, sink, executor, progress);
        SATEEN_TRY(const Finish finish,
                   Finish::create(material, options, period_of(options), executor));
        SATEEN_TRY(const Torus torus, Torus::create(material, options));
        const Image texture = draw_whole(torus, finish, subspace, {}, executor);
        progress.report(1, 1);
        return sink(0, texture.view());
    }
    SATEEN_TRY(const Finish finish,
               Finish::create(material, options, Period{}, executor));
    if (options.recursive || material.drawing == Drawing::recursive) {
        // Deviation: [CAR2] has no answer to a recursion that does not forget its start. Its
        // spectral density is finite all the same, and is drawn instead.
        const Result<RecursivePlanes> planes = RecursivePlanes::create(subspace);
        if (planes)
            return draw_in_strips(*planes, finish, subspace, options, sink, executor,
                                  progress);
        if (planes.error().code != Errc::not_stationary) return planes.error();
    }
    SATEEN_TRY(const InfinitePlanes planes,
               InfinitePlanes::create(material, subspace, Period{}, executor));
    return draw_in_strips(planes, finish, subspace, options, sink, executor, progress);
}

Result<Image> synthesise(const Material& material, std::size_t subspace,
                         const SynthesisOptions& options, Executor& executor,
                         Progress& progress) {
    SATEEN_CHECK(check_window(options));
    Image whole(material.bands, options.rows, options.cols);
    SATEEN_CHECK(synthesise(
        material, subspace, options,
        [&](std::size_t first_row, ImageView<const float> strip) -> Result<void> {
            for (std::size_t band = 0; band < strip.bands; ++band)
                for (std::size_t r = 0; r < strip.rows; ++r)
                    std::copy_n(strip.plane(band).row(r), strip.cols,
                                whole.plane(band).row(first_row + r));
            return {};
        },
        executor, progress));
    return whole;
}

Result<void> synthesise_tiles(
    const Material& material, std::span<const std::size_t> subspaces,
    const SynthesisOptions& options,
    const std::function<Result<void>(std::size_t subspace, Image texture)>& take,
    Executor& executor, Progress& progress) {
    SATEEN_CHECK(check_window(options));
    for (const std::size_t k : subspaces) SATEEN_CHECK(check_subspace(material, k));
    std::optional<Torus> torus;
    std::vector<SplitComplexPlane> noise;
    std::optional<Finish> finish;
    if (fits_one_transform(options)) {
        SATEEN_TRY(torus, Torus::create(material, options));
        noise = torus->noise(executor);
        SATEEN_TRY(finish,
                   Finish::create(material, options, period_of(options), executor));
    }
    SynthesisOptions tileable = options;
    tileable.tileable = true;
    PartProgress part(progress);
    const auto draw = [&](std::size_t subspace, Executor& threads) -> Result<Image> {
        if (!torus) return synthesise(material, subspace, tileable, threads, part);
        return draw_whole(*torus, *finish, material.subspaces[subspace], noise, threads);
    };
    // A subspace a thread, as many at a time as there are threads; what is left over
    // shares them.
    for (std::size_t first = 0; first < subspaces.size();) {
        if (progress.cancelled())
            return Error{Errc::cancelled, "cancelled while drawing"};
        const std::size_t count =
            std::min(executor.concurrency(), subspaces.size() - first);
        std::vector<Result<Image>> textures(count, Result<Image>(Image()));
        if (count < executor.concurrency()) {
            for (std::size_t i = 0; i < count; ++i)
                textures[i] = draw(subspaces[first + i], executor);
        } else {
            parallel_for(executor, count, [&](std::size_t i) {
                SerialExecutor serial;
                textures[i] = draw(subspaces[first + i], serial);
            });
        }
        for (std::size_t i = 0; i < count; ++i) {
            SATEEN_TRY(Image texture, std::move(textures[i]));
            SATEEN_CHECK(take(subspaces[first + i], std::move(texture)));
        }
        first += count;
        progress.report(static_cast<double>(first),
                        static_cast<double>(subspaces.size()));
    }
    return {};
}

std::size_t nearest_subspace(const Material& material, Direction view, Direction light) {
    const auto cosine = [](Direction a, Direction b) {
        const auto u = to_vector(a);
        const auto v = to_vector(b);
        return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    };
    std::vector<float> to_view;
    std::vector<float> to_light;
    for (const Direction& d : material.views) to_view.push_back(cosine(d, view));
    for (const Direction& d : material.lights) to_light.push_back(cosine(d, light));
    std::size_t best = 0;
    float best_closeness = -3;
    for (const IndexEntry& entry : material.index) {
        const float closeness = to_view[entry.view] + to_light[entry.light];
        if (closeness > best_closeness) {
            best_closeness = closeness;
            best = entry.subspace;
        }
    }
    return best;
}

}  // namespace sateen
