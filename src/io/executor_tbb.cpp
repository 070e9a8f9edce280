// SPDX-License-Identifier: Apache-2.0
// The native executor. See executor.hpp.
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

#include "sateen/io/executor.hpp"

namespace sateen {
namespace {

class TbbExecutor final : public Executor {
  public:
    explicit TbbExecutor(std::size_t threads)
        : threads_(threads),
          limit_(tbb::global_control::max_allowed_parallelism,
                 std::max(threads, tbb::global_control::active_value(
                                       tbb::global_control::max_allowed_parallelism))),
          arena_(static_cast<int>(threads)) {}

    void run(std::size_t count, IndexFunction body) override {
        if (count == 1) {
            body(0);
            return;
        }
        // Isolated: a thread that waits for the end of an inner run must not begin
        // another body of an outer one, which would double the memory in use and could
        // deadlock.
        arena_.execute([&] {
            tbb::this_task_arena::isolate([&] {
                tbb::parallel_for(
                    std::size_t{0}, count, [&](std::size_t i) { body(i); },
                    tbb::simple_partitioner{});
            });
        });
    }

    [[nodiscard]] std::size_t concurrency() const override { return threads_; }

  private:
    std::size_t threads_;
    tbb::global_control limit_;
    tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Executor> make_executor(std::size_t threads) {
    constexpr std::size_t kMaxThreads = 1024;
    if (threads == 0)
        threads = static_cast<std::size_t>(tbb::info::default_concurrency());
    if (threads == 1) return std::make_unique<SerialExecutor>();
    return std::make_unique<TbbExecutor>(std::min(threads, kMaxThreads));
}

}  // namespace sateen
