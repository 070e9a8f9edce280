// SPDX-License-Identifier: Apache-2.0
#include "budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <variant>

#include "sateen/io/material_file.hpp"
#include "sateen/material/file.hpp"

namespace sateen::cli {
namespace {

struct Saving {
    std::string name;
    std::function<void(AnalysisOptions&)> apply;
    /// Share of the bytes of fields that it leaves at best.
    double fields_left = 1;
};

std::size_t most_neighbours(const Material& material) {
    std::size_t most = 1;
    for (const Subspace& subspace : material.subspaces)
        for (const Level& level : subspace.levels)
            for (const FieldModel& field : level.fields)
                most = std::max(most, coefficients_of(field));
    return most;
}

/// Each includes those before it.
std::vector<Saving> savings_of(const AnalysisOptions& options, const Material& material) {
    std::vector<Saving> savings;
    const auto most = static_cast<double>(most_neighbours(material));
    if (options.field == FieldKind::automatic && options.joint &&
        std::holds_alternative<Car3d>(
            material.subspaces.front().levels.front().fields.front()))
        savings.push_back({"a field for every plane",
                           [](AnalysisOptions& o) { o.joint = false; }, 1.0 / 3});
    if (!options.neighbourhood) {
        for (const int order : {4, 2, 1}) {
            const auto count = static_cast<double>(hierarchical_half_plane(order).size());
            savings.push_back({fmt::format("neighbourhoods of order {} at most", order),
                               [order](AnalysisOptions& o) {
                                   o.neighbourhood = NeighbourhoodOptions{
                                       NeighbourhoodRule::evidence, order};
                               },
                               std::min(1.0, count / most)});
        }
    }
    const double smallest = savings.empty() ? 1.0 : savings.back().fields_left;
    const std::size_t levels = material.subspaces.front().levels.size();
    if (options.levels == 0 && levels > 3)
        savings.push_back({"3 levels", [](AnalysisOptions& o) { o.levels = 3; },
                           smallest * 3 / static_cast<double>(levels)});
    if (options.modulation && material.modulation)
        savings.push_back(
            {"no band modulation", [](AnalysisOptions& o) { o.modulation = false; }, 0});
    if (options.structure && material.structure)
        savings.push_back(
            {"no periodic layer", [](AnalysisOptions& o) { o.structure = false; }, 0});
    if (options.subspaces == 0)
        for (std::size_t k = material.subspaces.size() / 2; k > 0; k /= 2)
            savings.push_back({fmt::format("{} subspaces", k),
                               [k](AnalysisOptions& o) { o.subspaces = k; }, 0});
    return savings;
}

Result<std::size_t> stored_bytes(Analysis& analysis, const Provenance& provenance) {
    Provenance& own = analysis.material.provenance;
    own.options = provenance.options;
    own.writer = provenance.writer;
    SATEEN_TRY(const auto file, pack_material(analysis.material));
    return file.size();
}

/// The fewest bytes that a file can have with so little left of its fields.
Result<double> least_bytes(const Material& material, std::size_t bytes,
                           double fields_left) {
    SATEEN_TRY(const auto parts, material_part_bytes(material));
    double whole = 0;
    double fields = 0;
    for (const PartBytes& part : parts) {
        whole += static_cast<double>(part.bytes);
        if (part.part == "fields") fields += static_cast<double>(part.bytes);
    }
    return static_cast<double>(bytes) * (1 - fields / whole * (1 - fields_left));
}

}  // namespace

Result<BudgetedAnalysis> analyse_within(const Measurement& measurement,
                                        AnalysisOptions options, std::size_t budget,
                                        const Provenance& provenance,
                                        const RangeMap* surface, Executor& executor,
                                        Progress& progress) {
    BudgetedAnalysis result;
    SATEEN_TRY(result.analysis,
               analyse(measurement, options, executor, progress, surface));
    SATEEN_TRY(result.bytes, stored_bytes(result.analysis, provenance));
    if (budget == 0 || result.bytes <= budget) return result;

    const Material first = result.analysis.material;
    const std::size_t first_bytes = result.bytes;
    const std::vector<Saving> savings = savings_of(options, first);
    for (const Saving& saving : savings) {
        saving.apply(options);
        result.savings.push_back(saving.name);
        // A tenth is what compression can do better on the smaller file.
        SATEEN_TRY(const double least,
                   least_bytes(first, first_bytes, saving.fields_left));
        // The last is made in any case: an error says how few bytes there can be.
        const bool hopeless =
            saving.fields_left > 0 && 0.9 * least > static_cast<double>(budget);
        if (hopeless && &saving != &savings.back()) continue;
        SATEEN_TRY(result.analysis,
                   analyse(measurement, options, executor, progress, surface));
        SATEEN_TRY(result.bytes, stored_bytes(result.analysis, provenance));
        if (result.bytes <= budget) return result;
    }
    return Error{Errc::invalid_argument,
                 fmt::format("--budget {}: the smallest material of {} that the other "
                             "options allow has {} bytes",
                             budget, measurement.info().name, result.bytes)};
}

}  // namespace sateen::cli
