// SPDX-License-Identifier: Apache-2.0
// Progress bar and interrupts. See console.hpp.
#include "console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sateen::cli {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int signal_number) {
    stop_requested = 1;
    // The default action for a second one: whoever insists is obeyed.
    std::signal(signal_number, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
}

bool interrupted() {
    return stop_requested != 0;
}

std::string one_line(std::string_view text) {
    std::string line(text);
    std::replace_if(
        line.begin(), line.end(),
        [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
    return line;
}

void print_json(const nlohmann::ordered_json& json) {
    constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
    fmt::print("{}\n", json.dump(2, ' ', false, kReplace));
}

void print_drawn(const std::string& output, std::size_t count, std::string_view what,
                 std::size_t rows, std::size_t cols, double seconds) {
    fmt::print(stderr, "{}: {} {}{} of {}x{}, {:.2f} s\n", one_line(output), count, what,
               count == 1 ? "" : "s", cols, rows, seconds);
}

ConsoleProgress::ConsoleProgress() : visible_(isatty(STDERR_FILENO) != 0) {}

ConsoleProgress::~ConsoleProgress() {
    clear();
}

void ConsoleProgress::stage(std::string_view name) {
    const std::lock_guard lock(mutex_);
    stage_ = name;
    stage_start_ = Clock::now();
}

void ConsoleProgress::report(double done, double total) {
    if (!visible_ || !(total > 0)) return;
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    constexpr auto kInterval = std::chrono::milliseconds(100);
    if (done < total && now - last_draw_ < kInterval) return;
    last_draw_ = now;
    draw(std::clamp(done / total, 0.0, 1.0), now);
}

void ConsoleProgress::draw(double share, Clock::time_point now) {
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(share * kWidth);
    const double elapsed = std::chrono::duration<double>(now - stage_start_).count();
    std::string left;
    if (share > 0 && share < 1) {
        const auto seconds = static_cast<long>(elapsed / share - elapsed + 0.5);
        left = fmt::format("{}:{:02} left", seconds / 60, seconds % 60);
    }
    fmt::print(stderr, "\r{:<16} [{:=<{}}{:<{}}] {:3.0f} %  {:<12}", stage_, "", filled,
               "", kWidth - filled, 100 * share, left);
    std::fflush(stderr);
    drawn_ = true;
}

void ConsoleProgress::clear() {
    if (drawn_) fmt::print(stderr, "\r{:<80}\r", "");
    drawn_ = false;
}

}  // namespace sateen::cli
