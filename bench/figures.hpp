// SPDX-License-Identifier: Apache-2.0
// What a benchmark reports: figures with their limits, as JSON.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace sateen::bench {

/// A measured value and what it must reach. Where the unit is "x", the value is a ratio of
/// two times measured in one run.
struct Figure {
    enum class Bound { at_most, at_least };

    std::string name;
    double value = 0;
    std::string unit;
    double limit = 0;
    Bound bound = Bound::at_most;
    /// What the value was made of, for the reader.
    std::vector<std::pair<std::string, double>> details;
};

/// {"bench": …, "figures": [{name, value, unit, limit, ratio, ok, details}, …]}
inline void print(const std::string& bench, const std::vector<Figure>& figures) {
    std::printf("{\"bench\": \"%s\", \"figures\": [", bench.c_str());
    const char* separator = "";
    for (const Figure& figure : figures) {
        const double ratio = figure.value / figure.limit;
        const bool at_most = figure.bound == Figure::Bound::at_most;
        std::printf(
            "%s\n  {\"name\": \"%s\", \"value\": %.4g, \"unit\": \"%s\", \"%s\": %.4g, "
            "\"ratio\": %.3f, \"ok\": %s",
            separator, figure.name.c_str(), figure.value, figure.unit.c_str(),
            at_most ? "at_most" : "at_least", figure.limit, ratio,
            (at_most ? ratio <= 1 : ratio >= 1) ? "true" : "false");
        for (const auto& [name, value] : figure.details)
            std::printf(", \"%s\": %.4g", name.c_str(), value);
        std::printf("}");
        separator = ",";
    }
    std::printf("\n]}\n");
}

/// Seconds of processor time that `work` takes: unlike the clock on the wall it does not
/// count being descheduled.
template <class Work>
double processor_seconds(Work&& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Seconds on the wall, for work on several threads.
template <class Work>
double wall_seconds(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
        .count();
}

/// The shortest of several: the one disturbed least.
class Shortest {
  public:
    void add(double seconds) { seconds_ = std::min(seconds_, seconds); }
    [[nodiscard]] double seconds() const { return seconds_; }
    [[nodiscard]] double milliseconds() const { return 1e3 * seconds_; }

  private:
    double seconds_ = std::numeric_limits<double>::infinity();
};

/// The most memory this process has held so far.
inline double peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace sateen::bench
