// SPDX-License-Identifier: Apache-2.0
#include "sateen/io/executor.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace sateen {
namespace {

TEST(Executor, RunsEveryIndexOnce) {
    for (const std::size_t threads : {1U, 2U, 3U}) {
        const auto executor = make_executor(threads);
        EXPECT_EQ(executor->concurrency(), threads);
        for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
            std::vector<std::atomic<int>> hits(count);
            parallel_for(*executor, count, [&](std::size_t i) { ++hits[i]; });
            for (const auto& hit : hits) EXPECT_EQ(hit, 1);
        }
    }
}

TEST(Executor, UsesSomeThreadByDefault) {
    EXPECT_GE(make_executor(0)->concurrency(), 1U);
}

TEST(Executor, NestedRunsEnd) {
    const auto executor = make_executor(3);
    std::atomic<int> sum = 0;
    parallel_for(*executor, 20, [&](std::size_t) {
        parallel_for(*executor, 20, [&](std::size_t) {
            parallel_for(*executor, 5, [&](std::size_t) { ++sum; });
        });
    });
    EXPECT_EQ(sum, 20 * 20 * 5);
}

TEST(Executor, AThreadWaitingInsideDoesNotBeginAnotherOuterBody) {
    const auto executor = make_executor(3);
    std::atomic<int> nested_twice = 0;
    parallel_for(*executor, 64, [&](std::size_t) {
        static thread_local int depth = 0;
        if (++depth > 1) ++nested_twice;
        parallel_for(*executor, 8, [](std::size_t) { std::this_thread::yield(); });
        --depth;
    });
    EXPECT_EQ(nested_twice, 0);
}

TEST(Executor, ServesSeveralThreadsAtOnce) {
    const auto executor = make_executor(2);
    std::atomic<int> sum = 0;
    std::vector<std::thread> callers;
    for (int t = 0; t < 4; ++t)
        callers.emplace_back(
            [&] { parallel_for(*executor, 100, [&](std::size_t) { ++sum; }); });
    for (std::thread& caller : callers) caller.join();
    EXPECT_EQ(sum, 400);
}

}  // namespace
}  // namespace sateen
