// SPDX-License-Identifier: Apache-2.0
// Time to decode every image of a measurement once: the unit in which the time of
// `sateen model` is limited (2.0 x).
//
//     decode_bench ZIP|FOLDER [threads]
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "sateen/io/executor.hpp"
#include "sateen/io/open_measurement.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

int fail(const sateen::Error& error) {
    std::fprintf(stderr, "decode_bench: %s\n", error.message.c_str());
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: decode_bench ZIP|FOLDER [threads]\n");
        return 2;
    }
    const std::string path = argv[1];
    const std::size_t threads = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
    const std::unique_ptr<sateen::Executor> executor = sateen::make_executor(threads);

    const Clock::time_point opening = Clock::now();
    const auto measurement = sateen::open_measurement({&path, 1});
    if (!measurement) return fail(measurement.error());
    const double open_seconds = seconds_since(opening);

    sateen::Progress progress;
    std::atomic<std::size_t> pixels = 0;
    const Clock::time_point decoding = Clock::now();
    const auto report = sateen::for_each_image(
        **measurement, false, *executor, progress,
        [&](std::size_t, const sateen::Image& image) { pixels += image.plane_size(); });
    if (!report) return fail(report.error());
    const double seconds = seconds_since(decoding);

    const auto images = static_cast<double>((*measurement)->info().observations.size());
    std::printf(
        "{\"bench\": \"decode\", \"images\": %.0f, \"threads\": %zu, "
        "\"open_seconds\": %.4f, \"decode_seconds\": %.4f, "
        "\"images_per_second\": %.0f, \"megapixels_per_second\": %.1f}\n",
        images, executor->concurrency(), open_seconds, seconds, images / seconds,
        static_cast<double>(pixels) / seconds / 1e6);
    return 0;
}
