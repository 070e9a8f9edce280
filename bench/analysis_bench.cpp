// SPDX-License-Identifier: Apache-2.0
// Making materials: of one photograph of 800 x 800, and, where one is given, of a whole
// measurement against decoding its images once.
//
//     analysis_bench [ZIP|FOLDER]
#include <memory>
#include <string>
#include <vector>

#include "figures.hpp"
#include "generated.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/open_measurement.hpp"
#include "support/patterns.hpp"

namespace sateen::bench {
namespace {

void analyse_or_exit(const Measurement& measurement,
                     const AnalysisOptions& options = {}) {
    SerialExecutor executor;
    Progress progress;
    (void)value_or_exit(analyse(measurement, options, executor, progress));
}

double shortest_analysis(const Measurement& measurement, const AnalysisOptions& options) {
    Shortest shortest;
    for (int i = 0; i < 3; ++i)
        shortest.add(processor_seconds([&] { analyse_or_exit(measurement, options); }));
    return shortest.seconds();
}

/// With everything a model holds by default; and for one field as the papers print it.
Figure one_photograph(FieldKind field, bool modulation, const std::string& name,
                      double limit) {
    const GeneratedPhotograph photograph(800, 800);
    AnalysisOptions options;
    options.field = field;
    options.modulation = modulation;
    Figure figure = {"photograph of 800 x 800" + name,
                     shortest_analysis(photograph, options),
                     "s",
                     limit,
                     Figure::Bound::at_most,
                     {}};
    if (field == FieldKind::automatic) return figure;
    options.paper = true;
    figure.details.emplace_back("as_published_s", shortest_analysis(photograph, options));
    return figure;
}

/// With everything, of a cloth: the lattice is found and the pattern aligned.
Figure one_pattern(double limit) {
    const GeneratedPhotograph photograph(
        "knit", test::photograph_of(test::knit(), 800, 800, 1.5, 0.03, 1));
    return {"photograph of 800 x 800, with a pattern",
            shortest_analysis(photograph, {}),
            "s",
            limit,
            Figure::Bound::at_most,
            {}};
}

std::unique_ptr<Measurement> open_or_exit(const std::string& path) {
    return value_or_exit(open_measurement({&path, 1}));
}

/// One thread: the ratio is of work, not of how well it is spread.
void whole_measurement(const std::string& path, std::vector<Figure>& figures) {
    const auto decode = [&] {
        SerialExecutor executor;
        Progress progress;
        const auto measurement = open_or_exit(path);
        (void)value_or_exit(for_each_image(*measurement, false, executor, progress,
                                           [](std::size_t, const Image&) {}));
    };
    const double modelling =
        processor_seconds([&] { analyse_or_exit(*open_or_exit(path)); });
    const double memory = peak_megabytes();
    const double decoding = processor_seconds(decode);
    figures.push_back({"measurement, to decoding its images once",
                       modelling / decoding,
                       "x",
                       2.0,
                       Figure::Bound::at_most,
                       {{"model_s", modelling}, {"decode_s", decoding}}});
    figures.push_back(
        {"peak memory of a measurement", memory, "MB", 500, Figure::Bound::at_most, {}});
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    std::vector<sateen::bench::Figure> figures;
    if (argc > 1) sateen::bench::whole_measurement(argv[1], figures);
    using sateen::FieldKind;
    using sateen::bench::one_photograph;
    figures.push_back(
        one_photograph(FieldKind::automatic, true, ", bands modulated", 3.0));
    figures.push_back(sateen::bench::one_pattern(3.0));
    figures.push_back(one_photograph(FieldKind::automatic, false, "", 1.0));
    figures.push_back(one_photograph(FieldKind::car2d, false, ", car2d", 1.0));
    figures.push_back(one_photograph(FieldKind::gmrf2d, false, ", gmrf2d", 1.0));
    figures.push_back(one_photograph(FieldKind::car3d, false, ", car3d", 1.0));
    figures.push_back(one_photograph(FieldKind::sar3d, false, ", sar3d", 1.0));
    sateen::bench::print("analysis", figures);
}
