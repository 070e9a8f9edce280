// SPDX-License-Identifier: Apache-2.0
// The power-preserving pyramid, in the frequency domain. See autocovariance.hpp.
#include "sateen/analysis/autocovariance.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sateen/core/fft.hpp"
#include "sateen/core/periodic_part.hpp"

namespace sateen {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Eigen::Index;

/// A power spectrum S(m, n) of a real (rows, cols) lattice, n = 0 … ⌊cols/2⌋.
struct HalfSpectrum {
    Matrix S;
    Index cols = 0;
    [[nodiscard]] Index rows() const { return S.rows(); }
};

/// Border bands of the periodic part: wide enough that ribs, threads and stitches average
/// out.
constexpr double kBorderShare = 0.125;

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

/// |F{p}|² / MN of the periodic part p of a plane, without the mean.
Result<HalfSpectrum> periodogram(PlaneView<const float> plane, Executor& executor) {
    Image periodic(1, plane.rows, plane.cols);
    SATEEN_CHECK(periodic_part(plane, periodic.plane(0), executor, kBorderShare));
    SATEEN_TRY(const Fft2d fft, Fft2d::create(plane.rows, plane.cols));
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(periodic.plane(0), spectrum.view(), executor);

    HalfSpectrum half{
        Matrix(static_cast<Index>(fft.rows()), static_cast<Index>(fft.spectrum_cols())),
        static_cast<Index>(fft.cols())};
    const double sites = static_cast<double>(plane.size());
    for (std::size_t m = 0; m < fft.rows(); ++m) {
        const float* re = spectrum.view().re.row(m);
        const float* im = spectrum.view().im.row(m);
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            const double a = static_cast<double>(re[n]);
            const double b = static_cast<double>(im[n]);
            half.S(static_cast<Index>(m), static_cast<Index>(n)) =
                (a * a + b * b) / sites;
        }
    }
    half.S(0, 0) = 0;
    return half;
}

/// S(m, n) for n beyond the half spectrum, by S(-ω) = S(ω).
double at_any_column(const HalfSpectrum& half, Index m, Index n) {
    if (n < half.S.cols()) return half.S(m, n);
    return half.S((half.rows() - m) % half.rows(), half.cols - n);
}

//     S_{k+1}(2ω) = ¼ Σ_alias W²(ω) S_k(ω):   decimation by two folds the four aliases
//     (m', n'), (m' + M/2, n'), (m', n' + N/2), (m' + M/2, n' + N/2) onto (m', n').
HalfSpectrum reduced(const HalfSpectrum& fine) {
    const Index M = fine.rows();
    const Index N = fine.cols;
    const Eigen::VectorXd row_W2 = squared_transfer(M, M);
    const Eigen::VectorXd col_W2 = squared_transfer(N, N);
    HalfSpectrum coarse{Matrix(M / 2, N / 4 + 1), N / 2};
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

//     R(s) = (1/MN) Σ_m Σ_n w_n S(m, n) cos(ω1 s1 + ω2 s2),
//
// w_n = 2 for the columns that stand for two. The cosine of the sum separates, so that
// the double sum is two matrix products: over columns first, then over rows.
Autocovariance autocovariance(const HalfSpectrum& half, int reach) {
    const Index M = half.rows();
    const Index N = half.cols;
    const Index lags = reach + 1;
    Matrix col_cos(half.S.cols(), lags);
    Matrix col_sin(half.S.cols(), lags);
    for (Index n = 0; n < half.S.cols(); ++n) {
        const double w = n == 0 || 2 * n == N ? 1 : 2;
        for (Index s = 0; s < lags; ++s) {
            col_cos(n, s) = w * std::cos(frequency(n, N) * static_cast<double>(s));
            col_sin(n, s) = w * std::sin(frequency(n, N) * static_cast<double>(s));
        }
    }
    Matrix row_cos(lags, M);
    Matrix row_sin(lags, M);
    for (Index s = 0; s < lags; ++s)
        for (Index m = 0; m < M; ++m) {
            row_cos(s, m) = std::cos(frequency(m, M) * static_cast<double>(s));
            row_sin(s, m) = std::sin(frequency(m, M) * static_cast<double>(s));
        }
    const double sites = static_cast<double>(M * N);
    const Matrix even = row_cos * (half.S * col_cos) / sites;
    const Matrix odd = row_sin * (half.S * col_sin) / sites;

    Autocovariance R(reach, sites);
    for (int row = 0; row <= reach; ++row)
        for (int col = 0; col <= reach; ++col) {
            R.at(row, col) = even(row, col) - odd(row, col);
            R.at(row, -col) = even(row, col) + odd(row, col);
        }
    return R;
}

}  // namespace

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

Result<std::vector<Autocovariance>> power_preserving_pyramid(PlaneView<const float> plane,
                                                             std::size_t levels,
                                                             int reach,
                                                             Executor& executor) {
    SATEEN_TRY(HalfSpectrum present, periodogram(plane, executor));
    std::vector<Autocovariance> result;
    for (std::size_t level = 0; level + 1 < levels; ++level) {
        if (present.rows() % 2 != 0 || present.cols % 2 != 0)
            return Error{Errc::invalid_argument,
                         "a sample of " + std::to_string(plane.rows) + " x " +
                             std::to_string(plane.cols) + " pixels cannot be halved " +
                             std::to_string(levels - 1) + " times"};
        HalfSpectrum coarse = reduced(present);
        subtract_expanded(coarse, present);
        result.push_back(autocovariance(present, reach));
        present = std::move(coarse);
    }
    result.push_back(autocovariance(present, reach));
    return result;
}

}  // namespace sateen
