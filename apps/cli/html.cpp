// SPDX-License-Identifier: Apache-2.0
#include "html.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>

#include "sateen/io/atomic_file.hpp"
#include "sateen/io/image_file.hpp"

namespace sateen::cli::html {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --a: #2a6fbb; --b: #d9622b; --line: #8885; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 70rem; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.5rem; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }
.exhibits { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr)); gap: 1rem 2rem; }
.exhibits h3 { font-size: .95rem; font-weight: 600; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1rem; }
figure { margin: 0; } figcaption { font-size: .9rem; padding: .2rem 0; overflow-wrap: anywhere; }
figure img { width: 100%; height: auto; }
svg { width: 100%; height: auto; } svg text { font: 11px system-ui, sans-serif; fill: currentColor; }
.frame { fill: none; stroke: var(--line); } .a { stroke: var(--a); } .b { stroke: var(--b); }
.a, .b { fill: none; stroke-width: 1.6; } .key-a { color: var(--a); } .key-b { color: var(--b); }
table { border-collapse: collapse; } th, td { padding: .25rem .8rem; border-bottom: 1px solid var(--line); text-align: right; }
th:first-child, td:first-child, .text { text-align: left; } .text { font-size: .85rem; overflow-wrap: anywhere; }
td img { display: block; } .pair + table { margin-top: 1rem; } .total td { font-weight: 600; }
)";

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

}  // namespace

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

std::string page(std::string_view title, std::string_view body) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
        "<title>{0}</title><style>{1}</style></head><body>\n<h1>{0}</h1>\n{2}</body></"
        "html>\n",
        escaped(title), kStyle, body);
}

Result<std::string> picture(const Image& image, std::size_t most_side) {
    constexpr std::size_t kMostBytes = std::size_t{1} << 26U;
    constexpr std::size_t kMostTimes = 3;
    const std::size_t rows = std::min(image.rows(), most_side);
    const std::size_t cols = std::min(image.cols(), most_side);
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
        "<img width=\"{}\" height=\"{}\" style=\"max-width:{}px\" alt=\"\" "
        "src=\"data:image/png;base64,{}\">",
        cols, rows, kMostTimes * cols, base64(bytes));
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
    const auto end = [](const std::string& label, double x) {
        return label.empty() ? fmt::format("{:.3g}", x) : label;
    };
    text(kLeft, kHeight - kBottom + 14, "start", end(plot.x_first, plot.x_least));
    text(kWidth - 6, kHeight - kBottom + 14, "end", end(plot.x_last, plot.x_most));
    text((kLeft + kWidth) / 2, kHeight - 6, "middle", plot.x_label);
    svg += polyline(plot, a, "a") + polyline(plot, b, "b");
    return svg + fmt::format("</svg><figcaption>{}</figcaption></figure>\n", plot.title);
}

}  // namespace sateen::cli::html
