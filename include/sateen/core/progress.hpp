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

/// Of one part of a larger piece of work: cancelled with the whole, and silent, since the
/// whole reports when the part is done.
class PartProgress final : public Progress {
  public:
    explicit PartProgress(const Progress& whole) : whole_(whole) {}
    [[nodiscard]] bool cancelled() const override { return whole_.cancelled(); }

  private:
    const Progress& whole_;
};

}  // namespace sateen
