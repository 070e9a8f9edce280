// SPDX-License-Identifier: Apache-2.0
#include "direction_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sateen::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kGrazing = 60;

double theta_degrees(Direction d) {
    return static_cast<double>(d.theta / kRadiansPerDegree);
}

bool anything(const PairError& /*pair*/) {
    return true;
}

bool is_restored(const PairError& pair) {
    return pair.nearest.has_value();
}

Json json_of(const DirectionSummary& s) {
    Json json = {{"pairs", s.pairs},
                 {"delta_e", {{"mean", s.mean}, {"p95", s.p95}, {"max", s.largest}}},
                 {"contrast", s.contrast}};
    if (s.textures != 0)
        json["texture"] = {
            {"pairs_scored", s.textures},        {"score", s.texture},
            {"colour", s.components[0]},         {"power", s.components[1]},
            {"autocovariance", s.components[2]}, {"subbands", s.components[3]},
            {"joint", s.components[4]}};
    return json;
}

std::string line_of(const DirectionSummary& s) {
    std::string line = fmt::format(
        "mean colour ΔE {:.2f}, 95 % {:.2f}, largest {:.1f}; "
        "contrast off by {:.0f} %",
        s.mean, s.p95, s.largest, 100 * (std::exp(s.contrast) - 1));
    if (s.textures != 0)
        line += fmt::format("; texture {:.2f} ({} scored)", s.texture, s.textures);
    return line;
}

void take_textures(DirectionSummary& s, const DirectionComparison& c,
                   const std::function<bool(const PairError&)>& belongs, Shown shown) {
    double weight = 0;
    double total = 0;
    std::array<double, 5> logarithms = {};
    for (const PairTexture& texture : c.textures) {
        if (!belongs(c.pairs[texture.pair])) continue;
        const TextureScore& score =
            shown == Shown::drawn ? texture.drawn : texture.nearest;
        const std::array<double, 5> components = {
            score.colour.score, score.power.score, score.autocovariance.score,
            score.subbands.score, score.joint.score};
        for (std::size_t i = 0; i < 5; ++i)
            logarithms[i] += texture.weight * std::log(components[i]);
        total += texture.weight * std::log(score.total);
        weight += texture.weight;
        ++s.textures;
    }
    if (s.textures == 0) return;
    s.texture = std::exp(total / weight);
    for (std::size_t i = 0; i < 5; ++i)
        s.components[i] = std::exp(logarithms[i] / weight);
}

}  // namespace

DirectionSummary summary_of(const DirectionComparison& c,
                            const std::function<bool(const PairError&)>& belongs,
                            Shown shown) {
    std::vector<double> errors;
    DirectionSummary s;
    for (const PairError& pair : c.pairs) {
        if (!belongs(pair)) continue;
        const MeanError& error = shown == Shown::drawn ? pair.drawn : *pair.nearest;
        errors.push_back(error.delta_e);
        s.mean += error.delta_e;
        s.contrast += std::abs(error.contrast);
    }
    s.pairs = errors.size();
    if (errors.empty()) return s;
    const auto n = static_cast<double>(errors.size());
    s.mean /= n;
    s.contrast /= n;
    std::sort(errors.begin(), errors.end());
    s.p95 = errors[static_cast<std::size_t>(0.95 * (n - 1))];
    s.largest = errors.back();
    take_textures(s, c, belongs, shown);
    return s;
}

bool is_grazing(const DirectionComparison& c, const PairError& pair) {
    return std::max(theta_degrees(c.views[pair.view]),
                    theta_degrees(c.lights[pair.light])) > kGrazing - 0.5;
}

std::map<int, DirectionSummary> by_elevation(const DirectionComparison& c,
                                             const std::vector<Direction>& directions,
                                             std::size_t PairError::*which) {
    std::map<int, DirectionSummary> out;
    for (const Direction d : directions)
        out[static_cast<int>(std::lround(theta_degrees(d)))] = {};
    for (auto& [theta, summary] : out) {
        const int wanted = theta;
        summary = summary_of(c, [&](const PairError& pair) {
            return std::lround(theta_degrees(directions[pair.*which])) == wanted;
        });
    }
    std::erase_if(out, [](const auto& entry) { return entry.second.pairs == 0; });
    return out;
}

Json json_of(const DirectionComparison& c) {
    Json json = json_of(summary_of(c, anything));
    const auto list = [&](const std::map<int, DirectionSummary>& summaries) {
        Json out = Json::array();
        for (const auto& [theta, summary] : summaries) {
            Json entry = {{"theta", theta}};
            entry.update(json_of(summary));
            out.push_back(entry);
        }
        return out;
    };
    json["grazing"] =
        json_of(summary_of(c, [&](const PairError& p) { return is_grazing(c, p); }));
    json["not_grazing"] =
        json_of(summary_of(c, [&](const PairError& p) { return !is_grazing(c, p); }));
    json["by_view"] = list(by_elevation(c, c.views, &PairError::view));
    json["by_light"] = list(by_elevation(c, c.lights, &PairError::light));
    if (std::any_of(c.pairs.begin(), c.pairs.end(), is_restored)) {
        json["restored"] = json_of(summary_of(c, is_restored));
        json["restored"]["nearest"] = json_of(summary_of(c, is_restored, Shown::nearest));
    }
    return json;
}

std::string text_of(const DirectionComparison& c) {
    std::string text = fmt::format("{} pairs of directions: {}", c.pairs.size(),
                                   line_of(summary_of(c, anything)));
    const DirectionSummary grazing =
        summary_of(c, [&](const PairError& p) { return is_grazing(c, p); });
    text += fmt::format("\n{} grazing: {}", grazing.pairs, line_of(grazing));
    const DirectionSummary restored = summary_of(c, is_restored);
    if (restored.pairs != 0)
        text += fmt::format(
            "\n{} that the material was not made from: {}\nthe nearest images "
            "that it was made from: {}",
            restored.pairs, line_of(restored),
            line_of(summary_of(c, is_restored, Shown::nearest)));
    return text;
}

}  // namespace sateen::cli
