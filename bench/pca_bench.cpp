// SPDX-License-Identifier: Apache-2.0
// The factorisations that [CAR2] names as its rivals, on a crop of a measurement: PCA of the
// images of each view, and of all images together. Bytes are those of the whole images with
// factors of 2 bytes; they compress only, nothing is enlarged.
//
//     pca_bench MEASUREMENT [MATERIAL.sateen]
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "figures.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/open_measurement.hpp"

namespace sateen::bench {
namespace {

constexpr std::size_t kCrop = 16;

struct Crops {
    Eigen::MatrixXf values;  // (3 · kCrop², images), linear
    std::vector<std::uint32_t> views;
    std::size_t view_count = 0;
    double full_pixels = 0;
};

Crops read(const std::string& path) {
    Crops crops;
    auto measurement = open_measurement({&path, 1}, {});
    if (!measurement) return crops;
    const MeasurementInfo& info = (*measurement)->info();
    if (!info.has_directions() || info.bands != 3 || info.rows < kCrop ||
        info.cols < kCrop)
        return crops;
    crops.values.setZero(3 * kCrop * kCrop,
                         static_cast<Eigen::Index>(info.observations.size()));
    crops.view_count = info.views.size();
    crops.full_pixels = static_cast<double>(info.rows * info.cols);
    for (const Observation& o : info.observations) crops.views.push_back(o.view);
    const auto executor = make_executor(1);
    Progress progress;
    const auto pass = for_each_image(
        **measurement, true, *executor, progress, [&](std::size_t i, const Image& image) {
            float* to = crops.values.col(static_cast<Eigen::Index>(i)).data();
            for (std::size_t b = 0; b < 3; ++b)
                for (std::size_t r = 0; r < kCrop; ++r)
                    to =
                        std::copy_n(image.plane(b).row(image.rows() / 2 + r - kCrop / 2) +
                                        image.cols() / 2 - kCrop / 2,
                                    kCrop, to);
        });
    if (!pass) crops.values.resize(0, 0);
    return crops;
}

// The columns projected on their mean and the `rank` leading components, by the Gram matrix
// of the shorter side.
Eigen::MatrixXf approximated(const Eigen::MatrixXf& X, Eigen::Index rank) {
    const Eigen::VectorXf mean = X.rowwise().mean();
    const Eigen::MatrixXf centred = X.colwise() - mean;
    const bool tall = X.rows() > X.cols();
    const Eigen::MatrixXf gram = tall ? Eigen::MatrixXf(centred.transpose() * centred)
                                      : Eigen::MatrixXf(centred * centred.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> eigen(gram);
    const Eigen::MatrixXf basis =
        eigen.eigenvectors().rightCols(std::min(rank, gram.rows()));
    Eigen::MatrixXf low = tall ? Eigen::MatrixXf(centred * basis * basis.transpose())
                               : Eigen::MatrixXf(basis * (basis.transpose() * centred));
    low.colwise() += mean;
    return low;
}

struct Errors {
    double rms = 0;      // of sRGB code values, 0 … 255
    double delta_e = 0;  // of the mean colours of images
};

Errors errors(const Eigen::MatrixXf& truth, const Eigen::MatrixXf& found) {
    Errors e;
    constexpr Eigen::Index kPlane = kCrop * kCrop;
    for (Eigen::Index i = 0; i < truth.cols(); ++i) {
        for (Eigen::Index r = 0; r < truth.rows(); ++r) {
            const double a = srgb_encode(static_cast<double>(truth(r, i)));
            const double b =
                srgb_encode(static_cast<double>(std::max(0.0F, found(r, i))));
            e.rms += (a - b) * (a - b);
        }
        const auto lab = [&](const Eigen::MatrixXf& X) {
            const auto mean = [&](Eigen::Index band) {
                return static_cast<double>(
                    X.col(i).segment(band * kPlane, kPlane).mean());
            };
            return lab_from_linear_srgb(mean(0), mean(1), mean(2));
        };
        e.delta_e += delta_e_2000(lab(truth), lab(found));
    }
    e.rms = 255 * std::sqrt(e.rms / static_cast<double>(truth.size()));
    e.delta_e /= static_cast<double>(truth.cols());
    return e;
}

Eigen::MatrixXf per_view(const Crops& crops, Eigen::Index rank) {
    Eigen::MatrixXf out = crops.values;
    for (std::uint32_t view = 0; view < crops.view_count; ++view) {
        std::vector<Eigen::Index> columns;
        for (std::size_t i = 0; i < crops.views.size(); ++i)
            if (crops.views[i] == view) columns.push_back(static_cast<Eigen::Index>(i));
        out(Eigen::all, columns) = approximated(crops.values(Eigen::all, columns), rank);
    }
    return out;
}

int run(int argc, char** argv) {
    const Crops crops = argc > 1 ? read(argv[1]) : Crops{};
    if (crops.values.size() == 0) {
        std::fprintf(stderr, "usage: pca_bench MEASUREMENT [MATERIAL.sateen]\n");
        return 1;
    }
    std::error_code failure;
    const double material =
        argc > 2 ? static_cast<double>(std::filesystem::file_size(argv[2], failure)) : 0;
    const double values = 3 * crops.full_pixels;
    const auto images = static_cast<double>(crops.values.cols());
    const auto views = static_cast<double>(crops.view_count);
    std::vector<Figure> figures;
    const auto add = [&](const std::string& name, double bytes, auto&& approximate) {
        Eigen::MatrixXf found;
        const double seconds = processor_seconds([&] { found = approximate(); });
        const Errors e = errors(crops.values, found);
        figures.push_back({name,
                           bytes / 1e6,
                           "MB",
                           values * images / 1e6,
                           Figure::Bound::at_most,
                           {{"rms of code values", e.rms},
                            {"delta_e of mean colours", e.delta_e},
                            {"seconds for the crop", seconds},
                            {"material MB", material / 1e6}}});
    };
    for (const Eigen::Index rank : {4, 8, 16}) {
        const auto c = static_cast<double>(rank);
        add("PCA of each view, rank " + std::to_string(rank),
            2 * views * (c * (values + images / views) + values),
            [&] { return per_view(crops, rank); });
    }
    for (const Eigen::Index rank : {20, 50, 150}) {
        const auto c = static_cast<double>(rank);
        add("PCA of all images, rank " + std::to_string(rank),
            2 * (c * (values + images) + values),
            [&] { return approximated(crops.values, rank); });
    }
    print("pca", figures);
    return 0;
}

}  // namespace
}  // namespace sateen::bench

int main(int argc, char** argv) {
    return sateen::bench::run(argc, argv);
}
