// SPDX-License-Identifier: Apache-2.0
// Textures in strips. See window.hpp.
#include "synthesis/window.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/plane_moments.hpp"
#include "synthesis/finish.hpp"
#include "synthesis/infinite_field.hpp"
#include "synthesis/recursive_field.hpp"
#include "synthesis/spectral_density.hpp"
#include "synthesis/torus.hpp"

namespace sateen {
namespace {

/// Shifts and scales a plane to mean 0 and variance 1; leaves a constant one.
void standardise(PlaneView<float> plane) {
    const PlaneMoments moments = moments_of(plane);
    if (!(moments.variance > 0)) return;
    const auto shift = static_cast<float>(moments.mean);
    const auto scale = static_cast<float>(1 / std::sqrt(moments.variance));
    for (std::size_t i = 0; i < plane.size(); ++i)
        plane.data[i] = (plane.data[i] - shift) * scale;
}

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

}  // namespace

Result<void> draw_window(const Material& material, const Subspace& subspace,
                         const SynthesisOptions& options, const StripSink& sink,
                         Executor& executor, Progress& progress) {
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

}  // namespace sateen
