// SPDX-License-Identifier: Apache-2.0
// What the user sees while waiting, and how the user stops it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "sateen/core/progress.hpp"

namespace sateen::cli {

/// Makes Ctrl-C (and a polite kill) ask for a stop instead of ending the process, so that
/// unfinished files are removed. A second Ctrl-C ends it at once.
void catch_interrupts();
[[nodiscard]] bool interrupted();

/// The text with control characters, which a terminal would obey, replaced by '?'.
[[nodiscard]] std::string one_line(std::string_view text);
/// Prints to stdout; bytes of file names that are not UTF-8 are replaced.
void print_json(const nlohmann::ordered_json& json);

/// The last line of verbs that draw: what was written, how large, in what time.
void print_drawn(const std::string& output, std::size_t count, std::string_view what,
                 std::size_t rows, std::size_t cols, double seconds);

/// A progress bar with the time left on stderr; nothing where stderr is not a terminal.
class ConsoleProgress final : public Progress {
  public:
    ConsoleProgress();
    ~ConsoleProgress() override;
    ConsoleProgress(const ConsoleProgress&) = delete;
    ConsoleProgress& operator=(const ConsoleProgress&) = delete;

    void stage(std::string_view name) override;
    void report(double done, double total) override;
    [[nodiscard]] bool cancelled() const override { return interrupted(); }
    /// Clears the bar, so that a message can be printed.
    void clear();

  private:
    using Clock = std::chrono::steady_clock;
    void draw(double share, Clock::time_point now);

    const bool visible_;
    bool drawn_ = false;
    std::mutex mutex_;
    std::string stage_;
    Clock::time_point stage_start_ = Clock::now();
    Clock::time_point last_draw_;
};

}  // namespace sateen::cli
