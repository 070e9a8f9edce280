// SPDX-License-Identifier: Apache-2.0
// Progress reports going out, a request to stop coming in.
#pragma once

#include <string_view>

namespace sateen {

/// Told how far a long piece of work is; asked whether to go on. Called from any thread.
class Progress {
  public:
    virtual ~Progress() = default;
    /// A stage of the work has begun, e.g. "reading images".
    virtual void stage(std::string_view /*name*/) {}
    /// `done` of `total` units of the present stage are finished.
    virtual void report(double /*done*/, double /*total*/) {}
    /// True once the work should stop: it then ends with Errc::cancelled.
    [[nodiscard]] virtual bool cancelled() const { return false; }
};

}  // namespace sateen
