// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "analysis/quality_parts.hpp"
#include "analysis/quality_pyramid.hpp"

namespace sateen::quality {
namespace {

constexpr double kFloor = 0.02;  ///< of logarithms and correlations
constexpr std::size_t kLanes = 8;

// Σ f(i) over a row in eight independent sums, which the compiler can keep in registers;
// rows are added in double, since a float sum over 10^5 sites loses two digits.
template <class F>
double sum_row(std::size_t count, F&& f) {
    std::array<float, kLanes> lanes{};
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        for (std::size_t k = 0; k < kLanes; ++k) lanes[k] += f(i + k);
    }
    double sum = 0;
    for (; i < count; ++i) sum += static_cast<double>(f(i));
    for (float lane : lanes) sum += static_cast<double>(lane);
    return sum;
}

double sum_of(PlaneView<const float> a) {
    double sum = 0;
    for (std::size_t r = 0; r < a.rows; ++r) {
        const float* x = a.row(r);
        sum += sum_row(a.cols, [x](std::size_t i) { return x[i]; });
    }
    return sum;
}

double dot(PlaneView<const float> a, PlaneView<const float> b) {
    double sum = 0;
    for (std::size_t r = 0; r < a.rows; ++r) {
        const float* x = a.row(r);
        const float* y = b.row(r);
        sum += sum_row(a.cols, [x, y](std::size_t i) { return x[i] * y[i]; });
    }
    return sum;
}

// Σ a(r, c) a(r + dr, c + dc) on the torus.
double shifted_dot(PlaneView<const float> a, std::size_t dr, std::size_t dc) {
    double sum = 0;
    for (std::size_t r = 0; r < a.rows; ++r) {
        const float* x = a.row(r);
        const float* y = a.row((r + dr) % a.rows);
        sum +=
            sum_row(a.cols - dc, [x, y, dc](std::size_t i) { return x[i] * y[i + dc]; });
        const std::size_t from = a.cols - dc;
        sum += sum_row(dc, [x, y, from](std::size_t i) { return x[from + i] * y[i]; });
    }
    return sum;
}

void subtract_mean(PlaneView<float> a) {
    const auto mean = static_cast<float>(sum_of(a) / static_cast<double>(a.size()));
    for (std::size_t r = 0; r < a.rows; ++r) {
        for (std::size_t c = 0; c < a.cols; ++c) a(r, c) -= mean;
    }
}

// Covariance over the product of deviations, both taken above what is visible, so that
// an empty band correlates with nothing.
double correlation(double covariance, double variance_a, double variance_b) {
    constexpr double kSquare = kInvisible * kInvisible;
    return covariance / std::sqrt((variance_a + kSquare) * (variance_b + kSquare));
}

struct Marginal {
    double log_deviation = 0;
    double peakedness = 0;  ///< log(σ / E|x|): 0.226 for a Gaussian
    double log_kurtosis = 0;
    double asymmetry = 0;  ///< E x|x| / σ²
};

Marginal marginal(PlaneView<const float> band) {
    double absolute = 0;
    double square = 0;
    double fourth = 0;
    double signed_square = 0;
    for (std::size_t r = 0; r < band.rows; ++r) {
        const float* x = band.row(r);
        absolute += sum_row(band.cols, [x](std::size_t i) { return std::abs(x[i]); });
        square += sum_row(band.cols, [x](std::size_t i) { return x[i] * x[i]; });
        fourth += sum_row(band.cols, [x](std::size_t i) {
            const float y = x[i] * x[i];
            return y * y;
        });
        signed_square +=
            sum_row(band.cols, [x](std::size_t i) { return x[i] * std::abs(x[i]); });
    }
    const auto n = static_cast<double>(band.size());
    // As if Gaussian noise of invisible strength had been added: an empty band is
    // Gaussian.
    constexpr double kSquare = kInvisible * kInvisible;
    constexpr double kGaussianAbsolute = 0.7978845608;
    const double variance = square / n + kSquare;
    return {0.5 * std::log(variance),
            std::log(std::sqrt(variance) /
                     std::hypot(absolute / n, kGaussianAbsolute * kInvisible)),
            std::log((fourth / n + 6 * kSquare * square / n + 3 * kSquare * kSquare) /
                     (variance * variance)),
            signed_square / (n * variance)};
}

// One group of features per statistic, over the bands given.
void add_marginals(const std::vector<PlaneView<const float>>& bands, double weight,
                   Features& features) {
    std::vector<Marginal> marginals;
    for (const auto& band : bands) marginals.push_back(marginal(band));
    struct Statistic {
        double Marginal::*value;
        double share;
        double floor;
    };
    // The deviation counts little: it is the power spectrum once more.
    constexpr std::array<Statistic, 4> kStatistics = {
        {{&Marginal::log_deviation, 0.1, 0.1},
         {&Marginal::peakedness, 0.3, kFloor},
         {&Marginal::log_kurtosis, 0.3, kFloor},
         {&Marginal::asymmetry, 0.3, kFloor}}};
    for (const Statistic& statistic : kStatistics) {
        features.begin_group(weight * statistic.share, statistic.floor);
        for (const Marginal& m : marginals) features.add(m.*statistic.value);
    }
}

// Magnitudes at the sites of the next coarser level, which are the even sites, smoothed
// by [1 2 1]/4 on both axes.
Image at_parent_sites(const Image& child) {
    Image out(child.bands(), child.rows() / 2, child.cols() / 2);
    for (std::size_t b = 0; b < out.bands(); ++b) {
        for (std::size_t r = 0; r < out.rows(); ++r) {
            const float* above =
                child.plane(b).row((2 * r + child.rows() - 1) % child.rows());
            const float* here = child.plane(b).row(2 * r);
            const float* below = child.plane(b).row(2 * r + 1);
            const auto column = [&](std::size_t c) {
                return above[c] + 2 * here[c] + below[c];
            };
            for (std::size_t c = 0; c < out.cols(); ++c) {
                const std::size_t left = (2 * c + child.cols() - 1) % child.cols();
                constexpr float kSixteenth = 1.0F / 16;
                out(b, r, c) =
                    kSixteenth * (column(left) + 2 * column(2 * c) + column(2 * c + 1));
            }
        }
    }
    return out;
}

std::array<double, kOrientations> variances(const Image& centred) {
    std::array<double, kOrientations> v{};
    for (std::size_t k = 0; k < kOrientations; ++k) {
        v[k] = dot(centred.plane(k), centred.plane(k)) /
               static_cast<double>(centred.plane_size());
    }
    return v;
}

Image centred(Image magnitude) {
    for (std::size_t k = 0; k < magnitude.bands(); ++k) subtract_mean(magnitude.plane(k));
    return magnitude;
}

// Correlations of the magnitudes of two orientations at one scale.
void add_orientations(const Image& magnitude, double weight, Features& features) {
    const auto variance = variances(magnitude);
    const auto n = static_cast<double>(magnitude.plane_size());
    features.begin_group(weight, kFloor);
    for (std::size_t k = 0; k < kOrientations; ++k) {
        for (std::size_t l = k + 1; l < kOrientations; ++l) {
            features.add(correlation(dot(magnitude.plane(k), magnitude.plane(l)) / n,
                                     variance[k], variance[l]));
        }
    }
}

// Autocorrelations of magnitudes: how energy clusters.
void add_clustering(const Image& magnitude, double weight, Features& features) {
    struct Lag {
        std::size_t rows;
        std::size_t cols;
    };
    constexpr std::array<Lag, 4> kLags = {{{0, 2}, {2, 0}, {0, 4}, {4, 0}}};
    const auto variance = variances(magnitude);
    const auto n = static_cast<double>(magnitude.plane_size());
    features.begin_group(weight, kFloor);
    for (std::size_t k = 0; k < kOrientations; ++k) {
        for (const Lag& lag : kLags) {
            features.add(
                correlation(shifted_dot(magnitude.plane(k), lag.rows, lag.cols) / n,
                            variance[k], variance[k]));
        }
    }
}

// Magnitudes of a scale against those of the next coarser one, all orientations.
void add_parents(const Image& child, const Image& parent, double weight,
                 Features& features) {
    const auto child_variance = variances(child);
    const auto parent_variance = variances(parent);
    const auto n = static_cast<double>(parent.plane_size());
    features.begin_group(weight, kFloor);
    for (std::size_t k = 0; k < kOrientations; ++k) {
        for (std::size_t l = 0; l < kOrientations; ++l) {
            features.add(correlation(dot(child.plane(k), parent.plane(l)) / n,
                                     child_variance[k], parent_variance[l]));
        }
    }
}

// Phase of a band against the doubled phase of its parent, z²/|z|: edges and lines keep
// the two in step [Portilla & Simoncelli 2000, section 2.2.3].
void add_phases(const PyramidLevel& child, const PyramidLevel& parent, double weight,
                Features& features) {
    features.begin_group(weight, kFloor);
    for (std::size_t k = 0; k < kOrientations; ++k) {
        double real = 0;
        double imaginary = 0;
        double child_power = 0;
        double parent_power = 0;
        for (std::size_t r = 0; r < parent.re.rows(); ++r) {
            for (std::size_t c = 0; c < parent.re.cols(); ++c) {
                const float a = parent.re(k, r, c);
                const float b = parent.im(k, r, c);
                const float scale = 1 / std::max(parent.magnitude(k, r, c), 1e-20F);
                const float doubled_re = (a * a - b * b) * scale;
                const float doubled_im = 2 * a * b * scale;
                const float x = child.re(k, 2 * r, 2 * c);
                const float y = child.im(k, 2 * r, 2 * c);
                real += static_cast<double>(x * doubled_re + y * doubled_im);
                imaginary += static_cast<double>(y * doubled_re - x * doubled_im);
                child_power += static_cast<double>(x * x + y * y);
                parent_power += static_cast<double>(a * a + b * b);
            }
        }
        const auto n = static_cast<double>(parent.re.plane_size());
        features.add(correlation(real / n, child_power / n, parent_power / n));
        features.add(correlation(imaginary / n, child_power / n, parent_power / n));
    }
}

// Two planes at one scale: their bands, and the magnitudes of their bands.
void add_planes(const PyramidLevel& a, const PyramidLevel& b, const Image& magnitude_a,
                const Image& magnitude_b, double weight, Features& features) {
    const auto add = [&features](const Image& x, const Image& y) {
        const auto variance_x = variances(x);
        const auto variance_y = variances(y);
        for (std::size_t k = 0; k < kOrientations; ++k) {
            features.add(correlation(
                dot(x.plane(k), y.plane(k)) / static_cast<double>(x.plane_size()),
                variance_x[k], variance_y[k]));
        }
    };
    features.begin_group(weight / 2, kFloor);
    add(a.re, b.re);
    features.begin_group(weight / 2, kFloor);
    add(magnitude_a, magnitude_b);
}

}  // namespace

void add_subbands(const std::vector<SteerableBands>& planes,
                  const std::vector<double>& weights, Features& features) {
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const SteerableBands& bands = planes[p];
        const double share = weights[p] / static_cast<double>(bands.levels.size() + 1);
        add_marginals({bands.high.plane(0)}, share / 2, features);
        for (const PyramidLevel& level : bands.levels) {
            add_marginals({level.re.plane(0), level.re.plane(1), level.re.plane(2),
                           level.re.plane(3)},
                          share, features);
        }
        add_marginals({bands.low.plane(0)}, share / 2, features);
    }
}

void add_joint(const std::vector<SteerableBands>& planes,
               const std::vector<double>& weights, Features& features) {
    std::vector<std::vector<Image>> magnitudes(planes.size());
    for (std::size_t p = 0; p < planes.size(); ++p) {
        for (const PyramidLevel& level : planes[p].levels) {
            magnitudes[p].push_back(centred(level.magnitude));
        }
    }
    double total = 1;
    for (std::size_t p = 1; p < planes.size(); ++p) total += weights[p];

    for (std::size_t p = 0; p < planes.size(); ++p) {
        const auto& levels = planes[p].levels;
        const double share = weights[p] / (total * static_cast<double>(levels.size()));
        for (std::size_t s = 0; s < levels.size(); ++s) {
            const bool has_parent = s + 1 < levels.size();
            const double part = share / (has_parent ? 4 : 2);
            add_orientations(magnitudes[p][s], part, features);
            add_clustering(magnitudes[p][s], part, features);
            if (has_parent) {
                add_parents(centred(at_parent_sites(levels[s].magnitude)),
                            magnitudes[p][s + 1], part, features);
                add_phases(levels[s], levels[s + 1], part, features);
            }
            // A plane against the ones before it, at its own weight.
            for (std::size_t q = 0; q < p; ++q) {
                add_planes(planes[q].levels[s], levels[s], magnitudes[q][s],
                           magnitudes[p][s], share / static_cast<double>(p), features);
            }
        }
    }
}

}  // namespace sateen::quality
