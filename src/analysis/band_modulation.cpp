// SPDX-License-Identifier: Apache-2.0
// Band modulation. See band_modulation.hpp.
#include "analysis/band_modulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/amplitude_regression.hpp"
#include "analysis/modulation_trial.hpp"
#include "analysis/smooth_field.hpp"
#include "analysis/sorted_sample.hpp"
#include "core/plane_moments.hpp"
#include "material/modulate.hpp"
#include "sateen/analysis/marginal.hpp"
#include "sateen/analysis/translation.hpp"

namespace sateen {
namespace {

constexpr std::size_t kLevels = BandModulation::kLevels;
constexpr std::size_t kKnots = AmplitudeCurve::kKnots;
/// Fields that vary less are left out.
constexpr double kLeastFieldVariance = 0.003;
/// A field varies at most so many times as much as the first comparison said: a band that
/// answers less to it has another reason.
constexpr double kMostGrowth = 2;
/// Times that a trial is drawn and compared.
constexpr int kTrials = 3;
/// The same for a subspace that starts with the fields and curves of another.
constexpr int kTrialsOfOthers = 2;
/// How far knots and marginal curves reach.
constexpr double kOutermost = 0.00135;

AmplitudeCurve stored(const AmplitudeKnots& knots, std::size_t feature) {
    AmplitudeCurve curve;
    for (std::size_t j = 0; j < kKnots; ++j)
        curve.values[j] = static_cast<std::int8_t>(
            std::clamp(std::round(knots[feature * kKnots + j] /
                                  static_cast<double>(AmplitudeCurve::kStep)),
                       -127.0, 127.0));
    return curve;
}

AmplitudeKnots knots_of(const ModulatedBand& band) {
    AmplitudeKnots knots{};
    std::size_t i = 0;
    for (const AmplitudeCurve* curve : {&band.of_value, &band.of_parent, &band.of_first})
        for (const std::int8_t value : curve->values)
            knots[i++] = static_cast<double>(AmplitudeCurve::kStep) * value;
    return knots;
}

/// The curve that gives modulated values y the distribution that q gives normal ones,
/// q'(y) = q(Φ⁻¹(F(y))).
Marginal curve_of_modulated(const Marginal& marginal, const SortedSample& drawn,
                            float unit) {
    Marginal result = marginal;
    result.knots.assign(Marginal::kKnots, 0);
    constexpr double kStep =
        2 * static_cast<double>(Marginal::kRange) / (Marginal::kKnots - 1);
    for (std::size_t j = 0; j < Marginal::kKnots; ++j) {
        const double y =
            (-static_cast<double>(Marginal::kRange) + kStep * static_cast<double>(j)) /
            static_cast<double>(unit);
        const double p = std::clamp(drawn.rank(y), 1e-4, 1 - 1e-4);
        result.knots[j] = static_cast<float>(value_at(marginal, normal_quantile(p)) /
                                             static_cast<double>(marginal.scale));
    }
    return result;
}

/// What an image shows of one band of one plane.
struct ShownBand {
    bool seen = false;
    AmplitudeRegression regression;
    std::optional<CovarianceTable> covariances;  ///< of what is left; first plane only
};

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
        knots_.resize(planes_.bands() * kLevels);
        SATEEN_TRY(seen_, shown_by(planes_, Border::mirror));
        Image drawn = gaussian_;
        if (options_.shared != nullptr) {
            fit.modulation = *options_.shared;
            leave_alone(fit.modulation.curves);
            for (std::size_t i = 0; i < knots_.size(); ++i)
                knots_[i] = knots_of(fit.modulation.curves.bands[i]);
            SATEEN_CHECK(calibrate(drawn, fit));
        } else {
            fit.modulation.curves.bands.resize(planes_.bands() * kLevels);
            fit.modulation.curves.units.assign(planes_.bands(), 1.0F);
        }
        const int trials = options_.shared != nullptr ? kTrialsOfOthers : kTrials;
        for (int trial = 0; trial < trials; ++trial) {
            SATEEN_CHECK(compare(drawn, trial == 0, fit));
            drawn = gaussian_;
            SATEEN_CHECK(calibrate(drawn, fit));
        }
        return fit;
    }

  private:
    [[nodiscard]] bool varies(std::size_t plane) const {
        const bool left = !options_.left_alone.empty() && options_.left_alone[plane];
        return marginals_[plane].scale > 0 && !left;
    }

    /// Planes that are not modulated have straight curves, and no gain.
    void leave_alone(SubspaceModulation& curves) const {
        for (std::size_t i = 0; i < curves.bands.size(); ++i)
            if (!varies(i / kLevels)) curves.bands[i] = {};
        for (std::size_t plane = 0; plane < curves.units.size(); ++plane)
            if (!varies(plane)) curves.units[plane] = 1;
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

    /// What the planes of an image, made Gaussian by ranks, show of their bands.
    Result<std::vector<ShownBand>> shown_by(const Image& planes, Border border) {
        std::vector<BandFeatures> features(planes.bands());
        Image ranked(1, planes.rows(), planes.cols(), uninitialised);
        for (std::size_t plane = 0; plane < planes.bands(); ++plane) {
            if (!varies(plane)) continue;
            const PlaneView<const float> view = planes.plane(plane);
            MarginalDistribution({&view, 1}).gaussianise(view, ranked.plane(0));
            features[plane] =
                band_features(std::as_const(ranked).plane(0), border, executor_);
        }
        std::vector<Result<ShownBand>> found(planes.bands() * kLevels,
                                             Result<ShownBand>(ShownBand()));
        parallel_for(executor_, found.size(), [&](std::size_t i) {
            const std::size_t plane = i / kLevels;
            if (varies(plane)) found[i] = shown_band(features, plane, i % kLevels);
        });
        std::vector<ShownBand> shown;
        for (Result<ShownBand>& band : found) {
            SATEEN_TRY(ShownBand done, std::move(band));
            shown.push_back(std::move(done));
        }
        return shown;
    }

    Result<ShownBand> shown_band(const std::vector<BandFeatures>& features,
                                 std::size_t plane, std::size_t level) const {
        const bool follows = plane > 0 && varies(0);
        const Explanation explanation(features[plane],
                                      follows ? &features.front() : nullptr, level);
        ShownBand band;
        band.seen = features[plane].seen[level];
        band.regression = regress(explanation);
        if (plane > 0 || options_.shared != nullptr) return band;
        const Image rest =
            remainder_of(explanation, band.regression, field_spacing(level));
        SATEEN_TRY(band.covariances, covariances_of(rest.plane(0), executor_));
        return band;
    }

    /// Adds to curves and fields what a trial lacks. What Gaussian fields lack is the excess.
    Result<void> compare(const Image& trial, bool gaussian, ModulationFit& fit) {
        SATEEN_TRY(const std::vector<ShownBand> drawn, shown_by(trial, Border::wrap));
        for (std::size_t i = 0; i < seen_.size(); ++i) {
            if (!seen_[i].seen) continue;
            AmplitudeKnots& knots = knots_[i];
            for (std::size_t k = 0; k < knots.size(); ++k)
                knots[k] += seen_[i].regression.knots[k] - drawn[i].regression.knots[k];
            ModulatedBand& band = fit.modulation.curves.bands[i];
            band.of_value = stored(knots, 0);
            band.of_parent = stored(knots, 1);
            band.of_first = stored(knots, 2);
            if (i >= kLevels || options_.shared != nullptr) continue;
            if (gaussian) fit.excess += seen_[i].regression.variance(knots) / kLevels;
            compare_fields(drawn[i], i, gaussian, fit);
        }
        return {};
    }

    /// The field of a level answers for the covariances that curves leave.
    void compare_fields(const ShownBand& drawn, std::size_t level, bool first,
                        ModulationFit& fit) {
        const std::vector<double>& R = seen_[level].covariances->values;
        const std::vector<double>& Q = drawn.covariances->values;
        if (first) wanted_[level].assign(R.size(), 0);
        CovarianceTable lacking = *seen_[level].covariances;
        for (std::size_t k = 0; k < R.size(); ++k)
            lacking.values[k] = wanted_[level][k] += R[k] - Q[k];
        const double variance = std::max(0.0, lacking(0, 0));
        if (first) {
            fit.excess += variance / kLevels;
            first_variance_[level] = variance;
        }
        SmoothField& field = fit.modulation.fields.fields[level];
        field =
            variance > kLeastFieldVariance ? fit_smooth_field(lacking) : SmoothField{};
        field.deviation =
            std::min(field.deviation,
                     static_cast<float>(kMostGrowth * std::sqrt(first_variance_[level])));
        if (!(field.deviation > 0)) field = SmoothField{};
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
                const double wanted = moments_of(modulator.band(level)).variance;
                const double below = std::sqrt(moments_of(modulator.low()).variance);
                band.value_scale =
                    to_half_of_float(static_cast<float>(below > 0 ? 1 / below : 0));
                band.energy_scale =
                    to_half_of_float(static_cast<float>(wanted > 0 ? 1 / wanted : 0));
                band.gain = 1;
                const double found =
                    moments_of(modulator.tried(plane, level, fit.modulation.curves))
                        .variance;
                band.gain = to_half_of_float(
                    static_cast<float>(found > 0 ? std::sqrt(wanted / found) : 1));
                modulator.modulate(plane, level, fit.modulation.curves);
            }
            const PlaneView<const float> out = modulator.low();
            const SortedSample values({out.data, out.data + out.size()});
            const double furthest =
                std::max(-values.quantile(kOutermost), values.quantile(1 - kOutermost));
            const float unit = to_half_of_float(static_cast<float>(3 / furthest));
            fit.modulation.curves.units[plane] = unit;
            fit.marginals[plane] = curve_of_modulated(marginals_[plane], values, unit);
            modulator.finish(plane, unit);
        }
        return drawn;
    }

    const Image& planes_;
    const std::vector<Marginal>& marginals_;
    const ModulationOptions& options_;
    Executor& executor_;
    Image gaussian_;
    std::vector<ShownBand> seen_;  ///< by the photograph, planes · levels
    std::vector<AmplitudeKnots> knots_;
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
