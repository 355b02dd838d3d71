// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/scattering/adding_doubling_bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "lamina/core/error.h"
#include "lamina/scattering/adding_doubling_single.h"
#include "lamina/scattering/adding_doubling_stack.h"

namespace lamina {
namespace {

using detail::GridStack;
using detail::Matrix;

/// One side of the stack: the nodes to look from, and light scattered once towards each of them.
struct Side {
  double ior = 1.0;
  std::vector<std::size_t> nodes;                             ///< [theta_o]
  std::vector<std::vector<detail::SingleScattering>> single;  ///< [theta_o][layer]
};

void check_angle(double angle, const std::string& name) {
  if (!(0.0 <= angle && angle < 0.5 * std::numbers::pi))
    throw InvalidInput(name + ": must lie in [0, pi/2), but is " + std::to_string(angle));
}

/// The grid has the node of the beam first among its extra nodes, then those to look from above,
/// then those from below.
Side make_side(const GridStack& stack, bool is_above, std::size_t count) {
  Side side{.ior = is_above ? stack.ior.front() : stack.ior.back()};
  const std::size_t beam = stack.grid.extra[0];
  const auto arriving = detail::unscattered_from_above(stack, beam);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t node = stack.grid.extra[1 + (is_above ? 0 : count) + k];
    const auto leaving = is_above ? detail::unscattered_from_above(stack, node)
                                  : detail::unscattered_from_below(stack, node);
    side.nodes.push_back(node);
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

struct Values {
  std::vector<double> brdf, btdf;
};

StackBsdf bsdf_on_grid(const LayerStack& stack, double theta_i, std::span<const double> theta_o,
                       std::span<const double> phi_o, int nodes, double accuracy) {
  std::vector<double> extra{stack.ior_above() * std::sin(theta_i)};
  for (const double ior : {stack.ior_above(), stack.ior_below()})
    for (const double theta : theta_o) extra.push_back(ior * std::sin(theta));
  const GridStack on_grid = detail::make_grid_stack(stack, nodes, extra);
  const std::size_t beam = on_grid.grid.extra[0];
  const std::size_t thetas = theta_o.size(), phis = phi_o.size();
  const bool has_below = !on_grid.is_semi_infinite && on_grid.ground_reflectance == 0.0;
  std::vector<Side> sides{make_side(on_grid, true, thetas)};
  if (has_below) sides.push_back(make_side(on_grid, false, thetas));

  StackBsdf result{.brdf = std::vector<double>(thetas * phis),
                   .btdf = std::vector<double>(thetas * phis),
                   .nodes = nodes};
  const auto values_of = [&](std::size_t side) -> std::vector<double>& {
    return side == 0 ? result.brdf : result.btdf;
  };
  // Azimuth of propagation: light travels towards phi + pi of where it comes from.
  const auto azimuth = [&](std::size_t j) { return phi_o[j] - std::numbers::pi; };

  std::size_t most_modes = 1;
  for (const detail::GridLayer& layer : on_grid.layers)
    most_modes = std::max(most_modes, layer.moments.size());
  double largest = 0.0;
  int negligible = 0;
  for (int m = 0; m < static_cast<int>(most_modes) && negligible < 2; ++m) {
    const detail::StackOperators operators = detail::stack_operators(on_grid, m);
    std::vector<double> down(active_count(on_grid.grid, on_grid.ior.front()), 0.0);
    down[beam] = 1.0 / std::sqrt(extra_node_etendue);
    const std::vector<double> up = detail::product(operators.reflection, down);
    for (const detail::Crossing& crossing : operators.crossings)
      down = detail::product(crossing.pass, down);
    double mode_largest = 0.0;
    for (std::size_t s = 0; s < sides.size(); ++s) {
      const std::vector<double>& state = s == 0 ? up : down;
      const double factor = radiance_factor(sides[s].ior);
      for (std::size_t i = 0; i < thetas; ++i) {
        const double single = single_on_grid(on_grid, sides[s], i, m);
        const double rest = state[sides[s].nodes[i]] - single / std::sqrt(extra_node_etendue);
        const double amplitude = (m == 0 ? 1.0 : 2.0) * factor * rest;
        mode_largest = std::max(mode_largest, std::abs(amplitude));
        for (std::size_t j = 0; j < phis; ++j)
          values_of(s)[i * phis + j] += amplitude * std::cos(m * azimuth(j));
      }
    }
    largest = std::max(largest, mode_largest);
    negligible = mode_largest <= 0.03 * accuracy * largest ? negligible + 1 : 0;
    result.modes = m + 1;
  }
  for (std::size_t s = 0; s < sides.size(); ++s)
    for (std::size_t i = 0; i < thetas; ++i)
      for (std::size_t j = 0; j < phis; ++j)
        values_of(s)[i * phis + j] +=
            radiance_factor(sides[s].ior) / std::sqrt(extra_node_etendue) *
            single_exact(stack, on_grid, sides[s], i, std::cos(azimuth(j)));

  const auto unscattered = detail::unscattered_flux(on_grid, beam, detail::Unscattered::by_medium);
  result.unscattered_reflectance = unscattered.reflectance;
  result.unscattered_transmittance = unscattered.down.back();
  return result;
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

}  // namespace

StackBsdf stack_bsdf(const LayerStack& stack, double theta_i, std::span<const double> theta_o,
                     std::span<const double> phi_o, const StackBsdfOptions& options) {
  check_angle(theta_i, "angle of incidence");
  for (const double theta : theta_o) check_angle(theta, "angle to look from");
  for (const double phi : phi_o)
    if (!std::isfinite(phi))
      throw InvalidInput("azimuth: must be finite, but is " + std::to_string(phi));
  if (!(1e-8 <= options.accuracy && options.accuracy <= 0.1))
    throw InvalidInput("accuracy: must lie in [1e-8, 0.1], but is " +
                       std::to_string(options.accuracy));
  if (!(4 <= options.max_nodes && options.max_nodes <= 1000))
    throw InvalidInput("max_nodes: must lie in [4, 1000], but is " +
                       std::to_string(options.max_nodes));
  detail::require_smooth(stack, "a BRDF by adding-doubling");

  constexpr int coarsest = 9;
  const auto solve = [&](int nodes) {
    return bsdf_on_grid(stack, theta_i, theta_o, phi_o, std::min(nodes, options.max_nodes),
                        options.accuracy);
  };
  StackBsdf result = solve(coarsest);
  result.estimated_error = 1.0;
  while (!result.is_accurate && result.nodes < options.max_nodes) {
    StackBsdf finer = solve(result.nodes * 3 / 2);
    finer.estimated_error = std::max(relative_difference(finer.brdf, result.brdf),
                                     relative_difference(finer.btdf, result.btdf));
    finer.is_accurate = finer.estimated_error <= options.accuracy;
    result = std::move(finer);
  }
  return result;
}

}  // namespace lamina
