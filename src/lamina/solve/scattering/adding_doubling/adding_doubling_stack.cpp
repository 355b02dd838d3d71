// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lamina/base/core/error.h"
#include "lamina/base/core/number_text.h"

namespace lamina::detail {

Matrix mirror(const DirectionGrid& grid, double ior, double ior_beyond) {
  const std::size_t n = active_count(grid, ior), beyond = active_count(grid, ior_beyond);
  Matrix reflection(n, n);
  for (std::size_t i = 0; i < n; ++i)
    reflection(i, i) = i < beyond ? node_fresnel(grid, i, ior, ior_beyond) : 1.0;
  return reflection;
}

namespace {

Covered cover_by_smooth_interface(const DirectionGrid& grid, double ior_before, double ior_behind,
                                  Matrix below) {
  const std::size_t before = active_count(grid, ior_before), behind = below.rows;
  const std::size_t common = std::min(before, behind);
  std::vector<double> r(std::max(before, behind), 1.0);  // total reflection where not common
  for (std::size_t i = 0; i < common; ++i) r[i] = node_fresnel(grid, i, ior_before, ior_behind);

  Matrix returns = between(mirror(grid, ior_behind, ior_before), below);
  const Matrix sent_back = product(below, returns);
  Covered covered{{Matrix(behind, before), std::move(below)}, Matrix(before, before)};
  for (std::size_t j = 0; j < common; ++j) {
    for (std::size_t i = 0; i < behind; ++i)
      covered.crossing.pass(i, j) = returns(i, j) * (1.0 - r[j]);
    for (std::size_t i = 0; i < common; ++i)
      covered.reflection(i, j) = (1.0 - r[i]) * sent_back(i, j) * (1.0 - r[j]);
  }
  for (std::size_t i = 0; i < before; ++i) covered.reflection(i, i) += r[i];
  covered.crossing.returns = std::move(returns);
  return covered;
}

Covered cover_by_rough_interface(const RoughBoundary& boundary, Matrix below) {
  const Matrix returns = between(boundary.reflection_below, below);
  Matrix pass = product(returns, boundary.transmission_down);
  Matrix reflection = product(boundary.transmission_up, product(below, pass));
  for (std::size_t k = 0; k < reflection.values.size(); ++k)
    reflection.values[k] += boundary.reflection_above.values[k];
  return {{std::move(pass), std::move(below)}, std::move(reflection)};
}

/// A Lambertian ground sends back equal radiance in all directions, so only in mode 0.
Matrix ground_reflection(const GridStack& stack, int m) {
  const std::size_t n = active_count(stack.grid, stack.ior.back());
  Matrix ground(n, n);
  if (m != 0 || stack.ground_reflectance == 0.0) return ground;
  const auto& etendue = stack.grid.etendue;
  const double all =
      std::accumulate(etendue.begin(), etendue.begin() + static_cast<std::ptrdiff_t>(n), 0.0);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      ground(i, j) = stack.ground_reflectance * std::sqrt(etendue[i] * etendue[j]) / all;
  return ground;
}

}  // namespace

Covered cover_by_layer(const LayerOperators& layer, Matrix below) {
  Matrix returns = between(layer.reflection, below);
  Matrix pass = product(returns, layer.transmission);
  Matrix reflection = product(layer.transmission, product(below, pass));
  for (std::size_t k = 0; k < reflection.values.size(); ++k)
    reflection.values[k] += layer.reflection.values[k];
  return {{std::move(pass), std::move(below), std::move(returns)}, std::move(reflection)};
}

std::vector<double> merged_indices(const LayerStack& stack) {
  std::vector<double> ior{stack.ior_above()};
  for (const Layer& layer : stack.layers()) ior.push_back(layer.medium.ior);
  ior.push_back(stack.ior_below());
  std::vector<double> sorted = ior;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    if (sorted[k] == sorted[k - 1] || sorted[k] - sorted[k - 1] > 1e-9 * sorted[k]) continue;
    std::replace(ior.begin(), ior.end(), sorted[k], sorted[k - 1]);
    sorted[k] = sorted[k - 1];
  }
  return ior;
}

GridStack make_grid_stack(const LayerStack& stack, int nodes,
                          std::span<const GridDirection> extra) {
  GridStack made;
  made.ior = merged_indices(stack);
  made.grid = make_direction_grid(made.ior, nodes, extra);
  for (const Layer& layer : stack.layers()) made.interfaces.push_back(layer.top);
  made.interfaces.push_back(stack.ground().top);
  const std::vector<double> reach =
      reach_of_layers(stack.layers(), made.interfaces, made.ior, stack.ground().reflectance > 0.0);
  for (std::size_t k = 0; k < stack.layers().size(); ++k)
    made.layers.push_back(make_grid_layer(stack.layers()[k], made.ior[k + 1], reach[k], made.grid));
  made.ground_reflectance = stack.ground().reflectance;
  made.is_semi_infinite = is_semi_infinite(stack);
  return made;
}

double node_fresnel(const DirectionGrid& grid, std::size_t node, double ior_a, double ior_b) {
  if (ior_a == ior_b) return 0.0;
  const double cos_a = cosine(grid, node, ior_a), cos_b = cosine(grid, node, ior_b);
  const double r_s = (ior_a * cos_a - ior_b * cos_b) / (ior_a * cos_a + ior_b * cos_b);
  const double r_p = (ior_b * cos_a - ior_a * cos_b) / (ior_b * cos_a + ior_a * cos_b);
  return 0.5 * (r_s * r_s + r_p * r_p);
}

std::vector<RoughBoundaries> rough_boundaries(const GridStack& stack, int first, int count,
                                              const Progress& progress) {
  std::vector<RoughBoundaries> modes(static_cast<std::size_t>(count),
                                     RoughBoundaries(stack.interfaces.size()));
  for (std::size_t k = 0; k < stack.interfaces.size(); ++k) {
    if (!is_rough(stack.interfaces[k], stack.ior[k], stack.ior[k + 1])) continue;
    auto boundary = rough_boundary_modes(stack.grid, stack.interfaces[k], stack.ior[k],
                                         stack.ior[k + 1], first, count, progress);
    for (std::size_t m = 0; m < modes.size(); ++m) modes[m][k] = std::move(boundary[m]);
  }
  return modes;
}

std::vector<std::vector<std::size_t>> groups_of_equal_boundaries(
    std::span<const LayerStack> stacks) {
  const auto boundaries = [](const LayerStack& stack) {
    std::vector<Interface> interfaces;
    for (const Layer& layer : stack.layers()) interfaces.push_back(layer.top);
    interfaces.push_back(stack.ground().top);
    return std::pair(merged_indices(stack), std::move(interfaces));
  };
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t k = 0; k < stacks.size(); ++k) {
    const auto has_equal = [&](const std::vector<std::size_t>& group) {
      return boundaries(stacks[group.front()]) == boundaries(stacks[k]);
    };
    const auto group =
        is_smooth(stacks[k]) ? groups.end() : std::ranges::find_if(groups, has_equal);
    if (group != groups.end())
      group->push_back(k);
    else
      groups.push_back({k});
  }
  return groups;
}

StackOperators stack_operators(const GridStack& stack, int m) {
  return stack_operators(stack, m, rough_boundaries(stack, m, 1).front());
}

StackOperators stack_operators(const GridStack& stack, int m, const RoughBoundaries& rough) {
  std::vector<LayerOperators> layers;
  for (const GridLayer& layer : stack.layers) layers.push_back(layer_operators(layer, m));
  return stack_operators(stack, m, rough, layers);
}

StackOperators stack_operators(const GridStack& stack, int m, const RoughBoundaries& rough,
                               std::span<const LayerOperators> layers) {
  StackOperators operators;
  const auto take = [&](Covered covered) {
    operators.crossings.push_back(std::move(covered.crossing));
    operators.reflection = std::move(covered.reflection);
  };
  const auto cover_by_interface = [&](std::size_t k) {
    const double before = stack.ior[k], behind = stack.ior[k + 1];
    if (!is_rough(stack.interfaces[k], before, behind)) {
      if (k == 0) operators.first_reflection = mirror(stack.grid, before, behind);
      return take(
          cover_by_smooth_interface(stack.grid, before, behind, std::move(operators.reflection)));
    }
    if (k == 0) operators.first_reflection = rough[0].reflection_above;
    take(cover_by_rough_interface(rough[k], std::move(operators.reflection)));
  };
  operators.reflection = ground_reflection(stack, m);
  for (std::size_t k = stack.layers.size(); k-- > 0;) {
    cover_by_interface(k + 1);
    take(cover_by_layer(layers[k], std::move(operators.reflection)));
  }
  cover_by_interface(0);
  std::reverse(operators.crossings.begin(), operators.crossings.end());
  return operators;
}

void require_smooth(const LayerStack& stack, const std::string& method) {
  const auto require = [&](const Interface& interface, const std::string& where) {
    if (interface.roughness > 0.0)
      throw InvalidInput(where + ": " + method + " needs smooth boundaries, but the roughness is " +
                         number_text(interface.roughness) +
                         "; photon Monte Carlo takes rough ones");
  };
  for (std::size_t k = 0; k < stack.layers().size(); ++k)
    require(stack.layers()[k].top, "layer " + std::to_string(k));
  require(stack.ground().top, "ground");
}

GridStack turned_over(const GridStack& stack) {
  GridStack turned = stack;
  std::reverse(turned.ior.begin(), turned.ior.end());
  std::reverse(turned.layers.begin(), turned.layers.end());
  std::reverse(turned.interfaces.begin(), turned.interfaces.end());
  return turned;
}

UnscatteredFlux unscattered_flux(const GridStack& stack, std::size_t node, Unscattered which) {
  const std::size_t count = 2 * stack.layers.size() + 1;
  const auto is_active = [&](std::size_t medium) {
    return node < active_count(stack.grid, stack.ior[medium]);
  };
  std::vector<double> below(count), pass(count);  // [crossing]
  double r_below = 0.0;                           // nothing comes back unscattered from a ground
  for (std::size_t c = count; c-- > 0;) {
    below[c] = r_below;
    const std::size_t k = c / 2;
    if (c % 2 == 0 && is_rough(stack.interfaces[k], stack.ior[k], stack.ior[k + 1])) {
      r_below = 0.0;
    } else if (c % 2 == 0) {
      const bool is_common = is_active(k) && is_active(k + 1);
      const double r =
          is_common ? node_fresnel(stack.grid, node, stack.ior[k], stack.ior[k + 1]) : 1.0;
      pass[c] = r < 1.0 ? (1.0 - r) / (1.0 - r * r_below) : 0.0;
      r_below = r + (1.0 - r) * r_below * pass[c];
    } else {
      const GridLayer& layer = stack.layers[k];
      const bool is_fed = is_active(k + 1) && (layer.sigma_s > 0.0 || node < layer.reach);
      const double extinction = which == Unscattered::by_medium || !is_fed ? layer.extinction
                                : which == Unscattered::scaled             ? layer.sigma_t
                                                               : node_extinction(layer, node);
      pass[c] = !is_fed ? 0.0
                : extinction == 0.0
                    ? 1.0
                    : std::exp(-extinction * layer.thickness / cosine(stack.grid, node, layer.ior));
      r_below *= pass[c] * pass[c];
    }
  }
  UnscatteredFlux flux{std::vector<double>(count), std::vector<double>(count), r_below};
  double down = 1.0;
  for (std::size_t c = 0; c < count; ++c) {
    down *= pass[c];
    flux.down[c] = down;
    flux.up[c] = down * below[c];
  }
  return flux;
}

}  // namespace lamina::detail
