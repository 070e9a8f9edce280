// SPDX-License-Identifier: Apache-2.0
// sateen: photographs of a material in, a material of kilobytes out, seamless texture
// back.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <new>
#include <vector>

#include "console.hpp"
#include "verbs.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kUsage = 2;

int fail(std::string_view message) {
    fmt::print(stderr, "sateen: error: {}\n", message);
    return kFailed;
}

int run(int argc, char** argv) {
    CLI::App program{
        "Turns photographs of a material under many views and lights into a material of\n"
        "kilobytes, and draws seamless texture of any size from it.",
        "sateen"};
    program.set_version_flag("--version", SATEEN_VERSION);
    program.require_subcommand(1);
    program.footer("Help on a verb: sateen VERB --help");
    const std::vector<sateen::cli::Verb> verbs = {sateen::cli::add_model(program),
                                                  sateen::cli::add_synthesise(program),
                                                  sateen::cli::add_info(program)};
    try {
        program.parse(argc, argv);
        sateen::cli::catch_interrupts();
        for (const sateen::cli::Verb& verb : verbs)
            if (verb.command->parsed()) {
                const sateen::Result<void> result = verb.run();
                if (!result) return fail(result.error().message);
            }
    } catch (const CLI::ParseError& error) {
        return program.exit(error) == 0 ? 0 : kUsage;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::bad_alloc&) {
        return fail("out of memory");
    } catch (const std::exception& error) {
        return fail(error.what());
    }
}
