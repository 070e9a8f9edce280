// SPDX-License-Identifier: Apache-2.0
// The Gaussian field behind a marginal curve: its correlations from those of the plane.
// Theory: docs/theory/translation.md.
#pragma once

#include <array>
#include <cstddef>

#include "sateen/core/image.hpp"
#include "sateen/core/parallel.hpp"
#include "sateen/core/result.hpp"
#include "sateen/material/material.hpp"

namespace sateen {

/// How a curve q changes the correlation of a Gaussian field g of correlation ρ,
///
///     corr(q(g_r), q(g_{r-s})) = C(ρ) = Σ_{n≥1} c_n² ρⁿ / Σ c_n²,
///     c_n = E q(g) He_n(g) / √n!,    He_n the Hermite polynomials (Mehler's formula)
///
/// C grows with ρ on [-1, 1] for a monotone q.
class CorrelationMap {
  public:
    /// \param marginal  with knots
    explicit CorrelationMap(const Marginal& marginal);
    /// C(ρ)
    [[nodiscard]] double forward(double rho) const;
    /// The ρ in [-1, 1] whose C(ρ) is nearest to `correlation`.
    [[nodiscard]] double inverse(double correlation) const;

  private:
    void tabulate_inverse();

    static constexpr std::size_t kTerms = 24;
    static constexpr std::size_t kTable = 4096;
    std::array<double, kTerms> weights_{};      ///< c_n² / Σ c_n², n = 1, 2, …
    std::array<double, kTable + 1> inverse_{};  ///< over [C(-1), 1]
    double lowest_ = -1;
};

/// A plane whose periodogram is that which the Gaussian field needs for q(g) to have the
/// periodogram of `plane`: the phases stay, so relations between planes do.
///
///     R_g(s) = C⁻¹(R(s) / R(0)),   ŷ_t = √(Ŝ_g / Ŝ) p̂_t,   p the periodic part
///
/// Making the plane itself Gaussian by ranks, pixel by pixel, keeps the correlations of *its*
/// ranks; but where contrast goes with brightness (dark pores, bright threads) the curve then
/// turns them into others than the plane has.
///
/// \param plane  (M, N), accepted FFT sizes
/// \param out    (M, N), variance 1, mean 0
/// \cost         four Fourier transforms more than the plane's own
[[nodiscard]] Result<void> gaussian_behind_curve(PlaneView<const float> plane,
                                                 const Marginal& marginal,
                                                 PlaneView<float> out,
                                                 Executor& executor);

}  // namespace sateen
