// SPDX-License-Identifier: Apache-2.0
// An executor on std::thread, for tests of code that must not depend on the executor.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "sateen/core/parallel.hpp"

namespace sateen::test {

/// Starts its threads anew for each run(); they take indices as they come.
class ThreadedExecutor final : public Executor {
  public:
    explicit ThreadedExecutor(std::size_t threads) : threads_(threads) {}

    void run(std::size_t count, IndexFunction body) override {
        std::atomic<std::size_t> next = 0;
        const auto work = [&] {
            for (std::size_t i = next++; i < count; i = next++) body(i);
        };
        std::vector<std::jthread> pool;
        for (std::size_t t = 1; t < threads_; ++t) pool.emplace_back(work);
        work();
    }
    [[nodiscard]] std::size_t concurrency() const override { return threads_; }

  private:
    std::size_t threads_;
};

}  // namespace sateen::test
