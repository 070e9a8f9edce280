// SPDX-License-Identifier: Apache-2.0
#include "model_report.hpp"

#include <fmt/format.h>

#include <vector>

#include "compare_report.hpp"
#include "comparison.hpp"
#include "field_names.hpp"
#include "html.hpp"
#include "sateen/material/file.hpp"

namespace sateen::cli {
namespace {

/// Pixels a side in the table of subspaces.
constexpr std::size_t kThumbnail = 72;

std::string row(std::string_view name, std::string_view value) {
    return fmt::format("<tr><td>{}</td><td>{}</td></tr>", name, value);
}

/// The payload bytes of the parts that describe one subspace, in a material of its own.
Result<std::size_t> bytes_of_subspace(const Material& material, std::size_t number) {
    Material alone;
    alone.sample_rows = material.sample_rows;
    alone.sample_cols = material.sample_cols;
    alone.bands = material.bands;
    alone.drawing = material.drawing;
    alone.structure = material.structure;
    alone.modulation = material.modulation;
    alone.subspaces = {material.subspaces[number]};
    alone.subspaces[0].view = alone.subspaces[0].light = 0;
    SATEEN_TRY(const auto parts, material_part_bytes(alone));
    std::size_t bytes = 0;
    for (const PartBytes& part : parts)
        for (const std::string_view own :
             {"spectral transforms", "marginals", "fields", "structure", "modulation"})
            if (part.part == own) bytes += part.bytes;
    return bytes;
}

std::size_t coefficients_in(const Subspace& subspace) {
    std::size_t count = 0;
    for (const Level& level : subspace.levels)
        for (const FieldModel& field : level.fields) count += coefficients_of(field);
    return count;
}

Result<std::string> subspace_table(const Analysis& analysis, const MeasurementInfo& info,
                                   const std::vector<Comparison>& comparisons) {
    const Material& material = analysis.material;
    std::string table =
        "<h2>Subspaces</h2>\n<table><tr><th>number</th><th>measured</th><th>drawn</th>"
        "<th class=\"text\">modelled "
        "from</th><th>images</th><th>field</th><th>levels</th>"
        "<th>coefficients</th><th>payload bytes</th><th>score</th></tr>";
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) {
        const Subspace& subspace = material.subspaces[k];
        SATEEN_TRY(const std::size_t bytes, bytes_of_subspace(material, k));
        SATEEN_TRY(const std::string measured,
                   html::picture(comparisons[k].reference, kThumbnail));
        SATEEN_TRY(const std::string drawn,
                   html::picture(comparisons[k].candidate, kThumbnail));
        table += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td "
            "class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
            "<td>{}</td><td>{:.2f}</td></tr>",
            k, measured, drawn,
            html::escaped(info.observations[analysis.representatives[k]].name),
            subspace.members, field_names({&subspace, 1}), subspace.levels.size(),
            coefficients_in(subspace), bytes, comparisons[k].score.total);
    }
    return table + "</table>\n";
}

Result<std::string> part_table(const Material& material, std::size_t bytes) {
    SATEEN_TRY(const auto parts, material_part_bytes(material));
    std::string table =
        "<h2>Bytes</h2>\n<p>Payload: what the parts hold before the file is compressed "
        "as a "
        "whole.</p>\n<table><tr><th>part</th><th>payload bytes</th></tr>";
    for (const PartBytes& part : parts)
        table += row(part.part, std::to_string(part.bytes));
    return table + fmt::format(
                       "<tr class=\"total\"><td>file, compressed</td><td>{}</td></tr>"
                       "</table>\n",
                       bytes);
}

std::string choice_table(const FieldChoice& choice) {
    if (choice.car2d + choice.gmrf2d + choice.car3d == 0 || choice.information_apart == 0)
        return {};
    std::string table =
        "<h2>Field models</h2>\n<p>Chosen for the least Bayesian information <i>n D + "
        "k</i> "
        "ln <i>n</i>, <i>D</i> Whittle's deviance of the model's spectrum from the "
        "sample's; "
        "all take as many bytes a coefficient.</p>\n<table><tr><th>model</th><th>fields"
        "</th><th>information, were all of it</th></tr>";
    const auto add = [&table](std::string_view name, std::size_t fields, double sum) {
        table += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.0f}</td></tr>", name,
                             fields, sum);
    };
    add("car2d", choice.car2d, choice.information_car2d);
    add("gmrf2d", choice.gmrf2d, choice.information_gmrf2d);
    add("better of the two, field by field", choice.car2d + choice.gmrf2d,
        choice.information_apart);
    if (choice.information_car3d != 0)
        add("car3d, planes together", choice.car3d, choice.information_car3d);
    return table + "</table>\n";
}

std::string note_list(const std::vector<std::string>& notes) {
    if (notes.empty()) return {};
    std::string list = "<h2>Notes</h2>\n<ul>";
    for (const std::string& note : notes) list += "<li>" + html::escaped(note) + "</li>";
    return list + "</ul>\n";
}

}  // namespace

Result<std::string> model_page(const Analysis& analysis, const Measurement& measurement,
                               std::size_t bytes, Executor& executor,
                               Progress& progress) {
    const MeasurementInfo& info = measurement.info();
    const Material& material = analysis.material;
    SATEEN_TRY(const auto comparisons,
               compare_subspaces(material, "drawn from the material", measurement, 0,
                                 executor, progress));
    std::string lead = fmt::format(
        "<p>{} image{} of {} × {} in {} bytes; score {:.2f}, the geometric mean over "
        "the subspaces. Options: {}.</p>\n",
        info.observations.size(), info.observations.size() == 1 ? "" : "s", info.cols,
        info.rows, bytes, geometric_mean(comparisons),
        material.provenance.options.empty() ? "the defaults"
                                            : html::escaped(material.provenance.options));
    SATEEN_TRY(const std::string subspaces, subspace_table(analysis, info, comparisons));
    SATEEN_TRY(const std::string parts, part_table(material, bytes));
    lead += subspaces + parts + choice_table(analysis.choice) + note_list(analysis.notes);
    return comparison_page("Material " + material.provenance.name, lead, comparisons);
}

}  // namespace sateen::cli
