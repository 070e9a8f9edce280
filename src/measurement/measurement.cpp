// SPDX-License-Identifier: Apache-2.0
// One pass over the images of a measurement. See measurement.hpp.
#include "sateen/measurement/measurement.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

namespace sateen {

Result<PassReport> for_each_image(
    const Measurement& measurement, bool skip_bad, Executor& executor, Progress& progress,
    const std::function<void(std::size_t, const Image&)>& consume) {
    const std::size_t count = measurement.info().observations.size();
    std::mutex mutex;
    std::vector<std::pair<std::size_t, Error>> failures;
    std::size_t finished = 0;
    std::atomic<bool> stop = false;

    parallel_for(executor, count, [&](std::size_t i) {
        if (stop || progress.cancelled()) return;
        Result<Image> image = measurement.read(i);
        if (image) consume(i, *image);
        const std::lock_guard lock(mutex);
        if (!image) {
            failures.emplace_back(i, std::move(image).error());
            if (!skip_bad) stop = true;
        }
        progress.report(static_cast<double>(++finished), static_cast<double>(count));
    });

    if (progress.cancelled())
        return Error{Errc::cancelled, "cancelled while reading images"};
    std::sort(failures.begin(), failures.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    if (!skip_bad && !failures.empty()) return std::move(failures.front().second);
    if (!failures.empty() && failures.size() == count)
        return Error{Errc::bad_format,
                     "no readable image: all " + std::to_string(count) +
                         " failed, the first with: " + failures.front().second.message};
    PassReport report;
    for (auto& [index, error] : failures) {
        report.failed.push_back(index);
        report.reasons.push_back(std::move(error.message));
    }
    return report;
}

}  // namespace sateen
