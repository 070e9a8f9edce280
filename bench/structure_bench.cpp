// SPDX-License-Identifier: Apache-2.0
// What structure, the periodic layer and the modulation of bands, gives and costs: scores with
// and without it and of two rivals that keep the exemplar, independent numbers, bytes and
// processor time of each part.
//
//     structure_bench [--crop N] [--seeds N] [--sizes N,N,…] [--rivals] [-o FOLDER] PICTURE...
//
// A picture is a file, of which the N x N pixels at the top left are modelled, or
// pattern:NAME, made in code (tests/support/patterns.hpp). Materials with a pattern are drawn
// on the best torus near each size, the others and the rivals at the first size.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "baselines/random_phase.hpp"
#include "baselines/tiling_blending.hpp"
#include "figures.hpp"
#include "generated.hpp"
#include "sateen/analysis/analyse.hpp"
#include "sateen/analysis/quality.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/material/file.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "sateen/synthesis/torus_size.hpp"
#include "support/degradations.hpp"
#include "support/patterns.hpp"

namespace sateen::bench {
namespace {

struct Options {
    std::size_t crop = 512;
    std::uint64_t seeds = 4;
    std::vector<std::size_t> sizes = {512, 448, 576};
    bool rivals = false;
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
    all.push_back(test::pebbles());
    all.push_back(test::cracks());
    for (const test::Pattern& pattern : all)
        if (kPrefix + pattern.name == name)
            return test::photograph_of(pattern, crop, crop, kBend, kGrain, 1);
    std::fprintf(stderr, "structure_bench: no pattern %s\n", name.c_str());
    std::exit(2);
}

/// What is compared with the picture: means over seeds and sizes.
struct Scores {
    std::vector<double> each;
    TextureCrossCheck cross;
    std::vector<double> components = std::vector<double>(5);

    /// \param share  of the mean that this one is
    void add(const TextureReference& reference, const Image& picture, const Image& drawn,
             double share, Executor& executor) {
        const TextureScore score = value_or_exit(reference.compare(drawn, executor));
        each.push_back(score.total);
        const TextureCrossCheck found = value_or_exit(cross_check(picture, drawn));
        cross.gradient_kurtosis += share * found.gradient_kurtosis;
        cross.blob += share * found.blob;
        cross.patches += share * found.patches;
        const double parts[] = {score.colour.score, score.power.score,
                                score.autocovariance.score, score.subbands.score,
                                score.joint.score};
        for (std::size_t i = 0; i < 5; ++i) components[i] += share * parts[i];
    }
    [[nodiscard]] double mean() const {
        double sum = 0;
        for (const double score : each) sum += std::log(score);
        return std::exp(sum / static_cast<double>(each.size()));
    }
};

struct Outcome {
    bool patterned = false;
    bool modulated = false;
    std::size_t bytes = 0;
    std::size_t structure_bytes = 0;  ///< before compression, as is the next
    std::size_t modulation_bytes = 0;
    double analysis_seconds = 0;
    double drawing_seconds = 0;  ///< of exactly the first size
    double strain = 0;           ///< the largest
    Scores scores;
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
        analysis.structure = analysis.modulation = structure;
        const GeneratedPhotograph photograph(name, picture);
        material =
            value_or_exit(analyse(photograph, analysis, serial, progress)).material;
    });
    outcome.patterned = material.structure.has_value();
    outcome.modulated = material.modulation.has_value();
    outcome.bytes = value_or_exit(pack_material(material)).size();
    for (const PartBytes& part : value_or_exit(material_part_bytes(material))) {
        if (part.part == "structure") outcome.structure_bytes = part.bytes;
        if (part.part == "modulation") outcome.modulation_bytes = part.bytes;
    }
    outcome.drawing_seconds = drawing_seconds(material, options.sizes.front());
    std::vector<std::size_t> sizes = options.sizes;
    if (!outcome.patterned) sizes.resize(1);
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
            outcome.scores.add(reference, picture, drawn,
                               1 / static_cast<double>(options.seeds * sizes.size()),
                               executor);
            if (!options.folder.empty() && seed == 1 && size == sizes.front())
                check_or_exit(write_image(
                    options.folder + "/" + name + (structure ? "" : " none") + ".png",
                    drawn.view(), {}));
        }
    }
    return outcome;
}

using Baseline = Result<Image> (*)(const Image&, std::size_t, std::size_t, std::uint64_t);

/// \param file  for the first, without extension; or empty
Scores measure_rival(const Image& picture, Baseline baseline, const std::string& file,
                     const Options& options, Executor& executor) {
    Scores scores;
    const std::size_t size = options.sizes.front();
    const auto reference =
        value_or_exit(TextureReference::create(picture, {size, size}, executor));
    const Image exemplar = test::encoded(picture);
    for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
        const Image drawn =
            test::through_eight_bits(value_or_exit(baseline(exemplar, size, size, seed)));
        scores.add(reference, picture, drawn, 1 / static_cast<double>(options.seeds),
                   executor);
        if (!file.empty() && seed == 1)
            check_or_exit(write_image(file + ".png", drawn.view(), {}));
    }
    return scores;
}

void print(const Scores& scores) {
    std::printf(
        "\"score\": %.3f, \"gradient_kurtosis\": %.3f, \"blob\": %.3f, "
        "\"patches\": %.4f",
        scores.mean(), scores.cross.gradient_kurtosis, scores.cross.blob,
        scores.cross.patches);
    const char* names[] = {"colour", "power", "autocovariance", "subbands", "joint"};
    for (std::size_t i = 0; i < 5; ++i)
        std::printf(", \"%s\": %.2f", names[i], scores.components[i]);
    std::printf(", \"scores\": [");
    for (std::size_t i = 0; i < scores.each.size(); ++i)
        std::printf("%s%.2f", i == 0 ? "" : ", ", scores.each[i]);
    std::printf("]}");
}

void print(const char* key, const Outcome& outcome) {
    std::printf(
        ", \"%s\": {\"bytes\": %zu, \"structure_bytes\": %zu, "
        "\"modulation_bytes\": %zu, \"analysis_s\": %.2f, \"drawing_ms\": %.1f, "
        "\"strain\": %.4f, ",
        key, outcome.bytes, outcome.structure_bytes, outcome.modulation_bytes,
        outcome.analysis_seconds, 1e3 * outcome.drawing_seconds, outcome.strain);
    print(outcome.scores);
}

void print(const char* key, const Scores& scores) {
    std::printf(", \"%s\": {", key);
    print(scores);
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
        const auto yes = [](bool value) { return value ? "true" : "false"; };
        std::printf("%s\n  {\"texture\": \"%s\", \"found\": %s, \"modulated\": %s",
                    separator, name.c_str(), yes(with.patterned), yes(with.modulated));
        print("auto", with);
        if (with.patterned || with.modulated)
            print("none", measure(image, name, false, options, *executor));
        const auto rival = [&](const char* key, Baseline baseline) {
            const std::string file =
                options.folder.empty() ? "" : options.folder + "/" + name + " " + key;
            print(key, measure_rival(image, baseline, file, options, *executor));
        };
        if (options.rivals) {
            rival("random phase", baselines::random_phase);
            if (image.bands() == 3)
                rival("tiling and blending", baselines::tiling_blending);
        }
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
        if (argument == "--rivals")
            options.rivals = true;
        else if (argument == "-o" && more)
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
                     "[--rivals] [-o FOLDER] PICTURE...\n");
        return 2;
    }
    if (!options.folder.empty()) std::filesystem::create_directories(options.folder);
    sateen::bench::run(options);
}
