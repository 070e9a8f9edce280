// SPDX-License-Identifier: Apache-2.0
#include "compare_report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "sateen/analysis/texture_profile.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::cli {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --a: #2a6fbb; --b: #d9622b; --line: #8885; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 70rem; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.5rem; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1rem; }
figure { margin: 0; } figcaption { font-size: .9rem; padding: .2rem 0; overflow-wrap: anywhere; }
figure img { width: 100%; height: auto; }
svg { width: 100%; height: auto; } svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
.frame { fill: none; stroke: var(--line); } .a { stroke: var(--a); } .b { stroke: var(--b); }
.a, .b { fill: none; stroke-width: 1.6; } .key-a { color: var(--a); } .key-b { color: var(--b); }
table { border-collapse: collapse; } th, td { padding: .25rem .8rem; border-bottom: 1px solid var(--line); text-align: right; }
th:first-child, td:first-child { text-align: left; } .total td { font-weight: 600; }
)";

std::string escaped(std::string_view text) {
    std::string out;
    for (char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string base64(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            word = (word << 8U) | (k < left ? std::uint32_t{bytes[i + k]} : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            out += k <= left
                       ? kDigits[(word >> (18U - 6U * static_cast<unsigned>(k))) & 63U]
                       : '=';
        }
    }
    return out;
}

/// A name nobody else uses, gone at the end of the scope.
class TemporaryPath {
  public:
    explicit TemporaryPath(std::string_view extension) {
        static int count = 0;
        std::error_code failure;
        auto folder = std::filesystem::temp_directory_path(failure);
        if (failure) folder = ".";
        path_ = (folder / fmt::format("sateen-{}-{}{}", getpid(), ++count, extension))
                    .string();
    }
    TemporaryPath(const TemporaryPath&) = delete;
    TemporaryPath& operator=(const TemporaryPath&) = delete;
    ~TemporaryPath() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    [[nodiscard]] const std::string& string() const { return path_; }

  private:
    std::string path_;
};

// A picture as a data URI; pictures too large for a page are cropped in the middle.
Result<std::string> picture(const Image& image) {
    constexpr std::size_t kMostSide = 768;
    constexpr std::size_t kMostBytes = std::size_t{1} << 26U;
    const std::size_t rows = std::min(image.rows(), kMostSide);
    const std::size_t cols = std::min(image.cols(), kMostSide);
    Image shown(image.bands(), rows, cols);
    for (std::size_t b = 0; b < image.bands(); ++b) {
        const auto window = image.plane(b).window((image.rows() - rows) / 2,
                                                  (image.cols() - cols) / 2, rows, cols);
        for (std::size_t r = 0; r < rows; ++r) {
            std::copy_n(window.row(r), cols, shown.plane(b).row(r));
        }
    }
    const TemporaryPath path(".png");
    SATEEN_CHECK(write_image(path.string(), shown.view(), {.png_compression = 6}));
    SATEEN_TRY(const auto bytes, read_file(path.string(), kMostBytes));
    return fmt::format(
        "<img width=\"{}\" height=\"{}\" alt=\"\" src=\"data:image/png;base64,{}\">",
        cols, rows, base64(bytes));
}

/// A plot of two curves over one another.
struct Plot {
    std::string title;
    std::string x_label;
    double x_least = 0;
    double x_most = 1;
    double y_least = 0;
    double y_most = 1;
};

struct Curve {
    const std::vector<double>& x;
    const std::vector<double>& y;
};

constexpr double kWidth = 420;
constexpr double kHeight = 220;
constexpr double kLeft = 44;
constexpr double kBottom = 34;
constexpr double kTop = 10;

std::string polyline(const Plot& plot, const Curve& curve, std::string_view style) {
    std::string points;
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
        const double u = (curve.x[i] - plot.x_least) / (plot.x_most - plot.x_least);
        const double v = (curve.y[i] - plot.y_least) / (plot.y_most - plot.y_least);
        if (!std::isfinite(u) || !std::isfinite(v)) continue;
        points += fmt::format(
            "{:.1f},{:.1f} ", kLeft + u * (kWidth - kLeft - 6),
            kHeight - kBottom - std::clamp(v, 0.0, 1.0) * (kHeight - kBottom - kTop));
    }
    return fmt::format("<polyline class=\"{}\" points=\"{}\"/>", style, points);
}

std::string draw(const Plot& plot, const Curve& a, const Curve& b) {
    std::string svg =
        fmt::format("<figure><svg viewBox=\"0 0 {} {}\" role=\"img\">", kWidth, kHeight);
    svg += fmt::format(
        "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>", kLeft,
        kTop, kWidth - kLeft - 6, kHeight - kBottom - kTop);
    const auto text = [&svg](double x, double y, std::string_view anchor,
                             const std::string& label) {
        svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>", x, y,
                           anchor, label);
    };
    text(kLeft - 4, kHeight - kBottom, "end", fmt::format("{:.3g}", plot.y_least));
    text(kLeft - 4, kTop + 9, "end", fmt::format("{:.3g}", plot.y_most));
    text(kLeft, kHeight - kBottom + 14, "start", fmt::format("{:.3g}", plot.x_least));
    text(kWidth - 6, kHeight - kBottom + 14, "end", fmt::format("{:.3g}", plot.x_most));
    text((kLeft + kWidth) / 2, kHeight - 6, "middle", plot.x_label);
    svg += polyline(plot, a, "a") + polyline(plot, b, "b");
    return svg + fmt::format("</svg><figcaption>{}</figcaption></figure>\n", plot.title);
}

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
    return draw({fmt::format("Histogram of {}: share of pixels", kTitles[axis]), "ΔE",
                 least, most, 0, top},
                {x, ya}, {x, yb});
}

std::string power_plot(const TextureProfile& a, const TextureProfile& b) {
    const auto octaves = [](std::vector<double> frequency) {
        for (double& f : frequency) f = std::log2(f);
        return frequency;
    };
    const std::vector<double> xa = octaves(a.frequency);
    const std::vector<double> xb = octaves(b.frequency);
    const std::vector<double> ya = log10_of(a.power);
    const std::vector<double> yb = log10_of(b.power);
    const auto [left, right] = range_of(xa, xb);
    const auto [bottom, top] = range_of(ya, yb);
    return draw({"Power spectrum of lightness, log10 ΔE², averaged over directions",
                 "log2 cycles a pixel", left, right, bottom, top},
                {xa, ya}, {xb, yb});
}

std::string autocovariance_plot(const std::vector<double>& a,
                                const std::vector<double>& b, std::string_view axis) {
    const std::vector<double> x = count_up(std::max(a.size(), b.size()), 0, 1);
    return draw({fmt::format("Autocovariance of lightness over its variance, {}", axis),
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
        "blobs {:.2f} octaves, 5 × 5 patches {:.3f}. Seams of the second picture, 1 is "
        "seamless: rows {:.2f}, "
        "columns {:.2f}.</p>\n",
        rows, s.total, comparison.cross_check.gradient_kurtosis,
        comparison.cross_check.blob, comparison.cross_check.patches, comparison.seam.rows,
        comparison.seam.cols);
}

Result<std::string> section(const Comparison& comparison) {
    SATEEN_TRY(const TextureProfile a, texture_profile(comparison.reference));
    SATEEN_TRY(const TextureProfile b, texture_profile(comparison.candidate));
    SATEEN_TRY(const std::string picture_a, picture(comparison.reference));
    SATEEN_TRY(const std::string picture_b, picture(comparison.candidate));
    const auto values_a = a.spectrum.values();
    const float least = *std::min_element(values_a.begin(), values_a.end());
    const float most = *std::max_element(values_a.begin(), values_a.end());
    SATEEN_TRY(const std::string spectrum_a, picture(spectrum_picture(a, least, most)));
    SATEEN_TRY(const std::string spectrum_b, picture(spectrum_picture(b, least, most)));

    std::string html;
    if (!comparison.title.empty())
        html += fmt::format("<h2>{}</h2>\n", escaped(comparison.title));
    const auto pair = [&html](const std::string& left, const std::string& left_caption,
                              const std::string& right,
                              const std::string& right_caption) {
        html += fmt::format(
            "<div class=\"pair\"><figure>{}<figcaption "
            "class=\"key-a\">{}</figcaption></figure>"
            "<figure>{}<figcaption class=\"key-b\">{}</figcaption></figure></div>\n",
            left, left_caption, right, right_caption);
    };
    const auto caption = [](const std::string& name, const Image& image) {
        return fmt::format("{}, {} × {}", escaped(name), image.cols(), image.rows());
    };
    pair(picture_a, caption(comparison.reference_name, comparison.reference), picture_b,
         caption(comparison.candidate_name, comparison.candidate));
    html += score_table(comparison);
    html += "<div class=\"plots\">\n" + power_plot(a, b) +
            autocovariance_plot(a.along_cols, b.along_cols, "along a row") +
            autocovariance_plot(a.along_rows, b.along_rows, "down a column");
    for (std::size_t axis = 0; axis < 3; ++axis) html += histogram_plot(a, b, axis);
    html += "</div>\n";
    pair(spectrum_a, "Power spectrum, logarithmic, zero frequency in the middle",
         spectrum_b, "The same, in the same grey levels");
    return html;
}

}  // namespace

Result<std::string> comparison_page(const std::vector<Comparison>& comparisons,
                                    double total) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
        "<title>Texture similarity {:.2f}</title><style>{}</style></head><body>\n"
        "<h1>Texture similarity {:.2f}</h1>\n"
        "<p>1 is as close as two pieces of the reference are to each other, 2 is twice "
        "as far. "
        "<span class=\"key-a\">Blue: the reference.</span> "
        "<span class=\"key-b\">Orange: what is compared with it.</span></p>\n",
        total, kStyle, total);
    for (const Comparison& comparison : comparisons) {
        SATEEN_TRY(const std::string part, section(comparison));
        html += part;
    }
    return html + "</body></html>\n";
}

}  // namespace sateen::cli
