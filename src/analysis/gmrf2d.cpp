// SPDX-License-Identifier: Apache-2.0
// Estimation of the two-dimensional Gaussian Markov random field. See gmrf2d.hpp.
#include "sateen/analysis/gmrf2d.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "analysis/lag_transform.hpp"
#include "material/quantise.hpp"
#include "sateen/analysis/neighbourhood.hpp"
#include "sateen/analysis/whittle.hpp"

namespace sateen {
namespace {

using Eigen::Index;
using Vector = Eigen::VectorXd;

/// White noise of this share keeps spectra that live on a few lines only, for which the
/// likelihood has no maximum, within reach.
constexpr double kWhiteShare = 1e-7;
/// Covariances are matched to this share of the variance.
constexpr double kTolerance = 1e-9;
constexpr int kMaxSteps = 100;
/// No stored field has a smaller denominator anywhere: drawing in single precision loses
/// 10 % there, at the very peak of the spectrum.
constexpr double kSmallestDenominator = 1e-5;

int reach_of(const std::vector<Offset>& offsets) {
    int reach = 1;
    for (const Offset s : offsets)
        reach = std::max({reach, std::abs(int{s.row}), std::abs(int{s.col})});
    return reach;
}

/// The likelihood on one frequency grid, for covariances of variance 1.
class Likelihood {
  public:
    Likelihood(const std::vector<Offset>& offsets, const Vector& target, int grid)
        : offsets_(offsets),
          target_(target),
          reach_(reach_of(offsets)),
          polynomial_(grid, grid, reach_),
          curvature_(grid, grid, 2 * reach_) {}

    /// q_t = θ_0 - 2 Σ θ_s cos ω·s
    [[nodiscard]] RowMatrix denominator(const Vector& x) const {
        return polynomial_.spectrum(
            inverse_covariance({offsets_, x(0), {x.data() + 1, x.data() + x.size()}}));
    }

    /// ℓ, or minus infinity where q is not positive.
    [[nodiscard]] double value(const Vector& x, const RowMatrix& q) const {
        const double logarithm = polynomial_.mean_log(q);
        return std::isnan(logarithm) ? -HUGE_VAL : logarithm / 2 - target_.dot(x);
    }

    struct Step {
        Vector gradient;
        Vector newton;
    };
    //     ∂ℓ/∂θ_0 = ½ (r(0) - R(0))     ∂ℓ/∂θ_s = R(s) - r(s)      r the lags of 1/q
    //     -∂²ℓ:  ½ c(0)    -c(s)    c(s-t) + c(s+t)                c the lags of 1/q²
    [[nodiscard]] Step step(const RowMatrix& q) const {
        const RowMatrix S = q.cwiseInverse();
        const Autocovariance r = polynomial_.even(S);
        const Autocovariance c = curvature_.even(S.cwiseAbs2());
        const Index n = static_cast<Index>(offsets_.size());
        Vector gradient = -target_;
        RowMatrix H(n + 1, n + 1);
        gradient(0) += r.variance() / 2;
        H(0, 0) = c.variance() / 2;
        for (Index i = 0; i < n; ++i) {
            const Offset s = offsets_[static_cast<std::size_t>(i)];
            gradient(i + 1) -= r(s);
            H(0, i + 1) = H(i + 1, 0) = -c(s);
            for (Index j = 0; j < n; ++j) {
                const Offset t = offsets_[static_cast<std::size_t>(j)];
                H(i + 1, j + 1) =
                    c(s.row - t.row, s.col - t.col) + c(s.row + t.row, s.col + t.col);
            }
        }
        return {gradient, Eigen::LDLT<RowMatrix>(H).solve(gradient)};
    }

  private:
    const std::vector<Offset>& offsets_;
    const Vector& target_;  ///< (½ R(0), -R(s)): the linear part of the likelihood
    int reach_;
    LagTransform polynomial_;
    LagTransform curvature_;
};

/// Newton's method with backtracking. \returns whether x had to be moved.
bool ascend(const Likelihood& likelihood, Vector& x) {
    RowMatrix q = likelihood.denominator(x);
    double value = likelihood.value(x, q);
    for (int number = 0; number < kMaxSteps; ++number) {
        const Likelihood::Step step = likelihood.step(q);
        if (step.gradient.cwiseAbs().maxCoeff() < kTolerance) return number > 0;
        const RowMatrix direction = likelihood.denominator(step.newton);
        const double slope = step.gradient.dot(step.newton);
        double length = 1;
        double next = 0;
        RowMatrix next_q;
        while (true) {
            next_q = q + length * direction;
            next = likelihood.value(x + length * step.newton, next_q);
            if (next >= value + 1e-4 * length * slope) break;
            length /= 2;
            if (length < 1e-12) return true;  // as far as rounding allows
        }
        x += length * step.newton;
        q = std::move(next_q);
        value = next;
    }
    return true;
}

/// The denominator, its gradient and its second derivatives at one frequency.
struct Local {
    double value = 1;
    double d1 = 0, d2 = 0;
    double d11 = 0, d12 = 0, d22 = 0;
};

Local local_denominator(const Gmrf2d& field, double omega_1, double omega_2) {
    Local at;
    for (std::size_t i = 0; i < field.a.size(); ++i) {
        const double row = field.neighbourhood[i].row;
        const double col = field.neighbourhood[i].col;
        const double twice = 2 * static_cast<double>(field.a[i]);
        const double cosine = twice * std::cos(omega_1 * row + omega_2 * col);
        const double sine = twice * std::sin(omega_1 * row + omega_2 * col);
        at.value -= cosine;
        at.d1 += row * sine;
        at.d2 += col * sine;
        at.d11 += row * row * cosine;
        at.d12 += row * col * cosine;
        at.d22 += col * col * cosine;
    }
    return at;
}

/// Follows the denominator from a point of a grid to the minimum beside it.
double descend(const Gmrf2d& field, double omega_1, double omega_2) {
    double best = local_denominator(field, omega_1, omega_2).value;
    for (int step = 0; step < 8; ++step) {
        const Local at = local_denominator(field, omega_1, omega_2);
        best = std::min(best, at.value);
        const double determinant = at.d11 * at.d22 - at.d12 * at.d12;
        if (!(at.d11 > 0 && determinant > 0)) break;
        omega_1 -= (at.d22 * at.d1 - at.d12 * at.d2) / determinant;
        omega_2 -= (at.d11 * at.d2 - at.d12 * at.d1) / determinant;
    }
    return best;
}

/// Rounds to the numbers that the file can hold.
void round_to_file(std::vector<float>& a) {
    const int exponent = block_exponent(a);
    for (float& value : a) value = dequantise(quantise(value, exponent), exponent);
}

Gmrf2d scaled(const Gmrf2d& field, double factor) {
    Gmrf2d result = field;
    for (float& a : result.a) a = static_cast<float>(static_cast<double>(a) * factor);
    return result;
}

/// σ² such that the mean of S is the variance.
void set_variance(Gmrf2d& field, double variance) {
    constexpr int kGrid = 256;
    field.variance = 1;
    field.variance =
        static_cast<float>(variance / field_variance(inverse_covariance(field), kGrid));
}

}  // namespace

Result<NaturalGmrf2d> maximise_likelihood(const Autocovariance& R,
                                          const std::vector<Offset>& neighbourhood,
                                          const Gmrf2dOptions& options,
                                          const NaturalGmrf2d* start) {
    const double variance = R.variance();
    if (!(variance > 0))
        return Error{Errc::singular,
                     "a constant plane has no Gaussian Markov random field: variance " +
                         std::to_string(variance)};
    const Index n = static_cast<Index>(neighbourhood.size());
    Vector target(n + 1);
    target(0) = (1 + kWhiteShare) / 2;
    for (Index i = 0; i < n; ++i)
        target(i + 1) = -R(neighbourhood[static_cast<std::size_t>(i)]) / variance;

    Vector x = Vector::Zero(n + 1);
    x(0) = 1;
    if (start != nullptr) {
        x(0) = start->theta_0 * variance;
        for (std::size_t i = 0; i < start->theta.size(); ++i)
            x(static_cast<Index>(i) + 1) = start->theta[i] * variance;
    }
    for (int grid = options.first_grid; grid <= options.last_grid; grid *= 2) {
        const Likelihood likelihood(neighbourhood, target, grid);
        // What is positive on a coarse grid may be negative on a finer one: mixing with
        // white noise, which is valid, leads back into the convex set.
        while (!(likelihood.denominator(x).minCoeff() > 0)) {
            x *= 0.9;
            x(0) += 0.1;
        }
        if (!ascend(likelihood, x)) break;
    }
    NaturalGmrf2d result{neighbourhood, x(0) / variance, {}};
    for (Index i = 0; i < n; ++i) result.theta.push_back(x(i + 1) / variance);
    return result;
}

double smallest_denominator(const Gmrf2d& field) {
    constexpr Index kGrid = 128;
    constexpr std::size_t kFollowed = 16;
    Gmrf2d unit = field;
    unit.variance = 1;
    const Autocovariance b = inverse_covariance(unit);
    const LagTransform lags(kGrid, kGrid, b.reach());
    const RowMatrix q = lags.spectrum(b);
    struct Site {
        double value;
        Index m, n;
    };
    std::vector<Site> minima;
    for (Index m = 0; m < kGrid; ++m)
        for (Index n = 0; n < q.cols(); ++n) {
            const Index before = (m + kGrid - 1) % kGrid;
            const Index after = (m + 1) % kGrid;
            const double value = q(m, n);
            const bool lowest = value <= q(before, n) && value <= q(after, n) &&
                                (n == 0 || value <= q(m, n - 1)) &&
                                (n + 1 == q.cols() || value <= q(m, n + 1));
            if (lowest) minima.push_back({value, m, n});
        }
    std::sort(minima.begin(), minima.end(),
              [](const Site& x, const Site& y) { return x.value < y.value; });
    minima.resize(std::min(minima.size(), kFollowed));
    double smallest = q.minCoeff();
    constexpr double kStep = 2 * 3.14159265358979323846 / static_cast<double>(kGrid);
    for (const Site& site : minima)
        smallest = std::min(smallest, descend(field, kStep * static_cast<double>(site.m),
                                              kStep * static_cast<double>(site.n)));
    return smallest;
}

Gmrf2d shrunk(const Gmrf2d& field, double smallest, double variance) {
    const double lowest = smallest_denominator(field);
    // 1 - g A >= smallest, where 1 - A is lowest.
    Gmrf2d result =
        lowest < smallest ? scaled(field, (1 - smallest) / (1 - lowest)) : field;
    set_variance(result, variance);
    return result;
}

Autocovariance inverse_covariance(const NaturalGmrf2d& field) {
    Autocovariance b(reach_of(field.neighbourhood), 0);
    b.at(0, 0) = field.theta_0;
    for (std::size_t i = 0; i < field.theta.size(); ++i) {
        const Offset s = field.neighbourhood[i];
        b.at(s.row, s.col) -= field.theta[i];
        if (s.row == 0) b.at(0, -s.col) -= field.theta[i];
    }
    return b;
}

Gmrf2d to_material(const NaturalGmrf2d& field, double variance) {
    Gmrf2d exact{field.neighbourhood, {}, 0};
    for (const double theta : field.theta)
        exact.a.push_back(static_cast<float>(theta / field.theta_0));
    Gmrf2d result = exact;
    round_to_file(result.a);
    const double lowest = smallest_denominator(exact);
    for (double smallest = 2 * kSmallestDenominator;
         smallest_denominator(result) < kSmallestDenominator && smallest < 1;
         smallest *= 2) {
        result = lowest < smallest ? scaled(exact, (1 - smallest) / (1 - lowest)) : exact;
        round_to_file(result.a);
    }
    set_variance(result, variance);
    return result;
}

Result<Gmrf2d> maximise_pseudo_likelihood(const Autocovariance& R,
                                          const std::vector<Offset>& neighbourhood) {
    const Index n = static_cast<Index>(neighbourhood.size());
    RowMatrix Q(n, n);
    Vector QY(n);
    for (Index i = 0; i < n; ++i) {
        const Offset s = neighbourhood[static_cast<std::size_t>(i)];
        QY(i) = 2 * R(s);
        for (Index j = 0; j < n; ++j) {
            const Offset t = neighbourhood[static_cast<std::size_t>(j)];
            Q(i, j) =
                2 * R(s.row - t.row, s.col - t.col) + 2 * R(s.row + t.row, s.col + t.col);
        }
    }
    const Eigen::LLT<RowMatrix> cholesky(Q);
    if (!(R.variance() > 0) || cholesky.info() != Eigen::Success)
        return Error{Errc::singular, "the covariances of " + std::to_string(n) +
                                         " neighbours are not positive definite"};
    const Vector a = cholesky.solve(QY);
    Gmrf2d field{neighbourhood, {}, static_cast<float>(R.variance() - a.dot(QY))};
    for (Index i = 0; i < n; ++i) field.a.push_back(static_cast<float>(a(i)));
    return field;
}

Result<NaturalGmrf2d> select_gmrf2d(const Autocovariance& R, int max_order) {
    // One grid for all, so that the deviances compare; the winner is refined.
    const Gmrf2dOptions comparing{.first_grid = 64, .last_grid = 64};
    NaturalGmrf2d best;
    NaturalGmrf2d present;
    double best_information = HUGE_VAL;
    for (int order = 1; order <= affordable_order(R.sites(), max_order); ++order) {
        SATEEN_TRY(present,
                   maximise_likelihood(R, hierarchical_half_plane(order), comparing,
                                       order > 1 ? &present : nullptr));
        const double information = bayesian_information(
            whittle_deviance(inverse_covariance(present), R, comparing.last_grid),
            R.sites(), present.theta.size());
        if (!(information < best_information)) continue;
        best_information = information;
        best = present;
    }
    return maximise_likelihood(R, best.neighbourhood, {}, &best);
}

}  // namespace sateen
