// SPDX-License-Identifier: Apache-2.0
#include "compare_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "known_pairs.hpp"
#include "sateen/analysis/reflectance.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/synthesis/evaluate.hpp"

namespace sateen::cli {
namespace {

/// Means are taken of textures of this side; textures are scored at the size of the images, up
/// to a limit.
constexpr std::size_t kMeanSide = 64;
constexpr std::size_t kMostSide = 512;

double theta_degrees(Direction d) {
    return static_cast<double>(d.theta / kRadiansPerDegree);
}

// What a front end shows of a material, as values of the measurement.
class Drawing {
  public:
    static Result<Drawing> create(const Material& material, std::size_t side,
                                  std::uint64_t seed, Executor& executor) {
        Progress silent;
        EvaluatorOptions options;
        options.side = side;
        options.seed = seed;
        SATEEN_TRY(Evaluator evaluator,
                   Evaluator::create(material, options, executor, silent));
        return Drawing(std::move(evaluator), material);
    }
    [[nodiscard]] Image at(Direction view, Direction light, std::size_t rows,
                           std::size_t cols) const {
        const auto to_light = to_vector(light);
        const auto at = evaluator_.prepare(to_vector(view), to_light);
        // The evaluator's values contain the cosine of the light.
        const float scale = cosine_included_ ? 1 : 1 / std::max(1e-3F, to_light[2]);
        const auto side = static_cast<float>(evaluator_.side());
        Image drawn(bands_, rows, cols, uninitialised);
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < cols; ++c) {
                const auto value =
                    evaluator_.sample(at, (static_cast<float>(c) + 0.5F) / side,
                                      -(static_cast<float>(r) + 0.5F) / side);
                for (std::size_t b = 0; b < bands_; ++b)
                    drawn(b, r, c) = scale * value[b];
            }
        return drawn;
    }
    [[nodiscard]] const Evaluator& evaluator() const { return evaluator_; }

  private:
    Drawing(Evaluator evaluator, const Material& material)
        : evaluator_(std::move(evaluator)),
          bands_(material.bands),
          cosine_included_(material.cosine_included) {}
    Evaluator evaluator_;
    std::size_t bands_;
    bool cosine_included_;
};

MeanError error_of(const ImageMoments& measured, const ImageMoments& shown,
                   std::size_t bands) {
    const auto lab = [&](const ImageMoments& m) {
        const auto band = [&](std::size_t b) { return m.mean[std::min(b, bands - 1)]; };
        return lab_from_linear_srgb(band(0), band(1), band(2));
    };
    const auto contrast = [](const ImageMoments& m) {
        return std::max(1e-3, m.deviation / std::max(1e-6, m.luminance));
    };
    return {delta_e_2000(lab(measured), lab(shown)),
            std::log(contrast(shown) / contrast(measured))};
}

// The i-th of the values becomes one of those from i on, at random.
void draw_one(std::vector<std::size_t>& values, std::size_t i, std::mt19937_64& engine) {
    std::swap(values[i], values[i + engine() % (values.size() - i)]);
}

// How many to take of each group, `most` in all: one of each in turns, as long as there are.
std::vector<std::size_t> quotas(const std::vector<std::size_t>& sizes, std::size_t most,
                                std::mt19937_64& engine) {
    std::vector<std::size_t> quota(sizes.size());
    while (most > 0) {
        std::vector<std::size_t> open;
        for (std::size_t k = 0; k < sizes.size(); ++k)
            if (quota[k] < sizes[k]) open.push_back(k);
        if (open.empty()) break;
        const std::size_t taken = std::min(most, open.size());
        for (std::size_t i = 0; i < taken; ++i) {
            draw_one(open, i, engine);
            ++quota[open[i]];
        }
        most -= taken;
    }
    return quota;
}

// A random sample of the pairs, as many of each pair of elevations.
std::vector<PairTexture> sample_of(const DirectionComparison& comparison,
                                   std::size_t most, std::uint64_t seed) {
    std::map<std::pair<long, long>, std::vector<std::size_t>> strata;
    for (std::size_t i = 0; i < comparison.pairs.size(); ++i) {
        const PairError& pair = comparison.pairs[i];
        strata[{std::lround(theta_degrees(comparison.views[pair.view])),
                std::lround(theta_degrees(comparison.lights[pair.light]))}]
            .push_back(i);
    }
    std::vector<std::size_t> sizes;
    for (const auto& [elevations, members] : strata) sizes.push_back(members.size());
    std::mt19937_64 engine(seed);
    const std::vector<std::size_t> quota = quotas(sizes, most, engine);
    std::vector<PairTexture> sample;
    std::size_t k = 0;
    for (auto& [elevations, members] : strata) {
        for (std::size_t j = 0; j < quota[k]; ++j) {
            draw_one(members, j, engine);
            sample.push_back(
                {members[j],
                 static_cast<double>(sizes[k]) / static_cast<double>(quota[k]),
                 {},
                 {}});
        }
        ++k;
    }
    return sample;
}

// The whole comparison; its parts in the order of their calls.
class Comparer {
  public:
    Comparer(const Material& material, const Measurement& measurement,
             const CompareDirectionsOptions& options, Executor& executor,
             Progress& progress)
        : material_(material),
          measurement_(measurement),
          info_(measurement.info()),
          options_(options),
          executor_(executor),
          progress_(progress),
          known_(material, info_) {
        out_.views = info_.views;
        out_.lights = info_.lights;
    }

    Result<void> compare_means() {
        progress_.stage("comparing directions");
        SATEEN_TRY(const Drawing drawing,
                   Drawing::create(material_, kMeanSide, options_.seed, executor_));
        const std::size_t all = info_.observations.size();
        std::vector<std::size_t> asked = evenly_spread(all, options_.pairs);
        // The nearest measured pair of those that were not is one that the material knows.
        const bool incomplete = !known_.all().empty() && known_.all().size() < all;
        std::vector<std::size_t> read = asked;
        if (incomplete) {
            read.insert(read.end(), known_.all().begin(), known_.all().end());
            std::sort(read.begin(), read.end());
            read.erase(std::unique(read.begin(), read.end()), read.end());
        }
        std::vector<std::optional<ImageMoments>> moments(all);
        const SomeImages selection(measurement_, read);
        SATEEN_TRY(const PassReport report,
                   for_each_image(selection, true, executor_, progress_,
                                  [&](std::size_t i, const Image& image) {
                                      moments[read[i]] = image_moments(image.view());
                                  }));
        (void)report;
        std::erase_if(asked, [&](std::size_t i) { return !moments[i]; });
        out_.pairs.resize(asked.size());
        observations_ = asked;
        parallel_for(executor_, asked.size(), [&](std::size_t k) {
            const Observation& o = info_.observations[asked[k]];
            const ImageMoments& truth = *moments[asked[k]];
            const Image drawn = drawing.at(info_.views[o.view], info_.lights[o.light],
                                           kMeanSide, kMeanSide);
            PairError& pair = out_.pairs[k];
            pair = {o.view, o.light,
                    error_of(truth, image_moments(drawn.view()), material_.bands),
                    std::nullopt};
            if (!incomplete || known_.contains(asked[k])) return;
            if (const auto& nearest = moments[known_.nearest(o)])
                pair.nearest = error_of(truth, *nearest, material_.bands);
        });
        const auto index = drawing.evaluator().interpolation().index();
        if (index.size() == info_.views.size() * info_.lights.size())
            out_.index.assign(index.begin(), index.end());
        return {};
    }

    Result<void> compare_textures() {
        const std::size_t least = std::min(info_.rows, info_.cols);
        if (least < TextureReference::kMinSide || options_.textures == 0) return {};
        progress_.stage("scoring textures");
        const std::size_t side = std::clamp(std::max(info_.rows, info_.cols),
                                            TextureReference::kMinSide, kMostSide);
        SATEEN_TRY(drawing_, make_drawing(side));
        out_.textures = sample_of(out_, options_.textures, options_.seed);
        std::vector<std::optional<Error>> errors(out_.textures.size());
        std::atomic<std::size_t> finished = 0;
        parallel_for(executor_, out_.textures.size(), [&](std::size_t k) {
            if (progress_.cancelled()) return;
            const Result<void> scored = score(out_.textures[k]);
            if (!scored) errors[k] = scored.error();
            progress_.report(static_cast<double>(++finished),
                             static_cast<double>(out_.textures.size()));
        });
        for (std::optional<Error>& error : errors)
            if (error) return std::move(*error);
        if (progress_.cancelled())
            return Error{Errc::cancelled, "cancelled while scoring textures"};
        return options_.exhibits ? choose_exhibits() : Result<void>{};
    }

    [[nodiscard]] DirectionComparison take() { return std::move(out_); }

  private:
    Result<std::optional<Drawing>> make_drawing(std::size_t side) {
        SATEEN_TRY(Drawing drawing,
                   Drawing::create(material_, side, options_.seed, executor_));
        return std::optional<Drawing>(std::move(drawing));
    }

    [[nodiscard]] Image drawn(const PairError& pair) const {
        return drawing_->at(info_.views[pair.view], info_.lights[pair.light],
                            std::min(info_.rows, kMostSide),
                            std::min(info_.cols, kMostSide));
    }

    Result<void> score(PairTexture& texture) const {
        SerialExecutor here;
        const PairError& pair = out_.pairs[texture.pair];
        const std::size_t observation = observations_[texture.pair];
        SATEEN_TRY(const Image measured, measurement_.read(observation));
        const Image shown = drawn(pair);
        SATEEN_TRY(
            const TextureReference reference,
            TextureReference::create(measured, {shown.rows(), shown.cols()}, here));
        SATEEN_TRY(texture.drawn, reference.compare(shown, here));
        if (!pair.nearest) return {};
        SATEEN_TRY(const Image nearest,
                   measurement_.read(known_.nearest(info_.observations[observation])));
        SATEEN_TRY(texture.nearest, reference.compare(nearest, here));
        return {};
    }

    Result<void> exhibit(const std::string& what, const PairTexture& texture) {
        const PairError& pair = out_.pairs[texture.pair];
        const auto degrees = [](Direction d) {
            return fmt::format("{:.0f}°, {:.0f}°", theta_degrees(d),
                               static_cast<double>(d.phi / kRadiansPerDegree));
        };
        SATEEN_TRY(Image measured, measurement_.read(observations_[texture.pair]));
        out_.exhibits.push_back(
            {fmt::format("{}: view {}, light {}; texture {:.2f}, colour ΔE {:.2f}", what,
                         degrees(info_.views[pair.view]),
                         degrees(info_.lights[pair.light]), texture.drawn.total,
                         pair.drawn.delta_e),
             std::move(measured), drawn(pair)});
        return {};
    }

    Result<void> choose_exhibits() {
        std::vector<PairTexture> order = out_.textures;
        const auto sort_by = [&](auto value) {
            std::sort(order.begin(), order.end(),
                      [&](const auto& a, const auto& b) { return value(a) < value(b); });
        };
        if (order.empty()) return {};
        const auto score_of = [](const PairTexture& t) { return t.drawn.total; };
        sort_by(score_of);
        SATEEN_CHECK(exhibit("Best texture", order.front()));
        SATEEN_CHECK(exhibit("Median texture", order[order.size() / 2]));
        SATEEN_CHECK(exhibit("Worst texture", order.back()));
        sort_by([&](const PairTexture& t) { return out_.pairs[t.pair].drawn.delta_e; });
        SATEEN_CHECK(exhibit("Worst colour of those scored", order.back()));
        const auto sum_of_angles = [&](const PairTexture& t) {
            const PairError& pair = out_.pairs[t.pair];
            return info_.views[pair.view].theta + info_.lights[pair.light].theta;
        };
        sort_by(sum_of_angles);
        return exhibit("Most grazing", order.back());
    }

    const Material& material_;
    const Measurement& measurement_;
    const MeasurementInfo& info_;
    const CompareDirectionsOptions& options_;
    Executor& executor_;
    Progress& progress_;
    KnownPairs known_;
    std::optional<Drawing> drawing_;
    std::vector<std::size_t> observations_;  // of every pair
    DirectionComparison out_;
};

}  // namespace

Result<DirectionComparison> compare_directions(const Material& material,
                                               const Measurement& measurement,
                                               const CompareDirectionsOptions& options,
                                               Executor& executor, Progress& progress) {
    Comparer comparer(material, measurement, options, executor, progress);
    SATEEN_CHECK(comparer.compare_means());
    SATEEN_CHECK(comparer.compare_textures());
    return comparer.take();
}

}  // namespace sateen::cli
