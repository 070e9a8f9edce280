// SPDX-License-Identifier: Apache-2.0
// sateen model: a measurement to a material.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "console.hpp"
#include "sateen/analysis/analyse.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/io/open_measurement.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

struct ModelArguments {
    CommonArguments common;
    std::vector<std::string> inputs;
    std::string output;
    std::string field = "auto";
    std::string subspaces = "auto";
    std::string levels = "auto";
    std::string neighbourhood = "auto";
    std::string encoding = "auto";
    bool paper = false;
    bool skip_bad = false;
};

/// Options that differ from the defaults, as the material records them.
std::string recorded_options(const ModelArguments& arguments) {
    std::string text;
    const auto add = [&](const std::string& option, const std::string& value) {
        if (value != "auto") text += (text.empty() ? "" : " ") + option + " " + value;
    };
    add("--field", arguments.field);
    if (arguments.paper) text += text.empty() ? "--paper" : " --paper";
    add("--subspaces", arguments.subspaces);
    add("--levels", arguments.levels);
    add("--neighbourhood", arguments.neighbourhood);
    add("--encoding", arguments.encoding);
    if (arguments.common.seed != 0) add("--seed", std::to_string(arguments.common.seed));
    return text;
}

Result<AnalysisOptions> analysis_options(const ModelArguments& arguments) {
    AnalysisOptions options;
    options.paper = arguments.paper;
    options.subspaces =
        parse_auto_or_number("--subspaces", arguments.subspaces, 1, kMaxSubspaces);
    options.levels = parse_auto_or_number("--levels", arguments.levels, 1, kMaxLevels);
    SATEEN_TRY(options.neighbourhood, parse_neighbourhood(arguments.neighbourhood));
    options.seed = arguments.common.seed;
    options.skip_bad = arguments.skip_bad;
    return options;
}

void print_summary(const ModelArguments& arguments, const Analysis& analysis,
                   const MeasurementInfo& info, std::size_t bytes, double seconds) {
    const Material& material = analysis.material;
    if (!arguments.common.json) {
        fmt::print(stderr, "{}: {} images of {}x{}, {} subspace{}, {} bytes, {:.2f} s\n",
                   arguments.output, info.observations.size(), info.cols, info.rows,
                   material.subspaces.size(), material.subspaces.size() == 1 ? "" : "s",
                   bytes, seconds);
        return;
    }
    nlohmann::ordered_json json;
    json["material"] = arguments.output;
    json["bytes"] = bytes;
    json["seconds"] = seconds;
    json["images"] = info.observations.size();
    json["size"] = {info.cols, info.rows};
    json["field"] = "car2d";
    json["paper"] = arguments.paper;
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        const Subspace& subspace = material.subspaces[k];
        json["subspaces"].push_back(
            {{"representative", info.observations[analysis.representatives[k]].name},
             {"members", subspace.members},
             {"levels", subspace.levels.size()}});
    }
    json["notes"] = analysis.notes;
    fmt::print("{}\n", json.dump(2));
}

Result<void> run_model(const ModelArguments& arguments) {
    const auto start = std::chrono::steady_clock::now();
    SATEEN_TRY(const AnalysisOptions options, analysis_options(arguments));
    // Minutes of work should not end with "no such folder".
    SATEEN_TRY(AtomicFile probe, AtomicFile::create(arguments.output));

    const std::unique_ptr<Executor> executor = make_executor(arguments.common.threads);
    ConsoleProgress progress;
    SATEEN_TRY(const std::unique_ptr<Measurement> measurement,
               open_measurement(arguments.inputs,
                                {.skip_bad = arguments.skip_bad,
                                 .encoding = parse_encoding(arguments.encoding)}));
    SATEEN_TRY(Analysis analysis, analyse(*measurement, options, *executor, progress));
    analysis.material.provenance.options = recorded_options(arguments);
    analysis.material.provenance.writer = "sateen " SATEEN_VERSION;
    SATEEN_TRY(const std::size_t bytes,
               save_material(arguments.output, analysis.material));

    progress.clear();
    for (const std::string& note : analysis.notes)
        fmt::print(stderr, "sateen: {}\n", note);
    const std::chrono::duration<double> elapsed =
        std::chrono::steady_clock::now() - start;
    print_summary(arguments, analysis, measurement->info(), bytes, elapsed.count());
    return {};
}

}  // namespace

Verb add_model(CLI::App& program) {
    auto arguments = std::make_shared<ModelArguments>();
    CLI::App* verb = program.add_subcommand(
        "model", "Analyse a measurement or photographs and write the material");
    verb->add_option(
            "input", arguments->inputs,
            "A UBO2003 or ATRIUM zip or folder, a folder with directions.csv, or one "
            "or more photographs of one material")
        ->required();
    verb->add_option("-o,--output", arguments->output, "The material file, NAME.sateen")
        ->required();
    verb->add_option("--field", arguments->field, "Random field model: auto or car2d")
        ->check(CLI::IsMember({"auto", "car2d"}))
        ->capture_default_str();
    verb->add_flag(
        "--paper", arguments->paper,
        "What [CAR2] prints: 3 neighbours, 3 levels, no marginal curves, recursion");
    verb->add_option("--subspaces", arguments->subspaces, "auto or 1 to 20")
        ->capture_default_str()
        ->check([](const std::string& text) {
            (void)parse_auto_or_number("--subspaces", text, 1, kMaxSubspaces);
            return std::string();
        });
    verb->add_option("--levels", arguments->levels, "Pyramid levels: auto or 1 to 8")
        ->capture_default_str()
        ->check([](const std::string& text) {
            (void)parse_auto_or_number("--levels", text, 1, kMaxLevels);
            return std::string();
        });
    verb->add_option("--neighbourhood,--neighborhood", arguments->neighbourhood,
                     "auto, order:N, correlation:N, evidence:N or nearest:N")
        ->capture_default_str()
        ->check([](const std::string& text) {
            const auto parsed = parse_neighbourhood(text);
            return parsed ? std::string() : parsed.error().message;
        });
    verb->add_option("--encoding", arguments->encoding,
                     "How files encode values: auto, srgb, gamma2.2 or linear")
        ->capture_default_str()
        ->check([](const std::string& text) {
            (void)parse_encoding(text);
            return std::string();
        });
    verb->add_flag("--skip-bad", arguments->skip_bad,
                   "Leave out unreadable images and list them, instead of failing");
    arguments->common.add_to(*verb);
    return {verb, [arguments] { return run_model(*arguments); }};
}

}  // namespace sateen::cli
