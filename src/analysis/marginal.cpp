// SPDX-License-Identifier: Apache-2.0
// Marginal distributions of planes. See marginal.hpp.
#include "sateen/analysis/marginal.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace sateen {
namespace {

// Values are ranked by their leading 18 bits: sign, exponent and 9 bits of mantissa, so
// two values in one bin differ by at most 0.2 %, well below the steps of 8-bit
// photographs, for any range about 0 and with no tuning. Ranks are then a count of 2^18
// bins rather than a sort.
constexpr unsigned kKeyBits = 18;
constexpr std::uint32_t kNoBin = 0xFFFFFFFFU;

/// In the fit of a curve no quantile stands for more than this share of the plane: where
/// values tie, the curve has to be flat over all the ranks that they take up.
constexpr double kQuantileShare = 1.0 / 1024;

/// An integer that orders like the float, cut to its leading bits. Adding 0 makes one
/// value of the two zeros.
std::uint32_t key_of(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);
    const std::uint32_t ordered = (bits >> 31U) != 0 ? ~bits : bits | 0x80000000U;
    return ordered >> (32U - kKeyBits);
}

/// The weights of the two hats that a point lies between.
struct HatPosition {
    std::size_t knot = 0;
    double fraction = 0;
};

HatPosition hat_position(double g) {
    constexpr double kRange = static_cast<double>(Marginal::kRange);
    constexpr double kSteps = static_cast<double>(Marginal::kKnots - 1);
    const double x = (std::clamp(g, -kRange, kRange) + kRange) / (2 * kRange) * kSteps;
    const double knot = std::min(std::floor(x), kSteps - 1);
    return {static_cast<std::size_t>(knot), x - knot};
}

/// Pool adjacent violators: the nearest non-decreasing sequence, weighted.
void make_monotone(Eigen::VectorXd& values, const Eigen::VectorXd& weights) {
    struct Block {
        double value, weight;
        Eigen::Index count;
    };
    std::vector<Block> blocks;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        blocks.push_back({values(i), weights(i), 1});
        while (blocks.size() > 1 &&
               blocks[blocks.size() - 2].value > blocks.back().value) {
            const Block last = blocks.back();
            blocks.pop_back();
            Block& into = blocks.back();
            into.value = (into.value * into.weight + last.value * last.weight) /
                         (into.weight + last.weight);
            into.weight += last.weight;
            into.count += last.count;
        }
    }
    Eigen::Index i = 0;
    for (const Block& block : blocks)
        for (Eigen::Index k = 0; k < block.count; ++k) values(i++) = block.value;
}

}  // namespace

double normal_quantile(double p) {
    constexpr std::array a = {-3.969683028665376e+01, 2.209460984245205e+02,
                              -2.759285104469687e+02, 1.383577518672690e+02,
                              -3.066479806614716e+01, 2.506628277459239e+00};
    constexpr std::array b = {-5.447609879822406e+01, 1.615858368580409e+02,
                              -1.556989798598866e+02, 6.680131188771972e+01,
                              -1.328068155288572e+01};
    constexpr std::array c = {-7.784894002430293e-03, -3.223964580411365e-01,
                              -2.400758277161838e+00, -2.549732539343734e+00,
                              4.374664141464968e+00,  2.938163982698783e+00};
    constexpr std::array d = {7.784695709041462e-03, 3.224671290700398e-01,
                              2.445134137142996e+00, 3.754408661907416e+00};
    const auto tail = [&](double q) {
        return (((((c[0] * q + c[1]) * q + c[2]) * q + c[3]) * q + c[4]) * q + c[5]) /
               ((((d[0] * q + d[1]) * q + d[2]) * q + d[3]) * q + 1);
    };
    double x = 0;
    if (p < 0.02425) {
        x = tail(std::sqrt(-2 * std::log(p)));
    } else if (p > 1 - 0.02425) {
        x = -tail(std::sqrt(-2 * std::log1p(-p)));
    } else {
        const double q = p - 0.5;
        const double r = q * q;
        x = (((((a[0] * r + a[1]) * r + a[2]) * r + a[3]) * r + a[4]) * r + a[5]) * q /
            (((((b[0] * r + b[1]) * r + b[2]) * r + b[3]) * r + b[4]) * r + 1);
    }
    const double error = 0.5 * std::erfc(-x / std::numbers::sqrt2) - p;
    const double u = error * std::sqrt(2 * std::numbers::pi) * std::exp(x * x / 2);
    return x - u / (1 + x * u / 2);
}

double value_at(const Marginal& marginal, double g) {
    const auto scale = static_cast<double>(marginal.scale);
    if (marginal.knots.empty()) return scale * g;
    const HatPosition at = hat_position(g);
    const auto low = static_cast<double>(marginal.knots[at.knot]);
    return scale *
           (low + at.fraction * (static_cast<double>(marginal.knots[at.knot + 1]) - low));
}

MarginalDistribution::MarginalDistribution(
    std::span<const PlaneView<const float>> planes) {
    bin_of_key_.assign(std::size_t{1} << kKeyBits, 0);
    std::vector<double> sums(bin_of_key_.size(), 0.0);
    for (const auto& plane : planes)
        for (std::size_t r = 0; r < plane.rows; ++r)
            for (std::size_t c = 0; c < plane.cols; ++c) {
                const std::uint32_t key = key_of(plane(r, c));
                ++bin_of_key_[key];
                sums[key] += static_cast<double>(plane(r, c));
                count_ += 1;
            }

    double below = 0;
    double sum = 0;
    for (std::size_t key = 0; key < bin_of_key_.size(); ++key) {
        const double count = bin_of_key_[key];
        if (count == 0) {
            bin_of_key_[key] = kNoBin;
            continue;
        }
        bin_of_key_[key] = static_cast<std::uint32_t>(bins_.size());
        const double mid_rank = (below + count / 2) / count_;
        bins_.push_back(
            {sums[key] / count, count, static_cast<float>(normal_quantile(mid_rank))});
        below += count;
        sum += sums[key];
    }
    mean_ = sum / count_;
    double squares = 0;
    for (const Bin& bin : bins_)
        squares += bin.count * (bin.value - mean_) * (bin.value - mean_);
    deviation_ = std::sqrt(squares / count_);
}

void MarginalDistribution::gaussianise(PlaneView<const float> in,
                                       PlaneView<float> out) const {
    for (std::size_t r = 0; r < in.rows; ++r)
        for (std::size_t c = 0; c < in.cols; ++c)
            out(r, c) = bins_[bin_of_key_[key_of(in(r, c))]].normal;
}

Marginal MarginalDistribution::fit_curve() const {
    constexpr auto kKnots = static_cast<Eigen::Index>(Marginal::kKnots);
    // A weak pull towards the Gaussian straight line decides knots that no value reaches;
    // it acts on the second difference and so leaves mean and slope alone.
    constexpr double kSmoothness = 1e-6;
    Eigen::MatrixXd normal_matrix = Eigen::MatrixXd::Zero(kKnots, kKnots);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(kKnots);
    const auto add = [&](double g, double weight, double value) {
        const HatPosition at = hat_position(g);
        const auto j = static_cast<Eigen::Index>(at.knot);
        const double h0 = 1 - at.fraction;
        const double h1 = at.fraction;
        normal_matrix(j, j) += weight * h0 * h0;
        normal_matrix(j, j + 1) += weight * h0 * h1;
        normal_matrix(j + 1, j) += weight * h0 * h1;
        normal_matrix(j + 1, j + 1) += weight * h1 * h1;
        right(j) += weight * h0 * value;
        right(j + 1) += weight * h1 * value;
    };
    double below = 0;
    for (const Bin& bin : bins_) {
        const auto pieces =
            static_cast<std::size_t>(std::ceil(bin.count / (kQuantileShare * count_)));
        const double piece = bin.count / static_cast<double>(pieces);
        for (std::size_t i = 0; i < pieces; ++i) {
            const double rank = (below + (static_cast<double>(i) + 0.5) * piece) / count_;
            const double g =
                pieces == 1 ? static_cast<double>(bin.normal) : normal_quantile(rank);
            add(g, piece, bin.value - mean_);
        }
        below += bin.count;
    }
    for (Eigen::Index j = 1; j + 1 < kKnots; ++j) {
        Eigen::VectorXd second = Eigen::VectorXd::Zero(kKnots);
        second(j - 1) = 1;
        second(j) = -2;
        second(j + 1) = 1;
        normal_matrix += kSmoothness * count_ * second * second.transpose();
    }
    Eigen::VectorXd weights = normal_matrix.rowwise().sum();
    for (Eigen::Index j = 0; j < kKnots; ++j)
        weights(j) = std::max(weights(j), 1e-9 * count_);
    Eigen::VectorXd knots = normal_matrix.ldlt().solve(right);
    make_monotone(knots, weights);

    Marginal marginal;
    marginal.scale = static_cast<float>(deviation_);
    for (Eigen::Index j = 0; j < kKnots; ++j)
        marginal.knots.push_back(static_cast<float>(knots(j) / deviation_));
    return marginal;
}

Marginal MarginalDistribution::without_curve() const {
    Marginal marginal;
    marginal.scale = static_cast<float>(deviation_);
    return marginal;
}

}  // namespace sateen
