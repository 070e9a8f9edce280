// SPDX-License-Identifier: Apache-2.0
// Progress that stops the work, or remembers it.
#pragma once

#include <atomic>

#include "sateen/core/progress.hpp"

namespace sateen::test {

/// Asks to stop once `limit` units have been reported; 0: at once.
class CancelAfter final : public Progress {
  public:
    explicit CancelAfter(double limit) : limit_(limit) {}
    void report(double done, double /*total*/) override { done_ = done; }
    [[nodiscard]] bool cancelled() const override { return done_ >= limit_; }

  private:
    double limit_;
    std::atomic<double> done_ = 0;
};

}  // namespace sateen::test
