// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "lamina/layers/optics/layer_stack.h"

namespace lamina::reference {

/// One stack on which the solvers are compared, lit at normal incidence.
struct StackCase {
  std::string name;
  LayerStack stack;
};

/// The shared table of stacks: 1 to 4 layers, matched and mismatched, denser outside, g from -0.3
/// to 0.95, albedo from 0.1 to 1, optical thickness from 0.1 to 30; smooth, black ground.
[[nodiscard]] inline std::vector<StackCase> stack_table() {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  // A layer by its optical thickness, in a medium of extinction 10 / mm.
  const auto slab = [](double tau, double albedo, double g, double ior) {
    constexpr double extinction = 10.0;
    return Layer{.medium = {.sigma_a = extinction * (1.0 - albedo),
                            .sigma_s = extinction * albedo,
                            .g = g,
                            .ior = ior},
                 .thickness = tau / extinction};
  };
  const auto clear = [](double thickness, double ior) {
    return Layer{.medium = {.sigma_a = 0.0, .sigma_s = 0.0, .g = 0.0, .ior = ior},
                 .thickness = thickness};
  };
  const auto layer = [](double sigma_a, double sigma_s, double g, double ior, double thickness) {
    return Layer{.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
                 .thickness = thickness};
  };

  std::vector<StackCase> table;
  const auto add = [&](std::string name, std::vector<Layer> layers, double above = 1.0,
                       double below = 1.0) {
    table.push_back({std::move(name), LayerStack(std::move(layers), above, below)});
  };
  // One layer, matched.
  add("van de Hulst slab", {slab(2.0, 0.9, 0.75, 1.0)});
  add("thin isotropic", {slab(0.1, 0.9, 0.0, 1.0)});
  add("thin absorbing", {slab(0.5, 0.1, 0.0, 1.0)});
  add("thin pure scatterer", {slab(0.3, 1.0, 0.5, 1.0)});
  add("thick pure scatterer", {slab(30.0, 1.0, 0.9, 1.0)});
  add("backward slab", {slab(4.0, 0.8, -0.3, 1.0)});
  add("forward slab", {slab(8.0, 0.99, 0.95, 1.0)});
  add("thick absorbing", {slab(16.0, 0.5, 0.8, 1.0)});
  add("half-space, isotropic", {slab(infinite, 0.9, 0.0, 1.0)});
  add("half-space, dark", {slab(infinite, 0.1, 0.3, 1.0)});
  // One layer, mismatched.
  add("Giovanelli half-space", {slab(infinite, 0.9, 0.0, 1.5)});
  add("glass slab", {slab(1.0, 0.9, 0.0, 1.5)});
  add("water slab, forward", {slab(5.0, 0.95, 0.9, 1.33)});
  add("bright mismatched slab", {slab(10.0, 1.0, 0.5, 1.4)});
  add("backward mismatched slab", {slab(2.0, 0.7, -0.3, 1.4)});
  add("high index", {slab(3.0, 0.9, 0.2, 2.4)});
  add("half-space, forward", {slab(infinite, 0.98, 0.95, 1.4)});
  add("on glass", {slab(6.0, 0.9, 0.7, 1.4)}, 1.0, 1.5);
  // Denser outside.
  add("denser above", {slab(2.0, 0.9, 0.5, 1.0)}, 1.5, 1.0);
  add("denser on both sides", {slab(4.0, 0.95, 0.8, 1.33)}, 1.5, 1.5);
  add("denser below", {slab(1.0, 0.6, 0.0, 1.33)}, 1.0, 1.7);
  // Two layers.
  add("bright on dark", {slab(2.0, 0.99, 0.6, 1.4), slab(4.0, 0.3, 0.0, 1.4)});
  add("dark on bright", {slab(0.5, 0.4, 0.7, 1.4), slab(infinite, 0.99, 0.8, 1.4)});
  add("lighter on denser", {slab(1.0, 0.9, 0.8, 1.33), slab(3.0, 0.9, 0.3, 1.5)});
  add("denser on lighter", {slab(1.0, 0.9, 0.8, 1.5), slab(3.0, 0.9, 0.3, 1.33)});
  add("cover glass", {clear(1.0, 1.5), slab(5.0, 0.95, 0.9, 1.37)});
  add("clear layer below", {slab(1.0, 0.95, 0.5, 1.4), clear(0.5, 1.5)});
  // Three layers.
  add("skin, red", {layer(2.1, 48.0, 0.0, 1.4, 0.03), layer(0.16, 32.0, 0.25, 1.34, 0.05),
                    layer(0.085, 4.5, 0.8, 1.4, infinite)});
  add("skin, green", {layer(2.1, 60.0, 0.0, 1.4, 0.03), layer(0.19, 40.0, 0.25, 1.34, 0.05),
                      layer(1.0, 4.7, 0.8, 1.4, infinite)});
  add("skin, blue", {layer(5.0, 65.0, 0.0, 1.4, 0.03), layer(0.3, 46.0, 0.25, 1.34, 0.05),
                     layer(25.0, 4.8, 0.8, 1.4, infinite)});
  add("matched trio",
      {slab(0.5, 0.9, 0.9, 1.0), slab(1.0, 0.5, -0.3, 1.0), slab(2.0, 1.0, 0.5, 1.0)});
  add("air gap", {slab(2.0, 0.95, 0.5, 1.5), clear(0.1, 1.0), slab(2.0, 0.95, 0.5, 1.5)});
  // Four layers.
  add("four mismatched layers", {slab(0.2, 0.9, 0.95, 1.5), slab(1.0, 0.8, 0.5, 1.35),
                                 slab(5.0, 0.99, 0.8, 1.45), slab(3.0, 0.6, 0.0, 1.33)});
  add("glazing",
      {clear(0.2, 1.5), slab(0.5, 0.3, 0.0, 1.5), slab(10.0, 0.995, 0.6, 1.5), clear(0.2, 1.6)});
  add("four layers, denser outside",
      {slab(0.5, 0.95, 0.7, 1.3), slab(0.5, 0.95, -0.2, 1.4), slab(0.5, 0.5, 0.7, 1.3),
       slab(infinite, 0.97, 0.9, 1.4)},
      1.6);
  add("a micrometre of pigment", {layer(100.0, 100.0, 0.5, 1.4, 0.001), slab(2.0, 0.9, 0.8, 1.4)});
  return table;
}

/// Stacks with rough boundaries: at the top, below, inside; to lighter and denser media; Beckmann's
/// and GGX's facets from fine to coarse.
[[nodiscard]] inline std::vector<StackCase> rough_stack_table() {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  constexpr auto ggx = MicrofacetDistribution::ggx;
  const auto layer = [](double sigma_a, double sigma_s, double g, double ior, double thickness,
                        Interface top = {}) {
    return Layer{.medium = {.sigma_a = sigma_a, .sigma_s = sigma_s, .g = g, .ior = ior},
                 .thickness = thickness,
                 .top = top};
  };
  const Interface fine{.roughness = 0.1}, middle{.roughness = 0.4}, coarse{.roughness = 0.8};
  const Interface fine_ggx{0.1, ggx}, middle_ggx{0.4, ggx}, coarse_ggx{1.0, ggx};
  std::vector<StackCase> table;
  const auto add = [&](std::string name, std::vector<Layer> layers, double above = 1.0,
                       double below = 1.0, Ground ground = {}) {
    table.push_back({std::move(name), LayerStack(std::move(layers), above, below, ground)});
  };
  add("fine top", {layer(0.5, 10.0, 0.5, 1.5, 0.3, fine)});
  add("rough top", {layer(0.5, 10.0, 0.5, 1.5, 0.3, middle)});
  add("coarse top", {layer(0.5, 10.0, 0.5, 1.5, 0.3, coarse)});
  add("coarse GGX top, half-space", {layer(0.1, 10.0, 0.8, 1.4, infinite, coarse_ggx)}, 1.0, 1.4);
  add("denser outside", {layer(0.5, 10.0, 0.5, 1.0, 0.3, middle)}, 1.5, 1.5);
  add("rough bottom", {layer(0.2, 3.0, 0.3, 1.4, 0.3)}, 1.0, 1.0, {.top = coarse_ggx});
  add("rough inside", {layer(0.5, 10.0, 0.5, 1.3, 0.2), layer(0.2, 5.0, 0.8, 1.6, 0.4, middle_ggx)},
      1.0, 1.3);
  add("clear rough plate", {layer(0.3, 0.0, 0.0, 1.5, 1.0, fine_ggx)}, 1.0, 1.0, {.top = middle});
  add("rough glass on paint",
      {layer(0.0, 0.0, 0.0, 1.5, 1.0, middle), layer(0.01, 10.0, 0.7, 1.35, 1.0, coarse)});
  add("rough all over",
      {layer(0.0, 5.0, 0.9, 1.5, 0.3, fine), layer(1.0, 4.0, 0.0, 1.2, 0.2, coarse)}, 1.3, 1.6,
      {.top = middle_ggx});
  return table;
}

/// The stack of that name. @throws std::out_of_range
[[nodiscard]] inline const LayerStack& find_stack(const std::string& name) {
  static const std::vector<StackCase> table = stack_table();
  for (const StackCase& entry : table)
    if (entry.name == name) return entry.stack;
  throw std::out_of_range(name);
}

}  // namespace lamina::reference
