// SPDX-License-Identifier: Apache-2.0
// The runtime as flat functions, for JavaScript and anything else that loads a module.
//
// Memory goes both ways by sateen_allocate and sateen_release. A function that fails returns
// null or false; sateen_last_error then says why. There is one thread, and one last error.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "describe.hpp"
#include "sateen/material/cell_table.hpp"
#include "sateen/material/file.hpp"
#include "sateen/synthesis/interpolate.hpp"
#include "sateen/synthesis/surface.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/periodic_layer.hpp"

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
/// And of those that all textures are held of at a time.
constexpr std::uint32_t kMaxMomentSide = 512;

std::uint64_t whole(std::uint32_t low, std::uint32_t high) {
    return (std::uint64_t{high} << 32U) | low;
}

std::string& last_error() {
    static std::string message;
    return message;
}

/// A material and what JavaScript reads of it in place.
struct Loaded {
    Material material;
    Material
        fields;  ///< the same without its pattern: what is Gaussian before its curves
    std::string description;
    std::array<std::vector<std::uint32_t>, 2> cells;  ///< of the views, of the lights
    std::vector<std::uint8_t> index;                  ///< complete_index()
    std::vector<float> appearance;  ///< e of every pair, (lights, views, 4); or none
    std::vector<float> table;       ///< last asked for: of a pattern, or of moments
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

Material without_pattern(Material material) {
    material.structure.reset();
    for (sateen::Subspace& subspace : material.subspaces) subspace.structure.reset();
    return material;
}

/// B'⁻¹ D of rows and of columns, then B'⁻¹ by rows: the pattern's phase is B'⁻¹ x + that.
Result<void> draw_phase_of(const Material& material, std::uint32_t rows,
                           std::uint32_t cols, std::uint64_t seed) {
    if (!material.structure)
        return Error{Errc::invalid_argument, "the material has no pattern"};
    if (rows == 0 || cols == 0 || rows > kMaxSide || cols > kMaxSide)
        return Error{Errc::limit_exceeded, "a pattern of 1 to " +
                                               std::to_string(kMaxSide) +
                                               " pixels a side was expected"};
    const sateen::PeriodicLayer& layer = material.structure->periodic;
    sateen::SerialExecutor executor;
    const sateen::Period period = {static_cast<std::int32_t>(rows),
                                   static_cast<std::int32_t>(cols)};
    SATEEN_TRY(const sateen::PeriodicPhase phase,
               sateen::PeriodicPhase::create(layer, seed, period, executor));
    const sateen::PeriodicPhase::Window window(phase, 0, 0, rows, cols, executor);
    const sateen::LatticeMap map = sateen::closed_lattice(layer, rows, cols);
    std::vector<float> out(2U * rows * cols);
    std::vector<double> u(cols);
    std::vector<double> v(cols);
    for (std::size_t r = 0; r < rows; ++r) {
        window.phases(r, u, v);
        for (std::size_t c = 0; c < cols; ++c) {
            const auto straight =
                map.to_cell(static_cast<double>(r), static_cast<double>(c));
            out[r * cols + c] = static_cast<float>(u[c] - straight[0]);
            out[(rows + r) * cols + c] = static_cast<float>(v[c] - straight[1]);
        }
    }
    const auto down = map.to_cell(1, 0);
    const auto across = map.to_cell(0, 1);
    for (const double x : {down[0], across[0], down[1], across[1]})
        out.push_back(static_cast<float>(x));
    (void)sateen_take(0, out.data());
    return {};
}

/// mean, then shape, (subspaces, 4) each; then covariance, (subspaces, subspaces).
Result<std::vector<float>> moments_of(const Material& material, std::uint32_t rows,
                                      std::uint32_t cols, std::uint64_t seed) {
    if (rows > kMaxMomentSide || cols > kMaxMomentSide)
        return Error{Errc::limit_exceeded, "moments of textures of more than " +
                                               std::to_string(kMaxMomentSide) +
                                               " pixels a side"};
    sateen::SynthesisOptions options;
    options.rows = rows;
    options.cols = cols;
    options.tileable = true;
    options.seed = seed;
    std::vector<std::size_t> all(material.subspaces.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<Image> textures;
    sateen::SerialExecutor executor;
    sateen::Progress progress;
    SATEEN_CHECK(sateen::synthesise_tiles(
        material, all, options,
        [&](std::size_t, Image texture) -> Result<void> {
            textures.push_back(std::move(texture));
            return {};
        },
        executor, progress));
    const sateen::TextureMoments moments = sateen::texture_moments(textures);
    std::vector<float> out;
    for (const std::array<float, 3>& mean : moments.mean) {
        out.insert(out.end(), mean.begin(), mean.end());
        out.push_back(0);
    }
    for (const std::array<float, 4>& shape : moments.shape)
        out.insert(out.end(), shape.begin(), shape.end());
    out.insert(out.end(), moments.covariance.begin(), moments.covariance.end());
    return out;
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
    auto* loaded = new Loaded;
    loaded->material = std::move(*material);
    loaded->fields = without_pattern(loaded->material);
    loaded->description = sateen::wasm::describe(loaded->material);
    loaded->cells = {sateen::wasm::packed_cells(loaded->material.views),
                     sateen::wasm::packed_cells(loaded->material.lights)};
    loaded->index = sateen::wasm::complete_index(loaded->material);
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
    return loaded->cells[lights != 0 ? 1 : 0].data();
}

/// The subspace of every pair, (lights, views) bytes, measured or not; or null.
SATEEN_EXPORT(sateen_index) const std::uint8_t* sateen_index(const Loaded* loaded) {
    return loaded->index.empty() ? nullptr : loaded->index.data();
}

/// The cells of the pattern of a subspace, (rows, cols, 9) as the description says: m of the
/// three planes, then s, then l of the planes 1 from 0, 2 from 0, 2 from 1. Null without a pattern. Holds until the next table is asked for.
SATEEN_EXPORT(sateen_pattern)
const float* sateen_pattern(Loaded* loaded, std::uint32_t subspace) {
    const Material& material = loaded->material;
    if (!material.structure || subspace >= material.subspaces.size()) return nullptr;
    const sateen::CellTable table(material.structure->periodic,
                                  material.subspaces[subspace].structure->cells);
    const float* first = table.site(0, 0);
    loaded->table.assign(first, first + table.rows() * table.cols() * table.kValues);
    return loaded->table.data();
}

/// Moments of the tileable textures of all subspaces (synthesis/interpolate.hpp): mean
/// and shape, (subspaces, 4) each, and covariance, (subspaces, subspaces). Null after a failure.
SATEEN_EXPORT(sateen_moments)
const float* sateen_moments(Loaded* loaded, std::uint32_t rows, std::uint32_t cols,
                            std::uint32_t seed_low, std::uint32_t seed_high) {
    Result<std::vector<float>> moments =
        moments_of(loaded->material, rows, cols, whole(seed_low, seed_high));
    if (!moments) {
        last_error() = moments.error().message;
        return nullptr;
    }
    loaded->table = std::move(*moments);
    return loaded->table.data();
}

/// The pattern's phase beyond its lattice on a torus, one call of `take` with (2, rows, cols) and
/// the inverse of the lattice that closes on it, four numbers by rows.
SATEEN_EXPORT(sateen_draw_phase)
bool sateen_draw_phase(const Loaded* loaded, std::uint32_t rows, std::uint32_t cols,
                       std::uint32_t seed_low, std::uint32_t seed_high) {
    return succeeded(
        draw_phase_of(loaded->material, rows, cols, whole(seed_low, seed_high)));
}

/// Encoded appearance of every pair, (lights, views, 4), or null without a reflectance.
SATEEN_EXPORT(sateen_appearance) const float* sateen_appearance(const Loaded* loaded) {
    return loaded->appearance.empty() ? nullptr : loaded->appearance.data();
}

/// The range map in pixels, toroidal: one call of `take` with (1, rows, cols) as subspace 0.
SATEEN_EXPORT(sateen_draw_range)
bool sateen_draw_range(const Loaded* loaded, std::uint32_t rows, std::uint32_t cols,
                       std::uint32_t seed_low, std::uint32_t seed_high) {
    return succeeded(
        draw_range_of(loaded->material, rows, cols, whole(seed_low, seed_high)));
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
/// \param fields_only  standard normal fields instead of linear reflectance; of a pattern the fields
///                     that vary it
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
    options.seed = whole(seed_low, seed_high);
    return succeeded(draw(fields_only ? loaded->fields : loaded->material,
                          std::move(wanted), options));
}
