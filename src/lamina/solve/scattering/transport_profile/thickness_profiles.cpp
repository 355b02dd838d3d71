// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/transport_profile/thickness_profiles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lamina/base/core/parallel.h"
#include "lamina/layers/optics/symmetric_slab.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling.h"
#include "lamina/solve/scattering/low_orders/diffuse_lowest_orders.h"
#include "lamina/solve/scattering/low_orders/diffuse_single_scattering.h"
#include "lamina/solve/scattering/low_orders/single_at_contact.h"
#include "lamina/solve/scattering/low_orders/unscattered_paths.h"
#include "lamina/solve/scattering/spatial_frequency/frequency_spectrum.h"
#include "lamina/solve/scattering/spatial_frequency/slab_family.h"

namespace lamina {
namespace {

using namespace detail;

/// Directions, azimuthal modes and frequencies. Half-spaces and thick slabs ask for fewer
/// directions than thin ones, where light goes on in some: with 5 nodes R of skin and of jade under
/// paint is within .05 %, T of skin within .2 % from 10 mean free paths on:
/// test ThicknessProfiles.AgreeWithSlabsSolvedOneByOne.
constexpr int nodes_of_thin_slabs = 8, nodes_of_thick_ones = 5;
constexpr int modes_of_slabs = 4, frequencies_of_slabs = 24;
constexpr double thick = 10.0;  ///< optical thickness of the inner layer

/// Accuracy of adding-doubling: test ThicknessProfiles.HasTheTotalsOfItsSlabs.
constexpr double totals_accuracy = 1e-4;

/// Straight rays of the lowest orders. Fewer do where they do not reach a far side: R and T of skin
/// and marble within .05 % of those by twice as many, T of wax of a mean free path 5 % wrong with
/// few.
StraightLight straight_light(double contact, bool is_thin) {
  if (is_thin)
    return {.nodes = 12, .modes = 21, .frequencies = 32, .depth_nodes = 4, .contact = contact};
  return {.nodes = 8, .modes = 13, .frequencies = 24, .depth_nodes = 3, .contact = contact};
}

/// Optical thickness of the inner layer below which a body is thin, and from which on light of the
/// lowest orders knows no far side: test ThicknessProfiles.AgreeWithSlabsSolvedOneByOne.
constexpr double thin_for_straight_light = 6.0;
constexpr double opaque_to_straight_light = 10.0;

/// Half-space of one band, and totals of it and its slabs.
struct Family {
  LayerStack half_space;
  std::vector<SlabTotals> totals;  ///< [body], the half-space first
};

SlabTotals diffuse_totals(const LayerStack& stack) {
  return adding_doubling(stack, {.is_diffuse = true}, {.accuracy = totals_accuracy}).totals;
}

/// Body of a family: the half-space or a slab.
struct Body {
  LayerStack stack;
  FrequencySolver solver;
  std::vector<UnscatteredPath> paths;
  double depth = 0.0;                          ///< optical thickness of the inner layer
  std::vector<double> reflected, transmitted;  ///< [frequency] without the lowest orders
};

/// Half-space first, then slabs.
std::vector<Body> make_bodies(const SlabFamily& family, const LayerStack& half_space) {
  std::vector<Body> bodies;
  const auto add = [&](LayerStack stack, FrequencySolver solver, double depth) {
    std::vector<UnscatteredPath> paths = unscattered_paths(solver.stack);
    bodies.push_back({std::move(stack), std::move(solver), std::move(paths), depth, {}, {}});
  };
  add(half_space, family.half_space, std::numeric_limits<double>::infinity());
  for (std::size_t s = 0; s < family.slabs; ++s) {
    const double thickness = family.inner_thickness(s);
    FrequencySolver solver = family.slab;
    GridLayer& inner = solver.stack.layers[family.inner];
    inner.thickness = thickness;
    const double depth = inner.sigma_t * thickness;
    add(slab_with_inner_thickness(half_space, thickness), std::move(solver), depth);
  }
  return bodies;
}

/// Responses of all bodies, without the lowest orders.
void respond(const SlabFamily& family, const FrequencyGrid& grid, std::vector<Body>& bodies,
             const Progress& goes_on) {
  const std::size_t lanes = slabs_at_once();
  for (std::size_t first = 0; first < grid.k.size(); first += lanes) {
    report_or_throw(goes_on, 0.0);
    const auto at = std::span(grid.k).subspan(first, std::min(lanes, grid.k.size() - first));
    const std::vector<FamilyResponse> all = family_responses(family, at);
    for (std::size_t i = 0; i < at.size(); ++i) {
      FrequencyResponse of_half_space;
      for (std::size_t q = 0; q < bodies.size(); ++q) {
        Body& body = bodies[q];
        FrequencyResponse lowest = of_half_space;
        if (q == 0 || body.depth <= opaque_to_straight_light) {
          const FrequencyResponse once = diffuse_single_on_grid(body.solver, at[i]);
          lowest = unscattered_response(body.solver, body.paths, at[i]);
          lowest.reflectance += once.reflectance;
          lowest.transmittance += once.transmittance;
        }
        if (q == 0) of_half_space = lowest;
        const FrequencyResponse& whole = q == 0 ? all[i].half_space : all[i].slabs[q - 1];
        body.reflected.push_back(whole.reflectance - lowest.reflectance);
        body.transmitted.push_back(whole.transmittance - lowest.transmittance);
      }
    }
  }
}

/// Scales a curve so that its total is that of adding-doubling.
void conserve(double flux, double& total, std::vector<double>& curve) {
  if (flux > 0.0 && total > 0.0)
    for (double& value : curve) value = std::max(0.0, value * flux / total);
  total = flux;
}

/// Curves of all bodies of one band.
/// @param thinnest  of the inner layer [mm]
std::vector<ProfileCurves> solve_band(const Family& of_band, double thinnest,
                                      const HankelPlan& plan, const Progress& goes_on) {
  const LayerStack& half_space = of_band.half_space;
  const std::size_t slabs = of_band.totals.size() - 1;
  const Medium& inner = half_space.layers().back().medium;
  const bool is_thick = slabs == 0 || (inner.sigma_s + inner.sigma_a) * thinnest > thick;
  const SlabFamily family =
      make_slab_family(half_space, slab_with_inner_thickness(half_space, thinnest), slabs,
                       is_thick ? nodes_of_thick_ones : nodes_of_thin_slabs, modes_of_slabs);
  std::vector<Body> bodies = make_bodies(family, half_space);
  // From the half-space's slowest decay to the thinnest slab's steepest rings.
  double highest = beam_frequencies_per_sigma_t(family.half_space.stack);
  if (slabs > 0) highest = std::max(highest, beam_frequencies_per_sigma_t(family.slab.stack));
  const FrequencyGrid grid =
      make_frequency_grid(family.half_space.stack, frequencies_of_slabs, highest);
  respond(family, grid, bodies, goes_on);
  const double contact =
      single_at_contact(half_space, family.half_space.stack, family.half_space.top);
  std::vector<ProfileCurves> curves;
  ProfileCurves lowest_of_half_space;
  for (const Body& body : bodies) {
    report_or_throw(goes_on, 0.0);
    ProfileCurves all = lowest_of_half_space;
    if (curves.empty() || body.depth <= opaque_to_straight_light)
      all = diffuse_lowest_orders(body.stack, body.solver.stack, Illumination::diffuse, plan,
                                  straight_light(contact, body.depth < thin_for_straight_light));
    if (curves.empty()) lowest_of_half_space = all;
    const Spectrum reflected = make_spectrum(grid, body.reflected),
                   transmitted = make_spectrum(grid, body.transmitted);
    std::vector<double> spectra;
    for (const double k : plan.k) {
      spectra.push_back(evaluate(reflected, k));
      spectra.push_back(evaluate(transmitted, k));
    }
    const std::vector<double> multiple = inverse_hankel(plan, spectra, 2);
    for (std::size_t i = 0; i < plan.r.size(); ++i) {
      all.reflectance[i] += multiple[2 * i];
      all.transmittance[i] += multiple[2 * i + 1];
    }
    all.total_reflectance += evaluate(reflected, 0.0);
    all.total_transmittance += evaluate(transmitted, 0.0);
    const SlabTotals& totals = of_band.totals[curves.size()];
    conserve(totals.diffuse_reflectance, all.total_reflectance, all.reflectance);
    conserve(totals.transmittance, all.total_transmittance, all.transmittance);
    curves.push_back(std::move(all));
  }
  return curves;
}

}  // namespace

bool takes_thickness_profiles(std::span<const LayerStack> half_spaces) {
  return std::ranges::all_of(half_spaces, [](const LayerStack& stack) {
    return is_semi_infinite(stack) && is_smooth(stack) &&
           std::ranges::all_of(stack.layers(),
                               [](const Layer& layer) { return layer.medium.sigma_s > 0.0; });
  });
}

ThicknessProfiles thickness_profiles(std::span<const LayerStack> half_spaces,
                                     const ThicknessRange& range, const RadialGrid& radii,
                                     const Progress& progress) {
  assert(takes_thickness_profiles(half_spaces));
  const std::size_t bands = half_spaces.size();
  const Progress goes_on = of_unknown_length(progress);
  std::vector<Family> families;
  for (const LayerStack& band : half_spaces) families.push_back({band, {}});
  const auto add_totals = [&](const auto& stack_of) {
    std::vector<SlabTotals> totals(bands);
    parallel_for(bands, [&](std::size_t b) {
      report_or_throw(goes_on, 0.0);
      totals[b] = diffuse_totals(stack_of(families[b].half_space));
    });
    double most = 0.0;  // that is let through of what enters
    for (std::size_t b = 0; b < bands; ++b) {
      families[b].totals.push_back(totals[b]);
      most = std::max(most, totals[b].transmittance / (1.0 - totals[b].specular_reflectance));
    }
    return most;
  };
  ThicknessProfiles result;
  add_totals([](const LayerStack& stack) { return stack; });
  const double outer = 2.0 * thickness_of_upper_layers(half_spaces.front());
  const bool has_slabs = range.thinnest < range.thickest;
  const double thinnest = has_slabs ? range.thinnest - outer : 1.0;  // any, if there are none
  assert(thinnest > 0.0);
  for (double inner = thinnest; has_slabs && outer + inner < range.thickest;
       inner *= std::numbers::sqrt2) {
    const double let_through = add_totals(
        [&](const LayerStack& stack) { return slab_with_inner_thickness(stack, inner); });
    const bool is_opaque = let_through < range.least_transmittance;
    if (is_opaque && result.thickness.empty()) {  // as the half-space
      for (Family& family : families) family.totals.pop_back();
      break;
    }
    result.thickness.push_back(outer + inner);
    if (is_opaque) break;
  }
  const HankelPlan plan = make_hankel_plan(radii);
  const std::size_t count = plan.r.size();
  std::vector<std::vector<ProfileCurves>> solved(bands);
  parallel_for(
      bands, [&](std::size_t b) { solved[b] = solve_band(families[b], thinnest, plan, goes_on); });
  const auto profile_of = [&](std::size_t body) {
    Profile profile{.per = ProfilePer::arriving_flux, .bands = bands, .r = plan.r};
    profile.reflectance_profile.resize(count * bands);
    profile.transmittance_profile.resize(count * bands);
    for (std::size_t b = 0; b < bands; ++b) {
      const ProfileCurves& curves = solved[b][body];
      profile.total_reflectance.push_back(curves.total_reflectance);
      profile.total_transmittance.push_back(body == 0 ? 0.0 : curves.total_transmittance);
      for (std::size_t i = 0; i < count; ++i) {
        profile.reflectance_profile[i * bands + b] = curves.reflectance[i];
        profile.transmittance_profile[i * bands + b] = body == 0 ? 0.0 : curves.transmittance[i];
      }
    }
    return profile;
  };
  result.half_space = profile_of(0);
  for (std::size_t s = 0; s < result.thickness.size(); ++s)
    result.slabs.push_back(profile_of(s + 1));
  return result;
}

}  // namespace lamina
