// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/skin/acquire/inversion/patch_inversion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/skin/acquire/inversion/errors/local_fit.h"
#include "lamina/skin/acquire/inversion/errors/posterior.h"
#include "lamina/skin/acquire/inversion/errors/smoothness_choice.h"
#include "lamina/skin/acquire/inversion/objective/coarser_capture.h"
#include "lamina/skin/acquire/inversion/steps/gauss_newton.h"
#include "lamina/skin/acquire/inversion/steps/lbfgs.h"

namespace lamina {
namespace {

using detail::InversionCourse;
using detail::MapSmoothness;
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
  require(std::isfinite(options.level_error) && options.level_error >= 0.0, "level_error",
          "must be >= 0", options.level_error);
  require(options.deviation_samples >= 0, "deviation_samples", "must be >= 0",
          options.deviation_samples);
  if (!options.error_growth.empty() && options.error_growth.size() != capture.images.size())
    throw InvalidInput("error_growth: must have one for each of " +
                       std::to_string(capture.images.size()) + " images, but has " +
                       std::to_string(options.error_growth.size()));
  for (const double factor : options.error_growth)
    require(std::isfinite(factor) && factor >= 1.0, "error_growth", "must be >= 1", factor);
  const std::size_t numbers = tables.numbers.size();
  const auto require_all = [numbers](std::size_t given, const char* name) {
    if (given != 0 && given != numbers)
      throw InvalidInput(std::string(name) + ": must have one for each of " +
                         std::to_string(numbers) + " numbers, but has " + std::to_string(given));
  };
  require_all(options.smoothness.size() == 2 * numbers ? numbers : options.smoothness.size(),
              "smoothness");
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
  if (!options.is_by_texel && tables.stacks.empty())
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

/// Whether smoothness is chosen here, and whether maps have edges.
bool chooses_smoothness(const InversionOptions& options) { return options.smoothness.empty(); }
bool has_edges(const InversionOptions& options, const InversionTables& tables) {
  return options.smoothness.size() == 2 * tables.numbers.size();
}

/// The smoothness to start with on a grid.
/// @param cost  of the grid: its texels over those of the finest
std::vector<MapSmoothness> first_smoothness(const InversionOptions& options,
                                            const InversionTables& tables, double mm_per_texel,
                                            double cost) {
  if (chooses_smoothness(options)) return detail::usual_smoothness(tables, mm_per_texel);
  const std::size_t numbers = tables.numbers.size();
  std::vector<MapSmoothness> result(numbers);
  for (std::size_t n = 0; n < numbers; ++n) {
    result[n].first.weight = options.smoothness[n];
    if (has_edges(options, tables))
      result[n].third.weight = options.smoothness[numbers + n] * cost * cost;
  }
  return result;
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
  for (const MapSmoothness& each : objective.smoothness())
    result.smoothness.push_back(each.first.weight);
  for (const MapSmoothness& each : objective.smoothness())
    result.smoothness.push_back(each.third.weight);
  result.error_growth = objective.error_growth();
  result.history = course.history;
  result.stop = course.stop;
}

/// A capture on one grid.
struct PatchGrid {
  PatchGrid(const PatchCapture& capture, const InversionTables& tables,
            const InversionOptions& options, double cost, double spent)
      : light(capture, tables, cost, spent),
        objective(capture, tables, options, light),
        level(detail::light_levels(objective)) {}
  PatchLight light;
  PatchObjective objective;
  TexelMaps level;
};

/// The leverage of the texels of each image together, by a draw: the sum of squares of what it
/// changes the images by, in standard deviations.
std::vector<double> leverage_of(PatchGrid& grid, const TexelMaps& draw) {
  const TexelMaps changes = grid.light.change(draw);
  std::vector<double> leverage;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    double sum = 0.0;
    for (std::size_t t = 0; t < changes[i].size(); ++t)
      sum += static_cast<double>(grid.objective.shares()[i][t]) *
             std::pow(static_cast<double>(grid.objective.weights()[i][t] * changes[i][t]), 2);
    leverage.push_back(sum);
  }
  return leverage;
}

/// Takes the smoothness that the data ask for, or edges alone where it is given.
void choose_smoothness(PatchGrid& grid, InversionCourse& course, const InversionOptions& options) {
  constexpr double cost_of_draw = 26.0;  // forward equivalents, and of what comes before
  PatchObjective& objective = grid.objective;
  PatchState& best = course.best;
  std::vector<MapSmoothness> smoothness = objective.smoothness();
  if (chooses_smoothness(options)) {
    if (course.must_end(cost_of_draw)) return;
    best.images = grid.light.images(best.coordinates);
    objective.linearize(best);
    const detail::BandBlocks blocks(objective, best.coordinates, grid.level);
    const detail::PosteriorSample draw = detail::draw_posterior(
        objective, blocks, options.seed, 1, [&] { return course.is_interrupted(); });
    if (course.stop == InversionStop::interrupted) return;
    smoothness = detail::likely_smoothness(objective, best.coordinates, draw);
  } else {
    for (std::size_t n = 0; n < smoothness.size(); ++n)
      detail::find_edges(objective.size(), best.coordinates[n], smoothness[n]);
  }
  objective.set_smoothness(std::move(smoothness));
  objective.weigh_again(best);
  course.begin_again();
}

/// What a coarser grid hands to a finer one.
struct CoarseSolution {
  TexelMaps coordinates;
  double spent = 0.0;  ///< forward equivalents
};

CoarseSolution finer_start(const PatchCapture& capture, const InversionTables& tables,
                           const InversionOptions& options, const Progress& progress, double cost);

/// Coordinates to start from: those of a capture half as fine, where errors that vary slowly cost
/// little to remove, down to a few texels a side; there those of each texel by itself.
CoarseSolution coarse_solution(const PatchCapture& capture, const InversionTables& tables,
                               const InversionOptions& options, const Progress& progress,
                               double cost) {
  constexpr int least_side = 20;
  constexpr double most_own_forwards = 16.0;
  CoarseSolution start;
  const bool is_coarsest = std::min(capture.width, capture.height) < 2 * least_side;
  if (!is_coarsest) start = finer_start(capture, tables, options, progress, cost);
  PatchGrid grid(capture, tables, options, cost, start.spent);
  if (is_coarsest)
    start.coordinates = detail::fit_texels(grid.objective, grid.level, options.robust_limit);
  grid.objective.set_smoothness(first_smoothness(options, tables, capture.mm_per_texel, cost));
  InversionOptions own = options;
  own.most_forwards =
      std::min(options.most_forwards, grid.light.forwards() + most_own_forwards * cost);
  own.stops_at_noise = false;
  PatchState state = grid.objective.state(std::move(start.coordinates));
  InversionCourse course(own, grid.light, progress, std::move(state));
  detail::run_gauss_newton(grid.objective, grid.level, course);
  return {std::move(course.best.coordinates), grid.light.forwards()};
}

/// The coarser grid's solution on a finer one.
CoarseSolution finer_start(const PatchCapture& capture, const InversionTables& tables,
                           const InversionOptions& options, const Progress& progress, double cost) {
  CoarseSolution start =
      coarse_solution(detail::coarser_capture(capture), tables, options, progress, 0.25 * cost);
  start.coordinates = detail::on_finer(start.coordinates, capture);
  return start;
}

/// Puts standard deviations, their shares of the prior's and correlations into a result.
void put_errors(const PatchObjective& objective, detail::PosteriorErrors errors,
                InversionResult& result) {
  result.correlation = std::move(errors.correlation);
  const DenseMatrix& precision = objective.tables().prior_precision;
  DenseMatrix one(precision.rows, precision.rows);
  for (std::size_t n = 0; n < precision.rows; ++n) one(n, n) = 1.0;
  const DenseMatrix covariance = solve_linear(precision, one);
  for (std::size_t n = 0; n < errors.deviations.size(); ++n) {
    NumberMap& map = result.numbers[n];
    map.deviation = {map.value.width, map.value.height, std::move(errors.deviations[n])};
    map.prior_share = map.deviation;
    const auto prior = static_cast<float>(std::sqrt(covariance(n, n)));
    for (float& value : map.prior_share.values) value = std::min(1.0f, value / prior);
  }
}

/// Draws about the best state of a course: which errors it has, and what it leaves.
struct PosteriorDraws {
  PosteriorDraws(PatchGrid& grid, InversionCourse& course)
      : blocks([&]() -> detail::BandBlocks {
          course.best.images = grid.light.images(course.best.coordinates);
          grid.objective.linearize(course.best);
          return {grid.objective, course.best.coordinates, grid.level};
        }()) {}
  /// Adds draws until there are so many, or somebody asks to stop.
  void draw(PatchGrid& grid, InversionCourse& course, std::uint64_t seed, int count) {
    const auto must_end = [&] { return course.is_interrupted(); };
    for (auto d = static_cast<int>(draws.size()); d < count && !must_end(); ++d)
      draws.push_back(detail::draw_posterior(grid.objective, blocks, seed,
                                             100 + static_cast<std::uint64_t>(d), must_end)
                          .off);
  }
  detail::BandBlocks blocks;
  std::vector<TexelMaps> draws;
};

/// The errors of texels each by itself grow to what samples of them leave.
std::vector<BandMisfit> grow_errors_of_texels(PatchGrid& grid, double robust_limit) {
  constexpr int most_rounds = 20;
  constexpr double hardly = 1.02;
  std::vector<BandMisfit> misfit;
  for (int round = 0; round < most_rounds; ++round) {
    misfit = detail::texel_misfit(grid.objective, grid.level, robust_limit);
    const std::vector<double> before = grid.objective.error_growth();
    const std::vector<double> growth = error_growth_of(misfit);
    grid.objective.set_error_growth(growth);
    if (largest_ratio(growth, before) < hardly && largest_ratio(before, growth) < hardly) break;
  }
  return misfit;
}

}  // namespace

InversionResult invert_patch(const PatchCapture& capture, const InversionTables& tables,
                             const InversionOptions& options, const Progress& progress) {
  check_capture(capture);
  check(capture, tables, options);
  const bool is_local = options.is_by_texel;
  CoarseSolution start;
  if (!is_local && options.start.empty())
    start = finer_start(capture, tables, options, progress, 1.0);
  if (!options.start.empty()) start.coordinates = coordinates_of(options.start, tables);
  PatchGrid grid(capture, tables, options, 1.0, start.spent);
  InversionResult result;
  if (is_local && options.deviation_samples > 0 && options.error_growth.empty())
    result.misfit = grow_errors_of_texels(grid, options.robust_limit);
  if (!is_local)
    grid.objective.set_smoothness(first_smoothness(options, tables, capture.mm_per_texel, 1.0));
  if (start.coordinates.empty())
    start.coordinates = detail::fit_texels(grid.objective, grid.level, options.robust_limit);
  PatchState state = tables.stacks.empty()
                         ? grid.objective.state(
                               start.coordinates,
                               detail::local_images(grid.objective, grid.level, start.coordinates))
                         : grid.objective.state(start.coordinates);
  InversionOptions own = options;
  InversionCourse course(own, grid.light, progress, std::move(state));
  const auto run_gauss_newton = [&](int most_steps) {
    detail::run_gauss_newton(grid.objective, grid.level, course, most_steps);
  };
  constexpr int all_steps = std::numeric_limits<int>::max();
  if (!is_local) {
    if (chooses_smoothness(options)) {
      // Far off gradients alone find no step; nearer, they stand stiff smoothness better than
      // systems that are cut short.
      constexpr int steps = 10;
      constexpr double far = 6.0, near_noise = 1.05;  // in standard deviations
      if (course.best.in_deviations > far) run_gauss_newton(1);
      for (int round = 0; round < 2; ++round)
        if (course.goes_on() && (round == 0 || course.best.in_deviations > near_noise))
          detail::run_lbfgs(grid.objective, grid.level, course, steps);
    }
    if (course.goes_on() && (chooses_smoothness(options) || has_edges(options, tables)))
      choose_smoothness(grid, course, options);
    if (course.goes_on()) run_gauss_newton(all_steps);
  }
  if (options.deviation_samples > 0 && is_local) {
    put_results(grid.objective, course, result);
    put_errors(grid.objective,
               detail::texel_errors(grid.objective, grid.level, course.best.coordinates,
                                    options.robust_limit),
               result);
  } else if (options.deviation_samples > 0 && course.stop != InversionStop::interrupted) {
    // Errors grow to what is left; where that is much the maps follow. By the grown ones residuals
    // are at their deviations from the first step on, which then says nothing of the maps.
    own.stops_at_noise = false;
    constexpr double much = 1.1, hardly = 1.02;
    constexpr int most_rounds = 3;
    double before = grid.light.forwards();
    std::optional<PosteriorDraws> posterior(std::in_place, grid, course);
    for (int round = 0; round < most_rounds; ++round) {
      posterior->draw(grid, course, options.seed, 1);
      if (course.stop == InversionStop::interrupted) break;
      result.misfit =
          grid.objective.misfit(course.best, leverage_of(grid, posterior->draws.front()));
      if (!options.error_growth.empty()) break;
      const std::vector<double> growth = error_growth_of(result.misfit);
      const double more = std::max(largest_ratio(growth, grid.objective.error_growth()),
                                   largest_ratio(grid.objective.error_growth(), growth));
      if (more < hardly) break;
      grid.objective.set_error_growth(growth);
      grid.objective.weigh_again(course.best);
      if (more > much && round + 1 < most_rounds) {
        own.most_forwards = grid.light.forwards() + options.most_forwards;
        course.begin_again();
        if (chooses_smoothness(options)) choose_smoothness(grid, course, options);
        if (course.goes_on()) run_gauss_newton(all_steps);
        before = grid.light.forwards();
      }
      posterior.emplace(grid, course);
      if (more <= much) break;
    }
    put_results(grid.objective, course, result);
    posterior->draw(grid, course, options.seed, options.deviation_samples);
    result.deviation_forwards = grid.light.forwards() - before;
    if (!posterior->draws.empty() && course.stop != InversionStop::interrupted)
      put_errors(grid.objective,
                 detail::posterior_errors(grid.objective, posterior->blocks, posterior->draws,
                                          options.level_error),
                 result);
  } else {
    put_results(grid.objective, course, result);
  }
  result.stop = course.stop;
  return result;
}

std::vector<BandMisfit> misfit_of_texels(const PatchCapture& capture, const InversionTables& tables,
                                         const InversionOptions& options) {
  check_capture(capture);
  check(capture, tables, options);
  PatchGrid grid(capture, tables, options, 1.0, 0.0);
  return grow_errors_of_texels(grid, options.robust_limit);
}

}  // namespace lamina
