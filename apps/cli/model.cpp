// SPDX-License-Identifier: Apache-2.0
// sateen model: a measurement to a material.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "budget.hpp"
#include "console.hpp"
#include "field_names.hpp"
#include "model_report.hpp"
#include "sateen/analysis/analyse.hpp"
#include "sateen/analysis/range_map.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/atomic_folder.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/io/open_measurement.hpp"
#include "surface_maps.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

struct ModelArguments {
    CommonArguments common;
    std::vector<std::string> inputs;
    std::string output;
    std::string field = "auto";
    std::string space = "auto";
    std::string subspaces = "auto";
    std::string levels = "auto";
    std::string neighbourhood = "auto";
    std::string encoding = "auto";
    std::string report;
    std::string structure = "auto";
    std::string reflectance = "auto";
    std::string surface = "auto";
    std::string surface_out;
    std::string surface_light;
    std::size_t budget = 0;
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
    add("--space", arguments.space);
    if (arguments.paper) text += text.empty() ? "--paper" : " --paper";
    add("--subspaces", arguments.subspaces);
    add("--levels", arguments.levels);
    add("--neighbourhood", arguments.neighbourhood);
    add("--encoding", arguments.encoding);
    add("--structure", arguments.structure);
    add("--reflectance", arguments.reflectance);
    add("--surface", arguments.surface);
    if (!arguments.surface_light.empty()) add("--surface-light", arguments.surface_light);
    if (arguments.budget != 0) add("--budget", std::to_string(arguments.budget));
    if (arguments.common.seed != 0) add("--seed", std::to_string(arguments.common.seed));
    return text;
}

Result<AnalysisOptions> analysis_options(const ModelArguments& arguments) {
    AnalysisOptions options;
    options.paper = arguments.paper;
    options.subspaces = parse_auto_or_number(arguments.subspaces, 1, kMaxSubspaces);
    options.levels = parse_auto_or_number(arguments.levels, 1, kMaxLevels);
    SATEEN_TRY(options.field, parse_field_kind(arguments.field));
    if (arguments.space != "auto")
        options.space = arguments.space == "rgb" ? Space::rgb : Space::kl;
    if (arguments.neighbourhood != "auto") {
        SATEEN_TRY(options.neighbourhood, parse_neighbourhood(arguments.neighbourhood));
    }
    options.structure = options.modulation = arguments.structure == "auto";
    options.reflectance = arguments.reflectance == "auto";
    options.seed = arguments.common.seed;
    options.skip_bad = arguments.skip_bad;
    return options;
}

/// Why the automatic field is what it is.
nlohmann::ordered_json choice_json(const FieldChoice& choice) {
    nlohmann::ordered_json json = {
        {"criterion",
         "Bayesian information n D + k ln n with Whittle's deviance D, smaller "
         "is better; all models take as many bytes a coefficient"},
        {"fields",
         {{"car2d", choice.car2d}, {"gmrf2d", choice.gmrf2d}, {"car3d", choice.car3d}}},
        {"all_car2d", choice.information_car2d},
        {"all_gmrf2d", choice.information_gmrf2d},
        {"best_plane_by_plane", choice.information_apart}};
    if (choice.information_car3d != 0)
        json["all_car3d"] = choice.information_car3d;
    else
        json["not_considered"] =
            "car3d, which takes twice the bytes: for materials of one "
            "subspace, if the budget allows";
    return json;
}

void print_summary(const ModelArguments& arguments, const BudgetedAnalysis& result,
                   const std::optional<RangeMap>& range, const MeasurementInfo& info,
                   double seconds) {
    const Analysis& analysis = result.analysis;
    const Material& material = analysis.material;
    const std::size_t bytes = result.bytes;
    if (!arguments.common.json) {
        fmt::print(stderr, "{}: {} image{} of {}x{}, {} subspace{}, {} bytes, {:.2f} s\n",
                   one_line(arguments.output), info.observations.size(),
                   info.observations.size() == 1 ? "" : "s", info.cols, info.rows,
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
    json["field"] = field_names(material.subspaces);
    if (arguments.field == "auto" && !arguments.paper)
        json["choice"] = choice_json(analysis.choice);
    if (arguments.budget != 0)
        json["budget"] = {{"bytes", arguments.budget}, {"savings", result.savings}};
    json["paper"] = arguments.paper;
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        const Subspace& subspace = material.subspaces[k];
        json["subspaces"].push_back(
            {{"representative", info.observations[analysis.representatives[k]].name},
             {"members", subspace.members},
             {"field", field_names({&subspace, 1})},
             {"levels", subspace.levels.size()}});
    }
    if (!analysis.eigenvalues.empty()) json["eigenvalues"] = analysis.eigenvalues;
    if (material.surface)
        json["surface"] = {{"size", {material.surface->cols, material.surface->rows}},
                           {"shear", material.surface->shear_px},
                           {"tiles", material.surface->tiles.size()},
                           {"delit", material.surface->delit},
                           {"ambient", material.surface->ambient},
                           {"shading_share", analysis.shading_share}};
    if (range) {
        json["surface"]["estimated_bytes"] = range->estimated_bytes;
        json["surface"]["seam_ratio"] = {{"height", range->seam_ratio},
                                         {"normals", range->normal_seam_ratio}};
    }
    if (range && range->method == SurfaceMethod::shading) {
        json["surface"]["light"] = {range->light.theta / kRadiansPerDegree,
                                    range->light.phi / kRadiansPerDegree};
        json["surface"]["light_estimated"] = range->light_estimated;
    }
    json["notes"] = analysis.notes;
    print_json(json);
}

/// The range map, and what of the budget is left for the rest.
Result<std::optional<RangeMap>> find_surface(const ModelArguments& arguments,
                                             const Measurement& measurement,
                                             Executor& executor, Progress& progress) {
    RangeMapOptions options;
    SATEEN_TRY(options.method, parse_surface_method(arguments.surface));
    options.robust = !arguments.paper;
    options.skip_bad = arguments.skip_bad;
    if (!arguments.surface_light.empty())
        options.light = parse_direction(arguments.surface_light);
    if (arguments.budget != 0)
        options.budget_bytes = std::min(options.budget_bytes, arguments.budget / 2);
    SATEEN_TRY(std::optional<RangeMap> found,
               estimate_range_map(measurement, options, executor, progress));
    if (!found && !arguments.surface_out.empty())
        return Error{Errc::invalid_argument,
                     "--surface-out: no surface was estimated; --surface stereo needs "
                     "several lights, --surface shading takes one photograph"};
    return found;
}

Result<void> run_model(const ModelArguments& arguments) {
    const auto start = std::chrono::steady_clock::now();
    SATEEN_TRY(const AnalysisOptions options, analysis_options(arguments));
    for (const std::string& input : arguments.inputs)
        if (looks_like_material(input))
            return Error{Errc::bad_format,
                         input +
                             ": is a material already, expected photographs or a "
                             "measurement"};
    // Minutes of work should not end with "no such folder".
    SATEEN_TRY(const AtomicFile probe, AtomicFile::create(arguments.output));
    if (!arguments.report.empty()) {
        SATEEN_TRY(const AtomicFile other, AtomicFile::create(arguments.report));
    }
    if (!arguments.surface_out.empty()) {
        SATEEN_TRY(const AtomicFolder other, AtomicFolder::create(arguments.surface_out));
    }

    const std::unique_ptr<Executor> executor = make_executor(arguments.common.threads);
    ConsoleProgress progress;
    SATEEN_TRY(const std::unique_ptr<Measurement> measurement,
               open_measurement(arguments.inputs,
                                {.skip_bad = arguments.skip_bad,
                                 .encoding = parse_encoding(arguments.encoding)}));
    Provenance provenance;
    provenance.options = recorded_options(arguments);
    provenance.writer = "sateen " SATEEN_VERSION;
    SATEEN_TRY(std::optional<RangeMap> range,
               find_surface(arguments, *measurement, *executor, progress));
    // What surfaces take is not all entropy: tables, and what gzip does not see.
    constexpr std::size_t kTableBytes = 256;
    const std::size_t surface_bytes =
        range ? range->estimated_bytes + range->estimated_bytes / 8 + kTableBytes : 0;
    if (range && arguments.budget != 0 && surface_bytes > arguments.budget / 2)
        range.reset();
    SATEEN_TRY(BudgetedAnalysis result,
               analyse_within(*measurement, options, arguments.budget, provenance,
                              range ? &*range : nullptr, *executor, progress));
    Analysis& analysis = result.analysis;
    if (range) {
        analysis.notes.insert(analysis.notes.end(), range->notes.begin(),
                              range->notes.end());
        if (!arguments.surface_out.empty()) {
            SATEEN_TRY(const auto written,
                       write_maps(arguments.surface_out, *range,
                                  measurement->info().pixels_per_mm, *executor));
        }
    }
    SATEEN_TRY(const std::size_t bytes,
               save_material(arguments.output, analysis.material));
    result.bytes = bytes;
    if (!arguments.report.empty()) {
        SATEEN_TRY(const std::string page,
                   model_page(analysis, *measurement, bytes, *executor, progress));
        SATEEN_CHECK(write_file(arguments.report,
                                std::vector<std::uint8_t>(page.begin(), page.end())));
    }

    progress.clear();
    for (const std::string& saving : result.savings)
        fmt::print(stderr, "sateen: --budget {}: {}\n", arguments.budget, saving);
    for (const std::string& note : analysis.notes)
        fmt::print(stderr, "sateen: {}\n", one_line(note));
    const std::chrono::duration<double> elapsed =
        std::chrono::steady_clock::now() - start;
    print_summary(arguments, result, range, measurement->info(), elapsed.count());
    return {};
}

}  // namespace

Verb add_model(CLI::App& program) {
    auto arguments = std::make_shared<ModelArguments>();
    CLI::App* verb = program.add_subcommand(
        "model", "Analyse a measurement or photographs and write the material");
    verb->add_option("INPUT", arguments->inputs,
                     "A UBO2003 or ATRIUM zip or folder, a folder with\n"
                     "directions.csv, an RTI .lp file, or photographs of one\n"
                     "material")
        ->type_name("")
        ->required();
    verb->add_option("-o,--output", arguments->output, "The material to write")
        ->type_name("NAME.sateen")
        ->required();
    verb->add_option("--field", arguments->field, "Random field model")
        ->check(CLI::IsMember({"auto", "car2d", "gmrf2d", "car3d", "sar3d"}))
        ->capture_default_str();
    verb->add_option("--space", arguments->space,
                     "Planes of car3d and sar3d: kl (auto), or rgb, as with --paper")
        ->check(CLI::IsMember({"auto", "kl", "rgb"}))
        ->capture_default_str();
    verb->add_flag(
        "--paper", arguments->paper,
        "As published: 3 neighbours, 3 levels, no marginal\ncurves, causal recursion");
    verb->add_option("--subspaces", arguments->subspaces, "auto or 1 to 20")
        ->type_name("K")
        ->capture_default_str()
        ->check([](const std::string& text) {
            (void)parse_auto_or_number(text, 1, kMaxSubspaces);
            return std::string();
        });
    verb->add_option("--levels", arguments->levels, "Pyramid levels: auto or 1 to 8")
        ->type_name("L")
        ->capture_default_str()
        ->check([](const std::string& text) {
            (void)parse_auto_or_number(text, 1, kMaxLevels);
            return std::string();
        });
    verb->add_option("--neighbourhood,--neighborhood", arguments->neighbourhood,
                     "auto, order:N, correlation:N, evidence:N or nearest:N")
        ->type_name("RULE")
        ->capture_default_str()
        ->check([](const std::string& text) {
            const auto parsed = parse_neighbourhood(text);
            return parsed ? std::string() : parsed.error().message;
        });
    verb->add_option(
            "--structure", arguments->structure,
            "Patterns that repeat and bands that vary: auto, or none for Gaussian\n"
            "fields alone")
        ->type_name("KIND")
        ->check(CLI::IsMember({"auto", "none"}))
        ->capture_default_str();
    verb->add_option("--reflectance", arguments->reflectance,
                     "Mean colour and contrast of every pair of directions: auto,\n"
                     "or none, as with --paper: 4 to 12 KB less")
        ->type_name("KIND")
        ->check(CLI::IsMember({"auto", "none"}))
        ->capture_default_str();
    verb->add_option("--surface", arguments->surface,
                     "Range map: auto (stereo where one view has five lights),\n"
                     "stereo, shading (of one photograph), or none")
        ->type_name("KIND")
        ->check(CLI::IsMember({"auto", "stereo", "shading", "none"}))
        ->capture_default_str();
    add_direction(*verb, "--surface-light", arguments->surface_light,
                  "Of the photograph, for --surface shading; else estimated");
    verb->add_option("--surface-out", arguments->surface_out,
                     "Write the estimated height, normal and albedo maps")
        ->type_name("DIR");
    verb->add_option("--encoding", arguments->encoding,
                     "How files encode values: auto, srgb, gamma2.2 or linear")
        ->type_name("CURVE")
        ->capture_default_str()
        ->check([](const std::string& text) {
            (void)parse_encoding(text);
            return std::string();
        });
    verb->add_option("--budget", arguments->budget,
                     "Most bytes of the file: fields, levels and subspaces are given\n"
                     "up as needed, and listed")
        ->type_name("BYTES")
        ->check(whole_number_up_to(std::uint64_t{1} << 32U));
    verb->add_option("--report", arguments->report,
                     "Write a page with every subspace beside its measurement,\n"
                     "bytes and scores")
        ->type_name("R.html");
    verb->add_flag("--skip-bad", arguments->skip_bad,
                   "Leave out unreadable images and list them, instead of failing");
    arguments->common.add_to(*verb);
    verb->footer(
        "Examples:\n"
        "  sateen model stone.jpg -o stone.sateen\n"
        "  sateen model UBO_CORDUROY256.zip -o corduroy.sateen");
    return {verb, [arguments] { return run_model(*arguments); }};
}

}  // namespace sateen::cli
