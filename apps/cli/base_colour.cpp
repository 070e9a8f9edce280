// SPDX-License-Identifier: Apache-2.0
#include "base_colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace sateen::cli {
namespace {

constexpr float kLeastTheta = 19.5F * kRadiansPerDegree;
constexpr float kMostTheta = 60.5F * kRadiansPerDegree;
/// Of reflectances: a base colour is no lamp.
constexpr float kWhite = 1;

/// Mean reflectance of every band, or nothing where too few lights tell it.
std::optional<std::array<float, 3>> matt_reflectance(const Material& material) {
    if (!material.reflectance || material.views.empty()) return std::nullopt;
    const auto view =
        std::min_element(material.views.begin(), material.views.end(),
                         [](Direction a, Direction b) { return a.theta < b.theta; });
    std::array<std::vector<float>, 3> values;
    for (std::size_t light = 0; light < material.lights.size(); ++light) {
        const float theta = material.lights[light].theta;
        if (theta < kLeastTheta || theta > kMostTheta) continue;
        const EncodedAppearance e = encoded_appearance(
            *material.reflectance,
            static_cast<std::size_t>(view - material.views.begin()), light);
        const float cosine = material.cosine_included ? std::cos(theta) : 1;
        for (std::size_t b = 0; b < material.bands; ++b) {
            const float root = std::max(0.0F, e[b]);
            values[b].push_back(root * root * root / cosine);
        }
    }
    constexpr std::size_t kFewest = 3;
    if (values[0].size() < kFewest) return std::nullopt;
    std::array<float, 3> medians{};
    for (std::size_t b = 0; b < material.bands; ++b) {
        const auto middle =
            values[b].begin() + static_cast<std::ptrdiff_t>(values[b].size() / 2);
        std::nth_element(values[b].begin(), middle, values[b].end());
        medians[b] = std::min(kWhite, *middle);
    }
    return medians;
}

}  // namespace

Result<Image> draw_base_colour(const Material& material, const SynthesisOptions& options,
                               Executor& executor, Progress& progress) {
    SATEEN_TRY(Image colour, synthesise(material, nearest_subspace(material, {}, {}),
                                        options, executor, progress));
    const std::optional<std::array<float, 3>> wanted = matt_reflectance(material);
    if (!wanted) return colour;
    for (std::size_t b = 0; b < colour.bands(); ++b) {
        const auto plane = colour.plane(b);
        double sum = 0;
        for (std::size_t i = 0; i < plane.size(); ++i)
            sum += static_cast<double>(plane.data[i]);
        const double mean = sum / static_cast<double>(plane.size());
        if (!(mean > 0)) continue;
        const auto scale = static_cast<float>(static_cast<double>((*wanted)[b]) / mean);
        for (std::size_t i = 0; i < plane.size(); ++i) plane.data[i] *= scale;
    }
    return colour;
}

}  // namespace sateen::cli
