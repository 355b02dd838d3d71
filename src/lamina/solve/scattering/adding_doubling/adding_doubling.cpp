// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_on_grid.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_rough.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/adding_doubling/kept_rough_boundaries.h"

namespace lamina {
namespace {

using detail::GridStack;
using detail::StackOperators;

/// [incidence]. Diffuse ones take no beam on the grid.
std::vector<AddingDoublingTotals> totals_on_grid(const GridStack& on_grid,
                                                 std::span<const Incidence> incidences,
                                                 const detail::RoughBoundaries& rough) {
  const StackOperators operators = detail::stack_operators(on_grid, 0, rough);
  std::vector<AddingDoublingTotals> results;
  std::size_t beam = 0;
  for (const Incidence& incidence : incidences)
    results.push_back(detail::totals_of(on_grid, operators,
                                        incidence.is_diffuse
                                            ? detail::incident_state(on_grid, std::nullopt)
                                            : detail::incident_state(on_grid, beam++)));
  return results;
}

double largest_difference(const SlabTotals& a, const SlabTotals& b) {
  double largest = std::max({std::abs(a.specular_reflectance - b.specular_reflectance),
                             std::abs(a.diffuse_reflectance - b.diffuse_reflectance),
                             std::abs(a.transmittance - b.transmittance)});
  for (std::size_t k = 0; k < a.absorptance.size(); ++k)
    largest = std::max(largest, std::abs(a.absorptance[k] - b.absorptance[k]));
  return largest;
}

void check(const AddingDoublingOptions& options) {
  if (!(1e-10 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-10, 0.1], but is " +
                       number_text(options.accuracy));
  if (!(4 <= options.max_nodes && options.max_nodes <= 1000))
    throw InvalidInput("max_nodes: must lie in [4, 1000], but is " +
                       std::to_string(options.max_nodes));
}

/// Fraction of the extinction that goes into forward peaks too sharp for the grid, which it takes
/// for unscattered; the largest of all layers.
double unseen_peak(const GridStack& on_grid) {
  double most = 0.0;
  for (const detail::GridLayer& layer : on_grid.layers)
    if (layer.extinction > 0.0) most = std::max(most, 1.0 - layer.sigma_t / layer.extinction);
  return most;
}

/// What a grid is compared with.
struct LastGrid {
  std::vector<AddingDoublingTotals> results;  ///< [incidence]
  std::vector<double> change;                 ///< [incidence] from the grid before; 1 if none
  double unseen_peak = 0.0;
};

/// The error of a grid that changed the totals of the last one by so much. Changes fall by a factor
/// from grid to grid, so that what is left of a slow series is more than its last change. Two grids
/// may agree by chance; then the step before has its say, the more the slower the unseen peak
/// shrinks. (Errors are at most .8 of this over 60 stacks of g .9 to .995, five
/// accuracies each, against 200 nodes: tools/tables/adding_doubling_errors.)
double error_after(double change, double last_change, double last_error, double shrinking) {
  const double ratio = last_change > 0.0 ? std::min(change / last_change, 0.85) : 0.0;
  const double by_chance = last_change < 1.0 ? std::max(0.02, 0.25 * shrinking) : 0.02;
  return std::max(change * std::max(1.0, ratio / (1.0 - ratio)), by_chance * last_error);
}

/// Refines the grid until all is accurate, [stack][incidence]. The stacks have equal boundaries, so
/// rough ones are made once for all of them.
std::vector<std::vector<AddingDoublingTotals>> solve_group(
    std::span<const LayerStack* const> stacks, std::span<const Incidence> incidences,
    const AddingDoublingOptions& options) {
  constexpr int coarsest = 6;
  const std::vector<GridDirection> beams = detail::beams_of(*stacks[0], incidences);
  const double least_error = is_smooth(*stacks[0]) ? 0.0 : detail::rough_boundary_error;
  const auto is_coarse = [&](const AddingDoublingTotals& result) {
    return result.estimated_error > std::max(options.accuracy, least_error);
  };
  std::vector<LastGrid> grids(stacks.size());
  std::vector<std::size_t> coarse(stacks.size());
  std::iota(coarse.begin(), coarse.end(), 0);
  int nodes = std::min(coarsest, options.max_nodes);
  const Progress progress = of_unknown_length(options.progress);
  while (true) {
    std::vector<GridStack> on_grid;
    for (const std::size_t k : coarse)
      on_grid.push_back(detail::make_grid_stack(*stacks[k], nodes, beams));
    const detail::RoughBoundaries rough =
        detail::kept_rough_boundaries(on_grid[0], 1, progress).front();
    const auto solve = [&](std::size_t c) {
      LastGrid& last = grids[coarse[c]];
      LastGrid finer{.results = totals_on_grid(on_grid[c], incidences, rough),
                     .change = std::vector<double>(incidences.size(), 1.0),
                     .unseen_peak = unseen_peak(on_grid[c])};
      for (std::size_t i = 0; i < finer.results.size(); ++i) {
        AddingDoublingTotals& result = finer.results[i];
        result.nodes = nodes;
        result.estimated_error = 1.0;
        if (last.results.empty()) continue;
        finer.change[i] = largest_difference(result.totals, last.results[i].totals);
        const double shrinking =
            last.unseen_peak > 0.0 ? finer.unseen_peak / last.unseen_peak : 0.0;
        result.estimated_error =
            std::max(least_error, error_after(finer.change[i], last.change[i],
                                              last.results[i].estimated_error, shrinking));
        result.is_accurate = result.estimated_error <= options.accuracy;
      }
      last = std::move(finer);
    };
    parallel_for(coarse.size(), solve, progress);
    std::erase_if(coarse,
                  [&](std::size_t k) { return std::ranges::none_of(grids[k].results, is_coarse); });
    if (coarse.empty() || nodes >= options.max_nodes) break;
    // The last step is no smaller than others, or its change would say little.
    nodes = nodes * 15 / 8 > options.max_nodes ? options.max_nodes : nodes * 3 / 2;
  }
  std::vector<std::vector<AddingDoublingTotals>> results;
  for (LastGrid& grid : grids) results.push_back(std::move(grid.results));
  return results;
}

}  // namespace

std::vector<AddingDoublingTotals> adding_doubling_by_angle(const LayerStack& stack,
                                                           std::span<const Incidence> incidences,
                                                           const AddingDoublingOptions& options) {
  for (const Incidence& incidence : incidences) detail::require_incidence(incidence);
  check(options);
  const LayerStack* const alone = &stack;
  return solve_group({&alone, 1}, incidences, options).front();
}

AddingDoublingTotals adding_doubling_on_grid(const LayerStack& stack, Incidence incidence,
                                             int nodes) {
  detail::require_incidence(incidence);
  const GridStack on_grid =
      detail::make_grid_stack(stack, nodes, detail::beams_of(stack, {&incidence, 1}));
  AddingDoublingTotals result =
      totals_on_grid(on_grid, {&incidence, 1}, detail::rough_boundaries(on_grid, 0, 1).front())
          .front();
  result.nodes = nodes;
  result.estimated_error = 1.0;
  return result;
}

AddingDoublingTotals adding_doubling(const LayerStack& stack, Incidence incidence,
                                     const AddingDoublingOptions& options) {
  return adding_doubling_by_angle(stack, {&incidence, 1}, options).front();
}

std::vector<AddingDoublingTotals> adding_doubling(std::span<const LayerStack> bands,
                                                  Incidence incidence,
                                                  const AddingDoublingOptions& options) {
  detail::require_incidence(incidence);
  check(options);
  std::vector<AddingDoublingTotals> results(bands.size());
  const auto groups = detail::groups_of_equal_boundaries(bands);
  parallel_for(groups.size(), [&](std::size_t g) {
    std::vector<const LayerStack*> stacks;
    for (const std::size_t band : groups[g]) stacks.push_back(&bands[band]);
    const auto solved = solve_group(stacks, {&incidence, 1}, options);
    for (std::size_t k = 0; k < stacks.size(); ++k) results[groups[g][k]] = solved[k].front();
  });
  return results;
}

}  // namespace lamina
