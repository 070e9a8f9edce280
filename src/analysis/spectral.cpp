// SPDX-License-Identifier: Apache-2.0
// Karhunen-Loève spectral factorisation. See spectral.hpp.
#include "sateen/analysis/spectral.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "sateen/core/colour.hpp"

namespace sateen {
namespace {

using Eigen::Index;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Sums of values and of products over every pixel, in double.
struct Moments {
    Eigen::VectorXd sum;
    Matrix products;
    double count = 0;
};

Moments moments_of(std::span<const Image> images) {
    const Index d = static_cast<Index>(images.front().bands());
    Moments moments{Eigen::VectorXd::Zero(d), Matrix::Zero(d, d), 0};
    for (const Image& image : images) {
        const Eigen::Map<
            const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
            values(image.values().data(), d, static_cast<Index>(image.plane_size()));
        constexpr Index kBlock = 4096;
        for (Index start = 0; start < values.cols(); start += kBlock) {
            const Matrix block =
                values.middleCols(start, std::min(kBlock, values.cols() - start))
                    .cast<double>();
            moments.sum += block.rowwise().sum();
            moments.products.noalias() += block * block.transpose();
        }
        moments.count += static_cast<double>(image.plane_size());
    }
    return moments;
}

}  // namespace

SpectralTransform fit_spectral_transform(std::span<const Image> images, Tone tone) {
    const Moments moments = moments_of(images);
    const Eigen::VectorXd mean = moments.sum / moments.count;
    const Matrix Phi = moments.products / moments.count - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(Phi);

    const Index d = mean.size();
    SpectralTransform transform;
    transform.tone = tone;
    for (Index i = 0; i < d; ++i) transform.mean.push_back(static_cast<float>(mean(i)));
    for (Index row = 0; row < d; ++row) {
        Eigen::VectorXd axis = solver.eigenvectors().col(d - 1 - row);
        Index largest = 0;
        axis.cwiseAbs().maxCoeff(&largest);
        if (axis(largest) < 0) axis = -axis;
        for (Index i = 0; i < d; ++i) transform.T.push_back(static_cast<float>(axis(i)));
    }
    return transform;
}

void align(SpectralTransform& transform, const SpectralTransform& reference) {
    const std::size_t d = transform.mean.size();
    if (reference.mean.size() != d) return;
    const auto dot = [&](std::size_t row, std::size_t reference_row) {
        double sum = 0;
        for (std::size_t i = 0; i < d; ++i)
            sum += static_cast<double>(transform.T[row * d + i]) *
                   static_cast<double>(reference.T[reference_row * d + i]);
        return sum;
    };
    std::vector<std::size_t> order(d);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<std::size_t> best = order;
    double best_sum = -1;
    do {
        double sum = 0;
        for (std::size_t row = 0; row < d; ++row) sum += std::abs(dot(order[row], row));
        if (sum > best_sum + 1e-9) {
            best_sum = sum;
            best = order;
        }
    } while (std::next_permutation(order.begin(), order.end()));

    std::vector<float> T;
    for (std::size_t row = 0; row < d; ++row) {
        const float sign = dot(best[row], row) < 0 ? -1.0F : 1.0F;
        for (std::size_t i = 0; i < d; ++i)
            T.push_back(sign * transform.T[best[row] * d + i]);
    }
    transform.T = std::move(T);
}

Image apply_tone(const Image& linear, Tone tone) {
    Image result = linear;
    if (tone == Tone::srgb)
        for (float& value : result.values()) value = srgb_encode(value);
    return result;
}

Image decorrelate(const Image& image, const SpectralTransform& transform) {
    const std::size_t d = image.bands();
    Image result(d, image.rows(), image.cols());
    for (std::size_t row = 0; row < d; ++row) {
        float* out = result.plane(row).data;
        for (std::size_t band = 0; band < d; ++band) {
            const float t = transform.T[row * d + band];
            const float mean = transform.mean[band];
            const float* in = image.plane(band).data;
            for (std::size_t i = 0; i < image.plane_size(); ++i)
                out[i] += t * (in[i] - mean);
        }
    }
    return result;
}

}  // namespace sateen
