// SPDX-License-Identifier: Apache-2.0
// Drawing textures: 512 x 512 against the noise and the transforms it cannot do without,
// 15 subspaces on one thread and two, and a texture larger than memory.
//
//     synthesis_bench [SIDE]    the side of the largest texture, 32768 if not given
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "figures.hpp"
#include "generated.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/toroidal_field.hpp"

namespace sateen::bench {
namespace {

constexpr std::size_t kSide = 512;
constexpr int kRepeats = 41;

/// Noise, one forward and one inverse transform of every plane.
void draw_only_noise(const Fft2d& fft, Image& planes, SplitComplexPlane& spectrum) {
    SerialExecutor executor;
    for (std::uint32_t plane = 0; plane < planes.bands(); ++plane) {
        draw_noise(1, plane, planes.plane(plane), executor);
        fft.forward(planes.plane(plane), spectrum.view(), executor);
        fft.inverse(spectrum.view(), planes.plane(plane), executor);
    }
}

/// The first drawing and all it needs: nothing is kept from one texture to the next.
Figure one_texture(FieldKind field, const char* name) {
    AnalysisOptions analysis;
    analysis.field = field;
    const Material material = generated_material(1, analysis);
    SynthesisOptions options;
    options.rows = options.cols = kSide;
    options.tileable = true;
    const Fft2d fft = value_or_exit(Fft2d::create(kSide, kSide));
    Image planes(material.bands, kSide, kSide);
    SplitComplexPlane spectrum(kSide, fft.spectrum_cols());
    SerialExecutor executor;
    Progress progress;
    Shortest texture;
    Shortest noise;
    for (int i = 0; i < kRepeats; ++i) {
        noise.add(processor_seconds([&] { draw_only_noise(fft, planes, spectrum); }));
        texture.add(processor_seconds([&] {
            check_or_exit(synthesise(
                material, 0, options,
                [](std::size_t, ImageView<const float>) -> Result<void> { return {}; },
                executor, progress));
        }));
    }
    return {
        std::string(name) + " texture of 512 x 512, spectral, to noise and transforms",
        texture.seconds() / noise.seconds(),
        "x",
        1.6,
        Figure::Bound::at_most,
        {{"texture_ms", texture.milliseconds()},
         {"noise_and_transforms_ms", noise.milliseconds()}}};
}

double time_texture(const Material& material, bool tileable) {
    SynthesisOptions options;
    options.rows = options.cols = kSide;
    options.tileable = tileable;
    SerialExecutor executor;
    Progress progress;
    return processor_seconds([&] {
        check_or_exit(synthesise(
            material, 0, options,
            [](std::size_t, ImageView<const float>) -> Result<void> { return {}; },
            executor, progress));
    });
}

/// What the modulation of bands adds; a window needs a margin about it, too.
Figure modulated_texture(const std::string& name, bool tileable, double limit) {
    const Material plain = generated_material(1);
    const Material modulated = generated_material(1, {}, true);
    if (!modulated.modulation) {
        std::fprintf(stderr, "bench: error: the photograph is not modulated\n");
        std::exit(1);
    }
    Shortest without;
    Shortest with;
    for (int i = 0; i < kRepeats / 2; ++i) {
        without.add(time_texture(plain, tileable));
        with.add(time_texture(modulated, tileable));
    }
    return {
        name,
        with.seconds() / without.seconds(),
        "x",
        limit,
        Figure::Bound::at_most,
        {{"gaussian_ms", without.milliseconds()}, {"texture_ms", with.milliseconds()}}};
}

double time_tiles(const Material& material, std::size_t threads) {
    SynthesisOptions options;
    options.rows = options.cols = kSide;
    const std::unique_ptr<Executor> executor = make_executor(threads);
    Progress progress;
    std::vector<std::size_t> all(material.subspaces.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return wall_seconds([&] {
        check_or_exit(synthesise_tiles(
            material, all, options,
            [](std::size_t, const Image&) -> Result<void> { return {}; }, *executor,
            progress));
    });
}

Figure fifteen_subspaces() {
    const Material material = generated_material(15);
    Shortest one;
    Shortest two;
    for (int i = 0; i < kRepeats / 2; ++i) {
        one.add(time_tiles(material, 1));
        two.add(time_tiles(material, 2));
    }
    return {
        "15 subspaces of 512 x 512, two threads",
        one.seconds() / two.seconds(),
        "x",
        1.7,
        Figure::Bound::at_least,
        {{"one_thread_ms", one.milliseconds()}, {"two_threads_ms", two.milliseconds()}}};
}

double nanoseconds_a_pixel(const Material& material, std::size_t side) {
    SynthesisOptions options;
    options.rows = options.cols = side;
    SerialExecutor executor;
    Progress progress;
    const double seconds = processor_seconds([&] {
        check_or_exit(synthesise(
            material, 0, options,
            [](std::size_t, ImageView<const float>) -> Result<void> { return {}; },
            executor, progress));
    });
    return 1e9 * seconds / static_cast<double>(side * side);
}

void huge_texture(std::size_t side, std::vector<Figure>& figures) {
    const Material material = generated_material(1);
    Shortest small;
    for (int i = 0; i < 5; ++i) small.add(1e-9 * nanoseconds_a_pixel(material, 2048));
    const double huge = nanoseconds_a_pixel(material, side);
    const std::string size = std::to_string(side) + " x " + std::to_string(side);
    figures.push_back(
        {"time a pixel of " + size + " to that of 2048 x 2048",
         huge / (1e9 * small.seconds()),
         "x",
         1.3,
         Figure::Bound::at_most,
         {{"ns_a_pixel", huge}, {"small_ns_a_pixel", 1e9 * small.seconds()}}});
    figures.push_back({"peak memory of " + size,
                       peak_megabytes(),
                       "MB",
                       300,
                       Figure::Bound::at_most,
                       {}});
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    const std::size_t side = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 32768;
    // Memory first: its peak is that of the process so far.
    std::vector<sateen::bench::Figure> figures;
    sateen::bench::huge_texture(side, figures);
    using sateen::FieldKind;
    figures.push_back(sateen::bench::one_texture(FieldKind::car2d, "car2d"));
    figures.push_back(sateen::bench::one_texture(FieldKind::gmrf2d, "gmrf2d"));
    figures.push_back(sateen::bench::one_texture(FieldKind::car3d, "car3d"));
    figures.push_back(sateen::bench::one_texture(FieldKind::sar3d, "sar3d"));
    figures.push_back(sateen::bench::modulated_texture(
        "texture of 512 x 512, bands modulated, to the Gaussian one", true, 5));
    figures.push_back(sateen::bench::modulated_texture(
        "window of 512 x 512, bands modulated, to the Gaussian one", false, 5));
    figures.push_back(sateen::bench::fifteen_subspaces());
    sateen::bench::print("synthesis", figures);
}
