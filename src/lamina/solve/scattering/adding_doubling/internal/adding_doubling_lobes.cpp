// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "lamina/solve/scattering/adding_doubling/internal/adding_doubling_lobes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lamina/solve/scattering/adding_doubling/adding_doubling_stack.h"

namespace lamina::detail {
namespace {

constexpr double too_weak = 2e-3;  // fraction of light between the boundaries that is passed over

/// Fraction of light that is not scattered aside between interfaces a < b.
double passes(const LayerStack& stack, std::size_t a, std::size_t b) {
  double depth = 0.0;
  for (std::size_t l = a; l < b; ++l) {
    const Layer& layer = stack.layers()[l];
    if (std::isinf(layer.thickness)) return 0.0;
    const double aside = 1.0 - std::max(0.0, mean_cosine(phase_function(layer)));
    depth += (layer.medium.sigma_a + layer.medium.sigma_s * aside) * layer.thickness;
  }
  return std::exp(-depth);
}

}  // namespace

NarrowestLobe narrowest_lobe(const LayerStack& stack) {
  const std::vector<double> ior = merged_indices(stack);
  const std::size_t layers = stack.layers().size();
  const auto interface = [&](std::size_t k) {
    return k < layers ? stack.layers()[k].top : stack.ground().top;
  };
  const auto rough = [&](std::size_t k) { return is_rough(interface(k), ior[k], ior[k + 1]); };
  NarrowestLobe narrowest;
  for (std::size_t k = 0; k <= layers; ++k)
    for (std::size_t j = 0; rough(k) && j <= layers; ++j) {
      if (j == k || ior[j] == ior[j + 1]) continue;
      const double share = passes(stack, std::min(j, k), std::max(j, k));
      if ((rough(j) ? share : share * share) < too_weak) continue;
      const double width = interface(k).roughness * std::abs(ior[k] - ior[k + 1]);
      const int nodes = static_cast<int>(std::min(1e6, std::ceil(1.5 / width)));
      if (nodes <= narrowest.nodes) continue;
      narrowest = {.nodes = nodes,
                   .where = k < layers ? "layer " + std::to_string(k) : "ground",
                   .roughness = interface(k).roughness};
    }
  return narrowest;
}

}  // namespace lamina::detail
