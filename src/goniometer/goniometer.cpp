// SPDX-License-Identifier: Apache-2.0
// Images of a surface by view and light. See goniometer.hpp.
#include "sateen/goniometer/goniometer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>

#include "goniometer/interreflection.hpp"
#include "goniometer/tracer.hpp"

namespace sateen {

using goniometer::Hits;
using goniometer::Interreflection;
using goniometer::kLanes;
using goniometer::Layer;
using goniometer::Reflected;
using goniometer::Tracer;
using goniometer::Vector;

struct Goniometer::State {
    State(Tracer tracer_, std::vector<Direction> lights_,
          const GoniometerOptions& options_)
        : tracer(std::move(tracer_)), lights(std::move(lights_)), options(options_) {}

    Tracer tracer;
    std::vector<Direction> lights;
    GoniometerOptions options;
    std::vector<Image> gathered;  ///< of each light; none without interreflection

    [[nodiscard]] float width() const { return static_cast<float>(options.cols); }
    [[nodiscard]] float depth() const { return static_cast<float>(options.rows); }
    [[nodiscard]] Hits trace(Direction view, std::size_t samples,
                             Executor& executor) const;
    [[nodiscard]] Image light_up(const Hits& hits, Direction view,
                                 std::size_t light) const;
    void add_gathered(const Hits::Block& block, std::size_t light,
                      Reflected& value) const;
};

namespace {

Error out_of_range(const std::string& what, float radians, float largest) {
    return {Errc::invalid_argument,
            what + ": found theta " + std::to_string(radians / kRadiansPerDegree) +
                " degrees, expected 0 to " + std::to_string(largest / kRadiansPerDegree)};
}

Result<void> check(const GoniometerOptions& options, std::span<const Direction> lights) {
    constexpr std::size_t kMaxSide = 8192;
    constexpr std::size_t kMaxSamples = 16;
    const auto between = [](std::size_t value, std::size_t largest) {
        return value >= 1 && value <= largest;
    };
    if (!between(options.rows, kMaxSide) || !between(options.cols, kMaxSide))
        return Error{Errc::invalid_argument,
                     "size: found " + std::to_string(options.cols) + " x " +
                         std::to_string(options.rows) + ", expected 1 to 8192 a side"};
    if (!between(options.samples, kMaxSamples))
        return Error{
            Errc::invalid_argument,
            "samples: found " + std::to_string(options.samples) + ", expected 1 to 16"};
    if (!(options.f0 >= 0 && options.f0 <= 1))
        return Error{Errc::invalid_argument,
                     "F0: found " + std::to_string(options.f0) + ", expected 0 to 1"};
    if (!(options.max_view_theta >= 0 && options.max_view_theta <= kMaxTheta))
        return out_of_range("views", options.max_view_theta, kMaxTheta);
    for (std::size_t k = 0; k < lights.size(); ++k)
        if (!(lights[k].theta >= 0 && lights[k].theta <= kMaxTheta))
            return out_of_range("light " + std::to_string(k), lights[k].theta, kMaxTheta);
    return {};
}

/// The surface with its mean height at 0, and normals.
SurfaceMaps prepared(const SurfaceMaps& surface, float cell_x, float cell_y) {
    SurfaceMaps result = surface;
    const double sum = std::accumulate(surface.height.values().begin(),
                                       surface.height.values().end(), 0.0);
    const auto mean =
        static_cast<float>(sum / static_cast<double>(surface.height.plane_size()));
    for (float& z : result.height.values()) z -= mean;
    if (result.normal.empty()) result.normal = normals_of(result.height, cell_x, cell_y);
    return result;
}

}  // namespace

Goniometer::Goniometer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Goniometer::Goniometer(Goniometer&&) noexcept = default;
Goniometer& Goniometer::operator=(Goniometer&&) noexcept = default;
Goniometer::~Goniometer() = default;

Result<Goniometer> Goniometer::create(const SurfaceMaps& surface,
                                      std::vector<Direction> lights,
                                      const GoniometerOptions& options,
                                      Executor& executor) {
    SATEEN_CHECK(validate(surface));
    SATEEN_CHECK(check(options, lights));
    const auto width = static_cast<float>(options.cols);
    const auto depth = static_cast<float>(options.rows);
    const SurfaceMaps levelled =
        prepared(surface, width / static_cast<float>(surface.height.cols()),
                 depth / static_cast<float>(surface.height.rows()));
    const auto [low, high] = std::minmax_element(levelled.height.values().begin(),
                                                 levelled.height.values().end());
    float steepest = options.max_view_theta;
    for (const Direction& light : lights) steepest = std::max(steepest, light.theta);
    // A view ray crosses heights from above the highest to the lowest; a shadow ray at
    // most as many, from inside the period.
    const float reach = (*high - *low + 1) * std::tan(steepest);
    SATEEN_TRY(Tracer tracer, Tracer::create(levelled, width, depth, reach));
    auto state = std::make_unique<State>(std::move(tracer), std::move(lights), options);
    if (options.gather_rays > 0) {
        const Interreflection between(state->tracer, options.rows, options.cols, width,
                                      depth, options.gather_rays, executor);
        state->gathered.resize(state->lights.size());
        parallel_for(executor, state->lights.size(), [&](std::size_t k) {
            state->gathered[k] = between.gather(
                state->tracer, to_vector(state->lights[k]), options.shadows);
        });
    }
    return Goniometer(std::move(state));
}

Hits Goniometer::State::trace(Direction view, std::size_t samples,
                              Executor& executor) const {
    const std::size_t count = options.rows * options.cols * samples * samples;
    std::vector<float> x;
    std::vector<float> y;
    x.reserve(count);
    y.reserve(count);
    const auto place = [&](std::size_t pixel, std::size_t sample) {
        return static_cast<float>(pixel) +
               (static_cast<float>(sample) + 0.5F) / static_cast<float>(samples);
    };
    for (std::size_t r = 0; r < options.rows; ++r)
        for (std::size_t c = 0; c < options.cols; ++c)
            for (std::size_t i = 0; i < samples; ++i)
                for (std::size_t j = 0; j < samples; ++j) {
                    x.push_back(place(c, j));
                    y.push_back(-place(r, i));
                }
    return tracer.trace(x, y, view, executor);
}

/// Adds ρ J, bilinear between pixel centres.
void Goniometer::State::add_gathered(const Hits::Block& block, std::size_t light,
                                     Reflected& value) const {
    const std::size_t rows = options.rows;
    const std::size_t cols = options.cols;
    const std::size_t plane = rows * cols;
    const std::array<const float*, 3> albedo = {
        block.colour.x.data(), block.colour.y.data(), block.colour.z.data()};
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float col = block.point.x[i] - 0.5F;
        const float row = -block.point.y[i] - 0.5F;
        const float left = std::floor(col);
        const float top = std::floor(row);
        const float u = col - left;
        const float v = row - top;
        const std::size_t c0 =
            left < 0 ? cols - 1 : static_cast<std::size_t>(left) % cols;
        const std::size_t r0 = top < 0 ? rows - 1 : static_cast<std::size_t>(top) % rows;
        const std::size_t c1 = c0 + 1 == cols ? 0 : c0 + 1;
        const std::size_t r1 = r0 + 1 == rows ? 0 : r0 + 1;
        for (std::size_t band = 0; band < 3; ++band) {
            const float* const j = gathered[light].values().data() + band * plane;
            value[band][i] +=
                albedo[band][i] *
                ((1 - v) * ((1 - u) * j[r0 * cols + c0] + u * j[r0 * cols + c1]) +
                 v * ((1 - u) * j[r1 * cols + c0] + u * j[r1 * cols + c1]));
        }
    }
}

Image Goniometer::State::light_up(const Hits& hits, Direction view,
                                  std::size_t light) const {
    const Vector to_view = to_vector(view);
    const Vector to_light = to_vector(lights[light]);
    const Layer layer{options.specular, options.f0};
    Image image(3, options.rows, options.cols);
    const std::size_t plane = image.plane_size();
    const std::size_t per_pixel = options.samples * options.samples;
    const float share = 1 / static_cast<float>(per_pixel);
    float* const values = image.values().data();
    for (std::size_t b = 0; b < hits.blocks.size(); ++b) {
        const Hits::Block& block = hits.blocks[b];
        Reflected value =
            goniometer::reflect(block, layer, to_view, to_light,
                                tracer.lit(block, to_light, options.shadows));
        if (!gathered.empty()) add_gathered(block, light, value);
        for (std::size_t i = 0; i < kLanes && b * kLanes + i < hits.count; ++i) {
            const std::size_t pixel = (b * kLanes + i) / per_pixel;
            for (std::size_t band = 0; band < 3; ++band)
                values[band * plane + pixel] += share * value[band][i];
        }
    }
    return image;
}

Result<void> Goniometer::measure(Direction view, std::span<const std::size_t> lights,
                                 const LitImageSink& take, Executor& executor,
                                 const Progress& progress) const {
    if (!(view.theta >= 0 && view.theta <= state_->options.max_view_theta))
        return out_of_range("view", view.theta, state_->options.max_view_theta);
    for (const std::size_t light : lights)
        if (light >= state_->lights.size())
            return Error{Errc::invalid_argument,
                         "light: found index " + std::to_string(light) +
                             ", expected less than " +
                             std::to_string(state_->lights.size())};
    const Hits hits = state_->trace(view, state_->options.samples, executor);
    std::mutex mutex;
    std::map<std::size_t, Error> failures;
    parallel_for(executor, lights.size(), [&](std::size_t k) {
        if (progress.cancelled()) return;
        Result<void> taken = take(lights[k], state_->light_up(hits, view, lights[k]));
        if (taken) return;
        const std::lock_guard lock(mutex);
        failures.emplace(k, std::move(taken).error());
    });
    if (!failures.empty()) return failures.begin()->second;
    if (progress.cancelled()) return Error{Errc::cancelled, "cancelled"};
    return {};
}

SurfaceMaps Goniometer::truth(Executor& executor) const {
    constexpr std::size_t kSamples = 4;
    const GoniometerOptions& options = state_->options;
    const Hits hits = state_->trace({}, kSamples, executor);
    const std::size_t plane = options.rows * options.cols;
    SurfaceMaps truth{
        Image(1, options.rows, options.cols), Image(3, options.rows, options.cols),
        Image(3, options.rows, options.cols), Image(1, options.rows, options.cols)};
    constexpr std::size_t kPerPixel = kSamples * kSamples;
    constexpr float kShare = 1.0F / kPerPixel;
    const auto add = [&](Image& map, std::size_t band, std::size_t pixel, float value) {
        map.values()[band * plane + pixel] += kShare * value;
    };
    for (std::size_t k = 0; k < hits.count; ++k) {
        const Hits::Block& block = hits.blocks[k / kLanes];
        const std::size_t i = k % kLanes;
        const std::size_t pixel = k / kPerPixel;
        add(truth.height, 0, pixel, block.point.z[i]);
        add(truth.normal, 0, pixel, block.normal.x[i]);
        add(truth.normal, 1, pixel, block.normal.y[i]);
        add(truth.normal, 2, pixel, block.normal.z[i]);
        add(truth.colour, 0, pixel, block.colour.x[i]);
        add(truth.colour, 1, pixel, block.colour.y[i]);
        add(truth.colour, 2, pixel, block.colour.z[i]);
        add(truth.roughness, 0, pixel, block.roughness[i]);
    }
    const std::span<float> n = truth.normal.values();
    for (std::size_t p = 0; p < plane; ++p) {
        const Vector unit =
            goniometer::normalised({n[p], n[plane + p], n[2 * plane + p]});
        for (std::size_t band = 0; band < 3; ++band) n[band * plane + p] = unit[band];
    }
    return truth;
}

const GoniometerOptions& Goniometer::options() const {
    return state_->options;
}

std::span<const Direction> Goniometer::lights() const {
    return state_->lights;
}

}  // namespace sateen
