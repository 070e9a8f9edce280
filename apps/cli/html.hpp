// SPDX-License-Identifier: Apache-2.0
// What the pages of reports are made of: everything in one file, nothing to load.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/result.hpp"

namespace sateen::cli::html {

/// The text with the characters that HTML reserves replaced.
[[nodiscard]] std::string escaped(std::string_view text);

/// Bytes as text, for data inside a page [RFC 4648].
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// A whole page. \param title  plain text \param body  HTML
[[nodiscard]] std::string page(std::string_view title, std::string_view body);

/// An <img> with the picture inside, cropped in the middle to at most so many pixels a side;
/// it is enlarged three times at most.
inline constexpr std::size_t kMostSide = 768;
[[nodiscard]] Result<std::string> picture(const Image& image,
                                          std::size_t most_side = kMostSide);

/// The frame of a plot of two curves over one another.
struct Plot {
    std::string title;
    std::string x_label;
    double x_least = 0;
    double x_most = 1;
    double y_least = 0;
    double y_most = 1;
    /// What stands at the ends of the axis, where it is not x itself.
    std::string x_first = {};
    std::string x_last = {};
};

struct Curve {
    const std::vector<double>& x;
    const std::vector<double>& y;
};

/// A <figure> with the plot; the curves have the colours of the classes key-a and key-b.
[[nodiscard]] std::string draw(const Plot& plot, const Curve& a, const Curve& b);

}  // namespace sateen::cli::html
