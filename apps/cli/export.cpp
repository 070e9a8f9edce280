// SPDX-License-Identifier: Apache-2.0
// sateen export: a material for programs that know nothing of Sateen.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "baked_maps.hpp"
#include "console.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/material/file.hpp"
#include "verbs.hpp"
#include "web_page.hpp"

namespace sateen::cli {
namespace {

struct ExportArguments {
    CommonArguments common;
    std::string material;
    std::string output;
    std::string size = "1024x1024";
};

std::string lower_extension(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string name_of(const Material& material, const std::string& path) {
    return material.provenance.name.empty() ? std::filesystem::path(path).stem().string()
                                            : material.provenance.name;
}

Result<void> write_page(const ExportArguments& arguments, const Material& material) {
    SATEEN_TRY(const auto file, read_file(arguments.material, kMaxPayloadBytes));
    SATEEN_TRY(std::string page, viewer_page());
    SATEEN_TRY(page, page_with_material(std::move(page),
                                        name_of(material, arguments.material), file));
    return write_file(arguments.output,
                      {reinterpret_cast<const std::uint8_t*>(page.data()), page.size()});
}

Result<std::vector<std::string>> write_folder(const ExportArguments& arguments,
                                              const BakedMaps& maps) {
    std::error_code failure;
    if (std::filesystem::exists(arguments.output, failure) &&
        !std::filesystem::is_directory(arguments.output, failure))
        return Error{Errc::io,
                     arguments.output + ": is a file, expected a folder, .html or .glb"};
    std::filesystem::create_directories(arguments.output, failure);
    if (failure)
        return Error{Errc::io, fmt::format("{}: cannot create the folder: {}",
                                           arguments.output, failure.message())};
    std::vector<std::string> written;
    const auto write = [&](const char* name, const Image& image,
                           const WriteOptions& options) -> Result<void> {
        const std::string path =
            (std::filesystem::path(arguments.output) / name).string();
        SATEEN_CHECK(write_image(path, image.view(), options));
        written.push_back(path);
        return {};
    };
    WriteOptions linear;
    linear.encoding = Encoding::linear;
    SATEEN_CHECK(write("base_colour.png", maps.base_colour, {}));
    SATEEN_CHECK(write("normal.png", maps.normal, linear));
    SATEEN_CHECK(write("roughness.png", maps.roughness, linear));
    if (maps.height_px) SATEEN_CHECK(write("height_px.exr", *maps.height_px, linear));
    return written;
}

Result<void> run_export(const ExportArguments& arguments) {
    if (arguments.output.empty())
        return Error{Errc::invalid_argument,
                     "--output: is empty, expected a file or a folder"};
    SATEEN_TRY(const Material material, load_material(arguments.material));
    const std::string kind = lower_extension(arguments.output);
    std::vector<std::string> written = {arguments.output};
    if (kind == ".html" || kind == ".htm") {
        SATEEN_CHECK(write_page(arguments, material));
    } else {
        const Size size = parse_size(arguments.size);
        const std::unique_ptr<Executor> executor =
            make_executor(arguments.common.threads);
        ConsoleProgress progress;
        progress.stage("baking");
        SATEEN_TRY(const BakedMaps maps,
                   bake_maps(material, {size.rows, size.cols, arguments.common.seed},
                             *executor, progress));
        if (kind == ".glb") {
            SATEEN_TRY(const auto bytes,
                       gltf_of(maps, name_of(material, arguments.material)));
            SATEEN_CHECK(write_file(arguments.output, bytes));
        } else if (kind == ".gltf") {
            return Error{
                Errc::unsupported,
                arguments.output + ": glTF is written as one file, expected .glb"};
        } else {
            SATEEN_TRY(written, write_folder(arguments, maps));
        }
    }
    if (arguments.common.json) {
        nlohmann::ordered_json json;
        json["written"] = written;
        print_json(json);
    } else {
        for (const std::string& path : written) fmt::print("{}\n", one_line(path));
    }
    return {};
}

}  // namespace

Verb add_export(CLI::App& program) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* verb = program.add_subcommand(
        "export", "Write a material as a web page, glTF, or maps for other renderers");
    add_material(*verb, arguments->material);
    verb->add_option(
            "-o,--output", arguments->output,
            ".html: one page that shows it, from a disk as well;\n"
            ".glb: glTF 2.0 of a tileable patch; anything else: a folder of maps")
        ->type_name("OUT")
        ->required();
    verb->add_option("--size", arguments->size, "Of the maps, in pixels")
        ->type_name("WxH")
        ->capture_default_str()
        ->check([](const std::string& text) {
            const Size size = parse_size(text);
            constexpr std::size_t kMaxMapSide = 8192;
            return size.rows <= kMaxMapSide && size.cols <= kMaxMapSide
                       ? std::string()
                       : fmt::format("\"{}\": maps have at most {} pixels a side", text,
                                     kMaxMapSide);
        });
    arguments->common.add_to(*verb);
    verb->footer(
        "Maps are an approximation: colour as seen and lit from above, roughness of one "
        "lobe.\n"
        "Examples:\n"
        "  sateen export corduroy.sateen -o corduroy.html\n"
        "  sateen export corduroy.sateen -o corduroy.glb --size 2048");
    return {verb, [arguments] { return run_export(*arguments); }};
}

}  // namespace sateen::cli
