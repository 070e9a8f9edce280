// SPDX-License-Identifier: Apache-2.0
// What the periodic layer gives and costs: scores with and without it, independent numbers,
// bytes and processor time of each part.
//
//     structure_bench [--crop N] [--seeds N] [--sizes N,N,…] [-o FOLDER] PICTURE...
//
// A picture is a file, of which the N x N pixels at the top left are modelled, or
// pattern:NAME, made in code (tests/support/patterns.hpp). Materials with a pattern are drawn
// on the best torus near each size, the others at the first size.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "figures.hpp"
#include "generated.hpp"
#include "sateen/analysis/analyse.hpp"
#include "sateen/analysis/quality.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "sateen/synthesis/torus_size.hpp"
#include "support/patterns.hpp"

namespace sateen::bench {
namespace {

struct Options {
    std::size_t crop = 512;
    std::uint64_t seeds = 4;
    std::vector<std::size_t> sizes = {512, 448, 576};
    std::string folder;
    std::vector<std::string> pictures;
};

/// Bends and grain of the patterns made in code.
constexpr double kBend = 1.5;
constexpr double kGrain = 0.03;

Image picture_of(const std::string& name, std::size_t crop) {
    constexpr const char* kPrefix = "pattern:";
    if (name.rfind(kPrefix, 0) != 0) {
        const Image whole = value_or_exit(read_image(name));
        const std::size_t rows = std::min(crop, whole.rows());
        const std::size_t cols = std::min(crop, whole.cols());
        Image part(whole.bands(), rows, cols);
        for (std::size_t band = 0; band < whole.bands(); ++band)
            for (std::size_t r = 0; r < rows; ++r)
                std::copy_n(whole.plane(band).row(r), cols, part.plane(band).row(r));
        return part;
    }
    auto all = test::patterns();
    all.push_back(test::brick(0.35));
    all.back().name = "bricks";
    for (const test::Pattern& pattern : all)
        if (kPrefix + pattern.name == name)
            return test::photograph_of(pattern, crop, crop, kBend, kGrain, 1);
    std::fprintf(stderr, "structure_bench: no pattern %s\n", name.c_str());
    std::exit(2);
}

/// Means over seeds and sizes.
struct Outcome {
    bool found = false;
    std::size_t bytes = 0;
    double analysis_seconds = 0;
    double drawing_seconds = 0;  ///< of exactly the first size
    double strain = 0;           ///< the largest
    std::vector<double> scores;
    TextureCrossCheck cross;
    std::vector<double> components = std::vector<double>(5);
    [[nodiscard]] double score() const {
        double sum = 0;
        for (const double s : scores) sum += std::log(s);
        return std::exp(sum / static_cast<double>(scores.size()));
    }
};

/// Of a tileable texture.
double drawing_seconds(const Material& material, std::size_t size) {
    SerialExecutor executor;
    Progress progress;
    SynthesisOptions window;
    window.rows = window.cols = size;
    window.tileable = true;
    Shortest shortest;
    for (int i = 0; i < 3; ++i)
        shortest.add(processor_seconds(
            [&] { value_or_exit(synthesise(material, 0, window, executor, progress)); }));
    return shortest.seconds();
}

Outcome measure(const Image& picture, const std::string& name, bool structure,
                const Options& options, Executor& executor) {
    Outcome outcome;
    SerialExecutor serial;
    Progress progress;
    Material material;
    outcome.analysis_seconds = processor_seconds([&] {
        AnalysisOptions analysis;
        analysis.structure = structure;
        const GeneratedPhotograph photograph(name, picture);
        material =
            value_or_exit(analyse(photograph, analysis, serial, progress)).material;
    });
    outcome.found = material.structure.has_value();
    outcome.bytes = value_or_exit(pack_material(material)).size();
    outcome.drawing_seconds = drawing_seconds(material, options.sizes.front());
    std::vector<std::size_t> sizes = options.sizes;
    if (!outcome.found) sizes.resize(1);
    for (const std::size_t size : sizes) {
        const TorusSize torus = best_torus(material, size, size);
        outcome.strain = std::max(outcome.strain, torus.strain);
        const auto reference = value_or_exit(
            TextureReference::create(picture, {torus.rows, torus.cols}, executor));
        for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
            SynthesisOptions window;
            window.rows = torus.rows;
            window.cols = torus.cols;
            window.tileable = true;
            window.seed = seed;
            const Image drawn =
                value_or_exit(synthesise(material, 0, window, serial, progress));
            const TextureScore score = value_or_exit(reference.compare(drawn, executor));
            outcome.scores.push_back(score.total);
            const auto share = 1 / static_cast<double>(options.seeds * sizes.size());
            const TextureCrossCheck cross = value_or_exit(cross_check(picture, drawn));
            outcome.cross.gradient_kurtosis += share * cross.gradient_kurtosis;
            outcome.cross.blob += share * cross.blob;
            outcome.cross.patches += share * cross.patches;
            const double parts[] = {score.colour.score, score.power.score,
                                    score.autocovariance.score, score.subbands.score,
                                    score.joint.score};
            for (std::size_t i = 0; i < 5; ++i) outcome.components[i] += share * parts[i];
            if (!options.folder.empty() && seed == 1 && size == sizes.front())
                check_or_exit(write_image(
                    options.folder + "/" + name + (structure ? "" : " none") + ".png",
                    drawn.view(), {}));
        }
    }
    return outcome;
}

void print(const char* key, const Outcome& outcome) {
    std::printf(
        ", \"%s\": {\"score\": %.3f, \"bytes\": %zu, \"analysis_s\": %.2f, "
        "\"drawing_ms\": %.1f, \"strain\": %.4f, \"gradient_kurtosis\": %.3f, "
        "\"blob\": %.3f, \"patches\": %.4f",
        key, outcome.score(), outcome.bytes, outcome.analysis_seconds,
        1e3 * outcome.drawing_seconds, outcome.strain, outcome.cross.gradient_kurtosis,
        outcome.cross.blob, outcome.cross.patches);
    const char* names[] = {"colour", "power", "autocovariance", "subbands", "joint"};
    for (std::size_t i = 0; i < 5; ++i)
        std::printf(", \"%s\": %.2f", names[i], outcome.components[i]);
    std::printf(", \"scores\": [");
    for (std::size_t i = 0; i < outcome.scores.size(); ++i)
        std::printf("%s%.2f", i == 0 ? "" : ", ", outcome.scores[i]);
    std::printf("]}");
}

void run(const Options& options) {
    const auto executor = make_executor(0);
    std::printf("{\"bench\": \"structure\", \"textures\": [");
    const char* separator = "";
    for (const std::string& picture : options.pictures) {
        const std::string name =
            std::filesystem::path(picture.substr(picture.find(':') + 1)).stem().string();
        const Image image = picture_of(picture, options.crop);
        if (!options.folder.empty())
            check_or_exit(write_image(options.folder + "/" + name + " original.png",
                                      image.view(), {}));
        const Outcome with = measure(image, name, true, options, *executor);
        std::printf("%s\n  {\"texture\": \"%s\", \"found\": %s", separator, name.c_str(),
                    with.found ? "true" : "false");
        print("auto", with);
        if (with.found) print("none", measure(image, name, false, options, *executor));
        std::printf("}");
        std::fflush(stdout);
        separator = ",";
    }
    std::printf("\n]}\n");
}

std::vector<std::size_t> numbers(const std::string& list) {
    std::vector<std::size_t> result;
    for (std::size_t at = 0; at < list.size();) {
        const std::size_t end = std::min(list.find(',', at), list.size());
        result.push_back(std::stoul(list.substr(at, end - at)));
        at = end + 1;
    }
    return result;
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    sateen::bench::Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool more = i + 1 < argc;
        if (argument == "-o" && more)
            options.folder = argv[++i];
        else if (argument == "--crop" && more)
            options.crop = std::stoul(argv[++i]);
        else if (argument == "--seeds" && more)
            options.seeds = std::stoul(argv[++i]);
        else if (argument == "--sizes" && more)
            options.sizes = sateen::bench::numbers(argv[++i]);
        else
            options.pictures.push_back(argument);
    }
    if (options.pictures.empty() || options.sizes.empty() || options.seeds == 0) {
        std::fprintf(stderr,
                     "usage: structure_bench [--crop N] [--seeds N] [--sizes N,N,...] "
                     "[-o FOLDER] PICTURE...\n");
        return 2;
    }
    if (!options.folder.empty()) std::filesystem::create_directories(options.folder);
    sateen::bench::run(options);
}
