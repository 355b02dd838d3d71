// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// What waves of light tell of two-layer skin: fits of many noisy measurements beside the Cramér-Rao
// bound, with and without waves; the table of docs/fit_accuracy.md.
//
//   skin_waves [DRAWS]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/solve/scattering/transport_profile/spatial_frequency_response.h"
#include "skin/fit/normal_number.h"

namespace {

using namespace lamina;

const std::vector<double> wavelengths = {471, 526, 591, 621, 659, 691, 731, 851};
constexpr double noise = 0.005;  // of each number

const MeasuredMaterial skin{R"({ "lamina": "material", "version": 1, "length_unit": "mm",
  "skin": { "melanin": 0.03, "hemoglobin_dermis": 0.01, "saturation_dermis": 0.65,
    "scattering_scale": 0.6, "epidermis_thickness": 0.1 } })",
                            "skin"};

FreeNumber free_number(const std::string& name, double start, double low, double high,
                       FitScale scale, double prior) {
  return {{.name = "skin." + name,
           .start = start,
           .low = low,
           .high = high,
           .scale = scale,
           .prior = FitPrior{.mean = start, .standard_deviation = prior}}};
}

/// Wide priors, not centred on the truth.
Measurement unmeasured() {
  return {.name = "skin",
          .material = skin,
          .bands = BandSet(wavelengths),
          .free = {free_number("epidermis_thickness", 0.12, 0.02, 0.6, FitScale::logarithmic, 0.3),
                   free_number("melanin", 0.02, 1e-4, 0.4, FitScale::logarithmic, 1.0),
                   free_number("hemoglobin_dermis", 0.02, 1e-4, 0.3, FitScale::logarithmic, 1.0),
                   free_number("saturation_dermis", 0.5, 0.0, 1.0, FitScale::logit, 1.5),
                   free_number("scattering_scale", 0.8, 0.1, 4.0, FitScale::logarithmic, 1.0),
                   free_number("baseline_scale", 0.1, 0.01, 1.0, FitScale::logarithmic, 1.0)}};
}

const std::vector<double> truth = {0.1, 0.03, 0.01, 0.65, 0.6, 0.084};

/// [band][k]
std::vector<std::vector<double>> responses(const Measurement& measurement,
                                           const std::vector<double>& values,
                                           const std::vector<double>& k) {
  std::vector<std::vector<double>> table;
  for (const double value : values) table.push_back({value});
  const auto found = spatial_frequency_response(layer_stacks(material_with(measurement, table)), k,
                                                {.accuracy = 1e-3});
  std::vector<std::vector<double>> responses(wavelengths.size());
  for (std::size_t b = 0; b < wavelengths.size(); ++b)
    for (std::size_t i = 0; i < k.size(); ++i)
      responses[b].push_back(found.reflectance[i * wavelengths.size() + b]);
  return responses;
}

/// Standard deviations of the coordinates that no estimate can undercut, priors included: from
/// differences of responses by radiative transfer.
std::vector<double> bound(const Measurement& measurement, const std::vector<double>& k) {
  const std::size_t n = truth.size();
  const auto at_truth = responses(measurement, truth, k);
  std::vector<std::vector<std::vector<double>>> change;
  for (std::size_t u = 0; u < n; ++u) {
    const FitParameter& parameter = measurement.free[u].parameter;
    const auto at = [&](double step) {
      std::vector<double> values = truth;
      values[u] = fit_value(parameter, fit_coordinate(parameter, truth[u]) + step);
      return responses(measurement, values, k);
    };
    constexpr double step = 0.05;
    auto high = at(step);
    const auto low = at(-step);
    for (std::size_t b = 0; b < high.size(); ++b)
      for (std::size_t i = 0; i < k.size(); ++i)
        high[b][i] = (high[b][i] - low[b][i]) / (2.0 * step * noise * at_truth[b][i]);
    change.push_back(std::move(high));
  }
  DenseMatrix information(n, n), unit(n, n);
  for (std::size_t u = 0; u < n; ++u) {
    unit(u, u) = 1.0;
    information(u, u) = std::pow(measurement.free[u].parameter.prior->standard_deviation, -2.0);
    for (std::size_t v = 0; v < n; ++v)
      for (std::size_t b = 0; b < wavelengths.size(); ++b)
        for (std::size_t i = 0; i < k.size(); ++i)
          information(u, v) += change[u][b][i] * change[v][b][i];
  }
  const DenseMatrix covariance = solve_linear(information, unit);
  std::vector<double> sd;
  for (std::size_t u = 0; u < n; ++u) sd.push_back(std::sqrt(covariance(u, u)));
  return sd;
}

struct Study {
  std::vector<double> root_mean_square, stated, prior_share;  ///< [number], of coordinates
  double seconds = 0.0, chi_squared = 0.0;
};

Study study(Measurement measurement, const std::vector<double>& k, int draws) {
  const auto exact = responses(measurement, truth, k);
  const std::size_t n = truth.size();
  Study study{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  for (int draw = 0; draw < draws; ++draw) {
    Random random = make_random(11, static_cast<std::uint64_t>(draw));
    MeasuredSeries series{.kind = MeasurementKind::spatial_frequency};
    for (std::size_t b = 0; b < wavelengths.size(); ++b)
      for (std::size_t i = 0; i < k.size(); ++i)
        series.points.push_back({.band = b,
                                 .at = k[i],
                                 .value = exact[b][i] * (1.0 + noise * normal_number(random)),
                                 .standard_deviation = noise * exact[b][i]});
    measurement.series = {series};
    const std::clock_t before = std::clock();
    const MeasurementFit fit = fit_measurement(measurement);
    study.seconds += static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC / draws;
    study.chi_squared += fit.chi_squared / draws;
    for (std::size_t u = 0; u < n; ++u) {
      const FitParameter& parameter = measurement.free[u].parameter;
      const FittedParameter& fitted = fit.numbers[u].fitted;
      study.root_mean_square[u] +=
          std::pow(fit_coordinate(parameter, fitted.value) - fit_coordinate(parameter, truth[u]),
                   2) /
          draws;
      study.stated[u] += fitted.standard_deviation / draws;
      study.prior_share[u] += fitted.prior_share / draws;
    }
    if (draw == 0)
      for (const std::string& note : fit.notes) std::printf("  note: %s\n", note.c_str());
  }
  for (double& square : study.root_mean_square) square = std::sqrt(square);
  return study;
}

}  // namespace

int main(int argc, char** argv) {
  const int draws = argc > 1 ? std::atoi(argv[1]) : 20;
  const Measurement measurement = unmeasured();
  for (const std::vector<double>& k : {std::vector<double>{0.0}, {0.0, 0.05, 0.1, 0.2}}) {
    std::printf("k = %g ... %g /mm\n", k.front(), k.back());
    const std::vector<double> least = bound(measurement, k);
    const Study found = study(measurement, k, draws);
    std::printf("%-24s %8s %8s %8s %8s\n", "number", "rms", "stated", "bound", "of prior");
    for (std::size_t u = 0; u < truth.size(); ++u)
      std::printf("%-24s %8.4f %8.4f %8.4f %8.2f\n", measurement.free[u].parameter.name.c_str(),
                  found.root_mean_square[u], found.stated[u], least[u], found.prior_share[u]);
    std::printf("chi squared %.1f, %.2f CPU-s a fit\n", found.chi_squared, found.seconds);
    std::fflush(stdout);
  }
}
