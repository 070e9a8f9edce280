// SPDX-License-Identifier: Apache-2.0
#include "compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "html.hpp"
#include "sateen/analysis/texture_profile.hpp"
#include "sateen/core/colour.hpp"

namespace sateen::cli {
namespace {

std::vector<double> log10_of(std::vector<double> values) {
    for (double& v : values) v = std::log10(std::max(v, 1e-3));
    return values;
}

std::vector<double> count_up(std::size_t size, double first, double step) {
    std::vector<double> x(size);
    for (std::size_t i = 0; i < size; ++i) x[i] = first + step * static_cast<double>(i);
    return x;
}

std::pair<double, double> range_of(const std::vector<double>& a,
                                   const std::vector<double>& b) {
    double least = 1e300;
    double most = -1e300;
    for (const auto* values : {&a, &b}) {
        for (double v : *values) {
            least = std::min(least, v);
            most = std::max(most, v);
        }
    }
    return most > least ? std::pair{least, most} : std::pair{least - 1, least + 1};
}

std::string histogram_plot(const TextureProfile& a, const TextureProfile& b,
                           std::size_t axis) {
    constexpr std::array<std::string_view, 3> kTitles = {
        "Lightness L", "Lab a (green to red)", "Lab b (blue to yellow)"};
    const double least = axis == 0 ? 0 : -static_cast<double>(TextureProfile::kAxisRange);
    const double most = axis == 0 ? 100 : static_cast<double>(TextureProfile::kAxisRange);
    const double step = (most - least) / static_cast<double>(TextureProfile::kBins);
    const std::vector<double> x = count_up(TextureProfile::kBins, least + step / 2, step);
    const std::vector<double> ya(a.histogram[axis].begin(), a.histogram[axis].end());
    const std::vector<double> yb(b.histogram[axis].begin(), b.histogram[axis].end());
    const double top = range_of(ya, yb).second;
    return html::draw({fmt::format("Histogram of {}: share of pixels", kTitles[axis]),
                       "ΔE", least, most, 0, top},
                      html::Curve{x, ya}, html::Curve{x, yb});
}

std::string power_plot(const TextureProfile& a, const TextureProfile& b) {
    const auto octaves = [](std::vector<double> frequency) {
        for (double& f : frequency) f = std::log2(f);
        return frequency;
    };
    const auto wavelength = [](double octave) {
        return fmt::format("{:.3g} pixels", std::exp2(-octave));
    };
    const std::vector<double> xa = octaves(a.frequency);
    const std::vector<double> xb = octaves(b.frequency);
    const std::vector<double> ya = log10_of(a.power);
    const std::vector<double> yb = log10_of(b.power);
    const auto [left, right] = range_of(xa, xb);
    const auto [bottom, top] = range_of(ya, yb);
    return html::draw({"Power spectrum of lightness, log10 ΔE², averaged over directions",
                       "wavelength, logarithmic", left, right, bottom, top,
                       wavelength(left), wavelength(right)},
                      {xa, ya}, {xb, yb});
}

std::string autocovariance_plot(const std::vector<double>& a,
                                const std::vector<double>& b, std::string_view axis) {
    const std::vector<double> x = count_up(std::max(a.size(), b.size()), 0, 1);
    return html::draw(
        {fmt::format("Autocovariance of lightness over its variance, {}", axis),
         "lag, pixels", 0, x.back(), std::min(-0.2, range_of(a, b).first), 1},
        {x, a}, {x, b});
}

Image spectrum_picture(const TextureProfile& profile, float least, float most) {
    Image picture = profile.spectrum;
    for (float& v : picture.values()) {
        v = srgb_decode(
            std::clamp((v - least) / std::max(most - least, 1e-6F), 0.0F, 1.0F));
    }
    return picture;
}

std::string score_table(const Comparison& comparison) {
    const TextureScore& s = comparison.score;
    std::string rows;
    const auto add = [&rows](std::string_view name, const TextureComponent& c,
                             std::string_view unit) {
        rows += fmt::format(
            "<tr><td>{}</td><td>{:.2f}</td><td>{:.4g}</td><td>{:.4g}</td><td>{}</td></"
            "tr>",
            name, c.score, c.distance, c.spread, unit);
    };
    add("colour", s.colour, "ΔE");
    add("power spectrum", s.power, "nepers");
    add("autocovariance", s.autocovariance, "variances");
    add("subbands", s.subbands, "");
    add("joint", s.joint, "");
    return fmt::format(
        "<table><tr><th>component</th><th>score</th><th>distance</th><th>between pieces "
        "of the reference</th>"
        "<th>unit</th></tr>{}<tr class=\"total\"><td>total, geometric "
        "mean</td><td>{:.2f}</td><td></td>"
        "<td></td><td></td></tr></table>\n<p>Not part of the score, 0 is equality: "
        "gradient kurtosis {:.2f}, "
        "blobs {:.2f} octaves, 5 × 5 patches {:.3f}. Seams if the second picture were "
        "laid "
        "side by side with itself, 1 is none: rows {:.2f}, "
        "columns {:.2f}.</p>\n",
        rows, s.total, comparison.cross_check.gradient_kurtosis,
        comparison.cross_check.blob, comparison.cross_check.patches, comparison.seam.rows,
        comparison.seam.cols);
}

Result<std::string> section(const Comparison& comparison) {
    SATEEN_TRY(const TextureProfile a, texture_profile(comparison.reference));
    SATEEN_TRY(const TextureProfile b, texture_profile(comparison.candidate));
    SATEEN_TRY(const std::string picture_a, html::picture(comparison.reference));
    SATEEN_TRY(const std::string picture_b, html::picture(comparison.candidate));
    const auto values_a = a.spectrum.values();
    const float least = *std::min_element(values_a.begin(), values_a.end());
    const float most = *std::max_element(values_a.begin(), values_a.end());
    SATEEN_TRY(const std::string spectrum_a,
               html::picture(spectrum_picture(a, least, most)));
    SATEEN_TRY(const std::string spectrum_b,
               html::picture(spectrum_picture(b, least, most)));

    std::string body;
    if (!comparison.title.empty())
        body += fmt::format("<h2>{}</h2>\n", html::escaped(comparison.title));
    const auto pair = [&body](const std::string& left, const std::string& left_caption,
                              const std::string& right,
                              const std::string& right_caption) {
        body += fmt::format(
            "<div class=\"pair\"><figure>{}<figcaption "
            "class=\"key-a\">{}</figcaption></figure>"
            "<figure>{}<figcaption class=\"key-b\">{}</figcaption></figure></div>\n",
            left, left_caption, right, right_caption);
    };
    const auto caption = [](const std::string& name, const Image& image) {
        return fmt::format("{}, {} × {}", html::escaped(name), image.cols(),
                           image.rows());
    };
    pair(picture_a, caption(comparison.reference_name, comparison.reference), picture_b,
         caption(comparison.candidate_name, comparison.candidate));
    body += score_table(comparison);
    body += "<div class=\"plots\">\n" + power_plot(a, b) +
            autocovariance_plot(a.along_cols, b.along_cols, "along a row") +
            autocovariance_plot(a.along_rows, b.along_rows, "down a column");
    for (std::size_t axis = 0; axis < 3; ++axis) body += histogram_plot(a, b, axis);
    body += "</div>\n";
    pair(spectrum_a, "Power spectrum, logarithmic, zero frequency in the middle",
         spectrum_b, "The same, in the same grey levels");
    return body;
}

}  // namespace

Result<std::string> comparison_page(const std::string& title, const std::string& lead,
                                    const std::vector<Comparison>& comparisons) {
    std::string body =
        lead +
        "<p>A score of 1 is as close as two pieces of the reference are to each other, 2 "
        "is "
        "twice as far. <span class=\"key-a\">Blue: the reference.</span> "
        "<span class=\"key-b\">Orange: what is compared with it.</span></p>\n";
    for (const Comparison& comparison : comparisons) {
        SATEEN_TRY(const std::string part, section(comparison));
        body += part;
    }
    return html::page(title, body);
}

}  // namespace sateen::cli
