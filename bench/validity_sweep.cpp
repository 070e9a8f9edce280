// SPDX-License-Identifier: Apache-2.0
// No field is ever invalid: every model, order and number of levels on real pictures, drawn
// at sizes from 64 to 1000, even, odd and prime. What is checked of each texture: all values
// finite; the variance of its planes, on the torus and in a window of the infinite plane; no
// seam across the wrap of the torus.
//
// The variance of a window scatters about the field's. It is judged by its standard error,
//
//     Var(s²) = 2/n Σ_h R(h)² = 2/n mean_t E_t²,
//
// because a field with clouds of 60 pixels has no more than 200 of them in 1000 x 640: those
// beyond 5 % are counted, and of them those beyond 4 standard errors, the invalid ones. On the
// torus a wrap whose step is the largest happens once in as many textures as there are rows: a
// seam is one that shows for other seeds as well.
//
//     validity_bench IMAGE...
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "generated.hpp"
#include "sateen/analysis/analyse.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/open_measurement.hpp"
#include "sateen/synthesis/synthesise.hpp"
#include "synthesis/spectral_density.hpp"

namespace sateen::bench {
namespace {

/// Of the square around the middle: textures are larger than some of the pictures.
class Crop final : public Measurement {
  public:
    Crop(const Image& image, std::size_t side) : image_(image.bands(), side, side) {
        for (std::size_t band = 0; band < image.bands(); ++band)
            for (std::size_t r = 0; r < side; ++r)
                std::copy_n(image.plane(band).row((image.rows() - side) / 2 + r) +
                                (image.cols() - side) / 2,
                            side, image_.plane(band).row(r));
        info_.name = "crop";
        info_.layout = "photograph";
        info_.rows = info_.cols = side;
        info_.bands = image.bands();
        info_.observations.resize(1);
        info_.observations[0].name = "crop";
    }
    [[nodiscard]] const MeasurementInfo& info() const override { return info_; }
    [[nodiscard]] Result<Image> read(std::size_t) const override { return image_; }

  private:
    Image image_;
    MeasurementInfo info_;
};

struct Tally {
    std::size_t drawn = 0;
    std::size_t not_finite = 0;
    std::size_t seams = 0;
    std::size_t far_torus = 0;
    std::size_t far_plane = 0;
    std::size_t invalid = 0;  ///< of them, beyond 4 standard errors
    double worst_torus = 1;
    double worst_plane = 1;
};

/// Mean variance of the Gaussian planes that vary, 1 in a valid field.
double plane_variance(const Image& planes, const Subspace& subspace, bool& finite) {
    double sum = 0;
    std::size_t varying = 0;
    for (std::size_t plane = 0; plane < planes.bands(); ++plane) {
        double square = 0;
        for (std::size_t i = 0; i < planes.plane_size(); ++i) {
            const auto value = static_cast<double>(planes.plane(plane).data[i]);
            finite = finite && std::isfinite(value);
            square += value * value;
        }
        if (subspace.marginals[plane].scale == 0) continue;
        sum += square / static_cast<double>(planes.plane_size());
        ++varying;
    }
    return varying == 0 ? 1 : sum / static_cast<double>(varying);
}

/// The standard error of plane_variance() of so many sites.
double standard_error(const Material& material, std::size_t sites, Executor& executor) {
    constexpr std::size_t kSide = 512;
    const Subspace& subspace = material.subspaces[0];
    const std::size_t d = subspace.marginals.size();
    const bool joint = planes_of(subspace.levels.front().fields.front()) > 1;
    std::size_t varying = 0;
    double sum = 0;
    for (std::size_t plane = 0; plane < d; plane += joint ? d : 1) {
        const PlaneField field{subspace.levels, plane,
                               static_cast<double>(material.sample_rows),
                               static_cast<double>(material.sample_cols), joint ? d : 1};
        Image E = spectral_density(field, kSide, kSide, executor);
        for (std::size_t k = 0; k < E.bands(); ++k)
            suppress_unmeasured(field, E.plane(k), kSide);
        std::vector<double> variances;
        for (std::size_t i = 0; i < field.planes; ++i) {
            const double variance = mean_density(E.plane(i * (field.planes + 1)), kSide);
            variances.push_back(variance);
            if (variance > 0) ++varying;
        }
        for (std::size_t k = 0; k < E.bands(); ++k) {
            for (float& value : std::span(E.plane(k).data, E.plane_size()))
                value *= value;
            const double product =
                variances[k / field.planes] * variances[k % field.planes];
            // Both the real and the imaginary part of an element stand for two elements.
            const double times = k % (field.planes + 1) == 0 ? 1 : 2;
            if (product > 0) sum += times * mean_density(E.plane(k), kSide) / product;
        }
    }
    const auto n = static_cast<double>(sites);
    const auto planes = static_cast<double>(varying);
    return varying == 0 ? 0 : std::sqrt(2 / n * sum) / planes;
}

/// Whether the mean step across the wrap is larger than any between two rows, or columns, of
/// the texture. The ratio to the mean step says nothing on a weave, where steps differ.
bool wrap_stands_out(const Image& planes) {
    const auto stands_out = [&](std::size_t lines, const auto& step) {
        double most = 0;
        for (std::size_t i = 0; i + 1 < lines; ++i) most = std::max(most, step(i, i + 1));
        return step(lines - 1, 0) > 1.1 * most;
    };
    const std::size_t rows = planes.rows();
    const std::size_t cols = planes.cols();
    return stands_out(rows,
                      [&](std::size_t a, std::size_t b) {
                          double sum = 0;
                          for (std::size_t band = 0; band < planes.bands(); ++band)
                              for (std::size_t c = 0; c < cols; ++c)
                                  sum += std::abs(static_cast<double>(
                                      planes(band, a, c) - planes(band, b, c)));
                          return sum;
                      }) ||
           stands_out(cols, [&](std::size_t a, std::size_t b) {
               double sum = 0;
               for (std::size_t band = 0; band < planes.bands(); ++band)
                   for (std::size_t r = 0; r < rows; ++r)
                       sum += std::abs(
                           static_cast<double>(planes(band, r, a) - planes(band, r, b)));
               return sum;
           });
}

Image drawn(const Material& material, const SynthesisOptions& options,
            Executor& executor) {
    Progress progress;
    return value_or_exit(synthesise(material, 0, options, executor, progress));
}

void draw(const Material& material, std::size_t side, bool tileable, Tally& tally,
          Executor& executor) {
    SynthesisOptions options;
    options.rows = side;
    options.cols = side > 900 ? side - 360 : side;
    options.tileable = tileable;
    options.fields_only = true;
    const Image planes = drawn(material, options, executor);
    bool finite = true;
    const double variance = plane_variance(planes, material.subspaces[0], finite);
    ++tally.drawn;
    if (!finite) ++tally.not_finite;
    double& worst = tileable ? tally.worst_torus : tally.worst_plane;
    if (std::abs(std::log(variance)) > std::abs(std::log(worst))) worst = variance;
    if (std::abs(variance - 1) > 0.05) {
        ++(tileable ? tally.far_torus : tally.far_plane);
        const double error = standard_error(material, planes.plane_size(), executor);
        if (tileable || std::abs(variance - 1) > 4 * error) ++tally.invalid;
    }
    if (!tileable || !wrap_stands_out(planes)) return;
    std::size_t again = 0;
    for (options.seed = 1; options.seed <= 4; ++options.seed)
        if (wrap_stands_out(drawn(material, options, executor))) ++again;
    if (again >= 2) ++tally.seams;
}

void sweep(const std::string& path, FieldKind field, const char* name,
           Executor& executor) {
    const Image image = value_or_exit(read_image(path));
    const Crop crop(image, std::min<std::size_t>({256, image.rows(), image.cols()}));
    Tally tally;
    Progress progress;
    for (int order = 1; order <= 8; ++order)
        for (std::size_t levels = 1; levels <= 5; ++levels) {
            AnalysisOptions options;
            options.field = field;
            options.levels = levels;
            options.neighbourhood = NeighbourhoodOptions{NeighbourhoodRule::order, order};
            options.structure = false;
            options.modulation = false;  // its planes are of no variance 1, by design
            const Material material =
                value_or_exit(analyse(crop, options, executor, progress)).material;
            // A size that one transform draws, and one that it does not or a window.
            const std::size_t turn = static_cast<std::size_t>(order) + levels;
            constexpr std::size_t kWhole[] = {64, 250, 1000, 81};
            constexpr std::size_t kOther[] = {97, 333, 999};
            draw(material, kWhole[turn % 4], true, tally, executor);
            if (turn % 2 == 0)
                draw(material, kOther[turn / 2 % 3], true, tally, executor);
            else
                draw(material, 1000, false, tally, executor);
        }
    std::printf(
        "{\"picture\": \"%s\", \"model\": \"%s\", \"textures\": %zu, "
        "\"not_finite\": %zu, \"seams\": %zu, "
        "\"variance_beyond_5_percent\": {\"torus\": %zu, \"plane\": %zu}, "
        "\"beyond_4_standard_errors\": %zu, "
        "\"worst_variance\": {\"torus\": %.4f, \"plane\": %.4f}}\n",
        path.substr(path.find_last_of('/') + 1).c_str(), name, tally.drawn,
        tally.not_finite, tally.seams, tally.far_torus, tally.far_plane, tally.invalid,
        tally.worst_torus, tally.worst_plane);
    std::fflush(stdout);
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: validity_bench IMAGE...\n");
        return 2;
    }
    const auto executor = sateen::make_executor(0);
    for (int i = 1; i < argc; ++i) {
        using sateen::FieldKind;
        sateen::bench::sweep(argv[i], FieldKind::car2d, "car2d", *executor);
        sateen::bench::sweep(argv[i], FieldKind::gmrf2d, "gmrf2d", *executor);
        sateen::bench::sweep(argv[i], FieldKind::car3d, "car3d", *executor);
        sateen::bench::sweep(argv[i], FieldKind::sar3d, "sar3d", *executor);
    }
}
