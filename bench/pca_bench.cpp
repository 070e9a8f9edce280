// SPDX-License-Identifier: Apache-2.0
// The factorisations that [CAR2] names as its rivals: PCA of the images of each view, and of
// all images together; on a crop of 16 x 16 of large measurements. Bytes are those of the
// whole images with factors of 2 bytes; they compress only, nothing is enlarged.
//
//     pca_bench MEASUREMENT [FOLDER]    writes pictures of some images to FOLDER/METHOD
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "figures.hpp"
#include "generated.hpp"
#include "sateen/analysis/quality.hpp"
#include "sateen/core/colour.hpp"
#include "sateen/io/executor.hpp"
#include "sateen/io/image_file.hpp"
#include "sateen/io/open_measurement.hpp"

namespace sateen::bench {
namespace {

constexpr std::size_t kManyImages = 1000;  // of which a crop is taken
constexpr std::size_t kSmallCrop = 16;
constexpr std::size_t kLargeCrop = 128;
constexpr std::size_t kScored = 24;  // images whose texture is scored
constexpr std::size_t kShown = 8;    // images of which pictures are written

struct Crops {
    Eigen::MatrixXf values;  // (3 · side², images), linear
    std::size_t side = 0;
    std::vector<std::uint32_t> views;
    std::vector<std::string> names;
    std::size_t view_count = 0;
    double full_pixels = 0;
};

Crops read(const std::string& path) {
    Crops crops;
    auto measurement = open_measurement({&path, 1}, {});
    if (!measurement) return crops;
    const MeasurementInfo& info = (*measurement)->info();
    const std::size_t side =
        std::min({info.observations.size() > kManyImages ? kSmallCrop : kLargeCrop,
                  info.rows, info.cols});
    if (!info.has_directions() || info.bands != 3) return crops;
    crops.side = side;
    crops.values.setZero(static_cast<Eigen::Index>(3 * side * side),
                         static_cast<Eigen::Index>(info.observations.size()));
    crops.view_count = info.views.size();
    crops.full_pixels = static_cast<double>(info.rows * info.cols);
    for (const Observation& o : info.observations) {
        crops.views.push_back(o.view);
        crops.names.push_back(std::filesystem::path(o.name).stem().string());
    }
    const auto executor = make_executor(1);
    Progress progress;
    const auto pass = for_each_image(
        **measurement, true, *executor, progress, [&](std::size_t i, const Image& image) {
            float* to = crops.values.col(static_cast<Eigen::Index>(i)).data();
            for (std::size_t b = 0; b < 3; ++b)
                for (std::size_t r = 0; r < side; ++r)
                    to = std::copy_n(image.plane(b).row((image.rows() - side) / 2 + r) +
                                         (image.cols() - side) / 2,
                                     side, to);
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
    double texture = 0;  // score, geometric mean; 0 where images are too small
};

Image image_of(const Eigen::MatrixXf& values, Eigen::Index i, std::size_t side) {
    Image image(3, side, side);
    std::transform(values.col(i).data(), values.col(i).data() + values.rows(),
                   image.values().begin(), [](float v) { return std::max(0.0F, v); });
    return image;
}

// Of images evenly spread.
double texture_score(const Eigen::MatrixXf& truth, const Eigen::MatrixXf& found,
                     std::size_t side) {
    if (side < 2 * TextureReference::kMinSide) return 0;
    SerialExecutor executor;
    double sum = 0;
    for (std::size_t k = 0; k < kScored; ++k) {
        const auto i = static_cast<Eigen::Index>(k) * truth.cols() /
                       static_cast<Eigen::Index>(kScored);
        const auto reference =
            TextureReference::create(image_of(truth, i, side), {}, executor);
        if (!reference) return 0;
        const auto score = reference->compare(image_of(found, i, side), executor);
        if (!score) return 0;
        sum += std::log(score->total);
    }
    return std::exp(sum / kScored);
}

Errors errors(const Eigen::MatrixXf& truth, const Eigen::MatrixXf& found,
              std::size_t side) {
    Errors e;
    const auto plane = static_cast<Eigen::Index>(side * side);
    for (Eigen::Index i = 0; i < truth.cols(); ++i) {
        for (Eigen::Index r = 0; r < truth.rows(); ++r) {
            const double a = srgb_encode(static_cast<double>(truth(r, i)));
            const double b =
                srgb_encode(static_cast<double>(std::max(0.0F, found(r, i))));
            e.rms += (a - b) * (a - b);
        }
        const auto lab = [&](const Eigen::MatrixXf& X) {
            const auto mean = [&](Eigen::Index band) {
                return static_cast<double>(X.col(i).segment(band * plane, plane).mean());
            };
            return lab_from_linear_srgb(mean(0), mean(1), mean(2));
        };
        e.delta_e += delta_e_2000(lab(truth), lab(found));
    }
    e.rms = 255 * std::sqrt(e.rms / static_cast<double>(truth.size()));
    e.delta_e /= static_cast<double>(truth.cols());
    e.texture = texture_score(truth, found, side);
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

void write_pictures(const std::filesystem::path& folder, const Eigen::MatrixXf& values,
                    const Crops& crops) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    for (std::size_t k = 0; k < kShown; ++k) {
        const std::size_t i = (2 * k + 1) * crops.names.size() / (2 * kShown);
        const Image image = image_of(values, static_cast<Eigen::Index>(i), crops.side);
        const auto path = (folder / (crops.names[i] + ".png")).string();
        check_or_exit(write_image(path, image.view()));
    }
}

int run(int argc, char** argv) {
    const Crops crops = argc > 1 ? read(argv[1]) : Crops{};
    if (crops.values.size() == 0) {
        std::fprintf(stderr, "usage: pca_bench MEASUREMENT [FOLDER]\n");
        return 1;
    }
    const std::filesystem::path folder = argc > 2 ? argv[2] : "";
    const double values = 3 * crops.full_pixels;
    const auto images = static_cast<double>(crops.values.cols());
    const auto views = static_cast<double>(crops.view_count);
    std::vector<Figure> figures;
    const auto add = [&](const std::string& name, double bytes, auto&& approximate) {
        Eigen::MatrixXf found;
        const double seconds = processor_seconds([&] { found = approximate(); });
        const Errors e = errors(crops.values, found, crops.side);
        if (!folder.empty()) write_pictures(folder / name, found, crops);
        figures.push_back({name,
                           bytes / 1e6,
                           "MB",
                           values * images / 1e6,
                           Figure::Bound::at_most,
                           {{"crop", static_cast<double>(crops.side)},
                            {"rms of code values", e.rms},
                            {"delta_e of mean colours", e.delta_e},
                            {"seconds for the crop", seconds}}});
        if (e.texture > 0) figures.back().details.emplace_back("texture", e.texture);
    };
    if (!folder.empty()) write_pictures(folder / "measured", crops.values, crops);
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
