// SPDX-License-Identifier: Apache-2.0
// Band modulation. See band_modulation.hpp.
#include "analysis/band_modulation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "analysis/smooth_field.hpp"
#include "core/band_rows.hpp"
#include "material/modulate.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/analysis/translation.hpp"
#include "sateen/core/fft.hpp"
#include "sateen/core/normal.hpp"
#include "sateen/material/smooth_density.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLevels = BandModulation::kLevels;
constexpr std::size_t kKnots = AmplitudeCurve::kKnots;
constexpr std::size_t kFeatures = 3;
constexpr std::size_t kUnknowns = kFeatures * kKnots;
/// Of the random phases of the trial: none that a texture uses.
constexpr std::uint32_t kTrialBand = 128;
constexpr std::uint64_t kTrialSeed = 0;
/// Of the regression, in parts of the number of samples: of the squares of the values, and of
/// their second differences.
constexpr double kRidge = 1e-3;
constexpr double kStiffness = 3e-3;
/// Fields that vary less are left out.
constexpr double kLeastFieldVariance = 0.003;
/// A band with a smaller share of the variance of its plane is left alone: it is not seen, and
/// what varies in it is rounding.
constexpr double kLeastBandShare = 1e-3;
/// A field varies at most so many times as much as the first comparison said: a band that
/// answers less to it has another reason.
constexpr double kMostGrowth = 2;
/// Times that a trial is drawn and compared.
constexpr int kTrials = 3;
/// How far knots and marginal curves reach.
constexpr double kOutermost = 0.00135;

double variance_of(PlaneView<const float> plane) {
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const auto value = static_cast<double>(plane.data[i]);
        sum += value;
        squares += value * value;
    }
    const double n = static_cast<double>(plane.size());
    return std::max(0.0, squares / n - sum * sum / (n * n));
}

/// The bands of one plane with what their amplitudes are explained by, standardised.
struct BandFeatures {
    Image amplitude;  ///< (levels): ½ L(E / variance)
    Image value;      ///< (levels): of what is coarser, over its deviation
    std::array<bool, kLevels> seen{};  ///< the band has a share in the plane
};

BandFeatures features_of(PlaneView<const float> plane, Border border,
                         Executor& executor) {
    BandFeatures out;
    out.amplitude = Image(kLevels, plane.rows, plane.cols, uninitialised);
    out.value = Image(kLevels, plane.rows, plane.cols, uninitialised);
    Image work(3, plane.rows, plane.cols, uninitialised);
    const double whole = variance_of(plane);
    PlaneView<const float> from = plane;
    for (std::size_t level = 0; level < kLevels; ++level) {
        const PlaneView<float> band = work.plane(0);
        const PlaneView<float> low = out.value.plane(level);
        split_band(from, std::size_t{1} << level, border, band, low, executor);
        const PlaneView<float> energy = work.plane(2);
        local_energy(band, level, border, work.plane(1), energy, executor);
        const double variance = variance_of(band);
        out.seen[level] = variance > kLeastBandShare * whole;
        const auto scale = static_cast<float>(variance > 0 ? 1 / variance : 0);
        for (std::size_t r = 0; r < plane.rows; ++r)
            log_amplitude_row(energy.row(r), scale, out.amplitude.plane(level).row(r),
                              plane.cols);
        from = low;
    }
    for (std::size_t level = 0; level < kLevels; ++level) {
        const PlaneView<float> low = out.value.plane(level);
        const double deviation = std::sqrt(variance_of(low));
        const auto scale = static_cast<float>(deviation > 0 ? 1 / deviation : 0);
        for (std::size_t i = 0; i < low.size(); ++i) low.data[i] *= scale;
    }
    return out;
}

/// The two hats that a value lies between.
struct Hats {
    std::size_t first;
    double part;
};

Hats hats_at(float x, float low, float high) {
    const double t =
        std::clamp((static_cast<double>(x) - static_cast<double>(low)) /
                       (static_cast<double>(high) - static_cast<double>(low)),
                   0.0, 1.0) *
        static_cast<double>(kKnots - 1);
    const auto j = std::min(static_cast<std::size_t>(t), kKnots - 2);
    return {j, t - static_cast<double>(j)};
}

/// The features of a site of one plane and level as weights of the unknowns.
class Explanation {
  public:
    Explanation(const BandFeatures& own, const BandFeatures* first, std::size_t level)
        : own_(own), first_(first), level_(level) {}

    struct Site {
        std::array<std::size_t, 2 * kFeatures> unknown{};
        std::array<double, 2 * kFeatures> weight{};
        std::size_t count = 0;
    };
    [[nodiscard]] Site at(std::size_t r, std::size_t c) const {
        Site site;
        add(0,
            hats_at(own_.value(level_, r, c), -ModulatedBand::kValueRange,
                    ModulatedBand::kValueRange),
            site);
        if (level_ + 1 < kLevels) add(1, of_amplitude(own_, level_ + 1, r, c), site);
        if (first_ != nullptr) add(2, of_amplitude(*first_, level_, r, c), site);
        return site;
    }
    [[nodiscard]] float amplitude(std::size_t r, std::size_t c) const {
        return own_.amplitude(level_, r, c);
    }

  private:
    static Hats of_amplitude(const BandFeatures& of, std::size_t level, std::size_t r,
                             std::size_t c) {
        return hats_at(of.amplitude(level, r, c), ModulatedBand::kAmplitudeLow,
                       ModulatedBand::kAmplitudeHigh);
    }
    static void add(std::size_t feature, Hats hats, Site& site) {
        site.unknown[site.count] = feature * kKnots + hats.first;
        site.weight[site.count++] = 1 - hats.part;
        site.unknown[site.count] = feature * kKnots + hats.first + 1;
        site.weight[site.count++] = hats.part;
    }
    const BandFeatures& own_;
    const BandFeatures* first_;
    std::size_t level_;
};

using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

double value_at(const Explanation::Site& site, const Unknowns& theta) {
    double sum = 0;
    for (std::size_t i = 0; i < site.count; ++i)
        sum += site.weight[i] * theta(static_cast<Eigen::Index>(site.unknown[i]));
    return sum;
}

struct Regression {
    Unknowns theta = Unknowns::Zero();
    double mean = 0;  ///< of the amplitude
};

/// Least squares of the amplitude, about its mean, on the curves.
Regression regress(const Explanation& explanation, std::size_t rows, std::size_t cols,
                   std::size_t stride) {
    Normal G = Normal::Zero();
    Unknowns h = Unknowns::Zero();
    Unknowns occupancy = Unknowns::Zero();
    double sum = 0;
    double n = 0;
    for (std::size_t r = 0; r < rows; r += stride)
        for (std::size_t c = 0; c < cols; c += stride) {
            const auto site = explanation.at(r, c);
            const auto y = static_cast<double>(explanation.amplitude(r, c));
            sum += y;
            n += 1;
            for (std::size_t i = 0; i < site.count; ++i) {
                const auto a = static_cast<Eigen::Index>(site.unknown[i]);
                h(a) += site.weight[i] * y;
                occupancy(a) += site.weight[i];
                for (std::size_t j = 0; j < site.count; ++j)
                    G(a, static_cast<Eigen::Index>(site.unknown[j])) +=
                        site.weight[i] * site.weight[j];
            }
        }
    Regression result;
    result.mean = sum / n;
    h -= result.mean * occupancy;
    for (Eigen::Index k = 0; k < G.rows(); ++k) G(k, k) += kRidge * n;
    for (std::size_t feature = 0; feature < kFeatures; ++feature)
        for (std::size_t j = 0; j + 2 < kKnots; ++j) {
            const auto a = static_cast<Eigen::Index>(feature * kKnots + j);
            const std::array<double, 3> d = {1, -2, 1};
            for (Eigen::Index i = 0; i < 3; ++i)
                for (Eigen::Index k = 0; k < 3; ++k)
                    G(a + i, a + k) += kStiffness * n * d[static_cast<std::size_t>(i)] *
                                       d[static_cast<std::size_t>(k)];
        }
    result.theta = G.ldlt().solve(h);
    return result;
}

/// What the curves leave of the amplitude, on every spacing-th pixel.
Image remainder_of(const Explanation& explanation, const Regression& fit,
                   std::size_t rows, std::size_t cols, std::size_t spacing) {
    Image out(1, rows / spacing, cols / spacing);
    for (std::size_t r = 0; r < out.rows(); ++r)
        for (std::size_t c = 0; c < out.cols(); ++c) {
            const std::size_t y = r * spacing;
            const std::size_t x = c * spacing;
            out(0, r, c) =
                static_cast<float>(static_cast<double>(explanation.amplitude(y, x)) -
                                   fit.mean - value_at(explanation.at(y, x), fit.theta));
        }
    return out;
}

/// Sample covariances over lags (0 … down, 0 … across), those of (r, c) and (r, -c)
/// averaged, by a transform of the sample with zeros about it.
Result<CovarianceTable> covariances_of(PlaneView<const float> sample,
                                       Executor& executor) {
    CovarianceTable table(sample.rows, sample.cols);
    Image padded(1, fft_size_at_least(sample.rows + table.down),
                 fft_size_at_least(sample.cols + table.across));
    for (std::size_t r = 0; r < sample.rows; ++r)
        std::copy_n(sample.row(r), sample.cols, padded.plane(0).row(r));
    SATEEN_TRY(const Fft2d fft, Fft2d::create(padded.rows(), padded.cols()));
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    const SplitComplexView<float> s = spectrum.view();
    fft.forward(padded.plane(0), s, executor);
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            s.re(m, n) = s.re(m, n) * s.re(m, n) + s.im(m, n) * s.im(m, n);
            s.im(m, n) = 0;
        }
    fft.inverse(s, padded.plane(0), executor);
    for (std::size_t r = 0; r <= table.down; ++r)
        for (std::size_t c = 0; c <= table.across; ++c) {
            const std::size_t mirrored = c == 0 ? 0 : padded.cols() - c;
            const double sum = static_cast<double>(padded(0, r, c)) +
                               static_cast<double>(padded(0, r, mirrored));
            table(r, c) =
                sum / static_cast<double>(2 * (sample.rows - r) * (sample.cols - c));
        }
    return table;
}

/// Planes of the same power spectra and random phases.
Result<Image> with_random_phases(const Image& planes, bool together, Executor& executor) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(planes.rows(), planes.cols()));
    Image out(planes.bands(), planes.rows(), planes.cols(), uninitialised);
    SplitComplexPlane noise(fft.rows(), fft.spectrum_cols());
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    for (std::size_t plane = 0; plane < planes.bands(); ++plane) {
        if (plane == 0 || !together) {
            const PlaneView<float> white = out.plane(plane);
            parallel_for(executor, white.rows, [&](std::size_t r) {
                draw_normals({kTrialSeed, kTrialBand + static_cast<std::uint32_t>(plane)},
                             static_cast<std::int32_t>(r), 0, {white.row(r), white.cols});
            });
            fft.forward(white, noise.view(), executor);
        }
        fft.forward(planes.plane(plane), spectrum.view(), executor);
        const SplitComplexView<float> s = spectrum.view();
        const SplitComplexView<float> n = noise.view();
        for (std::size_t k = 0; k < fft.rows(); ++k)
            for (std::size_t l = 0; l < fft.spectrum_cols(); ++l) {
                const float length = std::hypot(n.re(k, l), n.im(k, l));
                const float re = length > 0 ? n.re(k, l) / length : 1.0F;
                const float im = length > 0 ? n.im(k, l) / length : 0.0F;
                const float a = s.re(k, l);
                const float b = s.im(k, l);
                s.re(k, l) = a * re - b * im;
                s.im(k, l) = a * im + b * re;
            }
        fft.inverse(s, out.plane(plane), executor);
    }
    return out;
}

/// The variance of the curves over an image.
double variance_explained(const Explanation& explanation, const Unknowns& theta,
                          std::size_t rows, std::size_t cols, std::size_t stride) {
    double sum = 0;
    double squares = 0;
    double n = 0;
    for (std::size_t r = 0; r < rows; r += stride)
        for (std::size_t c = 0; c < cols; c += stride) {
            const double p = value_at(explanation.at(r, c), theta);
            sum += p;
            squares += p * p;
            n += 1;
        }
    return squares / n - sum * sum / (n * n);
}

AmplitudeCurve stored(const Unknowns& theta, std::size_t feature) {
    AmplitudeCurve curve;
    for (std::size_t j = 0; j < kKnots; ++j)
        curve.values[j] = static_cast<std::int8_t>(
            std::clamp(std::round(theta(static_cast<Eigen::Index>(feature * kKnots + j)) /
                                  static_cast<double>(AmplitudeCurve::kStep)),
                       -127.0, 127.0));
    return curve;
}

/// A realisation of a smooth field on every pixel of a torus.
Result<void> draw_trial_field(const SmoothField& field, std::size_t level,
                              PlaneView<float> out, Executor& executor) {
    SATEEN_TRY(const Fft2d fft, Fft2d::create(out.rows, out.cols));
    const auto band = static_cast<std::uint32_t>(kTrialBand + 8 + level);
    for (std::size_t r = 0; r < out.rows; ++r)
        draw_normals({kTrialSeed, band}, static_cast<std::int32_t>(r), 0,
                     {out.row(r), out.cols});
    SplitComplexPlane spectrum(fft.rows(), fft.spectrum_cols());
    fft.forward(out, spectrum.view(), executor);
    const auto scale = static_cast<double>(field_spacing(level));
    const Image density = smooth_density(field, out.rows, out.cols, scale, scale);
    for (std::size_t m = 0; m < fft.rows(); ++m)
        for (std::size_t n = 0; n < fft.spectrum_cols(); ++n) {
            const float root = std::sqrt(density(0, m, n));
            spectrum.view().re(m, n) *= root;
            spectrum.view().im(m, n) *= root;
        }
    fft.inverse(spectrum.view(), out, executor);
    return {};
}

double quantile(const std::vector<float>& sorted, double p) {
    const double x = p * static_cast<double>(sorted.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(x), sorted.size() - 2);
    const auto low = static_cast<double>(sorted[i]);
    return low +
           (x - static_cast<double>(i)) * (static_cast<double>(sorted[i + 1]) - low);
}

/// q(g)/scale
double value_of(const Marginal& marginal, double g) {
    if (marginal.knots.empty()) return g;
    constexpr auto kRange = static_cast<double>(Marginal::kRange);
    const double t = (std::clamp(g, -kRange, kRange) + kRange) *
                     (static_cast<double>(Marginal::kKnots - 1) / (2 * kRange));
    const auto j = std::min(static_cast<std::size_t>(t), Marginal::kKnots - 2);
    const auto low = static_cast<double>(marginal.knots[j]);
    return low + (t - static_cast<double>(j)) *
                     (static_cast<double>(marginal.knots[j + 1]) - low);
}

/// The curve that gives modulated values y the distribution that q gives normal ones,
/// q'(y) = q(Φ⁻¹(F(y))).
Marginal curve_of_modulated(const Marginal& marginal, const std::vector<float>& sorted,
                            float unit) {
    Marginal result = marginal;
    result.knots.assign(Marginal::kKnots, 0);
    constexpr double kStep =
        2 * static_cast<double>(Marginal::kRange) / (Marginal::kKnots - 1);
    const double n = static_cast<double>(sorted.size());
    for (std::size_t j = 0; j < Marginal::kKnots; ++j) {
        const double y =
            (-static_cast<double>(Marginal::kRange) + kStep * static_cast<double>(j)) /
            static_cast<double>(unit);
        const auto below =
            std::ranges::lower_bound(sorted, static_cast<float>(y)) - sorted.begin();
        const double p =
            std::clamp((static_cast<double>(below) + 0.5) / n, 1e-4, 1 - 1e-4);
        result.knots[j] = static_cast<float>(value_of(marginal, normal_quantile(p)));
    }
    return result;
}

/// Fits by drawing: what the photograph's amplitudes show and those of a trial do not yet is
/// added to curves and fields, and the trial is drawn again.
class ModulationEstimate {
  public:
    ModulationEstimate(const Image& planes, const std::vector<Marginal>& marginals,
                       const ModulationOptions& options, Executor& executor)
        : planes_(planes),
          marginals_(marginals),
          options_(options),
          executor_(executor) {}

    Result<ModulationFit> run() {
        SATEEN_CHECK(prepare());
        ModulationFit fit;
        if (options_.shared != nullptr) {
            fit.modulation = *options_.shared;
            SATEEN_CHECK(calibrate(gaussian_, fit));
            return fit;
        }
        fit.modulation.curves.bands.resize(planes_.bands() * kLevels);
        fit.modulation.curves.units.assign(planes_.bands(), 1.0F);
        seen_ = features_of_ranks(planes_, Border::mirror);
        theta_.assign(planes_.bands() * kLevels, Unknowns::Zero());
        Image drawn = gaussian_;
        for (int trial = 0; trial < kTrials; ++trial) {
            SATEEN_CHECK(compare(drawn, trial == 0, fit));
            drawn = gaussian_;
            SATEEN_CHECK(calibrate(drawn, fit));
        }
        return fit;
    }

  private:
    [[nodiscard]] bool varies(std::size_t plane) const {
        return marginals_[plane].scale > 0;
    }

    /// Gaussian fields of the spectra that will be drawn.
    Result<void> prepare() {
        Image behind(planes_.bands(), planes_.rows(), planes_.cols());
        for (std::size_t plane = 0; plane < planes_.bands(); ++plane) {
            if (!varies(plane)) continue;
            SATEEN_CHECK(gaussian_behind_curve(planes_.plane(plane), marginals_[plane],
                                               behind.plane(plane), executor_));
        }
        SATEEN_TRY(gaussian_, with_random_phases(behind, options_.joint, executor_));
        return {};
    }

    /// Features of planes that are made Gaussian by ranks.
    std::vector<BandFeatures> features_of_ranks(const Image& planes, Border border) {
        std::vector<BandFeatures> features(planes.bands());
        Image ranked(1, planes.rows(), planes.cols());
        for (std::size_t plane = 0; plane < planes.bands(); ++plane) {
            if (!varies(plane)) continue;
            const PlaneView<const float> view = planes.plane(plane);
            MarginalDistribution({&view, 1}).gaussianise(view, ranked.plane(0));
            features[plane] =
                features_of(std::as_const(ranked).plane(0), border, executor_);
        }
        return features;
    }

    /// Adds to curves and fields what a trial lacks. What Gaussian fields lack is the excess.
    Result<void> compare(const Image& trial, bool gaussian, ModulationFit& fit) {
        const std::vector<BandFeatures> drawn = features_of_ranks(trial, Border::wrap);
        for (std::size_t plane = 0; plane < planes_.bands(); ++plane)
            for (std::size_t level = 0; varies(plane) && level < kLevels; ++level)
                if (seen_[plane].seen[level])
                    SATEEN_CHECK(compare(drawn, plane, level, gaussian, fit));
        return {};
    }

    Result<void> compare(const std::vector<BandFeatures>& drawn, std::size_t plane,
                         std::size_t level, bool gaussian, ModulationFit& fit) {
        const std::size_t rows = planes_.rows();
        const std::size_t cols = planes_.cols();
        const std::size_t stride = std::max<std::size_t>(2, std::size_t{1} << level);
        const bool follows = plane > 0 && varies(0);
        const Explanation of_seen(seen_[plane], follows ? seen_.data() : nullptr, level);
        const Explanation of_drawn(drawn[plane], follows ? drawn.data() : nullptr, level);
        const Regression a = regress(of_seen, rows, cols, stride);
        const Regression b = regress(of_drawn, rows, cols, stride);
        Unknowns& theta = theta_[plane * kLevels + level];
        theta += a.theta - b.theta;
        ModulatedBand& band = fit.modulation.curves.bands[plane * kLevels + level];
        band.of_value = stored(theta, 0);
        band.of_parent = stored(theta, 1);
        band.of_first = stored(theta, 2);
        if (plane > 0) return {};
        if (gaussian)
            fit.excess +=
                variance_explained(of_seen, theta, rows, cols, stride) / kLevels;

        const std::size_t spacing = field_spacing(level);
        const auto covariances = [&](const Explanation& of, const Regression& by) {
            const Image rest = remainder_of(of, by, rows, cols, spacing);
            return covariances_of(rest.plane(0), executor_);
        };
        SATEEN_TRY(const CovarianceTable R, covariances(of_seen, a));
        SATEEN_TRY(const CovarianceTable Q, covariances(of_drawn, b));
        if (gaussian) wanted_[level].assign(R.values.size(), 0);
        CovarianceTable lacking = R;
        for (std::size_t k = 0; k < R.values.size(); ++k)
            lacking.values[k] = wanted_[level][k] += R.values[k] - Q.values[k];
        const double variance = lacking(0, 0);
        if (gaussian) fit.excess += std::max(0.0, variance) / kLevels;
        if (gaussian) first_variance_[level] = variance;
        SmoothField& field = fit.modulation.fields.fields[level];
        field =
            variance > kLeastFieldVariance ? fit_smooth_field(lacking) : SmoothField{};
        field.deviation =
            std::min(field.deviation,
                     static_cast<float>(
                         kMostGrowth * std::sqrt(std::max(0.0, first_variance_[level]))));
        if (!(field.deviation > 0)) field = SmoothField{};
        return {};
    }

    /// Scales and gains such that the bands of the trial keep their variances, and the
    /// marginal curves of what comes out.
    Result<void> calibrate(Image& trial, ModulationFit& fit) {
        fit.marginals = marginals_;
        Result<void> drawn;
        const DrawAmplitudeField draw = [&](std::size_t level, PlaneView<float> out,
                                            Executor& threads) {
            const Result<void> done = draw_trial_field(
                fit.modulation.fields.fields[level], level, out, threads);
            if (!done) drawn = done;
        };
        BandModulator modulator(fit.modulation.fields, draw, Border::wrap, trial.view(),
                                executor_);
        for (std::size_t plane = 0; plane < trial.bands(); ++plane) {
            if (!varies(plane)) continue;
            modulator.split(plane);
            for (std::size_t level = kLevels; level-- > 0;) {
                ModulatedBand& band =
                    fit.modulation.curves.bands[plane * kLevels + level];
                const double wanted = variance_of(modulator.band(level));
                const double below = std::sqrt(variance_of(modulator.low()));
                band.value_scale =
                    to_half_of_float(static_cast<float>(below > 0 ? 1 / below : 0));
                band.energy_scale =
                    to_half_of_float(static_cast<float>(wanted > 0 ? 1 / wanted : 0));
                band.gain = 1;
                const double found =
                    variance_of(modulator.tried(plane, level, fit.modulation.curves));
                band.gain = to_half_of_float(
                    static_cast<float>(found > 0 ? std::sqrt(wanted / found) : 1));
                modulator.modulate(plane, level, fit.modulation.curves);
            }
            const PlaneView<const float> out = modulator.low();
            std::vector<float> sorted(out.data, out.data + out.size());
            std::ranges::sort(sorted);
            const double furthest =
                std::max(-quantile(sorted, kOutermost), quantile(sorted, 1 - kOutermost));
            const float unit = to_half_of_float(static_cast<float>(3 / furthest));
            fit.modulation.curves.units[plane] = unit;
            fit.marginals[plane] = curve_of_modulated(marginals_[plane], sorted, unit);
            modulator.finish(plane, unit);
        }
        return drawn;
    }

    const Image& planes_;
    const std::vector<Marginal>& marginals_;
    const ModulationOptions& options_;
    Executor& executor_;
    Image gaussian_;
    std::vector<BandFeatures> seen_;
    std::vector<Unknowns> theta_;
    std::array<double, kLevels> first_variance_{};
    std::array<std::vector<double>, kLevels> wanted_;  ///< covariances of the fields
};

}  // namespace

Result<ModulationFit> fit_band_modulation(const Image& planes,
                                          const std::vector<Marginal>& marginals,
                                          const ModulationOptions& options,
                                          Executor& executor) {
    return ModulationEstimate(planes, marginals, options, executor).run();
}

}  // namespace sateen
