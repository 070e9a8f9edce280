// SPDX-License-Identifier: Apache-2.0
// The field of one level. See fit_field.hpp.
#include "analysis/fit_field.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "sateen/analysis/car2d.hpp"
#include "sateen/analysis/gmrf2d.hpp"
#include "sateen/analysis/neighbourhood.hpp"
#include "sateen/analysis/whittle.hpp"

namespace sateen {
namespace {

/// [GMRF] repaired: the denominator 1 - 2 Σ a_s cos ω·s is at least this everywhere.
constexpr double kPaperDenominator = 0.02;

/// Levels of 32 x 32 sites and fewer are compared on a grid of 32.
constexpr double kSmallLevel = 32 * 32;

Result<Car2d> fit_car2d(const Autocovariance& R, const NeighbourhoodOptions& options) {
    SATEEN_TRY(auto neighbourhood, select_neighbourhood(R, options));
    SATEEN_TRY(Car2dEstimate estimate,
               estimate_car2d(toroidal_normal_equations(R, std::move(neighbourhood))));
    Car2d model = std::move(estimate.model);
    const double implied = model_variance(model);
    model.variance =
        static_cast<float>(static_cast<double>(model.variance) * R.variance() / implied);
    return model;
}

Result<Gmrf2d> fit_gmrf2d(const Autocovariance& R, const NeighbourhoodOptions& options) {
    if (options.rule == NeighbourhoodRule::evidence) {
        SATEEN_TRY(const NaturalGmrf2d field, select_gmrf2d(R, options.value));
        return to_material(field, R.variance());
    }
    SATEEN_TRY(const auto neighbourhood, select_neighbourhood(R, options));
    SATEEN_TRY(const NaturalGmrf2d field, maximise_likelihood(R, neighbourhood));
    return to_material(field, R.variance());
}

template <class Model>
double information_of(const Model& model, const Autocovariance& R, int grid = 128) {
    return bayesian_information(whittle_deviance(inverse_covariance(model), R, grid),
                                R.sites(), model.neighbourhood.size());
}

// Both models on one neighbourhood, of the order that the causal evidence chose: the sites
// that a field depends on are the same, and the search of an order by the exact likelihood
// takes ten times as long.
Result<FieldModel> fit_best(const Autocovariance& R, const NeighbourhoodOptions& options,
                            FieldChoice& choice) {
    const int grid = R.sites() > kSmallLevel ? 64 : 32;
    SATEEN_TRY(Car2d car, fit_car2d(R, options));
    SATEEN_TRY(const NaturalGmrf2d field,
               maximise_likelihood(R, car.neighbourhood, {grid, grid}));
    const double of_car = information_of(car, R);
    double of_gmrf = information_of(field, R, grid);
    if (!(of_gmrf < of_car)) {
        choice.add({1, 0, 0, of_car, of_gmrf, of_car, 0});
        return FieldModel(std::move(car));
    }
    SATEEN_TRY(const NaturalGmrf2d refined,
               maximise_likelihood(R, car.neighbourhood, {2 * grid, 2 * grid}, &field));
    Gmrf2d gmrf = to_material(refined, R.variance());
    // As stored it may be another: shrunk where its spectrum nearly had a pole.
    of_gmrf = information_of(gmrf, R);
    const bool markov = of_gmrf < of_car;
    choice.add({markov ? 0U : 1U, markov ? 1U : 0U, 0, of_car, of_gmrf,
                std::min(of_car, of_gmrf), 0});
    return markov ? FieldModel(std::move(gmrf)) : FieldModel(std::move(car));
}

double variance_of(PlaneView<const float> band) {
    double sum = 0;
    for (std::size_t r = 0; r < band.rows; ++r)
        for (std::size_t c = 0; c < band.cols; ++c)
            sum += static_cast<double>(band(r, c)) * static_cast<double>(band(r, c));
    return sum / static_cast<double>(band.size());
}

Result<FieldModel> car2d_as_printed(PlaneView<const float> band,
                                    const AnalysisOptions& options,
                                    const std::string& place,
                                    std::vector<std::string>& notes, Executor& executor) {
    const NeighbourhoodOptions rule = neighbourhood_of(options);
    SATEEN_TRY(const Autocovariance R,
               toroidal_autocovariance(band, 2 * reach_of(rule), executor));
    SATEEN_TRY(auto neighbourhood, select_neighbourhood(R, rule));
    const Result<Car2dEstimate> estimate =
        estimate_car2d(interior_normal_equations(band, std::move(neighbourhood)));
    if (!estimate) return FieldModel();
    const double radius = spectral_radius(estimate->model);
    if (radius < 1) return FieldModel(estimate->model);
    notes.push_back(place + ": unstable, spectral radius " + std::to_string(radius) +
                    "; coefficients shrunk");
    return FieldModel(stabilised(estimate->model, variance_of(band)));
}

Result<FieldModel> gmrf2d_as_printed(PlaneView<const float> band,
                                     const AnalysisOptions& options,
                                     const std::string& place,
                                     std::vector<std::string>& notes,
                                     Executor& executor) {
    const int reach = 2 * reach_of(neighbourhood_of(options));
    SATEEN_TRY(const Autocovariance R, toroidal_autocovariance(band, reach, executor));
    SATEEN_TRY(const auto neighbourhood,
               select_neighbourhood(R, neighbourhood_of(options)));
    const Result<Gmrf2d> estimate = maximise_pseudo_likelihood(R, neighbourhood);
    if (!estimate) return FieldModel(Gmrf2d{});
    const double smallest = smallest_denominator(*estimate);
    if (smallest >= kPaperDenominator) return FieldModel(*estimate);
    notes.push_back(place +
                    ": the pseudo-likelihood's spectrum is not positive, 1 - A = " +
                    std::to_string(smallest) + "; coefficients shrunk, variance kept");
    return FieldModel(shrunk(*estimate, kPaperDenominator, R.variance()));
}

}  // namespace

void FieldChoice::add(const FieldChoice& other) {
    car2d += other.car2d;
    gmrf2d += other.gmrf2d;
    car3d += other.car3d;
    information_car2d += other.information_car2d;
    information_gmrf2d += other.information_gmrf2d;
    information_apart += other.information_apart;
    information_car3d += other.information_car3d;
}

Result<FieldModel> fit_field(const Autocovariance& toroidal,
                             const AnalysisOptions& options, FieldChoice& choice) {
    const Autocovariance R = toroidal.resolved();
    const bool constant = R.variance() < kNegligibleVariance;
    if (options.field == FieldKind::gmrf2d) {
        if (constant) return FieldModel(Gmrf2d{});
        SATEEN_TRY(Gmrf2d field, fit_gmrf2d(R, neighbourhood_of(options)));
        return FieldModel(std::move(field));
    }
    if (constant) return FieldModel();
    if (options.field == FieldKind::automatic)
        return fit_best(R, neighbourhood_of(options), choice);
    SATEEN_TRY(Car2d field, fit_car2d(R, neighbourhood_of(options)));
    return FieldModel(std::move(field));
}

Result<FieldModel> fit_field_as_printed(PlaneView<const float> band,
                                        const AnalysisOptions& options,
                                        const std::string& place,
                                        std::vector<std::string>& notes,
                                        Executor& executor) {
    return options.field == FieldKind::gmrf2d
               ? gmrf2d_as_printed(band, options, place, notes, executor)
               : car2d_as_printed(band, options, place, notes, executor);
}

}  // namespace sateen
