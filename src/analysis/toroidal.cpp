// SPDX-License-Identifier: Apache-2.0
// Do slopes continue across their own borders? See roller.hpp.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "sateen/analysis/roller.hpp"

namespace sateen {
namespace {

// The largest mean square difference inside is exceeded at the border of a torus by chance,
// less between next pixels than between periods of a pattern that hardly differ. On the
// presets of the goniometer, estimated, by 0 % and 66 %; on pieces of them by 80 % or more.
constexpr double kNextPixels = 1.3;
constexpr double kPeriods = 1.9;
constexpr std::size_t kLagsPerSide = 4;
constexpr std::size_t kLargestLag = 64;

/// Σ over the lines of (z(i + lag) - z(i))², for every i of a ring of positions.
class RingDifferences {
  public:
    RingDifferences(PlaneView<const double> z, bool along_rows)
        : z_(z), along_rows_(along_rows) {}

    [[nodiscard]] std::size_t positions() const {
        return along_rows_ ? z_.cols : z_.rows;
    }

    [[nodiscard]] std::vector<double> of(std::size_t lag) const {
        std::vector<double> sums(positions(), 0);
        const std::size_t lines = along_rows_ ? z_.rows : z_.cols;
        for (std::size_t line = 0; line < lines; ++line)
            for (std::size_t i = 0; i < positions(); ++i) {
                const std::size_t next = (i + lag) % positions();
                const double step = along_rows_ ? z_(line, next) - z_(line, i)
                                                : z_(next, line) - z_(i, line);
                sums[i] += step * step;
            }
        return sums;
    }

  private:
    PlaneView<const double> z_;
    bool along_rows_;
};

/// The `lag` pairs of every line that straddle the border, against as many beside each other
/// anywhere inside.
bool continues(const RingDifferences& differences, std::size_t lag) {
    const std::size_t n = differences.positions();
    const std::vector<double> of = differences.of(lag);
    double window = 0;
    for (std::size_t i = 0; i < lag; ++i) window += of[i];
    double largest = window;
    // Pairs that begin at first … first + lag - 1 and all end before the border.
    for (std::size_t first = 1; first + 2 * lag <= n; ++first) {
        window += of[first + lag - 1] - of[first - 1];
        largest = std::max(largest, window);
    }
    double across = 0;
    for (std::size_t i = n - lag; i < n; ++i) across += of[i];
    return across <= (lag <= 2 ? kNextPixels : kPeriods) * largest;
}

bool continues(PlaneView<const double> plane) {
    for (const bool along_rows : {false, true}) {
        const RingDifferences differences(plane, along_rows);
        const std::size_t lags =
            std::min(kLargestLag, differences.positions() / kLagsPerSide);
        for (std::size_t lag = 1; lag <= std::max<std::size_t>(1, lags); ++lag)
            if (!continues(differences, lag)) return false;
    }
    return true;
}

}  // namespace

bool is_toroidal(const SlopeField& slopes) {
    for (std::size_t band = 0; band < slopes.bands(); ++band)
        if (!continues(slopes.plane(band))) return false;
    return true;
}

}  // namespace sateen
