// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"
#include "lamina/base/core/parallel.h"
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_lobes.h"
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_single.h"

namespace lamina {
namespace {

using detail::GridStack;
using detail::Matrix;

/// One side of the stack: the nodes to look from, and light scattered once towards each of them.
struct Side {
  bool is_above = true;
  double ior = 1.0;
  std::vector<std::size_t> nodes;                             ///< [theta_o]
  std::vector<std::vector<detail::SingleScattering>> single;  ///< [theta_o][layer]
  std::vector<detail::SingleFacet> facet;                     ///< [theta_o]
};

void check_angle(double angle, const std::string& name) {
  if (!(0.0 <= angle && angle < 0.5 * std::numbers::pi))
    throw InvalidInput(name + ": must lie in [0, pi/2), but is " + number_text(angle));
}

/// The grid has the node of the beam first among its extra nodes, then those to look from above,
/// then those from below.
Side make_side(const GridStack& stack, bool is_above, std::size_t count) {
  Side side{.is_above = is_above, .ior = is_above ? stack.ior.front() : stack.ior.back()};
  const std::size_t beam = stack.grid.extra[0];
  const auto arriving = detail::unscattered_from_above(stack, beam);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t node = stack.grid.extra[1 + (is_above ? 0 : count) + k];
    const auto leaving = is_above ? detail::unscattered_from_above(stack, node)
                                  : detail::unscattered_from_below(stack, node);
    side.nodes.push_back(node);
    side.facet.push_back(detail::single_facet(stack, beam, node, is_above));
    auto& layers = side.single.emplace_back();
    for (std::size_t l = 0; l < stack.layers.size(); ++l)
      layers.push_back(
          detail::single_scattering(stack.layers[l], beam, arriving[l], node, leaving[l]));
  }
  return side;
}

/// Azimuthal mode m of the light scattered once towards the k-th angle, as the grid has it: with
/// the cut series of the phase function.
double single_on_grid(const GridStack& stack, const Side& side, std::size_t k, int m) {
  double sum = 0.0;
  for (std::size_t l = 0; l < stack.layers.size(); ++l) {
    const detail::GridLayer& layer = stack.layers[l];
    const detail::SingleScattering& single = side.single[k][l];
    if (layer.sigma_s == 0.0 || (single.same_side == 0.0 && single.opposite_side == 0.0)) continue;
    const detail::PhaseMode phase = detail::phase_mode(
        layer.moments, {layer.cos[stack.grid.extra[0]], layer.cos[side.nodes[k]]}, m);
    sum += layer.sigma_s *
           (single.same_side * phase.forward(0, 1) + single.opposite_side * phase.backward(0, 1));
  }
  return sum;
}

/// The same light with the whole phase function, towards an azimuth.
double single_exact(const LayerStack& layers, const GridStack& stack, const Side& side,
                    std::size_t k, double cos_phi) {
  double sum = 0.0;
  for (std::size_t l = 0; l < stack.layers.size(); ++l) {
    const detail::GridLayer& layer = stack.layers[l];
    const detail::SingleScattering& single = side.single[k][l];
    const double sigma_s = layers.layers()[l].medium.sigma_s;
    if (sigma_s == 0.0 || (single.same_side == 0.0 && single.opposite_side == 0.0)) continue;
    const double cos_i = layer.cos[stack.grid.extra[0]], cos_o = layer.cos[side.nodes[k]];
    const double sines = std::sqrt((1.0 - cos_i * cos_i) * (1.0 - cos_o * cos_o)) * cos_phi;
    const PhaseFunction phase = phase_function(layers.layers()[l]);
    const auto toward = [&](double cos_theta) {
      return 4.0 * std::numbers::pi * evaluate(phase, std::clamp(cos_theta, -1.0, 1.0));
    };
    sum += sigma_s * (single.same_side * toward(cos_i * cos_o + sines) +
                      single.opposite_side * toward(-cos_i * cos_o + sines));
  }
  return sum;
}

/// Radiance per state of an extra node: flux over the square root of etendue, of a unit beam.
double radiance_factor(double ior) {
  return ior * ior / (std::numbers::pi * std::sqrt(extra_node_etendue));
}

/// Angles of light and view [rad].
struct Angles {
  double theta_i;
  std::span<const double> theta_o, phi_o;
};

/// One band on one grid, with the sum over the azimuthal modes so far.
struct BandOnGrid {
  GridStack stack;
  std::vector<Side> sides;  ///< above, and below where light leaves there
  StackBsdf result;
  int most_modes = 1;
  double largest = 0.0;  ///< amplitude of a mode
  int negligible = 0;    ///< last modes

  [[nodiscard]] bool is_done() const { return negligible >= 2 || result.modes >= most_modes; }
  [[nodiscard]] std::vector<double>& values(const Side& side) {
    return side.is_above ? result.brdf : result.btdf;
  }
};

BandOnGrid put_on_grid(const LayerStack& stack, const Angles& angles, int nodes) {
  std::vector<GridDirection> extra{direction_in(stack.ior_above(), angles.theta_i)};
  for (const double ior : {stack.ior_above(), stack.ior_below()})
    for (const double theta : angles.theta_o) extra.push_back(direction_in(ior, theta));
  const std::size_t thetas = angles.theta_o.size(), count = thetas * angles.phi_o.size();
  BandOnGrid band{
      .stack = detail::make_grid_stack(stack, nodes, extra),
      .result = {
          .brdf = std::vector<double>(count), .btdf = std::vector<double>(count), .nodes = nodes}};
  band.sides.push_back(make_side(band.stack, true, thetas));
  if (!band.stack.is_semi_infinite && band.stack.ground_reflectance == 0.0)
    band.sides.push_back(make_side(band.stack, false, thetas));
  for (const detail::GridLayer& layer : band.stack.layers)
    band.most_modes = std::max(band.most_modes, static_cast<int>(layer.moments.size()));
  if (!is_smooth(stack)) band.most_modes = std::max(band.most_modes, 2 * nodes);
  return band;
}

void add_mode(BandOnGrid& band, const Angles& angles, const detail::RoughBoundaries& rough,
              double accuracy) {
  const GridStack& stack = band.stack;
  const int m = band.result.modes++;
  const detail::StackOperators operators = detail::stack_operators(stack, m, rough);
  std::vector<double> down(active_count(stack.grid, stack.ior.front()), 0.0);
  down[stack.grid.extra[0]] = 1.0 / std::sqrt(extra_node_etendue);
  const std::vector<double> up = detail::product(operators.reflection, down);
  for (const detail::Crossing& crossing : operators.crossings)
    down = detail::product(crossing.pass, down);
  const std::size_t phis = angles.phi_o.size();
  double mode_largest = 0.0;
  for (const Side& side : band.sides) {
    const std::vector<double>& state = side.is_above ? up : down;
    for (std::size_t i = 0; i < angles.theta_o.size(); ++i) {
      const double single = single_on_grid(stack, side, i, m);
      const double rest = state[side.nodes[i]] - single / std::sqrt(extra_node_etendue);
      const double amplitude = (m == 0 ? 1.0 : 2.0) * radiance_factor(side.ior) * rest;
      mode_largest = std::max(mode_largest, std::abs(amplitude));
      for (std::size_t j = 0; j < phis; ++j)
        band.values(side)[i * phis + j] += amplitude * std::cos(m * angles.phi_o[j]);
    }
  }
  band.largest = std::max(band.largest, mode_largest);
  band.negligible = mode_largest <= 0.03 * accuracy * band.largest ? band.negligible + 1 : 0;
}

/// What the modes leave out: light scattered once by a layer or by a facet.
void add_single(BandOnGrid& band, const LayerStack& layers, const Angles& angles) {
  const GridStack& stack = band.stack;
  const std::size_t phis = angles.phi_o.size(), beam = stack.grid.extra[0];
  for (const Side& side : band.sides)
    for (std::size_t i = 0; i < angles.theta_o.size(); ++i)
      for (std::size_t j = 0; j < phis; ++j) {
        const double phi = angles.phi_o[j];
        band.values(side)[i * phis + j] +=
            radiance_factor(side.ior) / std::sqrt(extra_node_etendue) *
                single_exact(layers, stack, side, i, std::cos(phi)) +
            detail::facet_radiance(stack, side.facet[i], beam, side.nodes[i], side.is_above, phi);
      }
  const auto unscattered = detail::unscattered_flux(stack, beam, detail::Unscattered::by_medium);
  band.result.unscattered_reflectance = unscattered.reflectance;
  band.result.unscattered_transmittance = unscattered.down.back();
}

/// All bands on one grid. Their boundaries are equal, so rough ones are made once.
std::vector<StackBsdf> bsdf_on_grid(std::span<const LayerStack* const> stacks, const Angles& angles,
                                    int nodes, double accuracy, const Progress& progress) {
  constexpr int modes_at_once = 8;
  std::vector<BandOnGrid> bands;
  for (const LayerStack* stack : stacks) bands.push_back(put_on_grid(*stack, angles, nodes));
  for (int first = 0; !std::ranges::all_of(bands, &BandOnGrid::is_done); first += modes_at_once) {
    const auto rough = detail::rough_boundaries(bands[0].stack, first, modes_at_once, progress);
    const auto add_modes = [&](std::size_t b) {
      for (const detail::RoughBoundaries& boundaries : rough) {
        if (!bands[b].is_done()) add_mode(bands[b], angles, boundaries, accuracy);
        report_or_throw(progress, 0.0);
      }
    };
    parallel_for(bands.size(), add_modes);
  }
  std::vector<StackBsdf> results;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    add_single(bands[b], *stacks[b], angles);
    results.push_back(std::move(bands[b].result));
  }
  return results;
}

double relative_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double mean = 0.0;
  for (const double value : a) mean += std::abs(value) / static_cast<double>(a.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k] != b[k])
      largest = std::max(largest, std::abs(a[k] - b[k]) / std::max(std::abs(a[k]), mean));
  return largest;
}

/// Refines the grid until all bands are accurate. Their boundaries are equal.
std::vector<StackBsdf> solve_group(std::span<const LayerStack* const> stacks, const Angles& angles,
                                   const StackBsdfOptions& options) {
  constexpr int finest_rough = 42;  // a minute or two
  const bool is_rough = !is_smooth(*stacks[0]);
  const int finest = is_rough ? std::min(options.max_nodes, finest_rough) : options.max_nodes;
  int coarsest = 9;
  for (const LayerStack* stack : stacks) {
    const detail::NarrowestLobe lobe = detail::narrowest_lobe(*stack);
    if (lobe.nodes > finest)
      throw InvalidInput(lobe.where + ": the lobes of roughness " + number_text(lobe.roughness) +
                         " need " + std::to_string(lobe.nodes) + " directions and " +
                         std::to_string(2 * lobe.nodes) +
                         " azimuthal modes, but adding-doubling takes at most " +
                         std::to_string(finest) + " directions; photon Monte Carlo takes them");
    coarsest = std::max(coarsest, (2 * lobe.nodes + 2) / 3);  // the next one resolves it
  }
  const double least_error = is_rough ? rough_bsdf_error : 0.0;
  const double accuracy = std::max(options.accuracy, least_error);
  std::vector<StackBsdf> results(stacks.size());
  std::vector<std::size_t> coarse(stacks.size());
  std::iota(coarse.begin(), coarse.end(), 0);
  int nodes = std::min(coarsest, finest);
  const Progress progress = of_unknown_length(options.progress);
  while (true) {
    std::vector<const LayerStack*> refined;
    for (const std::size_t k : coarse) refined.push_back(stacks[k]);
    std::vector<StackBsdf> finer = bsdf_on_grid(refined, angles, nodes, accuracy, progress);
    for (std::size_t c = 0; c < coarse.size(); ++c) {
      StackBsdf& last = results[coarse[c]];
      finer[c].estimated_error =
          last.nodes == 0 ? 1.0
                          : std::max({relative_difference(finer[c].brdf, last.brdf),
                                      relative_difference(finer[c].btdf, last.btdf), least_error});
      finer[c].is_accurate = finer[c].estimated_error <= options.accuracy;
      last = std::move(finer[c]);
    }
    std::erase_if(coarse, [&](std::size_t k) { return results[k].estimated_error <= accuracy; });
    if (coarse.empty() || nodes >= finest) return results;
    nodes = std::min(nodes * 3 / 2, finest);
  }
}

}  // namespace

std::vector<StackBsdf> stack_bsdf(std::span<const LayerStack> bands, double theta_i,
                                  std::span<const double> theta_o, std::span<const double> phi_o,
                                  const StackBsdfOptions& options) {
  check_angle(theta_i, "angle of incidence");
  for (const double theta : theta_o) check_angle(theta, "angle to look from");
  for (const double phi : phi_o)
    if (!std::isfinite(phi))
      throw InvalidInput("azimuth: must be finite, but is " + number_text(phi));
  if (!(1e-8 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-8, 0.1], but is " +
                       number_text(options.accuracy));
  if (!(4 <= options.max_nodes && options.max_nodes <= 1000))
    throw InvalidInput("max_nodes: must lie in [4, 1000], but is " +
                       std::to_string(options.max_nodes));
  std::vector<StackBsdf> results(bands.size());
  const auto groups = detail::groups_of_equal_boundaries(bands);
  parallel_for(groups.size(), [&](std::size_t g) {
    std::vector<const LayerStack*> stacks;
    for (const std::size_t band : groups[g]) stacks.push_back(&bands[band]);
    std::vector<StackBsdf> solved = solve_group(stacks, {theta_i, theta_o, phi_o}, options);
    for (std::size_t k = 0; k < stacks.size(); ++k) results[groups[g][k]] = std::move(solved[k]);
  });
  return results;
}

StackBsdf stack_bsdf(const LayerStack& stack, double theta_i, std::span<const double> theta_o,
                     std::span<const double> phi_o, const StackBsdfOptions& options) {
  return std::move(stack_bsdf({&stack, 1}, theta_i, theta_o, phi_o, options).front());
}

}  // namespace lamina
