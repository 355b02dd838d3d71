// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/leaf/internal/leaf_pixel.h"

#include <algorithm>
#include <utility>

#include "lamina/skin/fit/least_squares/small_fit.h"

namespace lamina::detail {
namespace {

using Squares = SmallSquares<most_leaf_numbers>;

Squares squares_at(const LeafPixelModel& model, std::span<const double> measured,
                   const LeafCoordinates& at, LeafPrediction& prediction) {
  predict_leaf(model, at, prediction);
  const std::size_t n = model.size();
  Squares result;
  for (std::size_t b = 0; b < measured.size(); ++b) {
    const double weight = 1.0 / (model.deviation[b] * model.deviation[b]);
    const double miss = prediction.reflectance[b] - measured[b];
    const LeafCoordinates& by = prediction.by_coordinate[b];
    result.value += 0.5 * weight * miss * miss;
    for (std::size_t i = 0; i < n; ++i) {
      const double weighted = weight * by[i];
      result.gradient[i] += weighted * miss;
      for (std::size_t j = 0; j <= i; ++j) result.curvature[i][j] += weighted * by[j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double weight = 1.0 / (model.prior_deviation[i] * model.prior_deviation[i]);
    const double miss = at[i] - model.prior[i];
    result.value += 0.5 * weight * miss * miss;
    result.gradient[i] += weight * miss;
    result.curvature[i][i] += weight;
  }
  return result;
}

/// The usual leaf under the light that meets the bands best: a straight line of the measured over
/// what it reflects.
LeafCoordinates start_of(const LeafPixelModel& model, std::span<const double> measured,
                         LeafPrediction& prediction) {
  const std::size_t illumination = model.size() - 2, gloss = model.size() - 1;
  LeafCoordinates at = model.prior;
  at[illumination] = fit_coordinate(model.parameters[illumination], 1.0);
  at[gloss] = 0.0;
  predict_leaf(model, at, prediction);
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto bands = static_cast<double>(measured.size());
  for (std::size_t b = 0; b < measured.size(); ++b) {
    const double r = prediction.reflectance[b];
    x += r / bands;
    y += measured[b] / bands;
    xx += r * r / bands;
    xy += r * measured[b] / bands;
  }
  const double slope = std::clamp((xy - x * y) / std::max(1e-9, xx - x * x), 0.1, 1.2);
  at[illumination] = fit_coordinate(model.parameters[illumination], slope);
  at[gloss] = y - slope * x;
  for (const std::size_t i : {illumination, gloss})
    at[i] = std::clamp(at[i], model.low[i], model.high[i]);
  return at;
}

}  // namespace

void predict_leaf(const LeafPixelModel& model, const LeafCoordinates& at, LeafPrediction& result) {
  const std::size_t bands = model.spectra.size(), numbers = model.values.size();
  const std::size_t illumination = numbers, gloss = numbers + 1;
  result.reflectance.resize(bands);
  result.by_coordinate.resize(bands);
  LeafParameters leaf = model.leaf;
  std::array<LeafParameters, most_leaf_numbers> units;  // what one of a number absorbs
  LeafCoordinates chain = {};
  for (std::size_t n = 0; n < numbers; ++n) {
    leaf.*model.values[n] = fit_value(model.parameters[n], at[n]);
    units[n] = {.chlorophyll = 0.0,
                .carotenoids = 0.0,
                .anthocyanins = 0.0,
                .brown_pigments = 0.0,
                .water = 0.0,
                .dry_matter = 0.0,
                .structure = 0.0};
    units[n].*model.values[n] = 1.0;
    chain[n] = fit_value_derivative(model.parameters[n], at[n]);
  }
  const double factor = fit_value(model.parameters[illumination], at[illumination]);
  chain[illumination] = fit_value_derivative(model.parameters[illumination], at[illumination]);
  const double mirrored = fit_value(model.parameters[gloss], at[gloss]);
  chain[gloss] = fit_value_derivative(model.parameters[gloss], at[gloss]);
  for (std::size_t b = 0; b < bands; ++b) {
    const LeafLight::Value light =
        model.light.at(leaf_absorption(leaf, model.spectra[b]), leaf.structure);
    // Light goes to and fro between the leaf and the ground.
    const double ground = model.ground[b], echo = ground / (1.0 - light.reflectance * ground);
    const double through = light.transmittance;
    const double reflected = light.reflectance + through * through * echo;
    const auto by = [&](const std::array<double, 2>& totals) {
      return totals[0] * (1.0 + through * through * echo * echo) + totals[1] * 2.0 * through * echo;
    };
    const double by_absorption = by(light.by_absorption), by_structure = by(light.by_structure);
    LeafCoordinates& slopes = result.by_coordinate[b];
    for (std::size_t n = 0; n < numbers; ++n)
      slopes[n] = factor * chain[n] *
                  (by_absorption * leaf_absorption(units[n], model.spectra[b]) +
                   by_structure * units[n].structure);
    slopes[illumination] = chain[illumination] * reflected;
    slopes[gloss] = chain[gloss];
    result.reflectance[b] = factor * reflected + mirrored + model.missed[b];
  }
}

LeafFit fit_leaf(const LeafPixelModel& model, std::span<const double> measured,
                 LeafPrediction& prediction) {
  SmallFit<most_leaf_numbers> fit{.size = model.size(),
                                  .most_steps = 40,
                                  .shortest = 1e-3,
                                  .scale = model.prior_deviation,
                                  .at = start_of(model, measured, prediction)};
  LeafPrediction trial = prediction;
  fit.run([&](const LeafCoordinates& at) { return squares_at(model, measured, at, trial); },
          [&](std::size_t i, double x) { return std::clamp(x, model.low[i], model.high[i]); },
          // Numbers that the gradient pushes out of their range are held at its end.
          [&](std::size_t i, double x, double gradient) {
            return (x <= model.low[i] && gradient > 0.0) || (x >= model.high[i] && gradient < 0.0);
          },
          [&] { std::swap(prediction, trial); });
  return {fit.at, small_covariance(fit.squares.curvature, fit.size)};
}

}  // namespace lamina::detail
