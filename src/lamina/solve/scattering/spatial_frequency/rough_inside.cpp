// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/spatial_frequency/rough_inside.h"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "lamina/solve/scattering/spatial_frequency/internal/leaving_light.h"
#include "lamina/solve/scattering/spatial_frequency/internal/stack_at_frequency.h"

namespace lamina::detail {
namespace {

bool is_rough_at(const GridStack& stack, std::size_t interface) {
  return is_rough(stack.interfaces[interface], stack.ior[interface], stack.ior[interface + 1]);
}

/// The first rough boundary below the top; the number of boundaries if there is none.
std::size_t first_rough_inside(const GridStack& stack) {
  std::size_t q = 1;
  while (q < stack.interfaces.size() && !is_rough_at(stack, q)) ++q;
  return q;
}

}  // namespace

bool has_rough_inside(const GridStack& stack) {
  return first_rough_inside(stack) < stack.interfaces.size();
}

GridStack above_rough_inside(GridStack stack) {
  const std::size_t layers = first_rough_inside(stack);
  if (layers == stack.interfaces.size()) return stack;
  stack.layers.resize(layers);
  stack.ior.resize(layers + 2);
  stack.ior.back() = stack.ior[layers];
  stack.interfaces.resize(layers + 1);
  stack.interfaces.back() = {};
  stack.ground_reflectance = 0.0;
  stack.is_semi_infinite = true;
  return stack;
}

double through_rough_bottom(const FrequencySolver& solver, Unscattered which) {
  const GridStack& stack = solver.stack;
  const std::size_t bottom = stack.layers.size(), beam = stack.grid.extra[0];
  if (stack.is_semi_infinite || solver.top.is_rough || !is_rough_at(stack, bottom)) return 0.0;
  const Matrix pass = cover_by_interface(solver, bottom, ground_reflection(solver)).crossing.pass;
  std::vector<double> state(pass.columns, 0.0);
  state[beam] =
      unscattered_flux(stack, beam, which).down[2 * bottom - 1] / std::sqrt(extra_node_etendue);
  const std::vector<double> leaving = product(pass, state);
  const std::vector<double> weights = weights_of_flux(solver, stack.ior.back());
  return (1.0 - stack.ground_reflectance) *
         std::inner_product(leaving.begin(), leaving.end(), weights.begin(), 0.0);
}

}  // namespace lamina::detail
