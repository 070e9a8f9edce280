// SPDX-License-Identifier: Apache-2.0
// The power-preserving pyramid, in the frequency domain. See autocovariance.hpp.
#include "sateen/analysis/autocovariance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/lag_transform.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/core/periodic_part.hpp"

namespace sateen {
namespace {

using Eigen::Index;

/// A spectrum S(m, n) of a real (rows, cols) lattice, n = 0 … ⌊cols/2⌋.
struct HalfSpectrum {
    RowMatrix S;
    Index cols = 0;
    /// S(-ω) = mirror_sign · S(ω): -1 for imaginary parts.
    double mirror_sign = 1;
    [[nodiscard]] Index rows() const { return S.rows(); }
};

double frequency(Index k, Index n) {
    return 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
}

/// W²(ω) along one axis for the binomial kernel: W(ω) = cos⁴(ω/2).
Eigen::VectorXd squared_transfer(Index count, Index size) {
    Eigen::VectorXd W2(count);
    for (Index k = 0; k < count; ++k)
        W2(k) = std::pow(std::cos(frequency(k, size) / 2), 8);
    return W2;
}

/// F{y} of a plane on a torus, without the mean.
struct Transform {
    SplitComplexPlane y;
    std::size_t cols = 0;
};

Result<Transform> transform(PlaneView<const float> plane, Executor& executor) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(plane.rows, plane.cols));
    Transform result{SplitComplexPlane(fft.rows(), fft.spectrum_cols()), plane.cols};
    fft.forward(plane, result.y.view(), executor);
    result.y.view().re(0, 0) = 0;
    return result;
}

Result<Transform> transform_of_periodic_part(PlaneView<const float> plane,
                                             Executor& executor) {
    Image periodic(1, plane.rows, plane.cols);
    SATEEN_CHECK(periodic_part(plane, periodic.plane(0), executor, kTextureBorderShare));
    return transform(periodic.plane(0), executor);
}

/// Re or Im of ŷ conj(ẑ) / MN.
enum class Part { real, imaginary };
HalfSpectrum product(const Transform& left, const Transform& right, Part part) {
    const SplitComplexView<const float> y = left.y.view();
    const SplitComplexView<const float> z = right.y.view();
    const bool real = part == Part::real;
    HalfSpectrum half{
        RowMatrix(static_cast<Index>(y.re.rows), static_cast<Index>(y.re.cols)),
        static_cast<Index>(left.cols), real ? 1.0 : -1.0};
    const double scale = 1 / static_cast<double>(y.re.rows * left.cols);
    for (std::size_t m = 0; m < y.re.rows; ++m)
        for (std::size_t n = 0; n < y.re.cols; ++n) {
            const double a = static_cast<double>(y.re(m, n));
            const double b = static_cast<double>(y.im(m, n));
            const double c = static_cast<double>(z.re(m, n));
            const double e = static_cast<double>(z.im(m, n));
            half.S(static_cast<Index>(m), static_cast<Index>(n)) =
                scale * (real ? a * c + b * e : b * c - a * e);
        }
    return half;
}

/// |F{y}|² / MN, without the mean.
HalfSpectrum power(const Transform& y) {
    return product(y, y, Part::real);
}

/// S(m, n) for n beyond the half spectrum, by S(-ω) = S(ω).
double at_any_column(const HalfSpectrum& half, Index m, Index n) {
    if (n < half.S.cols()) return half.S(m, n);
    return half.mirror_sign * half.S((half.rows() - m) % half.rows(), half.cols - n);
}

//     S_{k+1}(2ω) = ¼ Σ_alias W²(ω) S_k(ω):   decimation by two folds the four aliases
//     (m', n'), (m' + M/2, n'), (m', n' + N/2), (m' + M/2, n' + N/2) onto (m', n').
HalfSpectrum reduced(const HalfSpectrum& fine) {
    const Index M = fine.rows();
    const Index N = fine.cols;
    const Eigen::VectorXd row_W2 = squared_transfer(M, M);
    const Eigen::VectorXd col_W2 = squared_transfer(N, N);
    HalfSpectrum coarse{RowMatrix(M / 2, N / 4 + 1), N / 2, fine.mirror_sign};
    for (Index m = 0; m < M / 2; ++m)
        for (Index n = 0; n <= N / 4; ++n) {
            double sum = 0;
            for (const Index alias_m : {m, m + M / 2})
                for (const Index alias_n : {n, n + N / 2})
                    sum += row_W2(alias_m) * col_W2(alias_n) *
                           at_any_column(fine, alias_m, alias_n);
            coarse.S(m, n) = sum / 4;
        }
    return coarse;
}

//     B_k(ω) = S_k(ω) - 4 W²(ω) S_{k+1}(2ω)
//
// It can dip below zero only by the scatter of the periodogram; a spectrum cannot.
void subtract_expanded(const HalfSpectrum& coarse, HalfSpectrum& fine) {
    const Index M = fine.rows();
    const Eigen::VectorXd row_W2 = squared_transfer(M, M);
    const Eigen::VectorXd col_W2 = squared_transfer(fine.S.cols(), fine.cols);
    for (Index m = 0; m < M; ++m)
        for (Index n = 0; n < fine.S.cols(); ++n) {
            const double expanded = 4 * row_W2(m) * col_W2(n) *
                                    at_any_column(coarse, m % (M / 2), n % coarse.cols);
            fine.S(m, n) = std::max(0.0, fine.S(m, n) - expanded);
        }
}

Autocovariance autocovariance(const HalfSpectrum& half, int reach) {
    return LagTransform(half.rows(), half.cols, reach).even(half.S);
}

Result<void> check_halvings(std::size_t rows, std::size_t cols, std::size_t levels) {
    const std::size_t factor = std::size_t{1} << (levels - 1);
    if (rows % factor == 0 && cols % factor == 0) return {};
    return Error{Errc::invalid_argument,
                 "a sample of " + std::to_string(rows) + " x " + std::to_string(cols) +
                     " pixels cannot be halved " + std::to_string(levels - 1) + " times"};
}

/// P_ij of d planes, i <= j: the real parts of all pairs and the imaginary parts.
struct CrossSpectra {
    std::size_t planes = 0;
    std::vector<HalfSpectrum> real;
    std::vector<HalfSpectrum> imaginary;

    static CrossSpectra of(const std::vector<Transform>& y) {
        CrossSpectra P{y.size(), {}, {}};
        for (std::size_t i = 0; i < y.size(); ++i)
            for (std::size_t j = i; j < y.size(); ++j) {
                P.real.push_back(product(y[i], y[j], Part::real));
                P.imaginary.push_back(product(y[i], y[j], Part::imaginary));
            }
        return P;
    }
    [[nodiscard]] CrossSpectra coarser() const {
        CrossSpectra coarse{planes, {}, {}};
        for (const HalfSpectrum& part : real) coarse.real.push_back(reduced(part));
        for (const HalfSpectrum& part : imaginary)
            coarse.imaginary.push_back(reduced(part));
        return coarse;
    }
    [[nodiscard]] CrossAutocovariance covariance(int reach) const {
        const LagTransform lags(real[0].rows(), real[0].cols, reach);
        std::vector<Autocovariance> even;
        std::vector<Autocovariance> odd;
        for (const HalfSpectrum& part : real) even.push_back(lags.even(part.S));
        for (const HalfSpectrum& part : imaginary) odd.push_back(lags.odd(part.S));
        return {planes, std::move(even), std::move(odd)};
    }
    /// The part that the level must hold, given the next coarser one.
    void keep_level(const CrossSpectra& coarse) {
        std::vector<RowMatrix> roots;  // √g_i
        std::size_t pair = 0;
        for (std::size_t i = 0; i < planes; pair += planes - i, ++i) {
            HalfSpectrum B = real[pair];
            subtract_expanded(coarse.real[pair], B);
            roots.push_back((B.S.array() / real[pair].S.array().max(1e-300)).sqrt());
        }
        pair = 0;
        for (std::size_t i = 0; i < planes; ++i)
            for (std::size_t j = i; j < planes; ++j, ++pair) {
                real[pair].S.array() *= roots[i].array() * roots[j].array();
                imaginary[pair].S.array() *= roots[i].array() * roots[j].array();
            }
    }
};

}  // namespace

double CrossAutocovariance::operator()(std::size_t i, std::size_t j, int row,
                                       int col) const {
    if (i > j) return (*this)(j, i, -row, -col);
    const double odd =
        row < 0 ? -odd_[pair(i, j)](-row, -col) : odd_[pair(i, j)](row, col);
    return even_[pair(i, j)](row, col) - odd;
}

CrossAutocovariance CrossAutocovariance::resolved() const {
    CrossAutocovariance result = *this;
    for (Autocovariance& part : result.even_) part = part.resolved();
    for (Autocovariance& part : result.odd_) part = part.resolved();
    return result;
}

// The triangle is the autocorrelation of the sample's window; positive definite, so that what
// it leaves are covariances.
Autocovariance Autocovariance::resolved() const {
    const double side = std::sqrt(sites_);
    const auto triangle = [&](int lag) {
        return std::max(0.0, 1 - std::abs(lag) / side);
    };
    Autocovariance result = *this;
    for (int row = 0; row <= reach_; ++row)
        for (int col = -reach_; col <= reach_; ++col)
            result.at(row, col) *= triangle(row) * triangle(col);
    return result;
}

void CrossAutocovariance::pool(const CrossAutocovariance& other) {
    if (planes_ == 0) {
        *this = other;
        return;
    }
    for (std::size_t k = 0; k < even_.size(); ++k) {
        even_[k].pool(other.even_[k]);
        odd_[k].pool(other.odd_[k]);
    }
}

void Autocovariance::pool(const Autocovariance& other) {
    if (sites_ == 0) {
        *this = other;
        return;
    }
    const double sum = sites_ + other.sites_;
    for (std::size_t i = 0; i < values_.size(); ++i)
        values_[i] = (values_[i] * sites_ + other.values_[i] * other.sites_) / sum;
    sites_ = sum;
}

Result<Autocovariance> toroidal_autocovariance(PlaneView<const float> plane, int reach,
                                               Executor& executor) {
    SATEEN_TRY(const Transform y, transform(plane, executor));
    return autocovariance(power(y), reach);
}

Result<std::vector<Autocovariance>> power_preserving_pyramid(PlaneView<const float> plane,
                                                             std::size_t levels,
                                                             int reach,
                                                             Executor& executor) {
    SATEEN_CHECK(check_halvings(plane.rows, plane.cols, levels));
    SATEEN_TRY(const Transform y, transform_of_periodic_part(plane, executor));
    HalfSpectrum present = power(y);
    std::vector<Autocovariance> result;
    for (std::size_t level = 0; level + 1 < levels; ++level) {
        HalfSpectrum coarse = reduced(present);
        subtract_expanded(coarse, present);
        result.push_back(autocovariance(present, reach));
        present = std::move(coarse);
    }
    result.push_back(autocovariance(present, reach));
    return result;
}

Result<CrossAutocovariance> toroidal_cross_autocovariance(
    std::span<const PlaneView<const float>> planes, int reach, Executor& executor) {
    std::vector<Transform> transforms;
    for (const auto& plane : planes) {
        SATEEN_TRY(Transform y, transform(plane, executor));
        transforms.push_back(std::move(y));
    }
    return CrossSpectra::of(transforms).covariance(reach);
}

Result<std::vector<CrossAutocovariance>> joint_power_preserving_pyramid(
    std::span<const PlaneView<const float>> planes, std::size_t levels, int reach,
    Executor& executor) {
    SATEEN_CHECK(check_halvings(planes[0].rows, planes[0].cols, levels));
    std::vector<Transform> transforms;
    for (const auto& plane : planes) {
        SATEEN_TRY(Transform y, transform_of_periodic_part(plane, executor));
        transforms.push_back(std::move(y));
    }
    CrossSpectra present = CrossSpectra::of(transforms);
    std::vector<CrossAutocovariance> result;
    for (std::size_t level = 0; level + 1 < levels; ++level) {
        CrossSpectra coarse = present.coarser();
        present.keep_level(coarse);
        result.push_back(present.covariance(reach));
        present = std::move(coarse);
    }
    result.push_back(present.covariance(reach));
    return result;
}

}  // namespace sateen
