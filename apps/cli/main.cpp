// SPDX-License-Identifier: Apache-2.0
// sateen: photographs of a material in, a material of kilobytes out, seamless texture
// back.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "console.hpp"
#include "verbs.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kUsage = 2;

/// One line, whatever the names of files in the message.
int fail(std::string_view message, int status = kFailed) {
    fmt::print(stderr, "sateen: error: {}\n", sateen::cli::one_line(message));
    return status;
}

std::string verb_names(const std::vector<sateen::cli::Verb>& verbs) {
    std::string names;
    for (const sateen::cli::Verb& verb : verbs)
        names += (names.empty() ? "" : ", ") + verb.command->get_name();
    return names;
}

/// CLI11 takes an unknown verb for an absent one.
bool known_verb(const std::vector<sateen::cli::Verb>& verbs, const std::string& name) {
    for (const sateen::cli::Verb& verb : verbs)
        if (verb.command->check_name(name)) return true;
    return false;
}

int run(int argc, char** argv) {
    CLI::App program{
        "Turns photographs of a material under many views and lights into a material of\n"
        "kilobytes, and draws seamless texture of any size from it.",
        "sateen"};
    program.set_version_flag("--version", "sateen " SATEEN_VERSION, "Print the version");
    program.set_help_flag("-h,--help", "Print this help");
    program.require_subcommand(1);
    program.get_formatter()->label("SUBCOMMAND", "VERB");
    program.footer("Help on a verb: sateen VERB --help");
    const std::vector<sateen::cli::Verb> verbs = {
        sateen::cli::add_model(program),   sateen::cli::add_synthesise(program),
        sateen::cli::add_info(program),    sateen::cli::add_compare(program),
        sateen::cli::add_measure(program), sateen::cli::add_render(program),
        sateen::cli::add_export(program),  sateen::cli::add_view(program)};
    for (const sateen::cli::Verb& verb : verbs) verb.command->group("Verbs");
    const std::string first = argc < 2 ? "" : argv[1];
    if (!first.starts_with('-') && !known_verb(verbs, first))
        return fail(fmt::format("{}, expected one of {}; see sateen --help",
                                argc < 2 ? "no verb" : "unknown verb " + first,
                                verb_names(verbs)),
                    kUsage);
    try {
        program.parse(argc, argv);
        sateen::cli::catch_interrupts();
        for (const sateen::cli::Verb& verb : verbs)
            if (verb.command->parsed()) {
                const sateen::Result<void> result = verb.run();
                if (!result) return fail(result.error().message);
            }
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return program.exit(error);
        const std::string verb = first.starts_with('-') ? "" : first + " ";
        return fail(fmt::format("{}; see sateen {}--help", error.what(), verb), kUsage);
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        return fail("the standard output cannot be written");
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
