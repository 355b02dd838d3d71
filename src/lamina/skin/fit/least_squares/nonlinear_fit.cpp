// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/least_squares/nonlinear_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/random.h"
#include "lamina/skin/fit/least_squares/internal/fit_errors.h"
#include "lamina/skin/fit/least_squares/internal/whitening.h"

namespace lamina {
namespace {

using fit_detail::Whitening;

constexpr double least_damping = 1e-15, most_damping = 1e15;

/// What the fit knows of one place.
struct Place {
  std::vector<double> coordinates;
  std::vector<double> prediction;
  std::vector<double> residual;  ///< whitened
  double data_cost = 0.0;        ///< sum of squares, or of what robust fits put in their place
  double prior_squares = 0.0;
  [[nodiscard]] double cost() const { return data_cost + prior_squares; }
};

class Fit {
 public:
  Fit(const std::vector<FitParameter>& parameters, const FitData& data, const FitModel& model,
      const FitOptions& options)
      : parameters_(parameters), whitening_(data), model_(model), options_(options) {
    for (const FitParameter& parameter : parameters_) {
      low_.push_back(fit_coordinate(parameter, parameter.low));
      high_.push_back(fit_coordinate(parameter, parameter.high));
    }
    points_ = data.measured.size();
    if (options_.prior_correlation.rows > 0) prior_whitening_.emplace(prior_data());
  }

  /// The place at coordinates; its cost is infinite where there is no prediction.
  [[nodiscard]] Place look(std::vector<double> coordinates) const {
    Place place{.coordinates = std::move(coordinates), .prediction = {}, .residual = {}};
    place.prediction = predict(place.coordinates);
    place.residual = whitening_.residual(place.prediction);
    for (const double r : place.residual) place.data_cost += loss(r);
    if (!std::isfinite(place.data_cost)) place.data_cost = std::numeric_limits<double>::infinity();
    for (const double r : prior_residuals(place)) place.prior_squares += r * r;
    return place;
  }

  /// Whitened predictions and priors by coordinates, robust weights included.
  [[nodiscard]] DenseMatrix jacobian(const Place& place) const {
    DenseMatrix derivatives = model_.derivatives ? by_coordinates(place) : by_differences(place);
    whitening_.apply(derivatives);
    DenseMatrix all(points_ + parameters_.size(), parameters_.size());
    for (std::size_t i = 0; i < points_; ++i) {
      const double weight = std::sqrt(weight_of(place.residual[i]));
      for (std::size_t j = 0; j < parameters_.size(); ++j) all(i, j) = weight * derivatives(i, j);
    }
    DenseMatrix priors(parameters_.size(), parameters_.size());
    for (std::size_t j = 0; j < parameters_.size(); ++j)
      if (parameters_[j].prior) priors(j, j) = 1.0 / parameters_[j].prior->standard_deviation;
    if (prior_whitening_) prior_whitening_->apply(priors);
    for (std::size_t i = 0; i < priors.rows; ++i)
      for (std::size_t j = 0; j < priors.columns; ++j) all(points_ + i, j) = priors(i, j);
    return all;
  }

  /// Rows as those of the Jacobian: what a step should take away.
  [[nodiscard]] DenseMatrix right_side(const Place& place) const {
    DenseMatrix right(points_ + parameters_.size(), 1);
    for (std::size_t i = 0; i < points_; ++i)
      right(i, 0) = std::sqrt(weight_of(place.residual[i])) * place.residual[i];
    const std::vector<double> priors = prior_residuals(place);
    for (std::size_t j = 0; j < priors.size(); ++j) right(points_ + j, 0) = priors[j];
    return right;
  }

  /// At a bound, with less cost beyond it.
  [[nodiscard]] std::vector<bool> held(const Place& place, const DenseMatrix& jacobian,
                                       const DenseMatrix& right) const {
    std::vector<bool> held;
    for (std::size_t j = 0; j < parameters_.size(); ++j) {
      double downhill = 0.0;
      for (std::size_t i = 0; i < right.rows; ++i) downhill += jacobian(i, j) * right(i, 0);
      held.push_back((place.coordinates[j] <= low_[j] && downhill < 0.0) ||
                     (place.coordinates[j] >= high_[j] && downhill > 0.0));
    }
    return held;
  }

  /// The least cost that steps from a place lead to.
  [[nodiscard]] Place descend(Place place, FitResult& result) const {
    const std::size_t n = parameters_.size();
    std::vector<double> scale(n, 0.0);
    double damping = 1e-3;
    result.has_converged = false;
    for (result.iterations = 0; result.iterations < options_.max_iterations; ++result.iterations) {
      const DenseMatrix derivatives = jacobian(place), right = right_side(place);
      const std::vector<bool> is_held = held(place, derivatives, right);
      for (std::size_t j = 0; j < n; ++j) {
        double squares = 0.0;
        for (std::size_t i = 0; i < derivatives.rows; ++i)
          squares += derivatives(i, j) * derivatives(i, j);
        scale[j] = std::max(scale[j], std::sqrt(squares));
      }
      while (true) {
        const std::vector<double> step = damped_step(derivatives, right, is_held, scale, damping);
        Place next = look(moved(place.coordinates, step));
        double length = 0.0;
        for (std::size_t j = 0; j < n; ++j)
          length = std::max(length, std::abs(next.coordinates[j] - place.coordinates[j]) /
                                        std::max(1.0, std::abs(place.coordinates[j])));
        const bool is_small = length <= options_.tolerance;
        const bool is_better = next.cost() <= place.cost();
        if (is_better) place = std::move(next);
        if (is_small) result.has_converged = true;
        if (is_better || is_small) break;
        damping *= 5.0;
        if (!(damping < most_damping)) return place;  // as where there are no derivatives
      }
      damping = std::max(0.1 * damping, least_damping);
      if (result.has_converged) break;
    }
    return place;
  }

  [[nodiscard]] std::vector<double> first_start() const {
    std::vector<double> start;
    for (const FitParameter& parameter : parameters_)
      start.push_back(fit_coordinate(parameter, parameter.start));
    return start;
  }

  /// From the whole range, or within two standard deviations of the prior, or within 2 of the start
  /// where neither is finite.
  [[nodiscard]] std::vector<double> drawn_start(Random& random) const {
    std::vector<double> start = first_start();
    for (std::size_t j = 0; j < start.size(); ++j) {
      double low = std::isfinite(low_[j]) ? low_[j] : start[j] - 2.0;
      double high = std::isfinite(high_[j]) ? high_[j] : start[j] + 2.0;
      if (const auto& prior = parameters_[j].prior) {
        const double mean = fit_coordinate(parameters_[j], prior->mean);
        low = std::max(low, mean - 2.0 * prior->standard_deviation);
        high = std::min(high, mean + 2.0 * prior->standard_deviation);
      }
      start[j] = low + (high - low) * random.uniform();
    }
    return start;
  }

 private:
  [[nodiscard]] std::vector<double> values_of(std::span<const double> coordinates) const {
    std::vector<double> values;
    for (std::size_t j = 0; j < parameters_.size(); ++j)
      values.push_back(fit_value(parameters_[j], coordinates[j]));
    return values;
  }

  [[nodiscard]] std::vector<double> predict(std::span<const double> coordinates) const {
    std::vector<double> prediction = model_.predict(values_of(coordinates));
    if (prediction.size() != points_)
      throw InvalidInput("model: must predict " + std::to_string(points_) +
                         " numbers, but predicts " + std::to_string(prediction.size()));
    return prediction;
  }

  /// Deviations of the priors' means, in standard deviations; independent ones.
  [[nodiscard]] std::vector<double> prior_residuals(const Place& place) const {
    std::vector<double> deviation(parameters_.size(), 0.0);
    for (std::size_t j = 0; j < parameters_.size(); ++j)
      if (const auto& prior = parameters_[j].prior)
        deviation[j] = (place.coordinates[j] - fit_coordinate(parameters_[j], prior->mean)) /
                       prior->standard_deviation;
    if (prior_whitening_) return prior_whitening_->residual(deviation);
    for (double& each : deviation) each = -each;
    return deviation;
  }

  /// The priors as a measurement of deviations, which finds none.
  [[nodiscard]] FitData prior_data() const {
    const std::size_t n = parameters_.size();
    const DenseMatrix& correlation = options_.prior_correlation;
    for (const FitParameter& parameter : parameters_)
      if (!parameter.prior)
        throw InvalidInput(parameter.name + ": must have a prior, since correlations are given");
    if (correlation.rows != n || correlation.columns != n)
      throw InvalidInput("prior_correlation: must have " + std::to_string(n) +
                         " rows and columns, as many as parameters, but has " +
                         std::to_string(correlation.rows) + " and " +
                         std::to_string(correlation.columns));
    for (std::size_t j = 0; j < n; ++j)
      if (std::abs(correlation(j, j) - 1.0) > 1e-9)
        throw InvalidInput("prior_correlation: must be 1 on the diagonal, but is " +
                           number_text(correlation(j, j)) + " in row " + std::to_string(j));
    return {.measured = std::vector<double>(n, 0.0), .covariance = correlation};
  }

  /// Source: [Huber1964].
  [[nodiscard]] double loss(double r) const {
    const double limit = options_.robust_limit;
    return limit > 0.0 && std::abs(r) > limit ? limit * (2.0 * std::abs(r) - limit) : r * r;
  }
  [[nodiscard]] double weight_of(double r) const {
    const double limit = options_.robust_limit;
    return limit > 0.0 && std::abs(r) > limit ? limit / std::abs(r) : 1.0;
  }

  [[nodiscard]] DenseMatrix by_coordinates(const Place& place) const {
    DenseMatrix derivatives = model_.derivatives(values_of(place.coordinates));
    if (derivatives.rows != points_ || derivatives.columns != parameters_.size())
      throw InvalidInput(
          "model: derivatives must be a row for each prediction and a column for "
          "each parameter");
    for (std::size_t j = 0; j < parameters_.size(); ++j) {
      const double derivative = fit_value_derivative(parameters_[j], place.coordinates[j]);
      for (std::size_t i = 0; i < points_; ++i) derivatives(i, j) *= derivative;
    }
    return derivatives;
  }

  /// Central, but to one side at a bound.
  [[nodiscard]] DenseMatrix by_differences(const Place& place) const {
    DenseMatrix derivatives(points_, parameters_.size());
    for (std::size_t j = 0; j < parameters_.size(); ++j) {
      const double at = place.coordinates[j];
      const double step = parameters_[j].scale == FitScale::linear && at != 0.0
                              ? options_.step * std::abs(at)
                              : options_.step;
      std::vector<double> below = place.coordinates, above = place.coordinates;
      below[j] = std::max(at - step, low_[j]);
      above[j] = std::min(at + step, high_[j]);
      const std::vector<double> low = predict(below), high = predict(above);
      for (std::size_t i = 0; i < points_; ++i)
        derivatives(i, j) = (high[i] - low[i]) / (above[j] - below[j]);
    }
    return derivatives;
  }

  /// The step of least squares with damping, 0 for what is held. Source: [Marquardt1963].
  [[nodiscard]] std::vector<double> damped_step(const DenseMatrix& derivatives,
                                                const DenseMatrix& right,
                                                const std::vector<bool>& is_held,
                                                const std::vector<double>& scale,
                                                double damping) const {
    std::vector<std::size_t> free;
    for (std::size_t j = 0; j < is_held.size(); ++j)
      if (!is_held[j]) free.push_back(j);
    std::vector<double> step(is_held.size(), 0.0);
    if (free.empty()) return step;
    DenseMatrix a(derivatives.rows + free.size(), free.size()), b(a.rows, 1);
    for (std::size_t i = 0; i < derivatives.rows; ++i) {
      for (std::size_t k = 0; k < free.size(); ++k) a(i, k) = derivatives(i, free[k]);
      b(i, 0) = right(i, 0);
    }
    for (std::size_t k = 0; k < free.size(); ++k)
      a(derivatives.rows + k, k) =
          std::sqrt(damping) * (scale[free[k]] > 0.0 ? scale[free[k]] : 1.0);
    const DenseMatrix solution = solve_least_squares(a, b);
    for (std::size_t k = 0; k < free.size(); ++k) step[free[k]] = solution(k, 0);
    return step;
  }

  [[nodiscard]] std::vector<double> moved(std::vector<double> coordinates,
                                          const std::vector<double>& step) const {
    for (std::size_t j = 0; j < coordinates.size(); ++j)
      coordinates[j] = std::clamp(coordinates[j] + step[j], low_[j], high_[j]);
    return coordinates;
  }

  const std::vector<FitParameter>& parameters_;
  Whitening whitening_;
  std::optional<Whitening> prior_whitening_;  ///< where priors go together
  const FitModel& model_;
  const FitOptions& options_;
  std::vector<double> low_, high_;  ///< coordinates
  std::size_t points_ = 0;
};

}  // namespace

FitResult fit_parameters(const std::vector<FitParameter>& parameters, const FitData& data,
                         const FitModel& model, const FitOptions& options) {
  if (parameters.empty()) throw InvalidInput("fit: at least one parameter must be free");
  for (const FitParameter& parameter : parameters) check_fit_parameter(parameter);
  const auto without_prior = static_cast<std::size_t>(
      std::ranges::count_if(parameters, [](const FitParameter& p) { return !p.prior; }));
  if (!data.has_known_errors && data.measured.size() <= without_prior)
    throw InvalidInput("fit: " + std::to_string(data.measured.size()) +
                       " numbers cannot tell their errors and " + std::to_string(without_prior) +
                       " parameters; give standard deviations");
  const Fit fit(parameters, data, model, options);

  FitResult result;
  Place best;
  std::vector<double> costs;
  Random random = make_random(options.seed, 0);
  for (int start = 0; start < options.starts; ++start) {
    Place place = fit.look(start == 0 ? fit.first_start() : fit.drawn_start(random));
    if (!std::isfinite(place.cost())) {
      if (start == 0) throw InvalidInput("fit: the model predicts nothing at the start");
      continue;
    }
    FitResult path;
    place = fit.descend(std::move(place), path);
    costs.push_back(place.cost());
    if (!best.coordinates.empty() && place.cost() >= best.cost()) continue;
    best = std::move(place);
    result.has_converged = path.has_converged;
    result.iterations = path.iterations;
  }
  result.agreeing_starts = static_cast<int>(std::ranges::count_if(
      costs, [&](double cost) { return cost <= best.cost() + 1e-6 * (1.0 + best.cost()); }));

  const DenseMatrix derivatives = fit.jacobian(best);
  const std::vector<bool> is_held = fit.held(best, derivatives, fit.right_side(best));
  result.prediction = best.prediction;
  result.residual = best.residual;
  for (const double r : best.residual) result.chi_squared += r * r;
  result.prior_squares = best.prior_squares;
  result.degrees_of_freedom = static_cast<std::ptrdiff_t>(data.measured.size()) -
                              static_cast<std::ptrdiff_t>(parameters.size()) +
                              std::ranges::count(is_held, true);
  const double variance =
      data.has_known_errors
          ? 1.0
          : result.chi_squared / static_cast<double>(data.measured.size() - without_prior);
  if (!result.has_converged)
    result.notes.push_back(
        "stopped after " + std::to_string(result.iterations) +
        " steps, short of a solution: values and errors are of where it stopped");
  fit_detail::add_errors(parameters, best.coordinates, derivatives, is_held, variance, result);
  return result;
}

}  // namespace lamina
