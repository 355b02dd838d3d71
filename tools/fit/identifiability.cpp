// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What kinds of measurements tell of a material, every number known to 1 %: standard deviations by
// the curvature of fits to measurements without noise; the table of docs/fit_accuracy.md.
//
//   identifiability
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "lamina/skin/fit/measurement_fit.h"

namespace {

using namespace lamina;

constexpr double known = 0.01;  // errors of what is measured, relative

MeasuredMaterial material(const std::string& content) {
  return {R"({ "lamina": "material", "version": 1, "length_unit": "mm", )" + content + " }",
          "example"};
}

const MeasuredMaterial half_space = material(R"("bands": [650], "layers": [
  { "sigma_a": 0.05, "sigma_s_prime": 1, "g": 0.8, "ior": 1.4, "thickness": "infinite" } ])");
const MeasuredMaterial slab = material(R"("bands": [650], "ior_below": 1, "layers": [
  { "sigma_a": 0.05, "sigma_s_prime": 1, "g": 0.8, "ior": 1.4, "thickness": 1 } ])");
const MeasuredMaterial two_layers = material(R"("bands": [650], "layers": [
  { "sigma_a": 0.5, "sigma_s_prime": 3, "g": 0.8, "ior": 1.4, "thickness": 0.2 },
  { "sigma_a": 0.05, "sigma_s_prime": 1.5, "g": 0.8, "ior": 1.4, "thickness": "infinite" } ])");
const MeasuredMaterial skin = material(R"("skin": { "melanin": 0.03, "hemoglobin_dermis": 0.01,
  "saturation_dermis": 0.65, "scattering_scale": 0.6, "epidermis_thickness": 0.1 })");

/// A positive number, hardly known before: to a factor of e.
FreeNumber positive(const std::string& path, double truth) {
  return {{.name = path,
           .start = truth,
           .low = truth / 100.0,
           .high = truth * 100.0,
           .scale = FitScale::logarithmic,
           .prior = FitPrior{.mean = truth, .standard_deviation = 1.0}}};
}

/// A mean cosine or a fraction, known before to 0.1.
FreeNumber fraction(const std::string& path, double truth) {
  return {{.name = path,
           .start = truth,
           .low = 0.0,
           .high = 0.99,
           .prior = FitPrior{.mean = truth, .standard_deviation = 0.1}}};
}

MeasuredSeries totals(const std::vector<MeasuredQuantity>& quantities, std::size_t bands = 1) {
  MeasuredSeries series;
  for (std::size_t band = 0; band < bands; ++band)
    for (const MeasuredQuantity quantity : quantities)
      series.points.push_back({.band = band, .quantity = quantity});
  return series;
}

MeasuredSeries over(MeasurementKind kind, const std::vector<double>& places) {
  MeasuredSeries series{.kind = kind};
  for (const double at : places) series.points.push_back({.at = at});
  return series;
}

/// Puts in what the material would show: predictions of a fit that may not move. What is asked of
/// their accuracy follows from the errors, hence twice.
void measure(Measurement& measurement) {
  for (MeasuredPoint& point : measurement.series[0].points)
    point.value = point.standard_deviation = 1.0;
  Measurement held = measurement;
  for (FreeNumber& free : held.free) free.parameter.prior->standard_deviation = 1e-6;
  for (int pass = 0; pass < 2; ++pass) {
    const MeasurementFit fit = fit_measurement(held);
    for (std::size_t p = 0; p < fit.predicted[0].size(); ++p) {
      held.series[0].points[p].value = fit.predicted[0][p];
      held.series[0].points[p].standard_deviation = known * fit.predicted[0][p];
    }
  }
  measurement.series = held.series;
}

void print_row(const char* measured, const MeasuredMaterial& is, const BandSet& bands,
               std::vector<FreeNumber> free, MeasuredSeries series) {
  Measurement measurement{
      .material = is, .bands = bands, .free = std::move(free), .series = {std::move(series)}};
  measure(measurement);
  const MeasurementFit fit = fit_measurement(measurement);
  std::printf("| %s |", measured);
  for (const FittedNumber& number : fit.numbers) {
    const std::string& name = number.name;
    const double sd = number.fitted.standard_deviation;
    std::printf(" %s", name.substr(name.rfind('.') + 1).c_str());
    if (name.find("[1]") != std::string::npos) std::printf(" below");
    if (number.fitted.prior_share > prior_share_of_note)
      std::printf(" –;");
    else if (measurement.free[number.free].parameter.scale == FitScale::logarithmic)
      std::printf(" %.2g %%;", 100.0 * sd);
    else
      std::printf(" ±%.2g;", sd);
  }
  std::printf(" |");
  const DenseMatrix& correlation = fit.groups[0].correlation;
  for (std::size_t i = 0; i < correlation.rows; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(correlation(i, j)) > correlation_of_note) {
        // What is told of the two together, of their product or quotient by the sign.
        const double a = fit.numbers[i].fitted.standard_deviation,
                     b = fit.numbers[j].fitted.standard_deviation;
        std::printf(" %s, %s: %.3f, together %.2g %%;", fit.numbers[j].name.c_str(),
                    fit.numbers[i].name.c_str(), correlation(i, j),
                    100.0 * std::sqrt(a * a + b * b - 2.0 * std::abs(correlation(i, j)) * a * b));
      }
  std::printf(" |\n");
  std::fflush(stdout);
}

}  // namespace

int main() {
  using enum MeasuredQuantity;
  const BandSet red({650.0});
  const auto absorption = positive("layers[0].sigma_a", 0.05),
             scattering = positive("layers[0].sigma_s_prime", 1.0);
  const auto g = fraction("layers[0].g", 0.8);
  const auto waves = MeasurementKind::spatial_frequency, rings = MeasurementKind::radial_profile;

  print_row("R, half-space", half_space, red, {absorption, scattering, g}, totals({reflectance}));
  print_row("R, T, slab of known thickness", slab, red, {absorption, scattering, g},
            totals({reflectance, transmittance}));
  print_row("R, T, thickness free", slab, red,
            {absorption, scattering, g, positive("layers[0].thickness", 1.0)},
            totals({reflectance, transmittance}));
  print_row("R, T, unscattered T", slab, red, {absorption, scattering, g},
            totals({reflectance, transmittance, unscattered_transmittance}));
  print_row("R(k), half-space, k = 0, .1, .3", half_space, red, {absorption, scattering, g},
            over(waves, {0.0, 0.1, 0.3}));
  print_row("R(r), half-space, r = .5, 1, 2, 4", half_space, red, {absorption, scattering, g},
            over(rings, {0.5, 1.0, 2.0, 4.0}));

  const std::vector<FreeNumber> of_two = {
      positive("layers[0].sigma_a", 0.5), positive("layers[0].sigma_s_prime", 3.0),
      positive("layers[0].thickness", 0.2), positive("layers[1].sigma_a", 0.05),
      positive("layers[1].sigma_s_prime", 1.5)};
  print_row("R(k), two layers, k = 0, .05, .1, .2", two_layers, red, of_two,
            over(waves, {0.0, 0.05, 0.1, 0.2}));
  print_row("R(k), two layers, k = 0 to 3", two_layers, red, of_two,
            over(waves, {0.0, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0}));
  std::vector<double> visible;
  for (double nm = 420.0; nm <= 700.0; nm += 20.0) visible.push_back(nm);
  print_row("R, skin, 420 to 700 nm", skin, BandSet(visible),
            {positive("skin.melanin", 0.03), positive("skin.hemoglobin_dermis", 0.01),
             fraction("skin.saturation_dermis", 0.65), positive("skin.scattering_scale", 0.6),
             positive("skin.epidermis_thickness", 0.1)},
            totals({reflectance}, visible.size()));

  print_row("R(r), two layers, r = .4, .8, 1.6, 3, 6", two_layers, red, of_two,
            over(rings, {0.4, 0.8, 1.6, 3.0, 6.0}));
}
