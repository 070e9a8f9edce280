// SPDX-License-Identifier: Apache-2.0
// sateen synthesise: textures from a material.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "console.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "sateen/synthesis/synthesise_direction.hpp"
#include "sateen/synthesis/torus_size.hpp"
#include "surface_maps.hpp"
#include "verbs.hpp"

namespace sateen::cli {
namespace {

/// A pattern stretched by more is worth a word.
constexpr double kNoticeableStrain = 0.02;

struct SynthesiseArguments {
    CommonArguments common;
    std::string material;
    std::string output;
    std::string size = "512x512";
    std::string offset = "0,0";
    std::string view = "0,0";
    std::string light;
    std::string format = "png";
    std::optional<std::size_t> subspace;
    int bits = 0;
    bool tileable = false;
    bool recursive = false;
    bool all = false;
    bool three_nearest = false;
    bool maps = false;
};

/// The size that was asked for, or the one near it on which the pattern is strained least.
TorusSize chosen_size(const SynthesiseArguments& arguments, const Material& material) {
    const WantedSize wanted = parse_wanted_size(arguments.size);
    return wanted.best ? best_torus(material, wanted.size.rows, wanted.size.cols)
                       : torus_of(material, wanted.size.rows, wanted.size.cols);
}

/// The light that was asked for, or the usual one.
Direction chosen_light(const SynthesiseArguments& arguments, const Material& material) {
    return arguments.light.empty() ? light_of(material)
                                   : parse_direction(arguments.light);
}

SynthesisOptions synthesis_options(const SynthesiseArguments& arguments,
                                   const TorusSize& size) {
    const Position offset = parse_position(arguments.offset);
    SynthesisOptions options;
    options.rows = size.rows;
    options.cols = size.cols;
    options.offset_row = offset.row;
    options.offset_col = offset.col;
    options.tileable = arguments.tileable || arguments.all;
    options.recursive = arguments.recursive;
    options.seed = arguments.common.seed;
    return options;
}

WriteOptions write_options(const SynthesiseArguments& arguments, Executor& executor) {
    WriteOptions options;
    options.executor = &executor;
    if (arguments.bits != 0) options.bits = arguments.bits;
    return options;
}

Result<void> write_one(const SynthesiseArguments& arguments, const Material& material,
                       const TorusSize& size, Executor& executor, Progress& progress) {
    const SynthesisOptions options = synthesis_options(arguments, size);
    SATEEN_TRY(const std::unique_ptr<ImageWriter> writer,
               ImageWriter::open(arguments.output, material.bands, options.rows,
                                 options.cols, write_options(arguments, executor)));
    const auto write = [&](std::size_t, ImageView<const float> strip) {
        return writer->write_rows(strip);
    };
    if (arguments.subspace) {
        SATEEN_CHECK(synthesise(material, *arguments.subspace, options, write, executor,
                                progress));
    } else {
        InterpolationOptions interpolation;
        interpolation.three_nearest = arguments.three_nearest;
        interpolation.reflectance = !arguments.three_nearest;
        SATEEN_TRY(const LitBlend lit,
                   lit_blend(material, parse_direction(arguments.view),
                             chosen_light(arguments, material), interpolation, executor));
        SATEEN_CHECK(synthesise(material, lit, options, write, executor, progress));
    }
    return writer->finish();
}

Result<std::vector<std::string>> write_all(const SynthesiseArguments& arguments,
                                           const Material& material,
                                           const TorusSize& size, Executor& executor,
                                           Progress& progress) {
    SATEEN_CHECK(make_folder(arguments.output));
    std::vector<std::size_t> subspaces;
    for (std::size_t k = 0; k < material.subspaces.size(); ++k) subspaces.push_back(k);
    std::vector<std::string> written;
    const auto write = [&](std::size_t k, const Image& texture) -> Result<void> {
        const std::string name = fmt::format("subspace_{:02}.{}", k, arguments.format);
        const std::string path =
            (std::filesystem::path(arguments.output) / name).string();
        SATEEN_CHECK(
            write_image(path, texture.view(), write_options(arguments, executor)));
        written.push_back(path);
        return {};
    };
    SATEEN_CHECK(synthesise_tiles(material, subspaces, synthesis_options(arguments, size),
                                  write, executor, progress));
    return written;
}

Result<void> run_synthesise(const SynthesiseArguments& arguments) {
    const auto start = std::chrono::steady_clock::now();
    SATEEN_TRY(const Material material, load_material(arguments.material));
    const TorusSize size = chosen_size(arguments, material);
    const std::unique_ptr<Executor> executor = make_executor(arguments.common.threads);
    ConsoleProgress progress;
    progress.stage("drawing");

    std::vector<std::string> written = {arguments.output};
    const std::size_t subspace = arguments.subspace.value_or(nearest_subspace(
        material, parse_direction(arguments.view), chosen_light(arguments, material)));
    if (arguments.maps) {
        SATEEN_TRY(
            written,
            draw_maps(arguments.output, material, synthesis_options(arguments, size),
                      arguments.light.empty()
                          ? std::nullopt
                          : std::optional(parse_direction(arguments.light)),
                      *executor, progress));
    } else if (arguments.all) {
        SATEEN_TRY(written, write_all(arguments, material, size, *executor, progress));
    } else {
        SATEEN_CHECK(write_one(arguments, material, size, *executor, progress));
    }

    progress.clear();
    const bool tileable = arguments.tileable || arguments.all || arguments.maps;
    if (tileable && size.strain > kNoticeableStrain) {
        const TorusSize better = best_torus(material, size.rows, size.cols);
        if (better.strain < size.strain)
            fmt::print(
                stderr,
                "sateen: the pattern is stretched by {:.1f} % to close on {}x{}; on "
                "{}x{} by {:.1f} % (--size best:{}x{})\n",
                100 * size.strain, size.cols, size.rows, better.cols, better.rows,
                100 * better.strain, size.cols, size.rows);
    }
    const std::chrono::duration<double> elapsed =
        std::chrono::steady_clock::now() - start;
    if (arguments.common.json) {
        nlohmann::ordered_json json;
        json["written"] = written;
        json["size"] = {size.cols, size.rows};
        if (tileable && material.structure) json["strain"] = size.strain;
        json["seed"] = arguments.common.seed;
        if (!arguments.all && !arguments.maps) json["subspace"] = subspace;
        json["seconds"] = elapsed.count();
        print_json(json);
    } else {
        print_drawn(arguments.output, written.size(), "texture", size.rows, size.cols,
                    elapsed.count());
    }
    return {};
}

}  // namespace

Verb add_synthesise(CLI::App& program) {
    auto arguments = std::make_shared<SynthesiseArguments>();
    CLI::App* verb = program.add_subcommand(
        "synthesise", "Draw seamless texture of any size from a material");
    verb->alias("synthesize");
    add_material(*verb, arguments->material);
    verb->add_option(
            "-o,--output", arguments->output,
            "Image file: .png, .jpg, .exr or .tif; with --all and --maps a folder")
        ->type_name("OUT")
        ->required();
    verb->add_option("--size", arguments->size,
                     "Width x height in pixels, or one number for a square;\n"
                     "best:WxH: near it, where the pattern closes best")
        ->type_name("WxH")
        ->capture_default_str()
        ->check(checked(parse_wanted_size));
    auto* offset =
        verb->add_option("--offset", arguments->offset,
                         "Top left corner of the window of the infinite plane,\n"
                         "in pixels: windows agree where they overlap")
            ->type_name("X,Y")
            ->capture_default_str()
            ->check(checked(parse_position));
    auto* tileable = verb->add_flag("--tileable", arguments->tileable,
                                    "Seamless across its own borders (toroidal)");
    auto* view = add_direction(*verb, "--view", arguments->view, "Direction in degrees")
                     ->capture_default_str();
    auto* light = add_direction(*verb, "--light", arguments->light,
                                "Direction in degrees; else 0,0, and 45,135 for\n"
                                "photographs with --surface shading");
    auto* subspace = verb->add_option("--subspace", arguments->subspace,
                                      "Number of a subspace, instead of directions")
                         ->type_name("K")
                         ->check(whole_number_up_to(kMaxSubspaces - 1));
    auto* all = verb->add_flag("--all", arguments->all,
                               "Tileable textures of every subspace, into a folder");
    auto* maps = verb->add_flag("--maps", arguments->maps,
                                "Aligned tileable maps into a folder: base_colour.png,\n"
                                "height.png and normal.png (16 bit), maps.json; with\n"
                                "--light also relit.png");
    verb->add_flag("--recursive", arguments->recursive,
                   "Draw by causal recursion, as paper-mode materials are");
    verb->add_option("--bits", arguments->bits,
                     "Bits a sample: PNG 8 or 16, EXR 16 or 32, TIFF any of them")
        ->type_name("N")
        ->check(CLI::IsMember({8, 16, 32}));
    verb->add_option("--format", arguments->format, "Of the files that --all writes")
        ->type_name("EXT")
        ->capture_default_str()
        ->check(CLI::IsMember({"png", "jpg", "exr", "tif"}))
        ->needs(all);
    verb->add_flag("--three-nearest", arguments->three_nearest,
                   "Interpolate the three nearest directions alone, as [CAR2] does");
    offset->excludes(tileable)->excludes(all);
    for (CLI::Option* other : {view, light, subspace}) other->excludes(all);
    subspace->excludes(view)->excludes(light);
    for (CLI::Option* other : {offset, view, subspace, all}) other->excludes(maps);
    arguments->common.add_to(*verb);
    verb->footer(
        "Examples:\n"
        "  sateen synthesise stone.sateen -o stone.png --size 2048 --tileable\n"
        "  sateen synthesise corduroy.sateen -o lit.exr --view 30,0 --light 45,90\n"
        "  sateen synthesise corduroy.sateen -o textures --all");
    return {verb, [arguments] { return run_synthesise(*arguments); }};
}

}  // namespace sateen::cli
