// SPDX-License-Identifier: Apache-2.0
// Drawing a 512 x 512 plane of normals on one thread, on each SIMD target.
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <limits>

#include "sateen/core/image.hpp"
#include "sateen/core/normal.hpp"

namespace {

constexpr std::size_t kSize = 512;
constexpr int kRepeats = 41;

// Shortest processor time of a call, in seconds: the one disturbed least.
template <class Work>
double shortest(Work&& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kRepeats; ++i) {
        const std::clock_t start = std::clock();
        work();
        best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return best;
}

// Seconds a clock cycle lasts, from a chain of additions that depend on each other:
// shared machines seldom run at the clock they state.
double cycle_seconds() {
    constexpr std::uint64_t kAdditions = 1'000'000;
    const double seconds = shortest([] {
        volatile std::uint64_t start = 1;
        std::uint64_t chain = start;
        for (std::uint64_t i = 0; i < kAdditions; ++i) {
            chain += i;
#if defined(__GNUC__)
            __asm__ volatile("" : "+r"(chain));
#endif
        }
        start = chain;
    });
    return seconds / static_cast<double>(kAdditions);
}

}  // namespace

int main() {
    sateen::Image noise(1, kSize, kSize);
    std::printf("{\"bench\": \"noise\", \"size\": %zu, \"targets\": {", kSize);
    const char* separator = "";
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().DeInit();
        const double cycle = cycle_seconds();
        const double seconds = shortest([&] {
            for (std::size_t r = 0; r < kSize; ++r) {
                sateen::draw_normals({1, 2}, static_cast<std::int32_t>(r), 0,
                                     {noise.plane(0).row(r), kSize});
            }
        });
        const double each = seconds / static_cast<double>(kSize * kSize);
        std::printf("%s\"%s\": {\"gnormals_per_s\": %.3f, \"cycles_per_normal\": %.2f}",
                    separator, hwy::TargetName(target), 1e-9 / each, each / cycle);
        separator = ", ";
    }
    // 0.4 G normals/s at 2.5 GHz.
    std::printf(
        "}, \"limit_avx2\": {\"gnormals_per_s\": 0.4, \"cycles_per_normal\": 6.25}}\n");
}
