// SPDX-License-Identifier: Apache-2.0
// Autocovariances of the levels of a pyramid: all that the estimators of the fields need.
// Theory: docs/theory/power_preserving_pyramid.md. Partner: synthesis/spectral_density.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/neighbourhood.hpp"

namespace sateen {

/// Border bands of the periodic part of a texture, as a share of its size: wide enough that
/// ribs, threads and stitches average out.
inline constexpr double kTextureBorderShare = 0.125;

/// R(s) = E Y_r Y_{r-s} of a zero-mean plane on a torus, for |s1|, |s2| <= reach.
class Autocovariance {
  public:
    Autocovariance() = default;
    Autocovariance(int reach, double sites)
        : values_(static_cast<std::size_t>((reach + 1) * (2 * reach + 1))),
          reach_(reach),
          sites_(sites) {}

    /// R(-s) = R(s), so only rows >= 0 are kept.
    [[nodiscard]] double operator()(int row, int col) const {
        return row < 0 ? values_[index(-row, -col)] : values_[index(row, col)];
    }
    [[nodiscard]] double operator()(Offset s) const { return (*this)(s.row, s.col); }
    /// row in [0, reach], col in [-reach, reach]
    [[nodiscard]] double& at(int row, int col) { return values_[index(row, col)]; }

    [[nodiscard]] double variance() const { return (*this)(0, 0); }
    [[nodiscard]] int reach() const { return reach_; }
    /// How many lattice sites were averaged.
    [[nodiscard]] double sites() const { return sites_; }
    /// R(s) (1 - |s1|/n) (1 - |s2|/n), n² sites: what so small a sample can resolve. Taken
    /// for a torus it shows the threads of a weave as waves without end, whose lines are
    /// narrower than the frequencies at which they are fitted and drawn.
    [[nodiscard]] Autocovariance resolved() const;
    /// Pools the statistics of another sample of the same field, weighted by its sites.
    void pool(const Autocovariance& other);

  private:
    [[nodiscard]] std::size_t index(int row, int col) const {
        return static_cast<std::size_t>(row * (2 * reach_ + 1) + col + reach_);
    }
    std::vector<double> values_;
    int reach_ = 0;
    double sites_ = 0;
};

/// R_ij(s) = E Y_{r,i} Y_{r-s,j} of d zero-mean planes on a torus; R_ji(s) = R_ij(-s).
class CrossAutocovariance {
  public:
    CrossAutocovariance() = default;
    /// \param even, odd  parts of R_ij, i <= j, row by row: R_ij(s) = even(s) - odd(s),
    ///                   odd(-s) = -odd(s)
    CrossAutocovariance(std::size_t planes, std::vector<Autocovariance> even,
                        std::vector<Autocovariance> odd)
        : planes_(planes), even_(std::move(even)), odd_(std::move(odd)) {}

    [[nodiscard]] double operator()(std::size_t i, std::size_t j, int row, int col) const;
    [[nodiscard]] const Autocovariance& plane(std::size_t i) const {
        return even_[pair(i, i)];
    }
    [[nodiscard]] std::size_t planes() const { return planes_; }
    [[nodiscard]] double sites() const { return even_.front().sites(); }
    void pool(const CrossAutocovariance& other);
    /// Autocovariance::resolved() for all pairs.
    [[nodiscard]] CrossAutocovariance resolved() const;

  private:
    [[nodiscard]] std::size_t pair(std::size_t i, std::size_t j) const {
        return i * planes_ - i * (i + 1) / 2 + j;
    }
    std::size_t planes_ = 0;
    std::vector<Autocovariance> even_;
    std::vector<Autocovariance> odd_;
};

/// The autocovariances of a plane on its own torus, about its mean.
/// \param plane  of accepted FFT sizes
[[nodiscard]] Result<Autocovariance> toroidal_autocovariance(PlaneView<const float> plane,
                                                             int reach,
                                                             Executor& executor);

/// The autocovariances of every level of a pyramid whose levels, drawn independently and
/// collapsed, have the power spectrum of `plane`.
///
/// Drawn independently, the levels of an ordinary Laplacian pyramid lose up to 4.75 dB
/// where they overlap. Instead, with S_0 the periodogram of the periodic part of the
/// plane,
///
///     S_{k+1}(2ω) = ¼ Σ_alias W²S_k          the Gaussian level
///     B_k(ω)      = S_k(ω) - W²(ω) Σ_alias W²S_k     the part that level k must hold
///
/// so that Σ of the expanded levels is S_0 again.
///
/// \param plane   (M, N), both accepted FFT sizes divisible by 2^(levels - 1); its mean
/// is
///                ignored
/// \param reach   of the autocovariances
/// \returns       one autocovariance a level, finest first, the low-pass residue last
/// \cost          O(MN log MN + MN·reach)
[[nodiscard]] Result<std::vector<Autocovariance>> power_preserving_pyramid(
    PlaneView<const float> plane, std::size_t levels, int reach, Executor& executor);

/// The cross-covariances of planes of one size on their own torus.
[[nodiscard]] Result<CrossAutocovariance> toroidal_cross_autocovariance(
    std::span<const PlaneView<const float>> planes, int reach, Executor& executor);

/// The same for d planes and all their cross-spectra P_ij. The power of every plane is
/// that of power_preserving_pyramid(); with g_i = B_ii / P_ii the share that a level must
/// hold, the cross-spectrum is B_ij = P_ij √(g_i g_j): the coherence of the Gaussian
/// level, and a matrix that stays positive.
[[nodiscard]] Result<std::vector<CrossAutocovariance>> joint_power_preserving_pyramid(
    std::span<const PlaneView<const float>> planes, std::size_t levels, int reach,
    Executor& executor);

}  // namespace sateen
