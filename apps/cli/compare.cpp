// SPDX-License-Identifier: Apache-2.0
// sateen compare: texture similarity of two images, or of a material and its measurement.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "compare_directions.hpp"
#include "compare_report.hpp"
#include "comparison.hpp"
#include "console.hpp"
#include "direction_summary.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/io/open_measurement.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    CommonArguments common;
    std::string reference;
    std::string candidate;
    std::string report;
    std::size_t directions = 0;
    std::size_t textures = CompareDirectionsOptions().textures;
};

/// What there is to say: textures side by side, and all directions of a measurement.
struct Findings {
    std::vector<Comparison> comparisons;
    std::optional<DirectionComparison> directions;
};

Result<Findings> compare_files(const CompareArguments& arguments, Executor& executor) {
    SATEEN_TRY(Image reference, read_image(arguments.reference));
    SATEEN_TRY(Image candidate, read_image(arguments.candidate));
    SATEEN_TRY(Comparison comparison,
               compare_images("", {arguments.reference, std::move(reference)},
                              {arguments.candidate, std::move(candidate)}, executor));
    Findings findings;
    findings.comparisons.push_back(std::move(comparison));
    return findings;
}

Result<Findings> compare_material(const std::string& material_path,
                                  const std::string& measurement_path,
                                  const CompareArguments& arguments, Executor& executor,
                                  Progress& progress) {
    SATEEN_TRY(const Material material, load_material(material_path));
    SATEEN_TRY(const std::unique_ptr<Measurement> measurement,
               open_measurement({&measurement_path, 1}, {}));
    Findings findings;
    SATEEN_TRY(findings.comparisons,
               compare_subspaces(material, material_path, *measurement,
                                 arguments.common.seed, executor, progress));
    if (!material.index.empty() && measurement->info().has_directions()) {
        const CompareDirectionsOptions options = {
            arguments.directions, arguments.textures, !arguments.report.empty(),
            arguments.common.seed};
        Result<DirectionComparison> directions =
            compare_directions(material, *measurement, options, executor, progress);
        // Scattered sets of very many directions have no table of all pairs.
        if (!directions && directions.error().code != Errc::limit_exceeded)
            return std::move(directions).error();
        if (directions) findings.directions = std::move(*directions);
    }
    return findings;
}

Json json_of(const Comparison& comparison) {
    const TextureScore& s = comparison.score;
    const auto component = [](const TextureComponent& c) {
        return Json{{"score", c.score}, {"distance", c.distance}, {"spread", c.spread}};
    };
    Json json;
    json["reference"] = comparison.reference_name;
    json["candidate"] = comparison.candidate_name;
    json["total"] = s.total;
    json["components"] = {{"colour", component(s.colour)},
                          {"power", component(s.power)},
                          {"autocovariance", component(s.autocovariance)},
                          {"subbands", component(s.subbands)},
                          {"joint", component(s.joint)}};
    json["cross_check"] = {
        {"gradient_kurtosis", comparison.cross_check.gradient_kurtosis},
        {"blob", comparison.cross_check.blob},
        {"patches", comparison.cross_check.patches}};
    json["seam_ratio"] = {{"rows", comparison.seam.rows}, {"cols", comparison.seam.cols}};
    json["pieces"] = {{"size", {s.piece_cols, s.piece_rows}},
                      {"reference", s.reference_pieces},
                      {"candidate", s.candidate_pieces}};
    return json;
}

void print_text(const std::vector<Comparison>& comparisons, double total) {
    for (const Comparison& comparison : comparisons) {
        const TextureScore& s = comparison.score;
        if (!comparison.title.empty()) fmt::print("{}: ", comparison.title);
        fmt::print(
            "colour {:.2f}  power {:.2f}  autocovariance {:.2f}  subbands {:.2f}  "
            "joint {:.2f}  total {:.2f}\n",
            s.colour.score, s.power.score, s.autocovariance.score, s.subbands.score,
            s.joint.score, s.total);
    }
    fmt::print("{:.3f}\n", total);
}

Result<void> run_compare(const CompareArguments& arguments) {
    const std::unique_ptr<Executor> executor = make_executor(arguments.common.threads);
    ConsoleProgress progress;
    const auto compare = [&]() -> Result<Findings> {
        if (looks_like_material(arguments.reference))
            return compare_material(arguments.reference, arguments.candidate, arguments,
                                    *executor, progress);
        if (looks_like_material(arguments.candidate))
            return compare_material(arguments.candidate, arguments.reference, arguments,
                                    *executor, progress);
        return compare_files(arguments, *executor);
    };
    SATEEN_TRY(const Findings findings, compare());
    const std::vector<Comparison>& comparisons = findings.comparisons;
    const double total = geometric_mean(comparisons);
    if (!arguments.report.empty()) {
        std::string lead;
        if (findings.directions) {
            SATEEN_TRY(lead, section_of(*findings.directions));
        }
        SATEEN_TRY(const std::string page,
                   comparison_page(fmt::format("Texture similarity {:.2f}", total), lead,
                                   comparisons));
        const std::vector<std::uint8_t> bytes(page.begin(), page.end());
        SATEEN_CHECK(write_file(arguments.report, bytes));
    }
    progress.clear();
    if (!arguments.common.json) {
        if (findings.directions) fmt::print("{}\n", text_of(*findings.directions));
        print_text(comparisons, total);
        return {};
    }
    Json json;
    if (comparisons.size() == 1) {
        json = json_of(comparisons.front());
    } else {
        json["total"] = total;
        for (const Comparison& c : comparisons) json["subspaces"].push_back(json_of(c));
    }
    if (findings.directions) json["directions"] = json_of(*findings.directions);
    fmt::print("{}\n", json.dump(2));
    return {};
}

}  // namespace

Verb add_compare(CLI::App& program) {
    auto arguments = std::make_shared<CompareArguments>();
    CLI::App* verb = program.add_subcommand(
        "compare", "Say how alike two textures are, or a material and its measurement");
    verb->add_option("A", arguments->reference,
                     "The reference, an image; or a measurement or a material")
        ->required();
    verb->add_option("B", arguments->candidate,
                     "What is compared with it; or the material's measurement")
        ->required();
    verb->add_option(
        "--report", arguments->report,
        "Write a page with pictures, spectra and histograms side by side (.html)");
    verb->add_option("--directions", arguments->directions,
                     "Of a measurement, compare N images spread evenly; 0 for all")
        ->type_name("N")
        ->capture_default_str()
        ->check(whole_number_up_to(kMaxPairs));
    verb->add_option("--textures", arguments->textures,
                     "Of a measurement, score the textures of N images, spread over the\n"
                     "elevations of view and light; 0 for none")
        ->type_name("N")
        ->capture_default_str()
        ->check(whole_number_up_to(kMaxPairs));
    verb->footer("1 is as close as two pieces of the reference, 2 twice as far.");
    arguments->common.add_to(*verb);
    return {verb, [arguments] { return run_compare(*arguments); }};
}

}  // namespace sateen::cli
