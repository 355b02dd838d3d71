// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/low_orders/diffuse_single_scattering.h"
#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/low_orders/unscattered_paths.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_response.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"
#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_cost.h"
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_photons.h"

namespace lamina::detail {
namespace {

using Curves = ProfileCurves;

// Refined from step to step: tools/tables/profile_validation.
constexpr std::array<int, 8> node_steps = {4, 6, 8, 11, 15, 20, 27, 36};
constexpr std::array<int, 8> frequency_steps = {20, 24, 28, 33, 40, 48, 58, 70};
constexpr int fewest_modes = 3, most_modes = 8;

/// Steps of nodes, and modes, beyond which errors in the mean are left as they are: those of light
/// that passes thin sheets and hardly moves aside, which pictures do not show:
/// test TransferProfileInTheMean.IsWithinItsAccuracyOfFinerProfiles.
constexpr std::size_t node_steps_in_the_mean = 4;
constexpr int most_modes_in_the_mean = 5;

/// Photons refine what waves leave wrong by more than this, of the accuracy asked:
/// test TransferProfile.PhotonsSeeTheRingsOfClearPlates.
constexpr double too_much = 2.0;
/// The same in the mean: by rings of light out of clear plates.
constexpr double too_much_in_the_mean = 10.0;

/// Most nodes while modes are chosen.
constexpr std::size_t probe_node_step = 2;

/// Error left after a step, as a part of its change: with more modes or frequencies changes fall to
/// a fourth or less from step to step, with more nodes to a third unless the forward peak that they
/// miss falls slower. Witnesses: tests TransferProfile*, tools/tables/profile_validation.
constexpr double left_of_step = 0.3, left_of_node_step = 0.4;

/// Changes by more nodes and by more modes are added up; what that misses is at most this times the
/// product of the two, relative to the profile (18 seen on those stacks):
/// test TransferProfileError.OfHalfSpacesStaysSmall.
constexpr double product_of_changes = 20.0;

/// Where the spectra are ended for a look at what their tails are worth, of the highest frequency;
/// and how much of the change counts as error. Photons, at 240 radii of thin slabs with g of .7 to
/// .9: errors of 1 to 60 % are .2 to 1 of the estimate:
/// test TransferProfileError.ThatOfTransmissionThroughAThinSlabIsSmall.
constexpr double earlier_end = 0.7, left_of_tail = 0.5;

/// Extinctions that differ by less than this part weaken light alike.
constexpr double same_extinction = 1e-6;

/// Straight rays of diffuse light where errors count in the mean. Against the usual ones, of skin,
/// jade, marble, leaf and snow, half-spaces and slabs: R within .1 %, T within .4 %; of snow of
/// .14 mm, almost clear, .5 and 2 %. A third of the time.
constexpr StraightLight straight_in_the_mean{
    .nodes = 12, .modes = 21, .frequencies = 32, .depth_nodes = 4};

/// Nodes of a second look at straight rays under a rough top, where the first has 24.
constexpr int fewer_nodes_of_rays = 17;

/// Modes, and nodes where frequencies do not suffice, are given up if a step changes no less than
/// this of what the last one did.
constexpr double no_progress = 0.9;

/// The fraction of the accuracy asked that each may use, if the others use all of theirs.
constexpr double frequency_share = 0.15, node_share = 0.5, mode_share = 0.35;

/// Rings of equal width in log r that hold less than this of the fullest ring's flux do not count.
constexpr double least_ring = 1e-4;

/// Where photons can take over, waves are given up beyond this time in all [CPU-s], as the cost of
/// a solution is foreseen.
constexpr double most_seconds_of_waves = 0.7;

struct Resolution {
  std::size_t node_step = 0;
  int modes = fewest_modes;
  std::size_t frequency_step = 0;

  friend auto operator<=>(const Resolution&, const Resolution&) = default;
};

struct Solution {
  Curves curves;
  Spectrum reflected, transmitted;  ///< without the lowest orders
};

class BandSolver {
 public:
  BandSolver(const LayerStack& stack, const HankelPlan& plan, const TransferProfileOptions& options)
      : stack_(stack),
        plan_(plan),
        options_(options),
        progress_(of_unknown_length(options.progress)),
        most_node_steps_(options.error == ProfileError::mean ? node_steps_in_the_mean
                                                             : node_steps.size()),
        most_modes_(options.error == ProfileError::mean ? most_modes_in_the_mean : most_modes),
        is_diffuse_(options.illumination == Illumination::diffuse),
        is_spread_(is_diffuse_ || has_rough_top(make_grid_stack(stack, node_steps[0], {}))),
        has_photons_(can_refine_by_photons(stack)) {}

  BandProfile solve(const FrequencyResponse& flux);

 private:
  [[nodiscard]] const Curves& lowest_curves(std::size_t node_step);
  [[nodiscard]] const Curves& all(const Resolution& resolution) {
    return solution(resolution).curves;
  }
  [[nodiscard]] const Solution& solution(const Resolution& resolution);
  [[nodiscard]] Curves over_radius(std::size_t node_step, const Spectrum& reflected,
                                   const Spectrum& transmitted);
  [[nodiscard]] Curves with_fewer_frequencies(const Resolution& resolution);
  void add_error_of_tail(const Resolution& resolution, Curves& error);
  void add_error_of_straight_rays(std::size_t node_step, Curves& error);
  [[nodiscard]] Curves finest(const Resolution& chosen, const Resolution& probe, Curves& error);
  [[nodiscard]] double largest(const std::vector<double>& error,
                               const std::vector<double>& value) const;
  [[nodiscard]] double mean(const std::vector<double>& error,
                            const std::vector<double>& value) const;

  /// The error that the accuracy is asked of, of the worse side.
  [[nodiscard]] double asked_error(const Curves& error, const Curves& value) const;

  /// Refines in one dimension until the largest error left is within `bound`, which is returned
  /// or what is reached, or until a step changes more than `give_up` of what the last one did. The
  /// error left is added to `error`.
  ///
  /// @param before  (resolution before, and after a step) the curves that the step changes
  template <class StepUp, class Before, class Left>
  double refine(Resolution& resolution, double bound, Curves& error, double give_up,
                const StepUp& step_up, const Before& before, const Left& left_of);

  [[nodiscard]] std::vector<double> left_after(const std::vector<double>& change,
                                               const std::vector<double>& before,
                                               double share) const;

  /// By what part extinctions differ from those of one step of nodes fewer, the most of all layers.
  [[nodiscard]] double extinction_change(std::size_t node_step) const;

  /// Scattering by the forward peak that the nodes do not see, the largest of all layers [1/mm].
  [[nodiscard]] double unseen_peak(std::size_t node_step) const;

  /// Whether there is time to solve once more; if so it counts as spent.
  [[nodiscard]] bool has_time_for(const Resolution& resolution);
  void refine_by_photons(const Resolution& chosen, BandProfile& result);
  [[nodiscard]] Curves difference(const Curves& fine, const Curves& coarse, double share) const;

  const LayerStack& stack_;
  const HankelPlan& plan_;
  const TransferProfileOptions& options_;
  Progress progress_;
  std::size_t most_node_steps_;
  int most_modes_;
  bool is_diffuse_;
  bool is_spread_;  ///< over directions inside, by a rough top if not diffuse before
  bool has_photons_;
  FrequencyResponse flux_;              ///< what the profile adds up to
  double seconds_ = 0.0;                ///< of waves, foreseen
  std::vector<ProfileCurves> changes_;  ///< by the last step of each refinement, what is left of it
  double budget_ = 0.0;                 ///< of the accuracy asked, for nodes, modes and frequencies
  std::map<std::size_t, Curves> lowest_curves_;  ///< [node step]
  std::map<Resolution, Solution> all_;
};

/// Light scattered once and, if diffuse, not at all: exactly. It depends on the nodes by their
/// extinction only.
const Curves& BandSolver::lowest_curves(std::size_t node_step) {
  const auto [place, is_new] = lowest_curves_.try_emplace(node_step);
  if (!is_new) return place->second;
  const std::vector<GridDirection> beams{direction_in(stack_.ior_above(), 0.0)};
  GridStack on_grid = above_rough_inside(make_grid_stack(stack_, node_steps[node_step], beams));
  if (node_step > 0 && lowest_curves_.contains(node_step - 1) &&
      extinction_change(node_step) < same_extinction)
    return place->second = lowest_curves_.at(node_step - 1);
  if (is_spread_)
    return place->second = diffuse_lowest_orders(stack_, on_grid, options_.illumination, plan_,
                                                 is_diffuse_ && options_.error == ProfileError::mean
                                                     ? straight_in_the_mean
                                                     : StraightLight{});
  const OnceScattered light = make_once_scattered(stack_, std::move(on_grid));
  const std::size_t radii = plan_.r.size();
  const SingleScatteringTotals totals = single_scattering_totals(light);
  Curves curves{std::vector<double>(radii), std::vector<double>(radii), totals.reflectance,
                totals.transmittance};
  const auto solve_at = [&](std::size_t i) {
    const SingleScatteringProfile at = single_scattering_profile(light, plan_.r[i]);
    curves.reflectance[i] = at.reflectance;
    curves.transmittance[i] = at.transmittance;
  };
  parallel_for(radii, solve_at, progress_);
  return place->second = std::move(curves);
}

const Solution& BandSolver::solution(const Resolution& resolution) {
  const auto [place, is_new] = all_.try_emplace(resolution);
  if (!is_new) return place->second;
  const FrequencySolver solver = make_frequency_solver(stack_, node_steps[resolution.node_step],
                                                       resolution.modes, {}, options_.illumination);
  // Light that has met facets inside is of no low order.
  std::optional<FrequencySolver> upper;
  if (has_rough_inside(solver.stack)) {
    upper = solver;
    upper->stack = above_rough_inside(solver.stack);
  }
  const FrequencySolver& lowest = upper ? *upper : solver;
  const double at_the_axis = is_spread_ ? 0.0 : through_rough_bottom(solver, Unscattered::on_grid);
  const FrequencyGrid grid =
      make_frequency_grid(solver.stack, frequency_steps[resolution.frequency_step],
                          beam_frequencies_per_sigma_t(solver.stack));
  const std::size_t frequencies = grid.k.size();
  std::vector<UnscatteredPath> paths;
  if (is_spread_) paths = unscattered_paths(lowest.stack);
  std::vector<double> reflected(frequencies), transmitted(frequencies);
  // Neighbours share the lanes of the processor; the same ones, however many threads there are.
  const auto lanes = slabs_at_once();
  const auto respond = [&](std::size_t group) {
    const std::size_t first = group * lanes, count = std::min(lanes, frequencies - first);
    const auto at = std::span(grid.k).subspan(first, count);
    const auto every = is_diffuse_ ? diffuse_responses(solver, at) : responses(solver, at);
    for (std::size_t i = first; i < first + count; ++i) {
      const double k = grid.k[i];
      const FrequencyResponse once =
          is_spread_ ? diffuse_single_on_grid(lowest, k) : single_scattering_response(lowest, k);
      FrequencyResponse unscattered;
      if (is_spread_) unscattered = unscattered_response(lowest, paths, k);
      reflected[i] = every[i - first].reflectance - once.reflectance - unscattered.reflectance;
      transmitted[i] = every[i - first].transmittance - once.transmittance -
                       unscattered.transmittance - at_the_axis;
    }
  };
  parallel_for((frequencies + lanes - 1) / lanes, respond, progress_);
  Solution& made = place->second;
  made.reflected = make_spectrum(grid, reflected);
  made.transmitted = make_spectrum(grid, transmitted);
  made.curves = over_radius(resolution.node_step, made.reflected, made.transmitted);
  return made;
}

Curves BandSolver::over_radius(std::size_t node_step, const Spectrum& reflected,
                               const Spectrum& transmitted) {
  const bool transmits = !is_semi_infinite(stack_);
  std::vector<double> spectra;
  for (const double k : plan_.k) {
    spectra.push_back(evaluate(reflected, k));
    spectra.push_back(transmits ? evaluate(transmitted, k) : 0.0);
  }
  const std::vector<double> multiple = inverse_hankel(plan_, spectra, 2);
  Curves curves = lowest_curves(node_step);
  for (std::size_t i = 0; i < plan_.r.size(); ++i) {
    curves.reflectance[i] += multiple[2 * i];
    curves.transmittance[i] += multiple[2 * i + 1];
  }
  curves.total_reflectance += evaluate(reflected, 0.0);
  if (transmits) curves.total_transmittance += evaluate(transmitted, 0.0);
  return curves;
}

/// What one step fewer frequencies give. If they were not solved, the spectrum of the others stands
/// in for it: how much is lost between fewer of them is the same.
Curves BandSolver::with_fewer_frequencies(const Resolution& resolution) {
  Resolution fewer = resolution;
  --fewer.frequency_step;
  if (all_.contains(fewer)) return all(fewer);
  const Solution& known = solution(resolution);
  const int count = frequency_steps[fewer.frequency_step];
  return over_radius(resolution.node_step, resampled(known.reflected, count),
                     resampled(known.transmitted, count));
}

/// How wrong the law is by which spectra go on beyond the highest frequency: what changes where it
/// begins earlier. Both ring, with periods of their own, so that they agree here and there: the
/// largest change within half a period counts.
void BandSolver::add_error_of_tail(const Resolution& resolution, Curves& error) {
  const Solution& known = solution(resolution);
  const Curves earlier = over_radius(resolution.node_step, ended_at(known.reflected, earlier_end),
                                     ended_at(known.transmitted, earlier_end));
  const double half_period = std::numbers::pi / (earlier_end * known.reflected.grid.highest);
  const std::vector<double>& r = plan_.r;
  const auto add = [&](auto side) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double reach = std::min(half_period, r[i] / 3.0);  // near the axis nothing rings yet
      while (r[first] < r[i] - reach) ++first;
      double most = 0.0;
      for (std::size_t j = first; j < r.size() && r[j] <= r[i] + reach; ++j)
        most = std::max(most, std::abs((known.curves.*side)[j] - (earlier.*side)[j]));
      (error.*side)[i] += left_of_tail * most;
    }
  };
  add(&Curves::reflectance);
  add(&Curves::transmittance);
}

/// Of a beam that a rough top spreads: the nodes show less of its lobe than of diffuse light.
void BandSolver::add_error_of_straight_rays(std::size_t node_step, Curves& error) {
  if (is_diffuse_ || !is_spread_) return;
  const FrequencySolver solver = make_frequency_solver(
      stack_, node_steps[node_step], fewest_modes, {}, options_.illumination, RoughModes::first);
  const Curves fewer =
      diffuse_lowest_orders(stack_, above_rough_inside(solver.stack), options_.illumination, plan_,
                            {.nodes = fewer_nodes_of_rays});
  const Curves& known = lowest_curves(node_step);
  const auto add = [](const std::vector<double>& a, const std::vector<double>& b,
                      std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += std::abs(a[i] - b[i]);
  };
  add(known.reflectance, fewer.reflectance, error.reflectance);
  add(known.transmittance, fewer.transmittance, error.transmittance);
}

/// Largest relative error where it counts, within the radii asked.
double BandSolver::largest(const std::vector<double>& error,
                           const std::vector<double>& value) const {
  const std::vector<double>& r = plan_.r;
  double fullest = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) fullest = std::max(fullest, r[i] * r[i] * value[i]);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const bool counts = options_.r_lowest <= r[i] && r[i] <= options_.r_highest &&
                        r[i] * r[i] * value[i] > least_ring * fullest;
    if (counts) worst = std::max(worst, error[i] / value[i]);
  }
  return worst;
}

bool BandSolver::has_time_for(const Resolution& resolution) {
  if (!has_photons_ || all_.contains(resolution)) return true;
  const double cost = solution_cost({&stack_, 1}, node_steps[resolution.node_step],
                                    resolution.modes, frequency_steps[resolution.frequency_step])
                          .seconds;
  if (seconds_ + cost > most_seconds_of_waves) return false;
  seconds_ += cost;
  return true;
}

/// Relative error, weighted by the flux of rings.
double BandSolver::mean(const std::vector<double>& error, const std::vector<double>& value) const {
  double wrong = 0.0, all = 0.0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double area = plan_.r[i] * plan_.r[i];
    wrong += area * error[i];
    all += area * std::max(0.0, value[i]);
  }
  return all > 0.0 ? wrong / all : 0.0;
}

double BandSolver::asked_error(const Curves& error, const Curves& value) const {
  if (options_.error == ProfileError::largest)
    return std::max(largest(error.reflectance, value.reflectance),
                    largest(error.transmittance, value.transmittance));
  double wrong = 0.0, all = 0.0;
  for (std::size_t i = 0; i < plan_.r.size(); ++i) {
    const double area = plan_.r[i] * plan_.r[i];
    wrong += area * (error.reflectance[i] + error.transmittance[i]);
    all += area * (std::max(0.0, value.reflectance[i]) + std::max(0.0, value.transmittance[i]));
  }
  return all > 0.0 ? wrong / all : 0.0;
}

double BandSolver::extinction_change(std::size_t node_step) const {
  const auto few = make_grid_stack(stack_, node_steps[node_step - 1], {}).layers;
  const auto many = make_grid_stack(stack_, node_steps[node_step], {}).layers;
  double most = 0.0;
  for (std::size_t l = 0; l < many.size(); ++l)
    if (many[l].extinction > 0.0)
      most = std::max(most, std::abs(many[l].sigma_t - few[l].sigma_t) / many[l].extinction);
  return most;
}

double BandSolver::unseen_peak(std::size_t node_step) const {
  double most = 0.0;
  for (const GridLayer& layer : make_grid_stack(stack_, node_steps[node_step], {}).layers)
    most = std::max(most, layer.extinction - layer.sigma_t);
  return most;
}

/// The error left after a step that changed this much, over all radii: `share` of it, or half as
/// much again as the next step would change if this one, within a third of a decade, is over half
/// the last one. So it is where rays of discrete directions stand out: they change sign from step
/// to step (photons, through a thin matched slab: within 30 %).
std::vector<double> BandSolver::left_after(const std::vector<double>& change,
                                           const std::vector<double>& before, double share) const {
  std::vector<double> left(change.size());
  const auto nearby = [&](const std::vector<double>& values, std::size_t i) {
    double most = 0.0;
    for (std::size_t j = i; j > 0 && plan_.r[j - 1] > plan_.r[i] / 1.5; --j)
      most = std::max(most, values[j - 1]);
    for (std::size_t j = i; j < values.size() && plan_.r[j] < plan_.r[i] * 1.5; ++j)
      most = std::max(most, values[j]);
    return most;
  };
  for (std::size_t i = 0; i < change.size(); ++i) {
    const double last = before.empty() ? 0.0 : nearby(before, i);
    const double ratio = last > 0.0 ? std::min(nearby(change, i) / last, 1.0) : 0.0;
    left[i] = change[i] * (ratio > 0.5 ? std::max(share, 1.5 * ratio) : share);
  }
  return left;
}

template <class StepUp, class Before, class Left>
double BandSolver::refine(Resolution& resolution, double bound, Curves& error, double give_up,
                          const StepUp& step_up, const Before& before, const Left& left_of) {
  const std::size_t radii = plan_.r.size();
  Curves left{std::vector<double>(radii), std::vector<double>(radii)};
  Curves before_it;      ///< of nodes alone, whose errors stand out as rays
  Curves signed_change;  ///< what is left of it
  double worst = 0.0, worst_change = std::numeric_limits<double>::infinity();
  while (true) {
    const Resolution last = resolution;
    if (!step_up(resolution)) break;
    const bool knows_a_step = !signed_change.reflectance.empty();
    if (!has_time_for(resolution) && knows_a_step) {
      resolution = last;
      break;
    }
    const Curves& fine = all(resolution);
    const Curves coarse = before(last, resolution);
    Curves change{std::vector<double>(radii), std::vector<double>(radii)};
    for (std::size_t i = 0; i < radii; ++i) {
      change.reflectance[i] = std::abs(fine.reflectance[i] - coarse.reflectance[i]);
      change.transmittance[i] = std::abs(fine.transmittance[i] - coarse.transmittance[i]);
    }
    const double share = left_of(resolution);
    signed_change = difference(fine, coarse, share);
    left.reflectance = left_after(change.reflectance, before_it.reflectance, share);
    left.transmittance = left_after(change.transmittance, before_it.transmittance, share);
    worst = asked_error(left, fine);
    const double most = asked_error(change, fine);
    if (worst <= bound || most > give_up * worst_change) break;
    worst_change = most;
    if (last.node_step != resolution.node_step) before_it = std::move(change);
  }
  for (std::size_t i = 0; i < radii; ++i) {
    error.reflectance[i] += left.reflectance[i];
    error.transmittance[i] += left.transmittance[i];
  }
  if (!signed_change.reflectance.empty()) changes_.push_back(std::move(signed_change));
  return worst;
}

/// With the nodes of `chosen` and the modes of `probe`, which has fewer nodes. As the two hardly
/// depend on one another their changes are added to what few of both give, if the error of that,
/// which goes into `error`, leaves the accuracy asked; else all is solved once more.
Curves BandSolver::finest(const Resolution& chosen, const Resolution& probe, Curves& error) {
  Resolution few = probe, nodes = chosen;
  few.modes = nodes.modes = fewest_modes;
  Curves sum = all(nodes), sum_error = error;
  const Curves &start = all(few), &more_modes = all(probe);
  const auto add = [](std::vector<double>& to, std::vector<double>& to_error,
                      const std::vector<double>& from, const std::vector<double>& modes) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      const double by_nodes = to[i] - from[i], by_modes = modes[i] - from[i];
      to[i] += by_modes;
      if (to[i] > 0.0) to_error[i] += product_of_changes * std::abs(by_nodes * by_modes) / to[i];
    }
  };
  add(sum.reflectance, sum_error.reflectance, start.reflectance, more_modes.reflectance);
  add(sum.transmittance, sum_error.transmittance, start.transmittance, more_modes.transmittance);
  sum.total_reflectance += more_modes.total_reflectance - start.total_reflectance;
  sum.total_transmittance += more_modes.total_transmittance - start.total_transmittance;
  const bool is_too_rough = asked_error(sum_error, sum) > budget_;
  if (is_too_rough && has_time_for(chosen)) return all(chosen);
  error = std::move(sum_error);
  return sum;
}

/// The curve times what makes it add up to `flux`; the distance of that factor from 1 is one more
/// error.
void conserve(double flux, double total, std::vector<double>& curve, std::vector<double>& error) {
  if (!(flux > 0.0 && total > 0.0)) return;
  const double factor = flux / total;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    error[i] += std::abs((factor - 1.0) * curve[i]) * std::max(1.0, factor);
    curve[i] *= factor;
  }
}

/// What a step changed, times a share of it, where both curves are made to add up to what is known.
Curves BandSolver::difference(const Curves& fine, const Curves& coarse, double share) const {
  const auto between = [&](const std::vector<double>& a, double total_a,
                           const std::vector<double>& b, double total_b, double flux) {
    const bool has_flux = flux > 0.0 && total_a > 0.0 && total_b > 0.0;
    const double of_a = has_flux ? flux / total_a : 1.0, of_b = has_flux ? flux / total_b : 1.0;
    std::vector<double> change(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) change[i] = share * (of_a * a[i] - of_b * b[i]);
    return change;
  };
  return {between(fine.reflectance, fine.total_reflectance, coarse.reflectance,
                  coarse.total_reflectance, flux_.reflectance),
          between(fine.transmittance, fine.total_transmittance, coarse.transmittance,
                  coarse.total_transmittance, flux_.transmittance)};
}

void BandSolver::refine_by_photons(const Resolution& chosen, BandProfile& result) {
  const Resolution few_modes{chosen.node_step, fewest_modes, chosen.frequency_step};
  const Solution& known = solution(few_modes);
  changes_.push_back(
      difference(known.curves,
                 over_radius(chosen.node_step, ended_at(known.reflected, earlier_end),
                             ended_at(known.transmitted, earlier_end)),
                 left_of_tail));
  PhotonRefinement refined = detail::refine_by_photons(
      stack_, {.is_diffuse = is_diffuse_}, plan_,
      {result.profile, result.error, changes_, known.reflected.grid.highest},
      detail::lowest_orders(stack_, options_.illumination, plan_),
      events_for(stack_, options_.accuracy), progress_);
  result.profile = std::move(refined.profile);
  result.error = std::move(refined.error);
  result.photons = refined.photons;
}

BandProfile BandSolver::solve(const FrequencyResponse& flux) {
  const std::size_t radii = plan_.r.size();
  flux_ = flux;
  BandProfile result;
  result.error = {std::vector<double>(radii), std::vector<double>(radii)};
  Resolution at;
  const auto solved = [&](const Resolution& last, const Resolution&) { return all(last); };
  const auto as_measured = [](const Resolution&) { return left_of_step; };
  const double asked = options_.accuracy;
  constexpr double never = std::numeric_limits<double>::infinity();
  const double of_frequencies = refine(
      at, frequency_share * asked, result.error, never,
      [](Resolution& up) { return ++up.frequency_step < frequency_steps.size(); },
      [&](const Resolution&, const Resolution& up) { return with_fewer_frequencies(up); },
      as_measured);
  at.frequency_step = std::min(at.frequency_step, frequency_steps.size() - 1);
  // The tail's error no step makes smaller: nodes and modes may use what it leaves, if that is
  // half.
  Curves tail{std::vector<double>(radii), std::vector<double>(radii)};
  add_error_of_tail(at, tail);
  budget_ = std::max(asked - asked_error(tail, all(at)), 0.5 * asked);
  double left = budget_ - of_frequencies;  // for what is still to be chosen
  left -= refine(
      at, std::max(left - mode_share * budget_, node_share * budget_), result.error,
      of_frequencies < asked ? never : no_progress,
      [&](Resolution& up) { return ++up.node_step < most_node_steps_; }, solved,
      [&](const Resolution& up) {
        const double before = unseen_peak(up.node_step - 1);
        const double ratio = before > 0.0 ? std::min(unseen_peak(up.node_step) / before, 0.9) : 0.0;
        return std::max(left_of_node_step, ratio / (1.0 - ratio));
      });
  at.node_step = std::min(at.node_step, most_node_steps_ - 1);
  Resolution chosen = at;
  at.node_step = std::min(at.node_step - 1, probe_node_step);
  refine(
      at, std::max(left, mode_share * budget_), result.error, no_progress,
      [&](Resolution& up) { return ++up.modes <= most_modes_; }, solved, as_measured);
  chosen.modes = at.modes = std::min(at.modes, most_modes_);

  result.profile = finest(chosen, at, result.error);
  add_error_of_tail({chosen.node_step, fewest_modes, chosen.frequency_step}, result.error);
  add_error_of_straight_rays(chosen.node_step, result.error);
  conserve(flux.reflectance, result.profile.total_reflectance, result.profile.reflectance,
           result.error.reflectance);
  conserve(flux.transmittance, result.profile.total_transmittance, result.profile.transmittance,
           result.error.transmittance);
  const auto estimate = [&] { return asked_error(result.error, result.profile); };
  result.estimated_error = estimate();
  const bool is_mean = options_.error == ProfileError::mean;
  if (has_photons_ &&
      result.estimated_error > (is_mean ? too_much_in_the_mean : too_much) * asked) {
    refine_by_photons(chosen, result);
    result.estimated_error = estimate();
  }
  for (double& value : result.profile.reflectance) value = std::max(0.0, value);
  for (double& value : result.profile.transmittance) value = std::max(0.0, value);
  result.mean_error = std::max(mean(result.error.reflectance, result.profile.reflectance),
                               mean(result.error.transmittance, result.profile.transmittance));
  result.nodes = node_steps[chosen.node_step];
  result.modes = chosen.modes;
  result.frequencies = frequency_steps[chosen.frequency_step];
  return result;
}

}  // namespace

BandProfile solve_band(const LayerStack& stack, const HankelPlan& plan,
                       const TransferProfileOptions& options, const FrequencyResponse& flux) {
  return BandSolver(stack, plan, options).solve(flux);
}

}  // namespace lamina::detail
