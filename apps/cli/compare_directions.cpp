// SPDX-License-Identifier: Apache-2.0
#include "compare_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>

#include "html.hpp"
#include "sateen/analysis/reflectance.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/synthesis/evaluate.hpp"

namespace sateen::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kSide = 64;
constexpr double kGrazing = 60;

double theta_degrees(Direction d) {
    return static_cast<double>(d.theta / kRadiansPerDegree);
}

bool is_grazing(const DirectionComparison& c, const PairError& pair) {
    return std::max(theta_degrees(c.views[pair.view]),
                    theta_degrees(c.lights[pair.light])) > kGrazing - 0.5;
}

// What a front end shows of the material, averaged over the texture.
ImageMoments drawn_moments(const Evaluator& evaluator, Direction view, Direction light,
                           std::size_t bands) {
    const auto at = evaluator.prepare(to_vector(view), to_vector(light));
    Image drawn(bands, kSide, kSide);
    for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c) {
            const auto value =
                evaluator.sample(at, (static_cast<float>(c) + 0.5F) / kSide,
                                 -(static_cast<float>(r) + 0.5F) / kSide);
            for (std::size_t b = 0; b < bands; ++b) drawn(b, r, c) = value[b];
        }
    return image_moments(drawn.view());
}

Lab lab_of(const ImageMoments& m, std::size_t bands) {
    const auto band = [&](std::size_t b) { return m.mean[std::min(b, bands - 1)]; };
    return lab_from_linear_srgb(band(0), band(1), band(2));
}

PairError error_of(const ImageMoments& measured, const ImageMoments& drawn,
                   const Observation& o, std::size_t bands) {
    const auto contrast = [](const ImageMoments& m) {
        return std::max(1e-3, m.deviation / std::max(1e-6, m.luminance));
    };
    return {o.view, o.light, delta_e_2000(lab_of(measured, bands), lab_of(drawn, bands)),
            std::log(contrast(drawn) / contrast(measured))};
}

// Only some of the observations of a measurement.
class Selection final : public Measurement {
  public:
    Selection(const Measurement& all, std::size_t most) : all_(all), info_(all.info()) {
        const std::size_t n = info_.observations.size();
        const std::size_t count = most == 0 ? n : std::min(n, most);
        info_.observations.clear();
        // A step that is no divisor of the grid's rows does not miss a column of it.
        for (std::size_t i = 0; i < count; ++i) {
            chosen_.push_back(i * n / count);
            info_.observations.push_back(all.info().observations[chosen_.back()]);
        }
    }
    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t observation) const override {
        return all_.read(chosen_[observation]);
    }

  private:
    const Measurement& all_;
    MeasurementInfo info_;
    std::vector<std::size_t> chosen_;
};

struct Summary {
    std::size_t pairs = 0;
    double mean = 0;
    double p95 = 0;
    double largest = 0;
    double contrast = 0;  // mean magnitude of the logarithm
};

Summary summary_of(const DirectionComparison& c,
                   const std::function<bool(const PairError&)>& belongs) {
    std::vector<double> errors;
    Summary s;
    for (const PairError& pair : c.pairs) {
        if (!belongs(pair)) continue;
        errors.push_back(pair.delta_e);
        s.mean += pair.delta_e;
        s.contrast += std::abs(pair.contrast);
    }
    s.pairs = errors.size();
    if (errors.empty()) return s;
    const auto n = static_cast<double>(errors.size());
    s.mean /= n;
    s.contrast /= n;
    std::sort(errors.begin(), errors.end());
    s.p95 = errors[static_cast<std::size_t>(0.95 * (n - 1))];
    s.largest = errors.back();
    return s;
}

Json json_of(const Summary& s) {
    return {{"pairs", s.pairs},
            {"delta_e", {{"mean", s.mean}, {"p95", s.p95}, {"max", s.largest}}},
            {"contrast", s.contrast}};
}

bool anything(const PairError& /*pair*/) {
    return true;
}

// Summaries by elevation, in whole degrees.
std::map<int, Summary> by_elevation(const DirectionComparison& c,
                                    const std::vector<Direction>& directions,
                                    std::size_t PairError::*which) {
    std::map<int, Summary> out;
    for (const Direction d : directions)
        out[static_cast<int>(std::lround(theta_degrees(d)))] = {};
    for (auto& [theta, summary] : out) {
        const int wanted = theta;
        summary = summary_of(c, [&](const PairError& pair) {
            return std::lround(theta_degrees(directions[pair.*which])) == wanted;
        });
    }
    return out;
}

std::string elevation_plot(const DirectionComparison& c) {
    std::array<std::vector<double>, 2> x;
    std::array<std::vector<double>, 2> y;
    double most = 1;
    const auto add = [&](std::size_t i, const std::map<int, Summary>& summaries) {
        for (const auto& [theta, s] : summaries) {
            if (s.pairs == 0) continue;
            x[i].push_back(theta);
            y[i].push_back(s.mean);
            most = std::max(most, s.mean);
        }
    };
    add(0, by_elevation(c, c.views, &PairError::view));
    add(1, by_elevation(c, c.lights, &PairError::light));
    return html::draw({"Mean ΔE by elevation: blue of the view, orange of the light",
                       "θ in degrees", 0, 90, 0, 1.1 * most},
                      {x[0], y[0]}, {x[1], y[1]});
}

constexpr std::size_t kCell = 4;

// One square a pair, views along the rows, lights down.
Image table_picture(const DirectionComparison& c,
                    const std::function<std::array<float, 3>(std::size_t)>& colour) {
    Image out(3, kCell * c.lights.size(), kCell * c.views.size());
    for (std::size_t r = 0; r < out.rows(); ++r)
        for (std::size_t col = 0; col < out.cols(); ++col) {
            const auto value = colour(r / kCell * c.views.size() + col / kCell);
            for (std::size_t b = 0; b < 3; ++b) out(b, r, col) = value[b];
        }
    return out;
}

}  // namespace

Result<DirectionComparison> compare_directions(const Material& material,
                                               const Measurement& measurement,
                                               std::size_t most, Executor& executor,
                                               Progress& progress) {
    progress.stage("comparing directions");
    Progress silent;
    EvaluatorOptions options;
    options.side = kSide;
    SATEEN_TRY(const Evaluator evaluator,
               Evaluator::create(material, options, executor, silent));
    const Selection selection(measurement, most);
    const MeasurementInfo& info = selection.info();
    std::vector<std::optional<PairError>> errors(info.observations.size());
    SATEEN_CHECK([&]() -> Result<void> {
        SATEEN_TRY(const PassReport report,
                   for_each_image(selection, true, executor, progress,
                                  [&](std::size_t i, const Image& image) {
                                      const Observation& o = info.observations[i];
                                      const ImageMoments drawn = drawn_moments(
                                          evaluator, info.views[o.view],
                                          info.lights[o.light], material.bands);
                                      errors[i] = error_of(image_moments(image.view()),
                                                           drawn, o, material.bands);
                                  }));
        (void)report;
        return {};
    }());
    DirectionComparison out;
    out.views = info.views;
    out.lights = info.lights;
    for (const auto& error : errors)
        if (error) out.pairs.push_back(*error);
    const auto index = evaluator.interpolation().index();
    if (index.size() == info.views.size() * info.lights.size())
        out.index.assign(index.begin(), index.end());
    return out;
}

Json json_of(const DirectionComparison& c) {
    Json json = json_of(summary_of(c, anything));
    const auto list = [&](const std::map<int, Summary>& summaries) {
        Json out = Json::array();
        for (const auto& [theta, summary] : summaries) {
            if (summary.pairs == 0) continue;
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
    return json;
}

std::string text_of(const DirectionComparison& c) {
    const Summary all = summary_of(c, anything);
    const Summary grazing =
        summary_of(c, [&](const PairError& p) { return is_grazing(c, p); });
    return fmt::format(
        "{} pairs of directions: mean colour ΔE {:.2f}, 95 % {:.2f}, largest {:.1f}; "
        "grazing {:.2f}; contrast off by {:.0f} %",
        all.pairs, all.mean, all.p95, all.largest, grazing.mean,
        100 * (std::exp(all.contrast) - 1));
}

Result<std::string> section_of(const DirectionComparison& c) {
    // White is no error, red 3, black 10 and more; pairs not looked at are grey.
    std::vector<float> table(c.views.size() * c.lights.size(), -1);
    for (const PairError& pair : c.pairs)
        table[pair.light * c.views.size() + pair.view] = static_cast<float>(pair.delta_e);
    const Image map = table_picture(c, [&](std::size_t i) -> std::array<float, 3> {
        if (table[i] < 0) return {0.4F, 0.4F, 0.4F};
        const float red = 1 - std::clamp((table[i] - 3) / 7, 0.0F, 1.0F);
        const float other = 1 - std::min(1.0F, table[i] / 3);
        return {red, red * other, red * other};
    });
    SATEEN_TRY(const std::string error_map, html::picture(map));
    std::string body =
        fmt::format("<h2>All directions</h2>\n<p>{}.</p>\n", html::escaped(text_of(c)));
    body += fmt::format(
        "<div class=\"pair\"><figure>{}<figcaption>Colour error, views along, lights "
        "down: "
        "white 0, red ΔE 3, black 10</figcaption></figure>\n",
        error_map);
    if (!c.index.empty()) {
        const Image index = table_picture(c, [&](std::size_t i) -> std::array<float, 3> {
            const float turn = 2.399963F * static_cast<float>(c.index[i]);
            return {0.5F + 0.4F * std::cos(turn), 0.5F + 0.4F * std::cos(turn - 2.0944F),
                    0.5F + 0.4F * std::cos(turn + 2.0944F)};
        });
        SATEEN_TRY(const std::string picture, html::picture(index));
        body += fmt::format(
            "<figure>{}<figcaption>Index table, a colour a "
            "subspace</figcaption></figure>",
            picture);
    }
    return body + "</div>\n<div class=\"plots\">\n" + elevation_plot(c) + "</div>\n";
}

}  // namespace sateen::cli
