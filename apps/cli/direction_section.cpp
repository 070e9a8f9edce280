// SPDX-License-Identifier: Apache-2.0
// The section of all directions in the report of `sateen compare`.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "direction_summary.hpp"
#include "html.hpp"

namespace sateen::cli {
namespace {

constexpr std::size_t kCell = 4;

using Elevations = std::map<int, DirectionSummary>;

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

// White is no error, red 3, black 10 and more; pairs not looked at are grey.
Image error_picture(const DirectionComparison& c) {
    std::vector<float> table(c.views.size() * c.lights.size(), -1);
    for (const PairError& pair : c.pairs)
        table[pair.light * c.views.size() + pair.view] =
            static_cast<float>(pair.drawn.delta_e);
    return table_picture(c, [&](std::size_t i) -> std::array<float, 3> {
        if (table[i] < 0) return {0.4F, 0.4F, 0.4F};
        const float red = 1 - std::clamp((table[i] - 3) / 7, 0.0F, 1.0F);
        const float other = 1 - std::min(1.0F, table[i] / 3);
        return {red, red * other, red * other};
    });
}

Image index_picture(const DirectionComparison& c) {
    return table_picture(c, [&](std::size_t i) -> std::array<float, 3> {
        const float turn = 2.399963F * static_cast<float>(c.index[i]);
        return {0.5F + 0.4F * std::cos(turn), 0.5F + 0.4F * std::cos(turn - 2.0944F),
                0.5F + 0.4F * std::cos(turn + 2.0944F)};
    });
}

// A curve by elevation of the view and one by that of the light.
std::string elevation_plot(const std::string& title, const Elevations& views,
                           const Elevations& lights, double least,
                           const std::function<double(const DirectionSummary&)>& value) {
    std::array<std::vector<double>, 2> x;
    std::array<std::vector<double>, 2> y;
    double most = least + 0.1;
    for (std::size_t i = 0; i < 2; ++i)
        for (const auto& [theta, summary] : i == 0 ? views : lights) {
            x[i].push_back(theta);
            y[i].push_back(value(summary));
            most = std::max(most, 1.1 * y[i].back());
        }
    return html::draw({title + ": blue by view, orange by light",
                       "θ from the normal, degrees", 0, 90, least, most},
                      {x[0], y[0]}, {x[1], y[1]});
}

std::string elevation_table(const DirectionComparison& c, const Elevations& views,
                            const Elevations& lights) {
    std::string rows;
    const auto add = [&rows](const std::string& name, const DirectionSummary& s) {
        rows += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td>"
            "<td>{:.0f} %</td><td>{}</td></tr>\n",
            name, s.pairs, s.mean, s.p95, 100 * (std::exp(s.contrast) - 1),
            s.textures == 0 ? "" : fmt::format("{:.2f} ({})", s.texture, s.textures));
    };
    for (const auto& [theta, summary] : views)
        add(fmt::format("view {}°", theta), summary);
    for (const auto& [theta, summary] : lights)
        add(fmt::format("light {}°", theta), summary);
    add("either at 60° or more",
        summary_of(c, [&](const PairError& p) { return is_grazing(c, p); }));
    add("neither", summary_of(c, [&](const PairError& p) { return !is_grazing(c, p); }));
    return "<table><tr><th></th><th>pairs</th><th>ΔE</th><th>95 %</th><th>contrast off "
           "by</th><th>texture (scored)</th></tr>\n" +
           rows + "</table>\n";
}

Result<std::string> exhibit(const Exhibit& pair) {
    SATEEN_TRY(const std::string measured, html::picture(pair.measured));
    SATEEN_TRY(const std::string drawn, html::picture(pair.drawn));
    return fmt::format(
        "<section><h3>{}</h3>\n<div class=\"pair\"><figure>{}<figcaption "
        "class=\"key-a\">measured"
        "</figcaption></figure><figure>{}<figcaption class=\"key-b\">drawn</figcaption>"
        "</figure></div></section>\n",
        html::escaped(pair.title), measured, drawn);
}

}  // namespace

Result<std::string> section_of(const DirectionComparison& c) {
    std::string body = "<h2>All directions</h2>\n<p>";
    for (const char letter : html::escaped(text_of(c)))
        body += letter == '\n' ? std::string("<br>") : std::string(1, letter);
    SATEEN_TRY(const std::string errors, html::picture(error_picture(c)));
    body += fmt::format(
        ".</p>\n<div class=\"pair\"><figure>{}<figcaption>Colour error, views along, "
        "lights down: white 0, red ΔE 3, black 10</figcaption></figure>\n",
        errors);
    if (!c.index.empty()) {
        SATEEN_TRY(const std::string index, html::picture(index_picture(c)));
        body += fmt::format(
            "<figure>{}<figcaption>Index table, a colour a subspace"
            "</figcaption></figure>",
            index);
    }
    const Elevations views = by_elevation(c, c.views, &PairError::view);
    const Elevations lights = by_elevation(c, c.lights, &PairError::light);
    body += "</div>\n<div class=\"plots\">\n" +
            elevation_plot("Mean ΔE", views, lights, 0,
                           [](const DirectionSummary& s) { return s.mean; }) +
            elevation_plot("Contrast off by, %", views, lights, 0,
                           [](const DirectionSummary& s) {
                               return 100 * (std::exp(s.contrast) - 1);
                           });
    if (!c.textures.empty())
        body += elevation_plot("Texture score", views, lights, 1,
                               [](const DirectionSummary& s) { return s.texture; });
    body += "</div>\n" + elevation_table(c, views, lights);
    body += "<div class=\"exhibits\">\n";
    for (const Exhibit& pair : c.exhibits) {
        SATEEN_TRY(const std::string pictures, exhibit(pair));
        body += pictures;
    }
    return body + "</div>\n";
}

}  // namespace sateen::cli
