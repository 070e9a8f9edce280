// SPDX-License-Identifier: Apache-2.0
// The seam through which the library uses threads: it never starts one itself.
// io/executor.hpp has the native implementation on oneTBB; the default is serial.
#pragma once

#include <cstddef>
#include <type_traits>

namespace sateen {

/// A borrowed callable `void(std::size_t)`; valid only during the call it is passed to.
class IndexFunction {
  public:
    template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, IndexFunction>)
        // NOLINTNEXTLINE(bugprone-forwarding-reference-overload): constrained above
        IndexFunction(F&& body)
        : object_(const_cast<void*>(static_cast<const void*>(&body))),
          call_([](void* object, std::size_t index) {
              (*static_cast<std::remove_reference_t<F>*>(object))(index);
          }) {}
    void operator()(std::size_t index) const { call_(object_, index); }

  private:
    void* object_;
    void (*call_)(void*, std::size_t);
};

/// Runs independent pieces of work, in any order and possibly at the same time.
///
/// What a body computes must not depend on the order or on the number of threads: results
/// are the same bytes for every executor.
class Executor {
  public:
    virtual ~Executor() = default;
    /// Calls `body(i)` once for every i in [0, count) and returns when all have returned.
    virtual void run(std::size_t count, IndexFunction body) = 0;
    /// How many bodies may run at the same time, at least 1.
    [[nodiscard]] virtual std::size_t concurrency() const = 0;
};

/// Runs everything on the calling thread, in order.
class SerialExecutor final : public Executor {
  public:
    void run(std::size_t count, IndexFunction body) override {
        for (std::size_t i = 0; i < count; ++i) body(i);
    }
    [[nodiscard]] std::size_t concurrency() const override { return 1; }
};

/// `body(i)` for every i in [0, count).
template <class F>
void parallel_for(Executor& executor, std::size_t count, F&& body) {
    executor.run(count, IndexFunction(body));
}

}  // namespace sateen
