// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Slabs between slides, as an integrating sphere with a small port reads them, and what fits find
// of their coefficients: the table of docs/fit_accuracy.md. `sphere_fits SLABS`, 30 if not given.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "lamina/base/core/number_text.h"
#include "lamina/base/core/random.h"
#include "lamina/skin/fit/measurement_fit.h"
#include "lamina/solve/integrating_sphere/lost_light.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "skin/fit/normal_number.h"

namespace {

using namespace lamina;

constexpr double beam = 2.0, noise = 0.002;

struct Sample {
  double sigma_a, sigma_s_prime, g, ior, thickness;
};

IntegratingSphere sphere_of(SphereMethod method, bool is_behind) {
  return {.diameter = 100.0,
          .sample_port = 10.0,
          .detector_port = 8.0,
          .entrance_port = is_behind ? 0.0 : 8.0,
          .wall_reflectance = 0.97,
          .standard_reflectance = is_behind ? 0.97 : 0.99,
          .method = method};
}

std::string material_text(const Sample& sample) {
  const std::string slide =
      R"({ "sigma_a": 0, "sigma_s": 0, "g": 0, "ior": 1.52, "thickness": 1 })";
  return R"({ "lamina": "material", "version": 1, "length_unit": "mm", "bands": [600],
    "ior_below": 1, "layers": [)" +
         slide + R"(, { "sigma_a": )" + number_text(sample.sigma_a) + R"(, "sigma_s_prime": )" +
         number_text(sample.sigma_s_prime) + R"(, "g": )" + number_text(sample.g) + R"(, "ior": )" +
         number_text(sample.ior) + R"(, "thickness": )" + number_text(sample.thickness) + "}, " +
         slide + "] }";
}

/// Reflectance and transmittance that spheres read; photons of another seed than that of fits.
std::pair<double, double> readings(const LayerStack& stack, SphereMethod method) {
  const auto found = adding_doubling(stack), diffuse = adding_doubling(stack, {.is_diffuse = true});
  const IntegratingSphere above = sphere_of(method, false), below = sphere_of(method, true);
  const double port = above.sample_port;
  const LostLight lost = lost_light(stack, {}, beam, port, {.photons = 4'000'000, .seed = 99});
  const double in_port =
      diffuse.totals.specular_reflectance + diffuse.totals.diffuse_reflectance -
      lost_light(stack, {.is_diffuse = true}, port, port, {.seed = 98}).reflected.value;
  const SampleLight reflected{.scattered = found.totals.specular_reflectance +
                                           found.totals.diffuse_reflectance -
                                           found.unscattered_reflectance - lost.reflected.value,
                              .straight = found.unscattered_reflectance};
  const SampleLight transmitted{
      .scattered =
          found.totals.transmittance - found.unscattered_transmittance - lost.transmitted.value,
      .straight = found.unscattered_transmittance};
  return {reflectance_reading(above, reflected, in_port).value,
          transmittance_reading(below, transmitted, in_port).value};  // slides are alike
}

/// Relative errors of a fit, and the same over its standard deviations.
struct Errors {
  std::vector<double> sigma_a, sigma_s_prime, of_deviation_a, of_deviation_s;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

void print_row(const char* name, const Errors& errors) {
  const auto inside = [](const std::vector<double>& of, double limit) {
    return 100.0 *
           static_cast<double>(std::ranges::count_if(of, [&](double e) { return e < limit; })) /
           static_cast<double>(of.size());
  };
  std::printf("| %s | %.1f / %.0f | %.1f / %.0f | %.0f, %.0f | %.0f, %.0f |\n", name,
              100 * quantile(errors.sigma_a, 0.5), 100 * quantile(errors.sigma_a, 0.9),
              100 * quantile(errors.sigma_s_prime, 0.5), 100 * quantile(errors.sigma_s_prime, 0.9),
              inside(errors.of_deviation_a, 1.0), inside(errors.of_deviation_a, 2.0),
              inside(errors.of_deviation_s, 1.0), inside(errors.of_deviation_s, 2.0));
}

enum class Model { nothing, gain, lost, all };

}  // namespace

int main(int count, char** arguments) {
  const int slabs = count > 1 ? std::atoi(arguments[1]) : 30;
  const bool prints_each = count > 2;
  Errors errors[4];
  std::vector<double> lost_share;
  for (int i = 0; i < slabs; ++i) {
    Random random = make_random(5, static_cast<std::uint64_t>(i));
    const auto between = [&](double low, double high) {
      return low * std::pow(high / low, random.uniform());
    };
    const Sample sample{.sigma_a = between(0.005, 0.5),
                        .sigma_s_prime = between(0.5, 5.0),
                        .g = 0.6 + 0.3 * random.uniform(),
                        .ior = 1.33 + 0.1 * random.uniform(),
                        .thickness = between(0.5, 4.0)};
    const MeasuredMaterial material{material_text(sample), "slab"};
    const auto method = i % 2 == 0 ? SphereMethod::substitution : SphereMethod::comparison;
    auto [r, t] = readings(layer_stack(material.with({}), 0), method);
    r += noise * normal_number(random);
    t += noise * normal_number(random);
    for (const Model model : {Model::nothing, Model::gain, Model::lost, Model::all}) {
      MeasuredSeries series;
      for (const bool is_behind : {false, true}) {
        MeasuredPoint point{
            .quantity = is_behind ? MeasuredQuantity::transmittance : MeasuredQuantity::reflectance,
            .value = is_behind ? t : r,
            .standard_deviation = noise};
        if (model != Model::nothing)
          point.sphere =
              sphere_of(model == Model::lost ? SphereMethod::comparison : method, is_behind);
        series.points.push_back(point);
      }
      if (model == Model::lost || model == Model::all) series.beam_diameter = beam;
      Measurement measurement{.material = material, .bands = BandSet({600.0})};
      measurement.series = {series};
      const auto free = [](const std::string& path, double start) {
        return FreeNumber{{.name = path,
                           .start = start,
                           .low = 1e-5,
                           .high = 100,
                           .scale = FitScale::logarithmic},
                          false};
      };
      measurement.free = {free("layers[1].sigma_a", 0.1), free("layers[1].sigma_s_prime", 1.0)};
      const MeasurementFit fit = fit_measurement(measurement);
      Errors& of = errors[static_cast<int>(model)];
      const auto add = [&](std::size_t u, double truth, std::vector<double>& relative,
                           std::vector<double>& over_deviation) {
        const double found = fit.values[u][0];
        relative.push_back(std::abs(found / truth - 1.0));
        over_deviation.push_back(std::abs(std::log(found / truth)) /
                                 fit.numbers[u].fitted.standard_deviation);
        if (prints_each)
          std::printf("%9.5f ± %-8.2g", found, found * fit.numbers[u].fitted.standard_deviation);
      };
      if (prints_each && model == Model::nothing)
        std::printf("%d: sigma_a %.5f, sigma_s' %.4f, g %.2f, %.2f mm: R %.4f T %.4f\n", i,
                    sample.sigma_a, sample.sigma_s_prime, sample.g, sample.thickness, r, t);
      add(0, sample.sigma_a, of.sigma_a, of.of_deviation_a);
      add(1, sample.sigma_s_prime, of.sigma_s_prime, of.of_deviation_s);
      if (prints_each) {
        std::printf("  chi squared %.2g", fit.chi_squared);
        for (const std::string& note : fit.notes) std::printf("; %s", note.c_str());
        std::printf("\n");
      }
      std::fflush(stdout);
    }
  }
  std::printf(
      "| the fit knows | sigma_a wrong by, %% | sigma_s' wrong by, %% | truths within 1, 2 sd: "
      "sigma_a | sigma_s' |\n|---|---|---|---|---|\n");
  print_row("neither", errors[0]);
  print_row("the gain of the sphere", errors[1]);
  print_row("lost light", errors[2]);
  print_row("both", errors[3]);
}
