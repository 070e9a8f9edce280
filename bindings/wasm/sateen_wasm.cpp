// SPDX-License-Identifier: Apache-2.0
// The runtime as flat functions, for JavaScript and anything else that loads a module.
//
// Memory goes both ways by sateen_allocate and sateen_release. A function that fails returns
// null or false; sateen_last_error then says why. There is one thread, and one last error.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "describe.hpp"
#include "sateen/material/file.hpp"
#include "sateen/synthesis/surface.hpp"
#include "sateen/synthesis/synthesise.hpp"

#define SATEEN_EXPORT(name) \
    extern "C" __attribute__((export_name(#name), used, visibility("default")))

/// Takes one finished texture, (bands, rows, cols) float; false asks to stop.
extern "C" __attribute__((import_module("sateen"), import_name("take"))) bool sateen_take(
    std::uint32_t subspace, const float* texture);

namespace {

using sateen::Errc;
using sateen::Error;
using sateen::Image;
using sateen::Material;
using sateen::Result;

/// The sides of a texture that still fits the memory of a module.
constexpr std::uint32_t kMaxSide = 4096;

std::string& last_error() {
    static std::string message;
    return message;
}

/// A material and what JavaScript reads of it in place.
struct Loaded {
    Material material;
    std::string description;
    std::vector<std::uint32_t> view_cells;   ///< packed_cells() of the views
    std::vector<std::uint32_t> light_cells;  ///< and of the lights
    std::vector<float> appearance;  ///< e of every pair, (lights, views, 4); or none
};

bool succeeded(const Result<void>& result) {
    last_error() = result ? "" : result.error().message;
    return result.has_value();
}

Result<void> draw(const Material& material, std::vector<std::size_t> subspaces,
                  const sateen::SynthesisOptions& options) {
    if (options.rows > kMaxSide || options.cols > kMaxSide)
        return Error{Errc::limit_exceeded,
                     "a texture of " + std::to_string(options.cols) + "x" +
                         std::to_string(options.rows) + " pixels, expected at most " +
                         std::to_string(kMaxSide) + " a side"};
    sateen::SerialExecutor executor;
    sateen::Progress progress;
    return sateen::synthesise_tiles(
        material, subspaces, options,
        [](std::size_t subspace, const Image& texture) -> Result<void> {
            if (sateen_take(static_cast<std::uint32_t>(subspace), texture.view().data))
                return {};
            return Error{Errc::cancelled, "cancelled while drawing"};
        },
        executor, progress);
}

Result<void> draw_range_of(const Material& material, std::uint32_t rows,
                           std::uint32_t cols, std::uint64_t seed) {
    if (!material.surface)
        return Error{Errc::invalid_argument, "the material has no surface"};
    if (rows > kMaxSide || cols > kMaxSide)
        return Error{
            Errc::limit_exceeded,
            "a range map of more than " + std::to_string(kMaxSide) + " pixels a side"};
    SATEEN_TRY(const sateen::ToroidalRange range,
               sateen::draw_toroidal_range(*material.surface, rows, cols, seed));
    (void)sateen_take(0, range.height_px.view().data);
    return {};
}

}  // namespace

SATEEN_EXPORT(sateen_allocate) void* sateen_allocate(std::size_t bytes) {
    return std::malloc(bytes);
}

SATEEN_EXPORT(sateen_release) void sateen_release(void* memory) {
    std::free(memory);
}

/// A text that ends in 0; empty after a success.
SATEEN_EXPORT(sateen_last_error) const char* sateen_last_error() {
    return last_error().c_str();
}

/// A material from the unpacked payload of a file (material/file.hpp), or null.
SATEEN_EXPORT(sateen_load)
Loaded* sateen_load(const std::uint8_t* payload, std::size_t bytes) {
    Result<Material> material = sateen::read_material({payload, bytes});
    if (!material) {
        last_error() = material.error().message;
        return nullptr;
    }
    last_error().clear();
    auto* loaded = new Loaded{std::move(*material), {}, {}, {}, {}};
    loaded->description = sateen::wasm::describe(loaded->material);
    loaded->view_cells = sateen::wasm::packed_cells(loaded->material.views);
    loaded->light_cells = sateen::wasm::packed_cells(loaded->material.lights);
    loaded->appearance = sateen::wasm::appearance_of_pairs(loaded->material);
    return loaded;
}

SATEEN_EXPORT(sateen_unload) void sateen_unload(Loaded* loaded) {
    delete loaded;
}

/// JSON, as bindings/wasm/describe.hpp says.
SATEEN_EXPORT(sateen_describe) const char* sateen_describe(const Loaded* loaded) {
    return loaded->description.c_str();
}

/// The cells of the views (0) or lights (1) in 32-bit words: see wasm::packed_cells().
SATEEN_EXPORT(sateen_cells)
const std::uint32_t* sateen_cells(const Loaded* loaded, std::uint32_t lights) {
    return (lights != 0 ? loaded->light_cells : loaded->view_cells).data();
}

/// Encoded appearance of every pair, (lights, views, 4), or null without a reflectance.
SATEEN_EXPORT(sateen_appearance) const float* sateen_appearance(const Loaded* loaded) {
    return loaded->appearance.empty() ? nullptr : loaded->appearance.data();
}

/// The range map in pixels, toroidal: one call of `take` with (1, rows, cols) as subspace 0.
SATEEN_EXPORT(sateen_draw_range)
bool sateen_draw_range(const Loaded* loaded, std::uint32_t rows, std::uint32_t cols,
                       std::uint32_t seed_low, std::uint32_t seed_high) {
    return succeeded(draw_range_of(loaded->material, rows, cols,
                                   (std::uint64_t{seed_high} << 32U) | seed_low));
}

/// The subspace of the measured pair nearest to two directions in radians.
SATEEN_EXPORT(sateen_nearest_subspace)
std::uint32_t sateen_nearest_subspace(const Loaded* loaded, float view_theta,
                                      float view_phi, float light_theta,
                                      float light_phi) {
    return static_cast<std::uint32_t>(sateen::nearest_subspace(
        loaded->material, {view_theta, view_phi}, {light_theta, light_phi}));
}

/// Tileable textures of `count` subspaces, or of all where `subspaces` is null, each given to
/// `take` as soon as it is drawn. The seed comes in halves: JavaScript has no whole 64 bits.
/// \param fields_only  standard normal fields instead of linear reflectance
SATEEN_EXPORT(sateen_draw)
bool sateen_draw(const Loaded* loaded, const std::uint32_t* subspaces,
                 std::uint32_t count, std::uint32_t rows, std::uint32_t cols,
                 std::uint32_t seed_low, std::uint32_t seed_high, bool fields_only) {
    std::vector<std::size_t> wanted(loaded->material.subspaces.size());
    if (subspaces == nullptr)
        std::iota(wanted.begin(), wanted.end(), std::size_t{0});
    else
        wanted.assign(subspaces, subspaces + count);
    sateen::SynthesisOptions options;
    options.rows = rows;
    options.cols = cols;
    options.tileable = true;
    options.fields_only = fields_only;
    options.seed = (std::uint64_t{seed_high} << 32U) | seed_low;
    return succeeded(draw(loaded->material, std::move(wanted), options));
}
