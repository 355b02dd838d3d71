// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/fit/slab/slab_inversion.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/fit/slab/internal/sample_model.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

namespace lamina {
namespace {

using fit_detail::SampleCoefficients;
using fit_detail::SampleModel;

/// Nodes of the grids for the first guess and for the fit; finer ones correct the latter.
constexpr int start_nodes = 4, fit_nodes = 6;
constexpr int most_steps = 60;
constexpr double signal_over_noise = 3.0;  ///< from which an unscattered transmittance counts

void check_total(const std::string& name, const MeasuredTotal& total) {
  const auto& [value, error] = total;
  if (!(0.0 <= value && value <= 1.2))
    throw InvalidInput(name + ": must lie in [0, 1.2], but is " + number_text(value));
  if (!(std::isfinite(error) && error > 0.0))
    throw InvalidInput(name + ": its standard deviation must be > 0, but is " + number_text(error));
}

void check_measurement(const LayerStack& stack, std::size_t sample,
                       const SlabMeasurement& measurement) {
  if (sample >= stack.layers().size())
    throw InvalidInput("sample: must be one of the " + std::to_string(stack.layers().size()) +
                       " layers, but is " + std::to_string(sample));
  const Layer& layer = stack.layers()[sample];
  if (layer.phase)
    throw InvalidInput("layer " + std::to_string(sample) +
                       ": a sample scatters by Henyey and Greenstein's phase function");
  check_total("reflectance", measurement.reflectance);
  const auto& [r, t, unscattered, has_specular] = measurement;
  if (unscattered && !t)
    throw InvalidInput("unscattered transmittance: needs the transmittance, too");
  if (!t) return;
  if (!std::isfinite(layer.thickness))
    throw InvalidInput("transmittance: must be missing, because the sample is infinitely thick");
  check_total("transmittance", *t);
  const double noise = 5.0 * std::hypot(r.standard_deviation, t->standard_deviation);
  if (r.value + t->value > 1.0 + noise)
    throw InvalidInput("reflectance and transmittance: must not exceed 1 together, but are " +
                       number_text(r.value + t->value));
  if (!unscattered) return;
  check_total("unscattered transmittance", *unscattered);
  const double both = 5.0 * std::hypot(unscattered->standard_deviation, t->standard_deviation);
  if (unscattered->value > t->value + both)
    throw InvalidInput("unscattered transmittance: must not exceed the transmittance, " +
                       number_text(t->value) + ", but is " + number_text(unscattered->value));
}

/// What a slab between media of its own index absorbs and scatters, per its thickness.
struct ReducedDepths {
  double sigma_a = 0.0, sigma_s_prime = 0.0;
};

/// Those of two streams of light that have this reflectance and transmittance.
///
/// Source: [Kubelka1948], turned round: sinh(b S d) = b R / T with 2 R a = 1 + R^2 - T^2 and
/// b^2 = a^2 - 1. K = 2 sigma_a and S = 3/4 sigma_s' - 1/4 sigma_a are those of diffusion.
ReducedDepths two_stream_depths(double r, double t) {
  r = std::clamp(r, 1e-3, 0.99);
  t = std::clamp(t, 1e-6, (1.0 - r) * (1.0 - 1e-5));
  const double a = (1.0 + r * r - t * t) / (2.0 * r), b = std::sqrt((a - 1.0) * (a + 1.0));
  const double scattering = std::asinh(b * r / t) / b;
  const double sigma_a = 0.5 * (a - 1.0) * scattering;
  return {sigma_a, (4.0 * scattering + sigma_a) / 3.0};
}

FitParameter logarithmic(const std::string& name, double start, double length) {
  const double low = 1e-8 / length, high = 1e5 / length;
  return {.name = name,
          .start = std::clamp(start, low, high),
          .low = low,
          .high = high,
          .scale = FitScale::logarithmic};
}

/// One sample, its measurement and its unknowns.
class Inversion {
 public:
  Inversion(const LayerStack& stack, std::size_t sample, const SlabMeasurement& measurement,
            const SlabInversionOptions& options)
      : stack_(stack), sample_(sample), measurement_(measurement), options_(options) {
    const Medium& given = stack.layers()[sample].medium;
    given_ = {given.sigma_a, sigma_s_prime(given), given.g};
    const auto& unscattered = measurement.unscattered_transmittance;
    has_g_ =
        unscattered && unscattered->value > signal_over_noise * unscattered->standard_deviation;
    const double thickness = stack.layers()[sample].thickness;
    length_ = std::isfinite(thickness) ? thickness : 1.0;
  }

  [[nodiscard]] SlabInversion run() {
    std::vector<FitParameter> parameters = start();
    if (has_g_) parameters = with_extinction(fitted_start(parameters));
    const SampleModel model = model_with(has_g_);
    std::vector<double> correction(parameters.size(),
                                   0.0);  // of the grid of the fit, by finer ones
    SlabInversion result;
    result.fit = fit(model, level(model.data()), parameters, correction, 1e-3);
    double last_change = 0.0;
    for (int nodes = fit_nodes; nodes < options_.max_nodes;) {
      nodes = std::min(nodes * 3 / 2, options_.max_nodes);
      const std::vector<double> values = values_of(result.fit);
      const std::vector<double> coarse = model.predict(coefficients(values), fit_nodes);
      const std::vector<double> fine = model.predict(coefficients(values), nodes);
      for (std::size_t i = 0; i < fine.size(); ++i) correction[i] = fine[i] - coarse[i];
      for (std::size_t j = 0; j < values.size(); ++j) parameters[j].start = values[j];
      result.fit = fit(model, model.data(), parameters, correction, 0.1 * options_.accuracy);
      result.nodes = nodes;
      double change = 0.0, allowed = options_.accuracy;
      for (std::size_t j = 0; j < values.size(); ++j) {
        const FittedParameter& found = result.fit.parameters[j];
        change = std::max(change, std::abs(found.value / values[j] - 1.0));
        if (!found.is_at_bound) allowed = std::max(allowed, 0.1 * found.standard_deviation);
      }
      // What is left of a series that falls by this ratio from grid to grid.
      const double ratio = last_change > 0.0 ? std::min(change / last_change, 0.85) : 0.85;
      result.estimated_error = change * std::max(1.0, ratio / (1.0 - ratio));
      result.is_accurate = result.estimated_error <= allowed;
      last_change = change;
      if (result.is_accurate) break;
    }
    if (has_g_) result.fit = by_g(model, result.fit, correction);
    return finished(std::move(result));
  }

 private:
  [[nodiscard]] SampleModel model_with(bool has_unscattered) const {
    return {stack_, sample_, measurement_, options_.incidence, has_unscattered};
  }

  /// Of sigma_a, sigma_s_prime and sigma_s. The unscattered light tells the last one, which hardly
  /// matters to the other totals if the first two are kept; g would matter.
  [[nodiscard]] SampleCoefficients coefficients(std::span<const double> values) const {
    SampleCoefficients made = given_;
    made.sigma_a = values[0];
    if (values.size() > 1) made.sigma_s_prime = values[1];
    if (values.size() > 2) made.g = 1.0 - values[1] / values[2];
    return made;
  }

  /// As if all were measured equally well, to 1 %: the way there is then no narrow valley.
  [[nodiscard]] static FitData level(FitData data) {
    for (std::size_t i = 0; i < data.measured.size(); ++i)
      data.standard_deviation[i] =
          std::max(data.standard_deviation[i], 0.01 * std::min(1.0, std::abs(data.measured[i])));
    return data;
  }

  [[nodiscard]] FitResult fit(const SampleModel& model, const FitData& data,
                              const std::vector<FitParameter>& parameters,
                              const std::vector<double>& correction, double tolerance,
                              int nodes = fit_nodes) const {
    return fit_parameters(parameters, data,
                          {.predict =
                               [&](std::span<const double> values) {
                                 return sum(model.predict(coefficients(values), nodes), correction);
                               },
                           .derivatives =
                               [&](std::span<const double> values) {
                                 const SampleCoefficients at = coefficients(values);
                                 const DenseMatrix by = model.derivatives(at, nodes);
                                 DenseMatrix jacobian(by.rows, values.size());
                                 for (std::size_t i = 0; i < by.rows; ++i) {
                                   jacobian(i, 0) = by(i, 0);
                                   if (values.size() == 2) jacobian(i, 1) = by(i, 1) / (1.0 - at.g);
                                   if (values.size() < 3) continue;
                                   jacobian(i, 1) = -by(i, 2) / values[2];
                                   jacobian(i, 2) =
                                       by(i, 1) + by(i, 2) * values[1] / (values[2] * values[2]);
                                 }
                                 return jacobian;
                               }},
                          {.max_iterations = most_steps, .tolerance = tolerance});
  }

  /// The same solution by g in place of sigma_s, for its error.
  [[nodiscard]] FitResult by_g(const SampleModel& model, const FitResult& fit,
                               const std::vector<double>& correction) const {
    const auto [sigma_a, sigma_s_prime, g] = coefficients(values_of(fit));
    const auto sample = [](std::span<const double> values) {
      return SampleCoefficients{values[0], values[1], values[2]};
    };
    FitResult result = fit_parameters(
        {logarithmic("sigma_a", sigma_a, length_),
         logarithmic("sigma_s_prime", sigma_s_prime, length_),
         {.name = "g", .start = g, .low = fit_detail::least_g, .high = fit_detail::largest_g}},
        model.data(),
        {.predict =
             [&](std::span<const double> values) {
               return sum(model.predict(sample(values), fit_nodes), correction);
             },
         .derivatives =
             [&](std::span<const double> values) {
               DenseMatrix jacobian = model.derivatives(sample(values), fit_nodes);
               const double rest = 1.0 - values[2];
               for (std::size_t i = 0; i < jacobian.rows; ++i) {
                 jacobian(i, 2) += jacobian(i, 1) * values[1] / (rest * rest);
                 jacobian(i, 1) /= rest;
               }
               return jacobian;
             }},
        {.max_iterations = 1, .tolerance = 1.0});
    result.has_converged = fit.has_converged;
    result.iterations = fit.iterations;
    return result;
  }

  /// In closed form.
  [[nodiscard]] std::vector<FitParameter> start() const {
    const double specular = measurement_.has_specular
                                ? adding_doubling_on_grid(stack_, options_.incidence, start_nodes)
                                      .totals.specular_reflectance
                                : 0.0;
    const double r = std::max(0.0, measurement_.reflectance.value - specular);
    const double t = measurement_.transmittance ? measurement_.transmittance->value : 0.0;
    const auto [absorbed, scattered] = two_stream_depths(r, t);
    if (!measurement_.transmittance)
      return {logarithmic("sigma_a", given_.sigma_s_prime * absorbed / scattered, length_)};
    return {logarithmic("sigma_a", absorbed / length_, length_),
            logarithmic("sigma_s_prime", scattered / length_, length_)};
  }

  /// A little better, by reflectance and transmittance alone with isotropic scattering.
  [[nodiscard]] SampleCoefficients fitted_start(const std::vector<FitParameter>& parameters) {
    const double given_g = std::exchange(given_.g, 0.0);
    const SampleModel model = model_with(false);
    const FitResult found =
        fit(model, level(model.data()), parameters, {0.0, 0.0}, 1e-2, start_nodes);
    const SampleCoefficients start = coefficients(values_of(found));
    given_.g = given_g;
    return start;
  }

  /// With the scattering that the unscattered transmittance asks for.
  [[nodiscard]] std::vector<FitParameter> with_extinction(const SampleCoefficients& start) const {
    const SampleModel model = model_with(true);
    // What the boundaries let through changes little with the sample: a few steps suffice.
    double extinction = 0.0;
    for (int step = 0; step < 3; ++step) {
      const double transmitted =
          model.predict({.sigma_a = extinction, .sigma_s_prime = 0.0, .g = 0.0}, start_nodes)[2];
      extinction +=
          (transmitted - std::log(measurement_.unscattered_transmittance->value)) / length_;
      extinction = std::max(extinction, 1e-4 / length_);
    }
    const double sigma_a = std::min(start.sigma_a, 0.95 * extinction);
    const double sigma_s = extinction - sigma_a;
    return {logarithmic("sigma_a", sigma_a, length_),
            logarithmic("sigma_s_prime",
                        std::clamp(start.sigma_s_prime, 0.02 * sigma_s, 1.7 * sigma_s), length_),
            logarithmic("sigma_s", sigma_s, length_)};
  }

  [[nodiscard]] static std::vector<double> values_of(const FitResult& fit) {
    std::vector<double> values;
    for (const FittedParameter& parameter : fit.parameters) values.push_back(parameter.value);
    return values;
  }

  [[nodiscard]] static std::vector<double> sum(std::vector<double> a,
                                               const std::vector<double>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
    return a;
  }

  [[nodiscard]] SlabInversion finished(SlabInversion result) const {
    const auto& fitted = result.fit.parameters;
    result.has_sigma_s_prime = fitted.size() > 1;
    result.has_g = has_g_;
    result.sigma_a = fitted[0];
    result.sigma_s_prime =
        fitted.size() > 1 ? fitted[1] : FittedParameter{.value = given_.sigma_s_prime};
    result.g = fitted.size() > 2 ? fitted[2] : FittedParameter{.value = given_.g};
    if (!result.has_sigma_s_prime)
      result.fit.notes.push_back(
          "sigma_s_prime: kept as given, reflectance alone tells its ratio to sigma_a only");
    if (!result.has_g && measurement_.unscattered_transmittance)
      result.fit.notes.push_back(
          "g: kept as given, the unscattered transmittance is lost in its noise");
    return result;
  }

  const LayerStack& stack_;
  std::size_t sample_;
  const SlabMeasurement& measurement_;
  const SlabInversionOptions& options_;
  SampleCoefficients given_;
  double length_ = 1.0;  ///< [mm] thickness of the sample
  bool has_g_ = false;
};

}  // namespace

SlabInversion invert_slab(const LayerStack& stack, std::size_t sample,
                          const SlabMeasurement& measurement, const SlabInversionOptions& options) {
  check_measurement(stack, sample, measurement);
  if (!(1e-6 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-6, 0.1], but is " +
                       number_text(options.accuracy));
  return Inversion(stack, sample, measurement, options).run();
}

}  // namespace lamina
