// SPDX-License-Identifier: Apache-2.0
// Moments of images and the factorisation of their table. See reflectance.hpp; the pairs
// that were not measured are predicted in reflectance_completion.cpp.
#include "sateen/analysis/reflectance.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "material/quantise.hpp"
#include "sateen/core/colour.hpp"

namespace sateen {
namespace {

// Pixels summed in single precision before they are added to the total.
constexpr std::size_t kBlock = 256;

constexpr std::array<double, 3> kLuminance = kRelativeXyzOfLinearSrgb[1];

struct Sums {
    std::array<float, 3> values = {};
    float luminance = 0;
    float squares = 0;
};

template <std::size_t kBands>
Sums sum_block(const std::array<const float*, 3>& band, std::size_t count) {
    constexpr float kRed = kBands == 1 ? 1.0F : static_cast<float>(kLuminance[0]);
    constexpr auto kGreen = static_cast<float>(kLuminance[1]);
    constexpr auto kBlue = static_cast<float>(kLuminance[2]);
    // Lanes of their own, each sum in a loop of its own: so the compiler uses vectors.
    constexpr std::size_t kLanes = 8;
    using Lanes = std::array<float, kLanes>;
    std::array<Lanes, kBands> values = {};
    Lanes luminances = {};
    Lanes squares = {};
    const auto add = [&](const std::array<const float*, 3>& at) {
        Lanes luminance = {};
        for (std::size_t k = 0; k < kLanes; ++k) luminance[k] = kRed * at[0][k];
        if constexpr (kBands > 1)
            for (std::size_t k = 0; k < kLanes; ++k)
                luminance[k] += kGreen * at[1][k] + kBlue * at[2][k];
        for (std::size_t b = 0; b < kBands; ++b)
            for (std::size_t k = 0; k < kLanes; ++k) values[b][k] += at[b][k];
        for (std::size_t k = 0; k < kLanes; ++k) luminances[k] += luminance[k];
        for (std::size_t k = 0; k < kLanes; ++k)
            squares[k] += luminance[k] * luminance[k];
    };
    std::array<const float*, 3> at = band;
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        add(at);
        for (std::size_t b = 0; b < kBands; ++b) at[b] += kLanes;
    }
    std::array<Lanes, kBands> rest = {};
    for (std::size_t b = 0; b < kBands; ++b) {
        std::copy_n(at[b], count - i, rest[b].begin());
        at[b] = rest[b].data();
    }
    add(at);
    Sums sums;
    for (std::size_t k = 0; k < kLanes; ++k) {
        for (std::size_t b = 0; b < kBands; ++b) sums.values[b] += values[b][k];
        sums.luminance += luminances[k];
        sums.squares += squares[k];
    }
    return sums;
}

}  // namespace

ImageMoments image_moments(ImageView<const float> image) {
    ImageMoments moments;
    double squares = 0;
    const std::size_t pixels = image.plane_size();
    for (std::size_t at = 0; at < pixels; at += kBlock) {
        const std::size_t count = std::min(kBlock, pixels - at);
        std::array<const float*, 3> band = {};
        for (std::size_t b = 0; b < image.bands; ++b)
            band[b] = image.data + b * pixels + at;
        const Sums sums =
            image.bands == 1 ? sum_block<1>(band, count) : sum_block<3>(band, count);
        for (std::size_t b = 0; b < 3; ++b)
            moments.mean[b] += static_cast<double>(sums.values[b]);
        moments.luminance += static_cast<double>(sums.luminance);
        squares += static_cast<double>(sums.squares);
    }
    const auto n = static_cast<double>(pixels);
    for (double& mean : moments.mean) mean /= n;
    moments.luminance /= n;
    moments.deviation =
        std::sqrt(std::max(0.0, squares / n - moments.luminance * moments.luminance));
    return moments;
}

EncodedAppearance encode_appearance(const ImageMoments& moments, std::size_t bands) {
    EncodedAppearance e{};
    for (std::size_t b = 0; b < bands; ++b)
        e[b] = static_cast<float>(std::cbrt(std::max(0.0, moments.mean[b])));
    // Of a black image the contrast means nothing.
    constexpr double kBlack = 1e-6;
    if (moments.luminance > kBlack)
        e[bands] = static_cast<float>(moments.deviation / moments.luminance);
    return e;
}

Reflectance factorise_appearance(const AppearanceGrid& grid, std::span<const float> table,
                                 const FactorisationOptions& options) {
    const auto lights = static_cast<Eigen::Index>(grid.lights.size());
    const auto columns = static_cast<Eigen::Index>(grid.views.size() * grid.channels);
    using RowMajor =
        Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::MatrixXd X =
        Eigen::Map<const RowMajor>(table.data(), lights, columns).cast<double>();
    Reflectance out;
    out.channels = static_cast<std::uint32_t>(grid.channels);
    const Eigen::RowVectorXd base = X.colwise().mean();
    X.rowwise() -= base;
    for (const double b : base) out.base.push_back(static_cast<float>(b));

    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(X * X.transpose());
    const double allowed = options.tolerance * options.tolerance *
                           static_cast<double>(lights) * static_cast<double>(columns);
    const auto most = std::min<Eigen::Index>(
        static_cast<Eigen::Index>(std::min(options.rank, Reflectance::kMaxRank)), lights);
    double left = X.squaredNorm();
    Eigen::Index rank = 0;
    while (rank < most && left > allowed)
        left -= eigen.eigenvalues()[lights - 1 - rank++];
    out.rank = static_cast<std::uint32_t>(rank);
    if (rank == 0) return out;

    Eigen::MatrixXd U = eigen.eigenvectors().rightCols(rank).rowwise().reverse();
    for (Eigen::Index k = 0; k < rank; ++k) {
        const Eigen::VectorXf exact = U.col(k).cast<float>();
        const std::span<const float> block(exact.data(),
                                           static_cast<std::size_t>(lights));
        const int exponent = block_exponent(block, 7);
        for (Eigen::Index l = 0; l < lights; ++l)
            U(l, k) = static_cast<double>(
                dequantise(quantise_byte(exact[l], exponent), exponent));
    }
    const Eigen::MatrixXd V = U.colPivHouseholderQr().solve(X);
    for (Eigen::Index l = 0; l < lights; ++l)
        for (Eigen::Index k = 0; k < rank; ++k)
            out.lights.push_back(static_cast<float>(U(l, k)));
    for (Eigen::Index c = 0; c < columns; ++c)
        for (Eigen::Index k = 0; k < rank; ++k)
            out.views.push_back(static_cast<float>(V(k, c)));
    return out;
}

}  // namespace sateen
