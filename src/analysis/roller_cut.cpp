// SPDX-License-Identifier: Apache-2.0
// Minimum-error cuts. See roller_cut.hpp.
#include "analysis/roller_cut.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace sateen {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

struct Path {
    double error = kNever;
    std::vector<std::size_t> sites;
};

/// The best path; with `start`, one that begins there and ends beside it.
Path best_path(const BasicImage<double>& error, std::size_t start) {
    const std::size_t steps = error.rows();
    const std::size_t sites = error.cols();
    BasicImage<double> total(1, steps, sites);
    for (std::size_t s = 0; s < sites; ++s)
        total(0, 0, s) = start == kNone || s == start ? error(0, 0, s) : kNever;
    const auto best_before = [&](std::size_t i, std::size_t s) {
        std::size_t best = s;
        if (s > 0 && total(0, i, s - 1) < total(0, i, best)) best = s - 1;
        if (s + 1 < sites && total(0, i, s + 1) < total(0, i, best)) best = s + 1;
        return best;
    };
    for (std::size_t i = 1; i < steps; ++i)
        for (std::size_t s = 0; s < sites; ++s)
            total(0, i, s) = error(0, i, s) + total(0, i - 1, best_before(i - 1, s));

    std::size_t low = 0;
    std::size_t high = sites - 1;
    if (start != kNone) {
        low = start > 0 ? start - 1 : 0;
        high = std::min(start + 1, sites - 1);
    }
    std::size_t end = low;
    for (std::size_t s = low; s <= high; ++s)
        if (total(0, steps - 1, s) < total(0, steps - 1, end)) end = s;
    Path path{total(0, steps - 1, end), std::vector<std::size_t>(steps)};
    for (std::size_t i = steps; i-- > 0;) {
        path.sites[i] = end;
        if (i > 0) end = best_before(i - 1, end);
    }
    return path;
}

/// Pixels of a ring along the border of a rectangle, cut open above its middle column.
class Ring {
  public:
    Ring(const BasicImage<double>& error, std::size_t band)
        : error_(error), band_(band), seam_(error.cols() / 2) {}

    /// The loop of least error through the pixel of a row, just right of the seam.
    [[nodiscard]] std::pair<double, std::vector<std::size_t>> loop(
        std::size_t row) const {
        using Entry = std::pair<double, std::size_t>;
        std::vector<double> total(error_.plane_size(), kNever);
        std::vector<std::size_t> before(error_.plane_size(), kNone);
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        const std::size_t first = index(row, seam_);
        const std::size_t last = index(row, seam_ - 1);
        total[first] = error_.values()[first];
        queue.emplace(total[first], first);
        while (!queue.empty()) {
            const auto [distance, at] = queue.top();
            queue.pop();
            if (distance > total[at]) continue;
            if (at == last) break;
            for (const std::size_t next : neighbours(at)) {
                if (next == kNone) continue;
                const double along = distance + error_.values()[next];
                if (along >= total[next]) continue;
                total[next] = along;
                before[next] = at;
                queue.emplace(along, next);
            }
        }
        std::vector<std::size_t> pixels;
        for (std::size_t at = last; at != kNone; at = before[at]) pixels.push_back(at);
        return {total[last], std::move(pixels)};
    }

    [[nodiscard]] std::size_t index(std::size_t r, std::size_t c) const {
        return r * error_.cols() + c;
    }

  private:
    [[nodiscard]] bool contains(std::size_t r, std::size_t c) const {
        const std::size_t depth =
            std::min({r, c, error_.rows() - 1 - r, error_.cols() - 1 - c});
        return depth >= 1 && depth <= band_;
    }

    // Of four neighbours, so that the loop is tight; not across the seam.
    [[nodiscard]] std::array<std::size_t, 4> neighbours(std::size_t at) const {
        const std::size_t r = at / error_.cols();
        const std::size_t c = at % error_.cols();
        const bool upper = r < error_.rows() / 2;
        const auto pixel = [&](bool exists, std::size_t row, std::size_t col) {
            return exists && contains(row, col) ? index(row, col) : kNone;
        };
        return {pixel(r > 0, r - 1, c), pixel(r + 1 < error_.rows(), r + 1, c),
                pixel(c > 0 && !(upper && c == seam_), r, c - 1),
                pixel(c + 1 < error_.cols() && !(upper && c + 1 == seam_), r, c + 1)};
    }

    const BasicImage<double>& error_;
    std::size_t band_;
    std::size_t seam_;
};

}  // namespace

std::vector<std::size_t> minimum_error_path(const BasicImage<double>& error,
                                            bool closed) {
    if (!closed) return best_path(error, kNone).sites;
    Path best;
    for (std::size_t start = 0; start < error.cols(); ++start) {
        Path path = best_path(error, start);
        if (path.error < best.error) best = std::move(path);
    }
    return best.sites;
}

std::vector<std::uint8_t> minimum_error_inside(const BasicImage<double>& error,
                                               std::size_t band) {
    const Ring ring(error, band);
    double least = kNever;
    std::vector<std::size_t> loop;
    // A loop crosses the seam somewhere: every few rows is near enough to the best place.
    const std::size_t step = std::max<std::size_t>(1, band / 8);
    for (std::size_t row = 1; row <= band; row += step) {
        auto [total, pixels] = ring.loop(row);
        if (total >= least) continue;
        least = total;
        loop = std::move(pixels);
    }
    std::vector<std::uint8_t> inside(error.plane_size(), 0);
    std::vector<std::uint8_t> wall(error.plane_size(), 0);
    for (const std::size_t at : loop) wall[at] = 1;
    std::vector<std::size_t> open = {ring.index(error.rows() / 2, error.cols() / 2)};
    inside[open[0]] = 1;
    while (!open.empty()) {
        const std::size_t at = open.back();
        open.pop_back();
        for (const std::size_t next :
             {at - error.cols(), at + error.cols(), at - 1, at + 1})
            if (inside[next] == 0 && wall[next] == 0) {
                inside[next] = 1;
                open.push_back(next);
            }
    }
    return inside;
}

}  // namespace sateen
