// SPDX-License-Identifier: Apache-2.0
// Amplitudes and their curves. See amplitude_regression.hpp.
#include "analysis/amplitude_regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "core/band_rows.hpp"
#include "core/plane_moments.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLevels = BandModulation::kLevels;
constexpr std::size_t kKnots = AmplitudeCurve::kKnots;
constexpr std::size_t kUnknowns = kAmplitudeFeatures * kKnots;
/// In parts of the number of samples: of the squares of the values, and of their second
/// differences.
constexpr double kRidge = 1e-3;
constexpr double kStiffness = 3e-3;
/// A band with a smaller share of the variance of its plane is left alone.
constexpr double kLeastBandShare = 1e-3;

double value_at(const Explanation::Site& site, const AmplitudeKnots& knots) {
    double sum = 0;
    for (std::size_t i = 0; i < site.count; ++i)
        sum += site.weight[i] * knots[site.knot[i]];
    return sum;
}

/// What least squares need of the sites of an image.
struct NormalEquations {
    std::array<double, kUnknowns * kUnknowns> G{};  ///< above the diagonal and on it
    AmplitudeKnots h{};
    AmplitudeKnots occupancy{};
    double sum = 0;  ///< of the amplitudes
    double n = 0;
};

NormalEquations normal_equations(const Explanation& explanation) {
    NormalEquations sums;
    const std::size_t stride = explanation.stride();
    for (std::size_t r = 0; r < explanation.rows(); r += stride)
        for (std::size_t c = 0; c < explanation.cols(); c += stride) {
            const auto site = explanation.at(r, c);
            const auto y = static_cast<double>(explanation.amplitude(r, c));
            sums.sum += y;
            sums.n += 1;
            for (std::size_t i = 0; i < site.count; ++i) {
                const std::size_t a = site.knot[i];
                sums.h[a] += site.weight[i] * y;
                sums.occupancy[a] += site.weight[i];
                for (std::size_t j = i; j < site.count; ++j)
                    sums.G[a * kUnknowns + site.knot[j]] +=
                        site.weight[i] * site.weight[j];
            }
        }
    return sums;
}

}  // namespace

BandFeatures band_features(PlaneView<const float> plane, Border border,
                           Executor& executor) {
    BandFeatures out;
    out.amplitude = Image(kLevels, plane.rows, plane.cols, uninitialised);
    out.value = Image(kLevels, plane.rows, plane.cols, uninitialised);
    Image work(3, plane.rows, plane.cols, uninitialised);
    const double whole = moments_of(plane).variance;
    PlaneView<const float> from = plane;
    for (std::size_t level = 0; level < kLevels; ++level) {
        const PlaneView<float> band = work.plane(0);
        const PlaneView<float> low = out.value.plane(level);
        split_band(from, std::size_t{1} << level, border, band, low, executor);
        const PlaneView<float> energy = work.plane(2);
        local_energy(band, level, border, work.plane(1), energy, executor);
        const double variance = moments_of(band).variance;
        out.seen[level] = variance > kLeastBandShare * whole;
        const auto scale = static_cast<float>(variance > 0 ? 1 / variance : 0);
        for (std::size_t r = 0; r < plane.rows; ++r)
            log_amplitude_row(energy.row(r), scale, out.amplitude.plane(level).row(r),
                              plane.cols);
        from = low;
    }
    for (std::size_t level = 0; level < kLevels; ++level) {
        const PlaneView<float> low = out.value.plane(level);
        const double deviation = std::sqrt(moments_of(low).variance);
        const auto scale = static_cast<float>(deviation > 0 ? 1 / deviation : 0);
        for (std::size_t i = 0; i < low.size(); ++i) low.data[i] *= scale;
    }
    return out;
}

AmplitudeRegression regress(const Explanation& explanation) {
    using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns, Eigen::RowMajor>;
    using Vector = Eigen::Matrix<double, kUnknowns, 1>;
    const NormalEquations sums = normal_equations(explanation);
    const double n = sums.n;
    AmplitudeRegression result;
    result.mean = sums.sum / n;
    Matrix G = Eigen::Map<const Matrix>(sums.G.data());
    G = G.selfadjointView<Eigen::Upper>();
    result.covariances.resize(kUnknowns);
    for (std::size_t i = 0; i < kUnknowns; ++i)
        for (std::size_t j = 0; j < kUnknowns; ++j)
            result.covariances[i][j] =
                G(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) / n -
                sums.occupancy[i] * sums.occupancy[j] / (n * n);
    const Vector h = Eigen::Map<const Vector>(sums.h.data()) -
                     result.mean * Eigen::Map<const Vector>(sums.occupancy.data());
    G.diagonal().array() += kRidge * n;
    for (std::size_t feature = 0; feature < kAmplitudeFeatures; ++feature)
        for (std::size_t j = 0; j + 2 < kKnots; ++j) {
            const Eigen::Vector3d d(1, -2, 1);
            const auto a = static_cast<Eigen::Index>(feature * kKnots + j);
            G.block<3, 3>(a, a) += kStiffness * n * d * d.transpose();
        }
    Eigen::Map<Vector>(result.knots.data()) = G.ldlt().solve(h);
    return result;
}

Image remainder_of(const Explanation& explanation, const AmplitudeRegression& fit,
                   std::size_t spacing) {
    Image out(1, explanation.rows() / spacing, explanation.cols() / spacing);
    for (std::size_t r = 0; r < out.rows(); ++r)
        for (std::size_t c = 0; c < out.cols(); ++c) {
            const std::size_t y = r * spacing;
            const std::size_t x = c * spacing;
            out(0, r, c) =
                static_cast<float>(static_cast<double>(explanation.amplitude(y, x)) -
                                   fit.mean - value_at(explanation.at(y, x), fit.knots));
        }
    return out;
}

double AmplitudeRegression::variance(const AmplitudeKnots& of) const {
    double sum = 0;
    for (std::size_t i = 0; i < of.size(); ++i)
        for (std::size_t j = 0; j < of.size(); ++j)
            sum += of[i] * covariances[i][j] * of[j];
    return sum;
}

}  // namespace sateen
