// SPDX-License-Identifier: Apache-2.0
// What a user would pick instead, side by side: score, seam, seconds of processor time, and
// the bytes that must be kept to draw again.
//
//     rivals_bench IMAGE... [-o FOLDER]    FOLDER: where the 512 x 512 results go
//
// G'MIC's syntexturize (random phase) and syntexturize_matchpatch run where `gmic` is
// installed.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
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
#include "sateen/io/open_measurement.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "support/degradations.hpp"

namespace sateen::bench {
namespace {

constexpr std::size_t kSide = 512;

struct Drawn {
    Image image;
    std::size_t bytes = 0;  ///< kept between measuring and drawing
    double seconds = 0;
};

double children_seconds() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Drawn by_sateen(const std::string& path, bool paper) {
    Drawn drawn;
    drawn.seconds = processor_seconds([&] {
        SerialExecutor executor;
        Progress progress;
        AnalysisOptions options;
        options.paper = paper;
        const auto photograph = value_or_exit(open_measurement({&path, 1}));
        const Material material =
            value_or_exit(analyse(*photograph, options, executor, progress)).material;
        drawn.bytes = value_or_exit(pack_material(material)).size();
        SynthesisOptions window;
        window.rows = window.cols = kSide;
        window.tileable = !paper;
        drawn.image = value_or_exit(synthesise(material, 0, window, executor, progress));
    });
    return drawn;
}

using Baseline = std::function<Result<Image>(const Image&)>;

Drawn by_baseline(const std::string& path, const Baseline& baseline) {
    Drawn drawn;
    drawn.seconds = processor_seconds([&] {
        const Image exemplar = value_or_exit(read_image(path));
        drawn.image =
            test::through_eight_bits(value_or_exit(baseline(test::encoded(exemplar))));
    });
    drawn.bytes = std::filesystem::file_size(path);
    return drawn;
}

bool have_gmic() {
    return std::system("command -v gmic > /dev/null 2>&1") == 0;
}

Drawn by_gmic(const std::string& path, const std::string& verb) {
    const std::string out =
        (std::filesystem::temp_directory_path() / "sateen_rival.png").string();
    const double before = children_seconds();
    const std::string command =
        "gmic '" + path + "' " + verb + " -c 0,255 -o '" + out + "' > /dev/null 2>&1";
    if (std::system(command.c_str()) != 0) return {};
    Drawn drawn;
    drawn.seconds = children_seconds() - before;
    drawn.image = value_or_exit(read_image(out));
    drawn.bytes = std::filesystem::file_size(path);
    std::filesystem::remove(out);
    return drawn;
}

struct Method {
    std::string name;
    std::function<Drawn(const std::string&)> draw;
};

std::vector<Method> methods() {
    std::vector<Method> all = {
        {"sateen", [](const std::string& path) { return by_sateen(path, false); }},
        {"sateen --paper", [](const std::string& path) { return by_sateen(path, true); }},
        {"random phase",
         [](const std::string& path) {
             return by_baseline(path, [](const Image& image) {
                 return baselines::random_phase(image, kSide, kSide, 1);
             });
         }},
        {"tiling and blending", [](const std::string& path) {
             return by_baseline(path, [](const Image& image) {
                 return baselines::tiling_blending(image, kSide, kSide, 1);
             });
         }}};
    if (have_gmic())
        for (const char* verb : {"syntexturize", "syntexturize_matchpatch"})
            all.push_back({std::string("gmic ") + verb, [verb](const std::string& path) {
                               return by_gmic(path, std::string(verb) + " 512,512");
                           }});
    return all;
}

struct Sums {
    double log_score = 0;
    double seam = 0;
    double seconds = 0;
    double bytes = 0;
    int count = 0;
};

void run(const std::vector<std::string>& paths, const std::string& folder) {
    const auto executor = make_executor(0);
    std::map<std::string, Sums> sums;
    std::printf("{\"bench\": \"rivals\", \"textures\": [");
    const char* separator = "";
    for (const std::string& path : paths) {
        const std::string stem = std::filesystem::path(path).stem().string();
        const auto reference = value_or_exit(TextureReference::create(
            value_or_exit(read_image(path)), {kSide, kSide}, *executor));
        for (const Method& method : methods()) {
            const Drawn drawn = method.draw(path);
            if (drawn.image.empty()) continue;
            const double score =
                value_or_exit(reference.compare(drawn.image, *executor)).total;
            const SeamRatio seams = seam_ratio(drawn.image.view());
            const double seam = std::max(seams.rows, seams.cols);
            std::printf(
                "%s\n  {\"texture\": \"%s\", \"method\": \"%s\", \"score\": %.3f, "
                "\"seam\": %.3f, \"seconds\": %.3f, \"bytes\": %zu}",
                separator, stem.c_str(), method.name.c_str(), score, seam, drawn.seconds,
                drawn.bytes);
            separator = ",";
            Sums& sum = sums[method.name];
            sum.log_score += std::log(score);
            sum.seam += seam;
            sum.seconds += drawn.seconds;
            sum.bytes += static_cast<double>(drawn.bytes);
            ++sum.count;
            if (!folder.empty())
                check_or_exit(
                    write_image(folder + "/" + stem + " " + method.name + ".png",
                                drawn.image.view(), {}));
        }
    }
    std::printf("\n], \"mean\": [");
    separator = "";
    for (const Method& method : methods()) {
        const Sums& sum = sums[method.name];
        if (sum.count == 0) continue;
        std::printf(
            "%s\n  {\"method\": \"%s\", \"score\": %.3f, \"seam\": %.3f, "
            "\"seconds\": %.3f, \"bytes\": %.0f}",
            separator, method.name.c_str(), std::exp(sum.log_score / sum.count),
            sum.seam / sum.count, sum.seconds / sum.count, sum.bytes / sum.count);
        separator = ",";
    }
    std::printf("\n]}\n");
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    std::vector<std::string> paths;
    std::string folder;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "-o" && i + 1 < argc)
            folder = argv[++i];
        else
            paths.push_back(argument);
    }
    if (paths.empty()) {
        std::fprintf(stderr, "usage: rivals_bench IMAGE... [-o FOLDER]\n");
        return 2;
    }
    if (!folder.empty()) std::filesystem::create_directories(folder);
    sateen::bench::run(paths, folder);
}
