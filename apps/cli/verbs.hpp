// SPDX-License-Identifier: Apache-2.0
// The verbs of the program, one file each: parse, one library call, print.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "sateen/core/result.hpp"

namespace sateen::cli {

/// A verb adds its sub-command; what it returns runs if that was given.
using Action = std::function<Result<void>()>;
struct Verb {
    CLI::App* command = nullptr;
    Action run;
};

[[nodiscard]] Verb add_model(CLI::App& program);
[[nodiscard]] Verb add_synthesise(CLI::App& program);
[[nodiscard]] Verb add_info(CLI::App& program);
[[nodiscard]] Verb add_compare(CLI::App& program);
[[nodiscard]] Verb add_measure(CLI::App& program);
[[nodiscard]] Verb add_render(CLI::App& program);
[[nodiscard]] Verb add_export(CLI::App& program);
[[nodiscard]] Verb add_view(CLI::App& program);

}  // namespace sateen::cli
