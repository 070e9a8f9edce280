// SPDX-License-Identifier: Apache-2.0
// Blends of subspaces. See synthesise_direction.hpp.
#include "sateen/synthesis/synthesise_direction.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "sateen/synthesis/surface.hpp"

namespace sateen {
namespace {

constexpr std::size_t kMomentSide = 128;
/// Of a tileable blend, which is drawn at once.
constexpr std::size_t kMaxTileableSites = std::size_t{1} << 26U;
/// Of the strips of other blends; each is drawn once for every subspace.
constexpr std::size_t kStripSites = std::size_t{1} << 22U;

Result<TextureMoments> small_moments(const Material& material, Executor& executor) {
    std::vector<std::size_t> all(material.subspaces.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<Image> textures;
    SynthesisOptions options;
    options.rows = kMomentSide;
    options.cols = kMomentSide;
    options.tileable = true;
    Progress silent;
    SATEEN_CHECK(synthesise_tiles(
        material, all, options,
        [&](std::size_t, Image texture) -> Result<void> {
            textures.push_back(std::move(texture));
            return {};
        },
        executor, silent));
    return texture_moments(textures);
}

// sum += weight · texture, where the texture lies in the sum at `first_row`.
void accumulate(ImageView<const float> texture, float weight, std::size_t first_row,
                Image& sum) {
    for (std::size_t b = 0; b < texture.bands; ++b)
        for (std::size_t r = 0; r < texture.rows; ++r) {
            const float* from = texture.plane(b).row(r);
            float* to = sum.plane(b).row(first_row + r);
            for (std::size_t c = 0; c < texture.cols; ++c) to[c] += weight * from[c];
        }
}

void apply(const Blend& blend, ImageView<float> image) {
    for (std::size_t b = 0; b < image.bands; ++b) {
        float* plane = image.plane(b).data;
        for (std::size_t i = 0; i < image.plane_size(); ++i)
            plane[i] = value_of(blend, b, plane[i]);
    }
}

// The blend of textures, not yet brought to its mean and contrast.
Result<Image> draw_smooth(const Material& material, const Blend& blend,
                          const SynthesisOptions& options, Executor& executor,
                          Progress& progress) {
    Image sum(material.bands, options.rows, options.cols);
    for (std::size_t i = 0; i < blend.count; ++i) {
        if (progress.cancelled())
            return Error{Errc::cancelled, "cancelled while drawing"};
        Progress silent;
        SATEEN_CHECK(synthesise(
            material, blend.subspace[i], options,
            [&](std::size_t first_row, ImageView<const float> strip) -> Result<void> {
                accumulate(strip, blend.weight[i], first_row, sum);
                return {};
            },
            executor, silent));
    }
    return sum;
}

Result<Image> draw_height(const Surface& surface, const SynthesisOptions& options) {
    if (!options.tileable)
        return draw_range(
            surface, {options.offset_row, options.offset_col, options.rows, options.cols},
            options.seed);
    SATEEN_TRY(ToroidalRange range,
               draw_toroidal_range(surface, options.rows, options.cols, options.seed));
    return std::move(range.height_px);
}

// A window of the blend, or the whole of a tileable one.
Result<Image> draw(const Material& material, const LitBlend& lit,
                   SynthesisOptions options, Executor& executor, Progress& progress) {
    if (lit.relief && !options.tileable) {
        const std::size_t margin = lit.relief->margin();
        options.rows += 2 * margin;
        options.cols += 2 * margin;
        options.offset_row -= static_cast<std::int32_t>(margin);
        options.offset_col -= static_cast<std::int32_t>(margin);
    }
    SATEEN_TRY(Image image,
               draw_smooth(material, lit.blend, options, executor, progress));
    if (lit.relief) {
        SATEEN_TRY(const Image height, draw_height(*material.surface, options));
        image = lit.relief->times(image, height, options.tileable, executor);
    }
    apply(lit.blend, image.view());
    return image;
}

Blend one_subspace(std::size_t subspace) {
    Blend blend;
    blend.count = 1;
    blend.subspace[0] = static_cast<std::uint8_t>(subspace);
    blend.weight[0] = 1;
    blend.gain = {1, 1, 1};
    return blend;
}

std::optional<RelitRange> relief_of(const Material& material, Direction view,
                                    Direction light) {
    if (!material.surface || !material.surface->delit) return std::nullopt;
    return RelitRange(*material.surface, view, light);
}

}  // namespace

Result<LitBlend> lit_blend(const Material& material, Direction view, Direction light,
                           const InterpolationOptions& options, Executor& executor) {
    LitBlend lit{{}, relief_of(material, view, light)};
    // Photographs, and scattered sets whose table of all pairs would be too large.
    const std::size_t most = std::max(material.views.size(), material.lights.size());
    if (material.index.empty() || most > DirectionMesh::kMaxSize ||
        material.views.size() * material.lights.size() > kMaxPairs) {
        lit.blend = one_subspace(nearest_subspace(material, view, light));
        return lit;
    }
    TextureMoments moments;
    if (options.reflectance && material.reflectance) {
        SATEEN_TRY(moments, small_moments(material, executor));
    }
    SATEEN_TRY(const DirectionalInterpolation interpolation,
               DirectionalInterpolation::create(material, std::move(moments), options));
    lit.blend = interpolation.at(to_vector(view), to_vector(light),
                                 lit.relief ? lit.relief->shape() : FactorShape{});
    return lit;
}

Direction light_of(const Material& material) {
    const bool delit = material.surface && material.surface->delit;
    return material.index.empty() && delit ? direction_from_degrees(45, 135)
                                           : Direction{};
}

LitBlend lit_subspace(const Material& material, std::size_t subspace) {
    const Subspace& of = material.subspaces[subspace];
    const bool measured = !material.index.empty();
    const Direction view = measured ? material.views[of.view] : Direction{};
    const Direction light = measured ? material.lights[of.light] : light_of(material);
    return {one_subspace(subspace), relief_of(material, view, light)};
}

Result<void> synthesise(const Material& material, const LitBlend& lit,
                        const SynthesisOptions& options, const StripSink& sink,
                        Executor& executor, Progress& progress) {
    const auto drawable = [](std::size_t side) {
        return side > 0 && side <= kMaxTextureSide;
    };
    const Blend& blend = lit.blend;
    // Sizes that cannot be drawn get their message there.
    if ((blend.count == 1 && !lit.relief) || !drawable(options.rows) ||
        !drawable(options.cols))
        return synthesise(
            material, blend.subspace[0], options,
            [&](std::size_t first_row, ImageView<const float> strip) -> Result<void> {
                Image scaled(strip.bands, strip.rows, strip.cols);
                accumulate(strip, 1, 0, scaled);
                apply(blend, scaled.view());
                return sink(first_row, scaled.view());
            },
            executor, progress);
    if (options.tileable && options.rows * options.cols > kMaxTileableSites)
        return Error{Errc::limit_exceeded,
                     "a tileable texture of " + std::to_string(options.cols) + "x" +
                         std::to_string(options.rows) +
                         " pixels between subspaces or with relief: expected at most " +
                         std::to_string(kMaxTileableSites) + " pixels, or one subspace"};
    const std::size_t step = options.tileable
                                 ? options.rows
                                 : std::max<std::size_t>(64, kStripSites / options.cols);
    for (std::size_t row = 0; row < options.rows; row += step) {
        SynthesisOptions window = options;
        window.rows = std::min(step, options.rows - row);
        window.offset_row += static_cast<std::int32_t>(row);
        SATEEN_TRY(const Image strip, draw(material, lit, window, executor, progress));
        SATEEN_CHECK(sink(row, strip.view()));
        progress.report(static_cast<double>(row + window.rows),
                        static_cast<double>(options.rows));
    }
    return {};
}

Result<Image> synthesise(const Material& material, const LitBlend& lit,
                         const SynthesisOptions& options, Executor& executor,
                         Progress& progress) {
    Image image(material.bands, options.rows, options.cols);
    SATEEN_CHECK(synthesise(
        material, lit, options,
        [&](std::size_t first_row, ImageView<const float> strip) -> Result<void> {
            accumulate(strip, 1, first_row, image);
            return {};
        },
        executor, progress));
    return image;
}

}  // namespace sateen
