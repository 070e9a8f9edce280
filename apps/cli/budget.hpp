// SPDX-License-Identifier: Apache-2.0
// A material of no more than so many bytes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sateen/analysis/analyse.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/progress.hpp"
#include "sateen/core/result.hpp"

namespace sateen::cli {

struct BudgetedAnalysis {
    Analysis analysis;
    std::size_t bytes = 0;             ///< of the file, with the provenance given
    std::vector<std::string> savings;  ///< what had to be given up, in words
};

/// Analyses, and where the file would have more than `budget` bytes analyses again with
/// smaller neighbourhoods, fewer levels and fewer subspaces, in this order: it is that of
/// what they cost in looks for the bytes that they save. What the options fix stays.
/// \param budget  0: any size
/// \param provenance  options and writer, which the file holds as well
/// \param surface     as for analyse()
/// \error as analyse(); invalid_argument where even the smallest is larger, with its size
/// \cost one analysis a saving that is tried; those that cannot suffice are passed over
[[nodiscard]] Result<BudgetedAnalysis> analyse_within(
    const Measurement& measurement, AnalysisOptions options, std::size_t budget,
    const Provenance& provenance, const RangeMap* surface, Executor& executor,
    Progress& progress);

}  // namespace sateen::cli
