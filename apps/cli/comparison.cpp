// SPDX-License-Identifier: Apache-2.0
#include "comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sateen/synthesis/synthesise.hpp"
#include "sateen/synthesis/synthesise_direction.hpp"

namespace sateen::cli {
namespace {

// The image a subspace was modelled from: the observation of its directions, or the
// photograph of its number.
Result<std::size_t> representative_of(const MeasurementInfo& info,
                                      const Material& material, std::size_t subspace) {
    const Subspace& wanted = material.subspaces[subspace];
    const auto near = [](Direction a, Direction b) {
        const auto u = to_vector(a);
        const auto v = to_vector(b);
        constexpr float kSame = 1 - 1e-6F;
        return u[0] * v[0] + u[1] * v[1] + u[2] * v[2] > kSame;
    };
    for (std::size_t i = 0; i < info.observations.size(); ++i) {
        const Observation& o = info.observations[i];
        if (!info.has_directions()) {
            if (i == std::min(subspace, info.observations.size() - 1)) return i;
        } else if (wanted.view < material.views.size() &&
                   wanted.light < material.lights.size() &&
                   near(info.views[o.view], material.views[wanted.view]) &&
                   near(info.lights[o.light], material.lights[wanted.light])) {
            return i;
        }
    }
    return Error{
        Errc::invalid_argument,
        fmt::format("{}: no image of the directions of subspace {}; is it another "
                    "measurement than the material's?",
                    info.name, subspace)};
}

/// Which subspace, and how its image was seen and lit.
std::string title_of(const MeasurementInfo& info, std::size_t observation,
                     std::size_t subspace) {
    std::string title = fmt::format("Subspace {}", subspace);
    if (!info.has_directions()) return title;
    const auto degrees = [](const Direction& d) {
        const auto of = [](float radians) {
            return static_cast<double>(radians) * 180 / std::numbers::pi;
        };
        return fmt::format("{:.0f}°, {:.0f}°", of(d.theta), of(d.phi));
    };
    const Observation& at = info.observations[observation];
    return title + fmt::format(": view {}, light {}", degrees(info.views[at.view]),
                               degrees(info.lights[at.light]));
}

}  // namespace

Result<Comparison> compare_images(std::string title, NamedImage reference,
                                  NamedImage candidate, Executor& executor) {
    SATEEN_TRY(
        const TextureReference prepared,
        TextureReference::create(
            reference.image, {candidate.image.rows(), candidate.image.cols()}, executor));
    SATEEN_TRY(const TextureScore score, prepared.compare(candidate.image, executor));
    SATEEN_TRY(const TextureCrossCheck check,
               cross_check(reference.image, candidate.image));
    const SeamRatio seam = seam_ratio(candidate.image.view());
    return Comparison{std::move(title),
                      std::move(reference.name),
                      std::move(candidate.name),
                      std::move(reference.image),
                      std::move(candidate.image),
                      score,
                      check,
                      seam};
}

Result<std::vector<Comparison>> compare_subspaces(const Material& material,
                                                  const std::string& material_name,
                                                  const Measurement& measurement,
                                                  std::uint64_t seed, Executor& executor,
                                                  Progress& progress) {
    progress.stage("comparing");
    PartProgress part(progress);
    std::vector<Comparison> comparisons;
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        SATEEN_TRY(const std::size_t observation,
                   representative_of(measurement.info(), material, k));
        SATEEN_TRY(Image reference, measurement.read(observation));
        SynthesisOptions options;
        options.rows = reference.rows();
        options.cols = reference.cols();
        options.seed = seed;
        SATEEN_TRY(Image drawn, synthesise(material, lit_subspace(material, k), options,
                                           executor, part));
        SATEEN_TRY(Comparison comparison,
                   compare_images(title_of(measurement.info(), observation, k),
                                  {measurement.info().observations[observation].name,
                                   std::move(reference)},
                                  {material_name, std::move(drawn)}, executor));
        comparisons.push_back(std::move(comparison));
        progress.report(static_cast<double>(k + 1),
                        static_cast<double>(material.subspaces.size()));
    }
    return comparisons;
}

double geometric_mean(const std::vector<Comparison>& comparisons) {
    double sum = 0;
    for (const Comparison& c : comparisons) sum += std::log(c.score.total);
    return std::exp(sum / static_cast<double>(comparisons.size()));
}

}  // namespace sateen::cli
