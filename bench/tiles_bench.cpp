// SPDX-License-Identifier: Apache-2.0
// What the viewer's worker is measured against (viewer/tests/bench.mjs): the tileable textures of
// all subspaces of a material, on one thread.
//
//     tiles_bench MATERIAL.sateen SIDE
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/synthesis/synthesise.hpp"

int main(int argc, char** argv) {
    using namespace sateen;
    if (argc != 3) {
        std::fprintf(stderr, "usage: tiles_bench MATERIAL.sateen SIDE\n");
        return 2;
    }
    const Result<Material> material = load_material(argv[1]);
    if (!material) {
        std::fprintf(stderr, "%s\n", material.error().message.c_str());
        return 1;
    }
    SynthesisOptions options;
    options.rows = options.cols = std::strtoul(argv[2], nullptr, 10);
    std::vector<std::size_t> all(material->subspaces.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    SerialExecutor executor;
    Progress progress;
    bench::Shortest shortest;
    constexpr int kRepeats = 15;
    for (int i = 0; i < kRepeats; ++i)
        shortest.add(bench::wall_seconds([&] {
            const Result<void> drawn = synthesise_tiles(
                *material, all, options,
                [](std::size_t, const Image&) -> Result<void> { return {}; }, executor,
                progress);
            if (!drawn) std::exit(1);
        }));
    std::printf("{\"subspaces\": %zu, \"side\": %zu, \"ms\": %.3f}\n", all.size(),
                options.rows, shortest.milliseconds());
    return 0;
}
