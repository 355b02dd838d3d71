// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/exact_profile.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "lamina/core/error.h"
#include "lamina/core/parallel.h"
#include "lamina/scattering/adding_doubling.h"
#include "lamina/scattering/exact_profile_cost.h"
#include "lamina/scattering/exact_profile_diffuse.h"
#include "lamina/scattering/exact_profile_diffuse_curves.h"
#include "lamina/scattering/exact_profile_frequency.h"
#include "lamina/scattering/exact_profile_single.h"
#include "lamina/scattering/exact_profile_spectrum.h"
#include "lamina/scattering/exact_profile_unscattered.h"

namespace lamina {
namespace {

constexpr int fewest_nodes = 5, most_nodes = 14, node_step = 3;
constexpr int fewest_modes = 3, most_modes = 11;

/// With two modes more the error falls to 0.29 of itself or less (measured over the table of
/// stacks), so this share of the last step is still to come. What remains then is a fourth or less
/// of that step for all stacks tried.
constexpr double step_to_come = 0.4;
constexpr double error_per_step = 0.4;

/// Rings of equal width in log r that hold less than this of the fullest ring's flux do not count.
constexpr double least_ring = 1e-4;

using Curves = detail::ProfileCurves;

detail::FrequencyResponse response(const detail::FrequencySolver& solver, double k,
                                   Illumination illumination) {
  return illumination == Illumination::diffuse ? detail::diffuse_response(solver, k)
                                               : detail::response(solver, k);
}

/// Nodes of a band's first segment, and what more of them would change.
struct NodeChoice {
  int nodes = fewest_nodes;
  double error = 0.0;  ///< relative, 0 unless there should be more
};

/// Directions that a band needs: more of them change nothing at low and middling frequencies.
NodeChoice enough_nodes(const LayerStack& stack, const ExactProfileOptions& options) {
  const double accuracy = 0.5 * options.accuracy;
  const auto sample = [&](int nodes) {
    const auto solver = detail::make_frequency_solver(stack, nodes, 1);
    const double highest = detail::make_frequency_grid(solver.stack, 1).highest;
    std::vector<double> values;
    for (const double share : {0.0, 0.02, 0.2}) {
      const auto all = response(solver, share * highest, options.illumination);
      values.push_back(all.reflectance);
      if (!solver.stack.is_semi_infinite && share < 0.1) values.push_back(all.transmittance);
    }
    return values;
  };
  std::vector<double> coarse = sample(fewest_nodes);
  double worst = 0.0;
  for (int nodes = fewest_nodes; nodes < most_nodes; nodes += node_step) {
    const std::vector<double> fine = sample(nodes + node_step);
    worst = 0.0;
    for (std::size_t i = 0; i < fine.size(); ++i)
      worst = std::max(worst, std::abs(fine[i] - coarse[i]) / std::max(std::abs(fine[i]), 1e-6));
    if (worst <= accuracy) return {.nodes = nodes};
    coarse = fine;
  }
  return {.nodes = most_nodes, .error = worst};
}

/// A normal beam's light scattered once.
Curves lowest_orders_of_beam(const LayerStack& stack, const detail::GridStack& on_grid,
                             const HankelPlan& plan) {
  Curves curves;
  for (const double radius : plan.r) {
    const auto once = detail::single_scattering_profile(stack, on_grid, radius);
    curves.reflectance.push_back(once.reflectance);
    curves.transmittance.push_back(once.transmittance);
  }
  return curves;
}

/// A band to be solved.
struct Band {
  const LayerStack* stack = nullptr;
  int nodes = fewest_nodes;
  Curves lowest_orders;  ///< what is not solved over frequency with all others
};

Band make_band(const LayerStack& stack, int nodes, const HankelPlan& plan,
               Illumination illumination) {
  const auto on_grid = detail::make_frequency_solver(stack, nodes, 1).stack;
  return {&stack, nodes,
          illumination == Illumination::diffuse
              ? detail::diffuse_lowest_orders(stack, on_grid, plan)
              : lowest_orders_of_beam(stack, on_grid, plan)};
}

/// Profiles of some bands, each with its own number of nodes.
std::vector<Curves> solve(std::span<const Band* const> bands_to_solve, const HankelPlan& plan,
                          int modes, int frequency_count, Illumination illumination) {
  const std::size_t bands = bands_to_solve.size();
  const auto frequencies = static_cast<std::size_t>(frequency_count);
  const bool is_diffuse = illumination == Illumination::diffuse;
  std::vector<detail::FrequencySolver> solvers(bands);
  std::vector<detail::FrequencyGrid> grids(bands);
  std::vector<std::vector<detail::UnscatteredPath>> paths(bands);
  for (std::size_t b = 0; b < bands; ++b) {
    const Band& band = *bands_to_solve[b];
    solvers[b] = detail::make_frequency_solver(*band.stack, band.nodes, modes);
    grids[b] = detail::make_frequency_grid(solvers[b].stack, frequency_count);
    if (is_diffuse) paths[b] = detail::unscattered_paths(solvers[b].stack);
  }
  std::vector<std::vector<double>> reflected(bands, std::vector<double>(frequencies));
  std::vector<std::vector<double>> transmitted = reflected;
  parallel_for(bands * frequencies, [&](std::size_t task) {
    const std::size_t b = task / frequencies, i = task % frequencies;
    const double k = grids[b].k[i];
    const auto all = response(solvers[b], k, illumination);
    auto taken = is_diffuse ? detail::diffuse_single_on_grid(solvers[b], k)
                            : detail::single_scattering_response(solvers[b], k);
    if (is_diffuse) {
      const auto unscattered =
          detail::unscattered_response(solvers[b].stack, paths[b], modes + 1, k);
      taken.reflectance += unscattered.reflectance;
      taken.transmittance += unscattered.transmittance;
    }
    reflected[b][i] = all.reflectance - taken.reflectance;
    transmitted[b][i] = all.transmittance - taken.transmittance;
  });

  std::vector<double> spectra(plan.k.size() * 2 * bands);
  for (std::size_t b = 0; b < bands; ++b) {
    const auto r = detail::make_spectrum(grids[b], reflected[b]);
    const auto t = detail::make_spectrum(grids[b], transmitted[b]);
    for (std::size_t i = 0; i < plan.k.size(); ++i) {
      spectra[(i * bands + b) * 2] = detail::evaluate(r, plan.k[i]);
      spectra[(i * bands + b) * 2 + 1] =
          is_semi_infinite(*bands_to_solve[b]->stack) ? 0.0 : detail::evaluate(t, plan.k[i]);
    }
  }
  const std::vector<double> multiple = inverse_hankel(plan, spectra, 2 * bands);
  std::vector<Curves> curves;
  for (std::size_t b = 0; b < bands; ++b) {
    Curves& all = curves.emplace_back(bands_to_solve[b]->lowest_orders);
    for (std::size_t i = 0; i < plan.r.size(); ++i) {
      all.reflectance[i] += multiple[(i * bands + b) * 2];
      all.transmittance[i] += multiple[(i * bands + b) * 2 + 1];
    }
  }
  return curves;
}

/// Largest relative difference of two curves where they count, within the radii asked.
double largest_difference(const std::vector<double>& r, const std::vector<double>& fine,
                          const std::vector<double>& coarse, const ExactProfileOptions& options) {
  double fullest = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) fullest = std::max(fullest, r[i] * r[i] * fine[i]);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const bool counts = options.r_lowest <= r[i] && r[i] <= options.r_highest &&
                        r[i] * r[i] * fine[i] > least_ring * fullest;
    if (counts) worst = std::max(worst, std::abs(fine[i] - coarse[i]) / fine[i]);
  }
  return worst;
}

void check(std::span<const LayerStack> stacks, const ExactProfileOptions& options) {
  if (!(1e-4 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-4, 0.1], but is " +
                       std::to_string(options.accuracy));
  for (std::size_t b = 0; b < stacks.size(); ++b) {
    const std::string band = "band " + std::to_string(b);
    detail::require_smooth(stacks[b], "the exact profile of " + band);
    const bool scatters = std::any_of(stacks[b].layers().begin(), stacks[b].layers().end(),
                                      [](const Layer& l) { return l.medium.sigma_s > 0.0; });
    if (!scatters) throw InvalidInput(band + ": at least one layer must scatter, but none does");
  }
  detail::require_affordable(detail::solution_cost(stacks, fewest_nodes, fewest_modes + 2, 24));
}

}  // namespace

std::vector<LayerStack> lit_from_below(std::span<const LayerStack> stacks) {
  std::vector<LayerStack> turned;
  for (const LayerStack& stack : stacks) {
    const std::string band = "band " + std::to_string(turned.size());
    if (is_semi_infinite(stack))
      throw InvalidInput(band + ": light from below needs a finite last layer, but it is infinite");
    if (stack.ground().reflectance > 0.0)
      throw InvalidInput(band + ": light from below needs a black ground, but its reflectance is " +
                         std::to_string(stack.ground().reflectance));
    turned.push_back(flipped(stack));
  }
  return turned;
}

ExactProfile exact_profile(std::span<const LayerStack> stacks, const RadialGrid& radii,
                           const ExactProfileOptions& options) {
  check(stacks, options);
  if (options.is_from_below) {
    ExactProfileOptions from_above = options;
    from_above.is_from_below = false;
    return exact_profile(lit_from_below(stacks), radii, from_above);
  }
  const HankelPlan plan = make_hankel_plan(radii);
  const std::size_t bands = stacks.size(), count = plan.r.size();
  ExactProfile result;
  Profile& profile = result.profile;
  profile.per = ProfilePer::arriving_flux;
  profile.bands = bands;
  profile.r = plan.r;
  profile.reflectance_profile.resize(count * bands);
  profile.transmittance_profile.resize(count * bands);
  result.relative_error.assign(count * bands, 0.0);
  result.estimated_error.assign(bands, 0.0);
  result.modes.assign(bands, 0);
  const Incidence incidence{.is_diffuse = options.illumination == Illumination::diffuse};
  for (const auto& totals : adding_doubling(stacks, incidence, {.accuracy = 1e-6})) {
    profile.total_reflectance.push_back(totals.totals.diffuse_reflectance);
    profile.total_transmittance.push_back(totals.totals.transmittance);
  }

  std::vector<std::size_t> unfinished(bands);  // bands still to be refined
  std::iota(unfinished.begin(), unfinished.end(), std::size_t{0});
  const int frequencies = options.accuracy >= 0.004 ? 24 : 36;
  std::vector<NodeChoice> choices(bands);
  std::vector<Band> problems(bands);
  parallel_for(bands, [&](std::size_t b) {
    choices[b] = enough_nodes(stacks[b], options);
    problems[b] = make_band(stacks[b], choices[b].nodes, plan, options.illumination);
  });
  for (const NodeChoice& choice : choices) result.nodes.push_back(choice.nodes);
  std::vector<Curves> coarser;  // of the unfinished bands
  for (int modes = fewest_modes; modes <= most_modes && !unfinished.empty(); modes += 2) {
    std::vector<const Band*> some;
    for (const std::size_t b : unfinished) some.push_back(&problems[b]);
    std::vector<Curves> finer = solve(some, plan, modes, frequencies, options.illumination);
    if (coarser.empty()) {
      coarser = std::move(finer);
      continue;
    }
    std::vector<std::size_t> still;
    std::vector<Curves> still_curves;
    for (std::size_t u = 0; u < unfinished.size(); ++u) {
      const std::size_t b = unfinished[u];
      const Curves &fine = finer[u], &coarse = coarser[u];
      const auto extrapolated = [](double value, double before) {
        return std::max(0.0, value + step_to_come * (value - before));
      };
      for (std::size_t i = 0; i < count; ++i) {
        const double value = extrapolated(fine.reflectance[i], coarse.reflectance[i]);
        profile.reflectance_profile[i * bands + b] = value;
        profile.transmittance_profile[i * bands + b] =
            extrapolated(fine.transmittance[i], coarse.transmittance[i]);
        result.relative_error[i * bands + b] =
            value > 0.0
                ? std::min(1.0, error_per_step *
                                    std::abs(fine.reflectance[i] - coarse.reflectance[i]) / value)
                : 1.0;
      }
      result.modes[b] = modes;
      const double step =
          std::max(largest_difference(plan.r, fine.reflectance, coarse.reflectance, options),
                   largest_difference(plan.r, fine.transmittance, coarse.transmittance, options));
      result.estimated_error[b] = std::max(error_per_step * step, choices[b].error);
      if (error_per_step * step <= options.accuracy) continue;
      still.push_back(b);
      still_curves.push_back(fine);
    }
    unfinished = std::move(still);
    coarser = std::move(still_curves);
  }
  result.is_accurate = std::ranges::all_of(result.estimated_error,
                                           [&](double error) { return error <= options.accuracy; });
  return result;
}

SpatialFrequencyResponse spatial_frequency_response(std::span<const LayerStack> stacks,
                                                    std::span<const double> k,
                                                    const ExactProfileOptions& options) {
  check(stacks, options);
  if (options.is_from_below) {
    ExactProfileOptions from_above = options;
    from_above.is_from_below = false;
    return spatial_frequency_response(lit_from_below(stacks), k, from_above);
  }
  for (const double frequency : k)
    if (!(std::isfinite(frequency) && frequency >= 0.0))
      throw InvalidInput("spatial frequency: must be finite and >= 0 [1/mm], but is " +
                         std::to_string(frequency));
  const std::size_t bands = stacks.size();
  SpatialFrequencyResponse result{.k = {k.begin(), k.end()},
                                  .reflectance = std::vector<double>(k.size() * bands),
                                  .transmittance = std::vector<double>(k.size() * bands)};
  for (std::size_t b = 0; b < bands; ++b) {
    const int nodes = enough_nodes(stacks[b], options).nodes;
    const auto fine = detail::make_frequency_solver(stacks[b], nodes, 7);
    const auto coarse = detail::make_frequency_solver(stacks[b], nodes, 5);
    parallel_for(k.size(), [&](std::size_t i) {
      const auto last = response(fine, k[i], options.illumination);
      const auto before = response(coarse, k[i], options.illumination);
      result.reflectance[i * bands + b] =
          last.reflectance + step_to_come * (last.reflectance - before.reflectance);
      result.transmittance[i * bands + b] =
          last.transmittance + step_to_come * (last.transmittance - before.transmittance);
    });
  }
  return result;
}

}  // namespace lamina
