// SPDX-License-Identifier: Apache-2.0
// Material to texture. See synthesise.hpp.
#include "sateen/synthesis/synthesise.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "synthesis/finish.hpp"
#include "synthesis/torus.hpp"
#include "synthesis/window.hpp"

namespace sateen {
namespace {

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
        const Image texture = torus.draw(subspace, finish, {}, executor);
        progress.report(1, 1);
        return sink(0, texture.view());
    }
    return draw_window(material, subspace, options, sink, executor, progress);
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
    const auto draw = [&](std::size_t subspace, Executor& by) -> Result<Image> {
        if (!torus) return synthesise(material, subspace, tileable, by, part);
        return torus->draw(material.subspaces[subspace], *finish, noise, by);
    };
    // A subspace a thread, as many at a time as there are threads: more at a time would be new
    // memory for each. What is left over shares the threads.
    const std::size_t threads = executor.concurrency();
    for (std::size_t first = 0; first < subspaces.size();) {
        if (progress.cancelled())
            return Error{Errc::cancelled, "cancelled while drawing"};
        const std::size_t count = std::min(threads, subspaces.size() - first);
        std::vector<Result<Image>> textures(count, Result<Image>(Image()));
        if (count < threads) {
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
