// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/internal/transfer_profile_photons.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "lamina/solve/scattering/low_orders/single_scattering_profile.h"
#include "lamina/solve/scattering/low_orders/straight_ray.h"
#include "lamina/solve/scattering/low_orders/unscattered_paths.h"
#include "lamina/solve/scattering/monte_carlo/photon_tracing.h"
#include "lamina/solve/scattering/monte_carlo/ring_density.h"
#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"
#include "lamina/solve/scattering/transport_profile/internal/wave_photon_blend.h"

namespace lamina::detail {
namespace {

using std::numbers::pi;

constexpr double ring_width = 0.02;               ///< of photons' rings, in log r
constexpr std::uint64_t first_photons = 1 << 14;  ///< that tell how many events a photon has
constexpr double fewest_photons = 1e4, most_photons = 1e9;
constexpr double events_of_start = 2.0;  ///< that starting a photon and counting it is worth
constexpr int nodes_of_lowest_orders = 24;

/// How often unscattered light of stacks of one, two, more layers is reflected, to be known: its
/// ways multiply.
int known_reflections(const LayerStack& stack) {
  const std::size_t layers = stack.layers().size();
  return layers == 1 ? 15 : layers == 2 ? 7 : 5;
}

/// Above, light scattered once is known, which grows as 1/r near the point where light enters.
/// Behind the stack it is smooth, and photons see all of it.
LowestOrders of_diffuse_light(const LayerStack& stack, const HankelPlan& plan) {
  FrequencySolver solver = make_frequency_solver(stack, nodes_of_lowest_orders, 1);
  LowestOrders lowest;
  lowest.above = {.unscattered = known_reflections(stack), .once = 0};
  for (GridLayer& layer : solver.stack.layers) layer.sigma_t = layer.extinction;
  lowest.curves = diffuse_lowest_orders(stack, solver.stack, Illumination::diffuse, plan,
                                        {.mirrors = known_reflections(stack)});
  std::ranges::fill(lowest.curves.transmittance, 0.0);
  if (!has_open_bottom(solver.stack)) return lowest;
  lowest.below = {.unscattered = known_reflections(stack)};
  const auto paths = unscattered_paths(solver.stack, known_reflections(stack));
  const double half_step = std::sqrt(plan.r[1] / plan.r[0]);
  for (std::size_t i = 0; i < plan.r.size(); ++i)
    lowest.curves.transmittance[i] =
        unscattered_ring(solver, paths, plan.r[i] / half_step, plan.r[i] * half_step).transmittance;
  return lowest;
}

LowestOrders of_normal_beam(const LayerStack& stack, const HankelPlan& plan) {
  const std::vector<GridDirection> beams{direction_in(stack.ior_above(), 0.0)};
  GridStack grid = make_grid_stack(stack, nodes_of_lowest_orders, beams);
  const bool is_black = stack.ground().reflectance == 0.0;
  LowestOrders lowest;
  for (GridLayer& layer : grid.layers) layer.sigma_t = layer.extinction;
  lowest.above = {.unscattered = KnownLight::all, .once = KnownLight::all};
  lowest.below = {.unscattered = KnownLight::all,
                  .once = is_black ? KnownLight::all : KnownLight::none};
  const OnceScattered light = make_once_scattered(stack, std::move(grid));
  for (const double r : plan.r) {
    const SingleScatteringProfile at = single_scattering_profile(light, r);
    lowest.curves.reflectance.push_back(at.reflectance);
    lowest.curves.transmittance.push_back(at.transmittance);
  }
  return lowest;
}

/// Above rough boundaries inside, of a beam: what never meets facets nor is scattered, at r = 0.
/// All else is for photons, but for what a rough bottom lets out there.
LowestOrders over_rough_boundaries(const LayerStack& stack, Illumination illumination,
                                   const HankelPlan& plan) {
  const std::vector<double> none(plan.r.size(), 0.0);
  LowestOrders lowest{.curves = {none, none}};
  if (illumination == Illumination::diffuse) return lowest;
  lowest.above.unscattered = lowest.below.unscattered = KnownLight::all;
  constexpr int modes = 1;
  lowest.below_axis = through_rough_bottom(
      make_frequency_solver(stack, nodes_of_lowest_orders, modes), Unscattered::by_medium);
  return lowest;
}

struct CountedRings {
  RingFlux above, below;
  double photons = 0.0;
};

RingFlux read_rings(const PhotonTallies& tallies, const std::vector<Estimate>& density,
                    const std::vector<Estimate>& beside) {
  RingFlux rings{
      .first_radius = tallies.log_r.low,
      .log_width = std::log(tallies.log_r.high / tallies.log_r.low) / tallies.log_r.count,
      .nearer = beside[0],
      .farther = beside[1]};
  for (std::size_t i = 0; i < density.size(); ++i) {
    const double begin = rings.begin_of(i);
    const double area = pi * begin * begin * std::expm1(2.0 * rings.log_width);
    rings.flux.push_back({density[i].value * area, density[i].standard_error * area});
  }
  return rings;
}

CountedRings count_rings(const LayerStack& stack, const Incidence& incidence,
                         const HankelPlan& plan, const LowestOrders& lowest, double events,
                         const Progress& progress) {
  MonteCarloOptions options{.photons = first_photons, .seed = 1, .incidence = incidence};
  options.progress = progress;
  const double low = std::max(0.5 * plan.r.front(), 1e-9),
               high = std::min(2.0 * plan.r.back(), 1e9);
  options.tallies.log_r = {.count = static_cast<int>(std::ceil(std::log(high / low) / ring_width)),
                           .low = low,
                           .high = high};
  options.tallies.known_above = lowest.above;
  options.tallies.known_below = lowest.below;
  const PhotonCounts first = count_photons(stack, options);
  if (first.was_stopped) throw Interrupted();
  const double each = events_of_start + static_cast<double>(first.events) / first_photons;
  options.photons =
      static_cast<std::uint64_t>(std::clamp(events / each, fewest_photons, most_photons));
  options.seed = 2;
  const PhotonCounts counts = count_photons(stack, options);
  if (counts.was_stopped) throw Interrupted();
  const MonteCarloResult result = summarize(counts);
  return {read_rings(options.tallies, result.log_radial.reflection,
                     result.log_radial_outside.reflection),
          read_rings(options.tallies, result.log_radial.transmission,
                     result.log_radial_outside.transmission),
          static_cast<double>(counts.photons)};
}

}  // namespace

double events_for(const LayerStack& stack, double accuracy) {
  constexpr double usual = 1e8, usual_accuracy = 0.005, fewest = 2e7, most = 1e9;
  constexpr double of_facets = 0.5;  // an event with facets takes several times as long
  return (is_smooth(stack) ? 1.0 : of_facets) *
         std::clamp(usual * std::pow(usual_accuracy / accuracy, 2.0), fewest, most);
}

LowestOrders lowest_orders(const LayerStack& stack, Illumination illumination,
                           const HankelPlan& plan) {
  if (!is_smooth(stack)) return over_rough_boundaries(stack, illumination, plan);
  return illumination == Illumination::diffuse ? of_diffuse_light(stack, plan)
                                               : of_normal_beam(stack, plan);
}

bool can_refine_by_photons(const LayerStack& stack) {
  return stack.layers().front().top.roughness == 0.0;
}

PhotonRefinement refine_by_photons(const LayerStack& stack, const Incidence& incidence,
                                   const HankelPlan& plan, const WaveProfile& waves,
                                   const LowestOrders& lowest, double events,
                                   const Progress& progress) {
  CountedRings counted = count_rings(stack, incidence, plan, lowest, events, progress);
  counted.below.nearer.value -= lowest.below_axis;
  const auto refine_side = [&](std::vector<double> ProfileCurves::*side, const RingFlux& rings) {
    WaveCurve curve{.density = waves.profile.*side,
                    .error = waves.error.*side,
                    .changes = {},
                    .highest = waves.highest};
    for (const ProfileCurves& change : waves.changes) curve.changes.emplace_back(change.*side);
    return blend(plan.r, curve, lowest.curves.*side, lowest.unseen, rings, counted.photons);
  };
  PhotonRefinement refined{.profile = waves.profile, .error = waves.error};
  refined.photons = static_cast<std::uint64_t>(counted.photons);
  BlendedCurve above = refine_side(&ProfileCurves::reflectance, counted.above);
  refined.profile.reflectance = std::move(above.density);
  refined.error.reflectance = std::move(above.error);
  if (is_semi_infinite(stack)) return refined;
  BlendedCurve below = refine_side(&ProfileCurves::transmittance, counted.below);
  refined.profile.transmittance = std::move(below.density);
  refined.error.transmittance = std::move(below.error);
  return refined;
}

}  // namespace lamina::detail
