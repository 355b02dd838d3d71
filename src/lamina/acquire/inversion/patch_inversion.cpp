// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/acquire/inversion/patch_inversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "lamina/acquire/inversion/internal/coarser_capture.h"
#include "lamina/acquire/inversion/internal/gauss_newton.h"
#include "lamina/acquire/inversion/internal/local_fit.h"
#include "lamina/core/error.h"
#include "lamina/core/number_text.h"

namespace lamina {
namespace {

using detail::InversionCourse;
using detail::PatchLight;
using detail::PatchObjective;
using detail::PatchState;
using detail::TexelMaps;

void check(const PatchCapture& capture, const InversionTables& tables,
           const InversionOptions& options) {
  const auto require = [](bool holds, const char* name, const char* rule, double given) {
    if (!holds)
      throw InvalidInput(std::string(name) + ": " + rule + ", but is " + number_text(given));
  };
  require(std::isfinite(options.robust_limit) && options.robust_limit >= 0.0, "robust_limit",
          "must be >= 0", options.robust_limit);
  require(std::isfinite(options.model_error) && options.model_error >= 0.0, "model_error",
          "must be >= 0", options.model_error);
  require(options.most_forwards > 0.0, "most_forwards", "must be > 0", options.most_forwards);
  require(options.tolerance >= 0.0, "tolerance", "must be >= 0", options.tolerance);
  require(options.deviation_samples >= 0, "deviation_samples", "must be >= 0",
          options.deviation_samples);
  const std::size_t numbers = tables.numbers.size();
  const auto require_all = [numbers](std::size_t given, const char* name) {
    if (given != 0 && given != numbers)
      throw InvalidInput(std::string(name) + ": must have one for each of " +
                         std::to_string(numbers) + " numbers, but has " + std::to_string(given));
  };
  require_all(options.smoothness.size(), "smoothness");
  for (const double weight : options.smoothness)
    require(std::isfinite(weight) && weight >= 0.0, "smoothness", "must be >= 0", weight);
  require_all(options.start.size(), "start");
  for (const Plane& plane : options.start) {
    if (plane.width != capture.width || plane.height != capture.height ||
        plane.values.size() != capture.images[0].reflected.values.size())
      throw InvalidInput("start: must be of the size of the capture");
    for (const float value : plane.values)
      require(std::isfinite(value), "start", "must be finite", static_cast<double>(value));
  }
  if (capture.wavelengths != tables.wavelengths)
    throw InvalidInput("tables: must be of the wavelengths of the capture");
  if (options.method != InversionMethod::per_pixel && tables.stacks.empty())
    throw InvalidInput("tables: must be of skin with transport, unless texels are inverted alone");
}

TexelMaps coordinates_of(const std::vector<Plane>& values, const InversionTables& tables) {
  TexelMaps result;
  for (std::size_t n = 0; n < values.size(); ++n) {
    const FitParameter& parameter = tables.numbers[n].parameter;
    std::vector<float>& map = result.emplace_back();
    for (const float value : values[n].values)
      map.push_back(static_cast<float>(fit_coordinate(
          parameter, std::clamp(static_cast<double>(value), parameter.low, parameter.high))));
  }
  return result;
}

/// Weights of smoothness for numbers of skin as they vary over forearms.
std::vector<double> usual_smoothness(const InversionTables& tables) {
  static constexpr std::array<std::pair<const char*, double>, 7> usual = {
      {{"melanin", 10.0},
       {"melanin_blend", 100.0},
       {"hemoglobin_epidermis", 30.0},
       {"hemoglobin_dermis", 100.0},
       {"carotene", 300.0},
       {"saturation", 300.0},
       {"baseline_scale", 300.0}}};
  std::vector<double> weights;
  for (const SkinFitNumber& number : tables.numbers)
    for (const auto& [name, weight] : usual)
      if (number.parameter.name == name) weights.push_back(weight);
  return weights;
}

void put_results(const PatchObjective& objective, const InversionCourse& course,
                 InversionResult& result) {
  const PatchCapture& capture = objective.capture();
  const PatchState& state = course.best;
  for (std::size_t n = 0; n < state.coordinates.size(); ++n) {
    const FitParameter& parameter = objective.tables().numbers[n].parameter;
    NumberMap& map = result.numbers.emplace_back();
    map.name = parameter.name;
    map.value = make_plane(capture.width, capture.height);
    for (std::size_t t = 0; t < map.value.values.size(); ++t)
      map.value.values[t] =
          static_cast<float>(fit_value(parameter, static_cast<double>(state.coordinates[n][t])));
  }
  for (std::size_t i = 0; i < capture.images.size(); ++i) {
    Plane& residual = result.residual.emplace_back(make_plane(capture.width, capture.height));
    for (std::size_t t = 0; t < residual.values.size(); ++t)
      if (objective.weights()[i][t] > 0.0f)
        residual.values[t] = capture.images[i].reflected.values[t] - state.images[i][t];
  }
  result.smoothness = objective.smoothness();
  result.history = course.history;
  result.stop = course.stop;
}

/// Coordinates to start from: those of a capture half as fine, where errors that vary slowly cost
/// little to remove, down to a few texels a side; there those of each texel by itself.
TexelMaps coarse_solution(const PatchCapture& capture, const InversionTables& tables,
                          const InversionOptions& options, const std::vector<double>& smoothness,
                          const Progress& progress, double cost, double& spent) {
  constexpr int least_side = 20;
  constexpr double most_own_forwards = 30.0;
  std::optional<TexelMaps> start;
  if (std::min(capture.width, capture.height) >= 2 * least_side) {
    const PatchCapture coarse = detail::coarser_capture(capture);
    start = detail::on_finer(
        coarse_solution(coarse, tables, options, smoothness, progress, 0.25 * cost, spent),
        capture);
  }
  PatchLight light(capture, tables, cost, spent);
  PatchObjective objective(capture, tables, options, light);
  objective.set_smoothness(smoothness);
  const TexelMaps level = detail::light_levels(objective);
  if (!start) start = detail::fit_texels(objective, level, options.robust_limit);
  InversionOptions own = options;
  own.most_forwards = std::min(options.most_forwards, light.forwards() + most_own_forwards * cost);
  own.stops_at_noise = false;
  own.tolerance = 0.03;
  InversionCourse course(own, light, progress, objective.state(std::move(*start)));
  detail::run_gauss_newton(objective, level, course);
  spent = light.forwards();
  return std::move(course.best.coordinates);
}

}  // namespace

InversionResult invert_patch(const PatchCapture& capture, const InversionTables& tables,
                             const InversionOptions& options, const Progress& progress) {
  check_capture(capture);
  check(capture, tables, options);
  const bool is_local = options.method == InversionMethod::per_pixel;
  std::vector<double> smoothness(tables.numbers.size(), 0.0);
  if (!is_local)
    smoothness = options.smoothness.empty() ? usual_smoothness(tables) : options.smoothness;
  double spent = 0.0;
  TexelMaps start;
  if (!options.start.empty()) {
    start = coordinates_of(options.start, tables);
  } else if (options.method == InversionMethod::gauss_newton) {
    start = detail::on_finer(coarse_solution(detail::coarser_capture(capture), tables, options,
                                             smoothness, progress, 0.25, spent),
                             capture);
  }
  PatchLight light(capture, tables, 1.0, spent);
  PatchObjective objective(capture, tables, options, light);
  objective.set_smoothness(smoothness);
  const TexelMaps level = detail::light_levels(objective);
  if (start.empty()) start = detail::fit_texels(objective, level, options.robust_limit);
  PatchState state = is_local
                         ? objective.state(start, detail::local_images(objective, level, start))
                         : objective.state(std::move(start));
  InversionCourse course(options, light, progress, std::move(state));
  if (options.method == InversionMethod::gauss_newton)
    detail::run_gauss_newton(objective, level, course);
  InversionResult result;
  put_results(objective, course, result);
  return result;
}

}  // namespace lamina
